"""From a recording to the motion of the coordinates: q, q', q'' with bands.

Every coordinate is a quintic spline; all sensors together, whether they measure positions, speeds
or accelerations, determine its coefficients by weighted least squares (Gauss–Newton where a
sensor is nonlinear). The spacing of the knots is chosen by the Bayesian information criterion.
No second derivative of noisy data is formed by differences. Uneven and missing samples need no
special care. Where no sensor shows a place, the equations of motion are rows of the same problem,
weighted by the force that the model may lack.
Sizes: N samples, n coordinates, m sensors, B coefficients a coordinate.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.channel_spread import noise_spread
from symhyb.discrepancy.recorded.cyclic import cyclic, rates_shown
from symhyb.discrepancy.recorded.independent import Independent, independent, placed_with
from symhyb.discrepancy.recorded.knots import SPACINGS, SplineFit, chosen
from symhyb.discrepancy.recorded.signals import acting, measured, noise_level
from symhyb.discrepancy.recorded.splines import design, ridge, spline_basis, swings
from symhyb.discrepancy.recorded.tracking import firmness, tracked
from symhyb.discrepancy.recorded.watching import watching_model
from symhyb.errors import InputError, Problem
from symhyb.model.types import Energy
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.known import Known, machine_with
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import closed, gaps_of, placing

GUIDE_FIRST = 0.01  # of what acts: the force that a model may lack at first, where it must guide
GUIDE_LEAST, GUIDE_MOST = 0.02, 0.5  # of what acts, afterwards
GUIDE_ROUNDS = 3
GUIDE_KNOTS = 4  # samples


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """Smoothed motion of one recording, SI: ``q``, ``v``, ``a`` (N, n) and one standard deviation
    of each in ``q_sd``, ``v_sd``, ``a_sd`` (n,); ``sd`` (m,) is the measured noise of the sensors
    (NaN for a sensor without samples), ``spacing_s`` the distance of the knots in s, ``blind`` the
    coordinates whose place no sensor shows and the model had to determine, ``known`` the parameters
    that the recording knows."""

    t: Array
    q: Array
    v: Array
    a: Array
    q_sd: Array
    v_sd: Array
    a_sd: Array
    sd: Array
    spacing_s: float
    blind: tuple[str, ...] = ()
    known: Known = field(default_factory=dict)

    def periods(self) -> Array:
        """Typical period 2π·RMS(q')/RMS(q'') of each coordinate that moves, s; at most the length
        of the recording."""
        whole = float(self.t[-1] - self.t[0])
        speed, pull = (np.sqrt(np.mean(part**2, axis=0)) for part in (self.v, self.a))
        moves = (speed > 0) & (pull > 0)
        if not moves.any():
            return np.array([whole])
        return np.asarray(np.minimum(2 * np.pi * speed[moves] / pull[moves], whole))

    def every(self, factor: int) -> "Motion":
        """The motion at the middle of each block of ``factor`` samples."""
        return self.at(np.arange(self.t.size // factor) * factor + factor // 2)

    def at(self, rows: slice | NDArray[np.int64]) -> "Motion":
        """The motion at some of its samples."""
        return replace(self, t=self.t[rows], q=self.q[rows], v=self.v[rows], a=self.a[rows])


def motion_of(
    recording: Recording, machine: Machine, spacings_s: Sequence[float] | None = None
) -> Motion:
    """Estimate the motion of all coordinates from whatever the sensors of a recording give.

    Sensors of forces say nothing about it: they show what the model may lack. ``spacings_s`` are
    distances of the knots in s to choose from; by default all that the samples allow.

    Raises:
        InputError: too few samples, or none of any sensor of motion.
    """
    machine = machine_with(machine, recording.parameters)
    shown, watching = _watched(recording, machine)
    motion = replace(_smoothed(shown, watching, spacings_s), known=recording.parameters)
    if watching is machine:
        return motion
    spreads = dict(zip((sensor.name for sensor in watching.model.sensors), motion.sd, strict=True))
    y = measured(recording, machine)
    sd = [
        float(spreads.get(sensor.name, noise_level(column)))
        for sensor, column in zip(machine.model.sensors, y.T, strict=True)
    ]
    return replace(motion, sd=np.array(sd))


def unplaced(recording: Recording, machine: Machine) -> tuple[str, ...]:
    """The coordinates that would be ``blind`` in the motion of a recording, without estimating it.

    Raises:
        InputError: no samples of any sensor of motion.
    """
    shown, watching = _watched(recording, machine)
    return _unplaced(shown, watching, measured(shown, watching), acting(shown, watching))


def _watched(recording: Recording, machine: Machine) -> tuple[Recording, Machine]:
    """A recording of the sensors of motion alone, and the machine with these."""
    watching, shown = watching_model(machine.model, recording)
    if watching is machine.model:
        return recording, machine
    return shown, build(watching, keep=False)


def given_motion(recording: Recording, machine: Machine) -> Array:
    """Places, speeds and accelerations (N, 3·g) of the g imposed coordinates, smoothed, SI."""
    model = machine.model
    imposed = tuple(c for c in model.coordinates if c.imposed)
    alone = replace(
        model,
        coordinates=imposed,
        states=(),
        points=(),
        bodies=(),
        elements=(),
        sensors=(),
        energy=Energy(),
        constraints=(),
        assembly=None,
    )
    watching, shown = watching_model(alone, recording)
    motion = _smoothed(shown, build(watching, keep=False))
    return np.concatenate([motion.q, motion.v, motion.a], axis=1)


def _smoothed(
    recording: Recording, machine: Machine, spacings_s: Sequence[float] | None = None
) -> Motion:
    y, u = measured(recording, machine), acting(recording, machine)
    t, step = recording.t, float(np.median(np.diff(recording.t)))
    blind = _unplaced(recording, machine, y, u)
    sd = np.array([noise_level(column) for column in y.T])
    weights, watched = _weights(y, sd), len(sd)
    first: Array | None = None
    few: Independent | None = None
    if machine.constraints:
        first = tracked(machine, y, u, t, weights)
        few = None if blind else independent(machine, first, t)
    if machine.constraints and first is not None and few is None:
        noise = np.nan_to_num([noise_level(column) for column in first.T])
        held = firmness(machine, first, t, noise)
        y = np.concatenate([y, np.zeros((t.size, held.size))], axis=1)
        weights = np.concatenate([weights, held])
    if blind:
        guide = _guide(machine, t, u, y, weights, step, first)
        y = np.concatenate([y, np.zeros((t.size, guide.size))], axis=1)
        weights = np.concatenate([weights, guide])

    def fitted(rows: slice, spacing: float) -> SplineFit:
        places = few or (None if first is None else first[rows])
        return _fit(machine, t[rows], u[rows], y[rows], weights, spacing * step, places)

    spacings = SPACINGS if spacings_s is None else [s / step for s in spacings_s]
    usable = [s for s in spacings if t.size >= 4 * s] if np.isfinite(sd).any() else []
    if not usable:
        text = f"{t.size} samples are too few to estimate a motion"
        raise InputError(Problem(text, file=recording.name))
    fit, narrower = chosen(fitted, usable, t.size, whole=few is not None)
    q, v, a = (np.column_stack([b @ c for c in fit.coefficients]) for b in fit.basis)
    q_sd, v_sd, a_sd = (_spread(order, fit, narrower) for order in range(3))
    lost = (
        len(fit.coefficients) * fit.basis[0].shape[1] / max(int(np.isfinite(fit.residual).sum()), 1)
    )
    pairs = zip(fit.residual[:, :watched].T, y.T, strict=False)
    spread = np.array([noise_spread(*pair, t) for pair in pairs]) / np.sqrt(1 - lost)
    if few is not None:
        q, v, a = few.complete((q, v, a))
        q_sd, v_sd, a_sd = (few.spread((q, v, a), sd) for sd in (q_sd, v_sd, a_sd))
    elif machine.constraints:
        on = closed(machine, (q, v, a), t, machine.values, machine.imposed, q_sd**2)
        q, v, a = on.q, on.v, on.a
    return Motion(t, q, v, a, q_sd, v_sd, a_sd, spread, fit.spacing, blind)


def _unplaced(recording: Recording, machine: Machine, y: Array, u: Array) -> tuple[str, ...]:
    """The coordinates whose place no sensor of the recording shows, though something depends on it
    or no sensor shows their rate."""
    coordinates = machine.model.coordinates
    start = np.array(machine.model.start()[0])
    rows = start + 1e-3 * np.arange(1, recording.t.size + 1)[:, None]  # away from special places
    _, slopes = _sense(machine, rows, rows, rows, u, recording.t, closing=False)
    recorded = np.isfinite(y).any(axis=0)
    if not recorded.any():
        text = "none of the model's sensors of motion has samples here"
        raise InputError(Problem(text, "sensors", recording.name))
    power = np.atleast_1d(np.abs(slopes[0][:, recorded]).sum(axis=(0, 1)))
    if machine.constraints:
        power = placed_with(machine, rows, recording.t, slopes[0][:, recorded])
    elif not np.all(power > 0):
        known = np.isin(np.arange(machine.n), list(cyclic(machine, u, recording.t)))
        power = power + (known & rates_shown(np.asarray(slopes[1])[:, recorded]))
    return tuple(c.name for c, seen in zip(coordinates, power, strict=True) if not seen > 0)


def _guide(
    machine: Machine,
    t: Array,
    u: Array,
    y: Array,
    weights: Array,
    step: float,
    first: Array | None = None,
) -> Array:
    """How much the model counts where sensors do not show a place: 1/sd (f,) of the force that it
    may lack on each free coordinate, SI.

    First the model rules; then it may lack what is left over, between 2 % and half of what acts or
    of what the seen accelerations take.
    """
    free = list(machine.free)
    start = np.array(machine.model.start()[0])
    still = np.tile(start, (t.size, 1))
    rest = np.zeros_like(still)
    guided = np.concatenate([y, np.zeros((t.size, len(free)))], axis=1)
    acts = _forces(machine, still, rest, u, t)[:, free]
    (mass,) = call(machine.M, (start, float(t[0]), machine.values))
    plain = _fit(machine, t, u, y, weights, GUIDE_KNOTS * step, first)
    pulls = np.array([np.std(plain.basis[2] @ c) for c in plain.coefficients]) * np.diag(mass)
    moved = np.maximum(pulls[free], 1e-3 * np.diag(mass)[free])
    size = np.maximum(np.sqrt(np.mean(acts**2, axis=0)), moved)
    lacks = np.where(size > 0, GUIDE_FIRST * size, 1.0)  # nothing acts on a part without mass yet
    for _ in range(GUIDE_ROUNDS):
        weighed = np.concatenate([weights, 1 / lacks])
        fit = _fit(machine, t, u, guided, weighed, GUIDE_KNOTS * step, first)
        q, v = (np.column_stack([b @ c for c in fit.coefficients]) for b in fit.basis[:2])
        acts = _forces(machine, q, v, u, t)[:, free]
        size = np.maximum(np.sqrt(np.mean(acts**2, axis=0)), pulls[free])
        left = np.sqrt(np.mean(fit.residual[:, y.shape[1] :] ** 2, axis=0))
        lacks = np.maximum(np.clip(left, GUIDE_LEAST * size, GUIDE_MOST * size), 1e-12)
    return np.asarray(1 / lacks)


def _forces(machine: Machine, q: Array, v: Array, u: Array, t: Array) -> Array:
    """k_e (N, n) along a motion, inner states at rest."""
    z = _remembered(machine, (q, v, 0 * q), u, t)
    (force,) = along(machine.k_e, (q, v, z, u, t, machine.values), (5,), t.size)
    return force


def _remembered(machine: Machine, motion: tuple[Array, Array, Array], u: Array, t: Array) -> Array:
    """Declared states (N, z) along a motion, inner states of elements at rest."""
    z, declared = np.zeros((t.size, machine.inner_states)), len(machine.model.states)
    if declared:
        z[:, :declared] = inner_along(machine, t, motion, u, machine.values)[:, :declared]
    return z


def _spread(order: int, fit: SplineFit, narrower: SplineFit) -> Array:
    """One sd (n,) of a derivative of the coordinates, SI: noise, and the bias of knots that are
    balanced for q: what narrower knots change beyond what their noise explains."""
    noise = fit.variance * fit.bands[order] ** 2
    more = narrower.variance * narrower.bands[order] ** 2
    pairs = zip(fit.coefficients, narrower.coefficients, strict=True)
    inner = slice(fit.residual.shape[0] // 10, -(fit.residual.shape[0] // 10))  # ends are wilder
    moved = [_rms((fit.basis[order] @ c - narrower.basis[order] @ d)[inner]) for c, d in pairs]
    bias = np.maximum(np.square(moved) - np.maximum(more - noise, 0.0), 0.0)
    return np.asarray(np.sqrt(noise + bias))


def _fit(
    machine: Machine,
    t: Array,
    u: Array,
    y: Array,
    weights: Array,
    spacing: float,
    first: Array | Independent | None = None,
) -> SplineFit:
    """Splines fitted to measurements, from the declared start or from places ``first`` (N, n); of
    the independent coordinates alone where these are known."""
    basis = spline_basis(t, spacing)
    few = first if isinstance(first, Independent) else None
    n, size = machine.n if few is None else len(few.chosen), basis[0].shape[1]
    starts = np.array(machine.model.start()[0])
    coefficients = np.repeat(starts[:, None], size, axis=1)
    if first is not None:
        places = first if few is None else few.q[:, list(few.chosen)]
        normal = sparse.csc_array(basis[0].T @ basis[0])
        coefficients = splu(normal + ridge(normal)).solve(basis[0].T @ places).T
    shown = len(machine.model.sensors) + (machine.constraints if few is None else 0)
    used, guided = np.isfinite(y), y.shape[1] > shown
    residual = np.full(y.shape, np.nan)
    rows, solver = sparse.csr_array((0, n * size)), None
    known: tuple[Array, ...] = ()
    for _ in range(12):
        q, v, a = (np.column_stack([b @ c for c in coefficients]) for b in basis)
        predicted, slopes = _seen(machine, (q, v, a), u, t, guided, few)
        residual = np.where(used, y - predicted, np.nan)
        if solver is None or not all(map(np.array_equal, slopes, known)):
            rows, known = design(basis, slopes, used, weights), slopes
            normal = (rows.T @ rows).tocsc()
            normal = normal + ridge(normal)
            solver = splu(normal)
        target = (residual * weights).T[used.T]
        change = solver.solve(rows.T @ target).reshape(n, size)
        coefficients = coefficients + change
        moved = np.abs(basis[0] @ change.T).max() / max(np.abs(q).max(), 1e-300)
        if moved < 1e-9:
            break
    q, v, a = (np.column_stack([b @ c for c in coefficients]) for b in basis)
    residual = np.where(used, y - _seen(machine, (q, v, a), u, t, guided, few)[0], np.nan)
    count = int(used.sum())
    cost = float(np.nansum((residual * weights) ** 2))
    free = max(count - n * size, 1)
    criterion = count * np.log(max(cost, 1e-300) / count) + n * size * np.log(count)
    if free < 0.15 * count or swings(t, q, v):
        criterion = np.inf
    fitted = list(coefficients)
    return SplineFit(fitted, basis, residual, cost / free, criterion, spacing, solver)


def _seen(
    machine: Machine,
    motion: tuple[Array, Array, Array],
    u: Array,
    t: Array,
    guided: bool,
    few: Independent | None,
) -> tuple[Array, tuple[Array, ...]]:
    """What :func:`_sense` says of the coordinates that have splines."""
    if few is None:
        return _sense(machine, *motion, u, t, guided)
    full = few.complete(motion)
    y, slopes = _sense(machine, *full, u, t, closing=False)
    return y, few.lifted(full, slopes)


def _weights(y: Array, sd: Array) -> Array:
    """1/sd of every sensor (m,); a hundredth of its spread where too few samples show the noise."""
    spread = np.array([np.std(c[np.isfinite(c)]) if np.isfinite(c).any() else 0.0 for c in y.T])
    known = np.where(np.isfinite(sd), sd, 1e-2 * spread)
    level = np.maximum(known, 1e-9 * spread)
    return np.asarray(1 / np.where(level > 0, level, 1.0))  # a channel that stands still weighs 1


def _sense(
    machine: Machine,
    q: Array,
    v: Array,
    a: Array,
    u: Array,
    t: Array,
    guided: bool = False,
    closing: bool = True,
) -> tuple[Array, tuple[Array, ...]]:
    """Sensors (N, m) and their slopes by q, v and a (N, m, n); ``closing``, also what constraints
    leave open; ``guided``, also the force that the model lacks on the free coordinates."""
    total, m, n = t.size, len(machine.model.sensors), machine.n
    z = np.zeros((total, machine.inner_states))
    if guided:
        z = _remembered(machine, (q, v, a), u, t)
    arguments = (q, v, a, z, u, t, machine.values)
    (y,) = along(machine.outputs, arguments, (6,), total)
    slopes = along(machine.output_slopes, arguments, (6,), total)
    shaped = tuple(s.reshape(total, n, m).transpose(0, 2, 1) for s in slopes)
    if machine.constraints and closing:
        gaps = gaps_of(machine, q, v, a, t, machine.values)
        places = np.isin(np.arange(machine.constraints), placing(machine))
        left = np.where(places, gaps.gap, gaps.rate)
        y, m = np.concatenate([y.reshape(total, m), left], axis=1), m + machine.constraints
        on = places[:, None]  # of a nonholonomic row the speed is held, of others the place
        held = np.where(on, gaps.slope, gaps.turn), np.where(on, 0, gaps.slope), 0 * gaps.slope
        shaped = tuple(np.concatenate(pair, axis=1) for pair in zip(shaped, held, strict=True))
    if not guided:
        return y.reshape(total, m), shaped
    free = list(machine.free)
    (lacking,) = along(machine.discrepancy, arguments, (6,), total)
    more = along(machine.discrepancy_slopes, arguments, (6,), total)
    rows = [s.reshape(total, n, n).transpose(0, 2, 1)[:, free] for s in more]
    joined = tuple(np.concatenate(pair, axis=1) for pair in zip(shaped, rows, strict=True))
    return np.concatenate([y.reshape(total, m), lacking[:, free]], axis=1), joined


def _rms(values: Array) -> float:
    good = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(good**2))) if good.size else float("nan")
