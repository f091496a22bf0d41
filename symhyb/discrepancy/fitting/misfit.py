"""How badly a model and its sensors fit the motion that recordings show, without simulating.

Two things are measured. *Forces*: what ΔF holds of all forces, inertia included, that act on the
coordinates, as it is and after the best two ordinary causes took what they could: laws of the
motion with the signs that physics allows, equal and opposite between two coordinates, and every
force of the model wrong by up to half. *Senses*: how far the sensors contradict each other,
whatever the forces are. Sizes: N samples, n coordinates, C causes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.residual import discrepancy, force_band
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.recorded.signals import noise_level
from symhyb.judgement import GAIN_REACH, SLIP_MOST
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import free_part

TRIMMED = 0.04  # of a recording at either end, where splines are wild
ROWS_MOST = 3000  # samples of a recording that are looked at
BEAM = 6  # single causes that are tried with a second one

Limited = tuple[Array, float, float]


@dataclass(frozen=True, slots=True)
class Misfit:
    """Shares of squares, dimensionless: ΔF against all forces (``plain``, the sum over coordinates)
    and what two ordinary causes and noise leave of it (``ordinary``); ``senses``, the worst sensor
    against its spread."""

    plain: float
    ordinary: float
    senses: float

    @property
    def worst(self) -> float:
        """What neither ordinary physics nor consistent sensors explain."""
        return max(self.ordinary, self.senses)


@dataclass(frozen=True, slots=True)
class _Forces:
    """Along one recording, SI: ΔF (N, n) of the free coordinates, the squares (n,) of all that acts
    and of the noise, and what ordinary causes do: columns (N, n, C) with bounds (C,)."""

    lacking: Array
    size: Array
    noise: Array
    columns: Array
    lower: Array
    upper: Array


def misfit(machine: Machine, runs: Sequence[Run]) -> Misfit:
    """The misfit of a model, with ``machine.values``, along the smoothed motion of recordings."""
    parts = [_forces(machine, run) for run in runs]
    size = np.sum([part.size for part in parts], axis=0)
    scale = np.where(size > 0, 1 / np.sqrt(np.where(size > 0, size, 1.0)), 0.0)
    lacking = np.concatenate([(part.lacking * scale).ravel() for part in parts])
    columns = np.concatenate(
        [(p.columns * scale[:, None]).reshape(-1, p.columns.shape[2]) for p in parts]
    )
    plain = float(lacking @ lacking)
    noise = float(np.sum([part.noise * scale**2 for part in parts]))
    left = _least(columns, lacking, parts[0].lower, parts[0].upper)
    return Misfit(plain, max(left - noise, 0.0), senses(machine, runs))


def senses(machine: Machine, runs: Sequence[Run]) -> float:
    """The largest share of a sensor's variance, beyond its noise, that a motion common to all
    sensors leaves."""
    worst = 0.0
    for run in runs:
        for sensor, sd in zip(machine.model.sensors, run.motion.sd, strict=True):
            values = run.recording.sensors.get(sensor.name)
            spread = 0.0 if values is None else float(np.nanstd(values))
            if values is None or not spread > 0 or not np.isfinite(sd):
                continue
            noise = noise_level(values)
            beyond = sd**2 - (noise**2 if np.isfinite(noise) else 0.0)
            worst = max(worst, float(beyond / spread**2))
    return worst


def _forces(machine: Machine, run: Run) -> _Forces:
    c, free = course_of(run.recording, machine, run.motion), list(machine.free)
    count = c.t.size
    rows = slice(int(TRIMMED * count), count - int(TRIMMED * count), max(count // ROWS_MOST, 1))
    p = c.values(machine)
    given = c.q, c.v, c.z, c.u, c.t, p
    (k_e,) = along(machine.k_e, given, (5,), count)
    (flat,) = along(machine.elements, given, (5,), count)
    elements = flat.reshape(count, -1, machine.n).swapaxes(1, 2)
    k_e, elements = (free_part(machine, c.q, c.t, p, f) for f in (k_e, elements))
    lacking = discrepancy(machine, c, machine.values)
    rest, inertia = k_e - elements.sum(axis=2), lacking + k_e
    acting = np.concatenate([elements, inertia[..., None], rest[..., None]], axis=2)[rows][:, free]
    noise = force_band(machine, run.motion, c)[rows][:, free]
    ordinary = list(_laws(c, free, rows, acting[..., -2]))
    if machine.constraints:
        ordinary = [(_held(machine, c, rows, f), low, high) for f, low, high in ordinary]
    ordinary += [(acting[..., e], -GAIN_REACH, GAIN_REACH) for e in range(acting.shape[2])]
    return _Forces(
        lacking[rows][:, free],
        np.sum(acting**2, axis=(0, 2)),
        np.sum(noise**2, axis=0),
        np.stack([column for column, _, _ in ordinary], axis=2),
        np.array([low for _, low, _ in ordinary]),
        np.array([high for _, _, high in ordinary]),
    )


def _held(machine: Machine, c: Course, rows: slice, force: Array) -> Array:
    """What constraints leave of a force (N, f) on the free coordinates at some rows of a course."""
    free = list(machine.free)
    whole = np.zeros((force.shape[0], machine.n))
    whole[:, free] = force
    return free_part(machine, c.q[rows], c.t[rows], c.values(machine), whole)[:, free]


def _laws(c: Course, free: Sequence[int], rows: slice, inertia: Array) -> Iterator[Limited]:
    """Forces (N, n) of unit laws on every coordinate and between two, with the bounds of their
    coefficients: a passive machine only loses energy, and what it does to one coordinate it does to
    the other in the opposite direction."""
    q, v, a = c.q[rows][:, free], c.v[rows][:, free], c.a[rows][:, free]
    for i in range(len(free)):
        own = np.eye(len(free))[i]
        for held in _holding(q[:, i]):
            yield held[:, None] * own, -np.inf, np.inf
        for lost in _losing(v[:, i]):
            yield -lost[:, None] * own, 0.0, np.inf
        pull = float(np.linalg.norm(a[:, i]))
        mass = float(np.linalg.norm(inertia[:, i])) / pull if pull > 0 else 0.0
        yield -a[:, i : i + 1] * own, 0.0, SLIP_MOST * mass
        for j in range(i):
            pair = own - np.eye(len(free))[j]
            for held in _holding(q[:, i] - q[:, j])[1:]:
                yield held[:, None] * pair, -np.inf, np.inf
            for lost in _losing(v[:, i] - v[:, j]):
                yield -lost[:, None] * pair, 0.0, np.inf


def _holding(s: Array) -> tuple[Array, ...]:
    centred = s - s.mean()
    return np.ones_like(s), centred, centred**3, np.sin(s), np.cos(s)


def _losing(rate: Array) -> tuple[Array, ...]:
    fast = max(float(np.abs(rate).max()), 1e-300)
    return rate, np.abs(rate) * rate, np.tanh(100 * rate / fast)


def _least(columns: Array, lacking: Array, lower: Array, upper: Array) -> float:
    """The squares of ``lacking`` (R,) that the best two of the columns (R, C) leave, their
    coefficients (C,) within bounds."""
    total = float(lacking @ lacking)
    length = np.linalg.norm(columns, axis=0)
    used = np.flatnonzero(np.isfinite(length) & (length > 0))
    if total <= 0 or used.size == 0:
        return total
    unit = columns[:, used] / length[used]
    low, high = lower[used] * length[used], upper[used] * length[used]
    gram, along_each = unit.T @ unit, unit.T @ lacking
    alone = np.clip(along_each, low, high)
    single = total - 2 * alone * along_each + alone**2
    best = float(single.min())
    for i in np.argsort(single)[:BEAM]:
        overlap = gram[i]
        free = 1 - overlap**2
        with np.errstate(divide="ignore", invalid="ignore"):
            first = (along_each[i] - overlap * along_each) / free
            second = (along_each - overlap * along_each[i]) / free
            pair = total - first * along_each[i] - second * along_each
        allowed = (free > 1e-9) & (first >= low[i]) & (first <= high[i])
        allowed &= (second >= low) & (second <= high)
        best = min(best, float(pair[allowed].min(initial=np.inf)))
    return max(best, 0.0)
