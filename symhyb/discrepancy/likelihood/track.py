"""A recording linearised along a trajectory, ready for the filter.

A track is one stretch of a recording without a gap in time. It is linearised from sample to sample:
every sample starts anew at the trajectory, so that no error grows on the way, and an unstable
machine under control is as good a subject as any.
Sizes: N samples, X states, n coordinates, m sensors, F free parameters, K columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.fitting.anchors import begin_spread
from symhyb.discrepancy.likelihood.filter import smooth, whiten
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import Linear, WindowModel

INNER_SPREAD = 0.05  # of the RMS of an inner state: how well its start is known


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """One stretch (``item``), linearised along states ``x`` (N, X): ``linear`` as of one window,
    ``residual`` (N, m) measured less computed (0 where not ``seen``), ``step_s`` (N − 1,), and what
    is known of the first state: its offset (X,) from the trajectory and covariance ``P0`` (X, X).
    SI."""

    linear: Linear
    item: Cut
    residual: Array
    seen: NDArray[np.bool_]
    step_s: Array
    first: Array
    P0: Array

    @property
    def x(self) -> Array:
        """The trajectory (N, X)."""
        return np.asarray(self.linear.x[0])

    @property
    def item_y(self) -> Array:
        """What was measured (N, m), NaN where missing."""
        return np.asarray(self.item.block.y[0])

    @property
    def count(self) -> int:
        """Measurements that are there."""
        return int(np.count_nonzero(self.seen))


@dataclass(frozen=True, slots=True, eq=False)
class Extra:
    """Columns that no parameter of the model makes: generalized ``force`` (N, n, K) and parts of
    what the sensors show, ``output`` (N, m, K), for a coefficient of 1, SI. Forces run straight
    from sample to sample; where they jump, ``before`` (N, n, K) has them just before each."""

    force: Array
    output: Array
    before: Array | None = None

    @property
    def arriving(self) -> Array:
        """The force (N, n, K), SI, just before each sample."""
        return self.force if self.before is None else self.before

    def driving(self, linear: Linear) -> tuple[Array, Array]:
        """What the columns do to the next state (N - 1, X, K) and to the sensors (N, m, K)."""
        pushed = linear.left[0] @ self.force[:-1] + linear.right[0] @ self.arriving[1:]
        return pushed, linear.by_force[0] @ self.force + self.output


@dataclass(frozen=True, slots=True, eq=False)
class Smoothed:
    """Deviation of the state (N, X), unknown force (N, n) and its deviation (N, n), and the
    coloured noise (N, m or 0), given all measurements; ln L with its derivatives by the variances
    of force (n,), white (m,) and colour (m,), and by the logarithms of the correlation times (2,)
    of force and colour. SI."""

    state: Array
    force: Array
    force_sd: Array
    colour: Array
    logl: float
    by_force: Array
    by_white: Array
    by_colour: Array
    by_times: Array


def track(
    model: WindowModel,
    item: Cut,
    states: Array,
    p: Array,
    extra: Extra | None = None,
    sizes: Array | None = None,
) -> Track:
    """Linearise a stretch ``item`` (one window) along ``states`` (N, X) with ``p`` (P,), SI; the
    columns of an ``extra``, which act with ``sizes`` (K,), come behind the free parameters."""
    with np.errstate(over="ignore", invalid="ignore"):
        linear = model.along(item.block, states[None], p)
    if extra is not None and sizes is not None:
        linear = _with_extra(linear, extra, sizes)
    residual = item.block.y[0] - linear.output[0]
    seen = np.isfinite(item.block.y[0])
    return Track(
        linear,
        item,
        np.where(seen, residual, 0.0),
        seen,
        np.diff(item.block.t[0]),
        item.states[0, 0] - states[0],
        _known_start(model, item, linear, p),
    )


def _with_extra(linear: Linear, extra: Extra, sizes: Array) -> Linear:
    pushed, shown = extra.driving(linear)
    begin = linear.begin_free
    if begin is not None:
        begin = np.concatenate([begin, np.zeros((*begin.shape[:2], sizes.size))], axis=2)
    return replace(
        linear,
        by_free=np.concatenate([linear.by_free, pushed[None]], axis=3),
        direct=np.concatenate([linear.direct, shown[None]], axis=3),
        defect=linear.defect - (pushed @ sizes)[None],
        output=linear.output + (shown @ sizes)[None],
        begin_free=begin,
    )


def _known_start(model: WindowModel, item: Cut, linear: Linear, p: Array) -> Array:
    """Covariance (X, X) of the first state about the measured motion: places and speeds by as much
    as they move, inner states by a share of their RMS, declared ones by what is known of their
    beginning, all within the constraints."""
    moving = 2 * len(model.form.free)
    size = np.ptp(item.states[0], axis=0)
    whole = np.sqrt(np.mean(item.states[0][:, moving:] ** 2, axis=0))
    size[moving:] = INNER_SPREAD * whole
    if declared := len(model.machine.model.states):
        size[moving : moving + declared] = begin_spread(model, item, p, whole)
    size = np.maximum(size, 1e-12 * (1 + np.abs(item.states[0]).max(axis=0)))
    spread = np.diag(size**2)
    if linear.begin is None:
        return spread
    along = linear.begin[0] @ np.linalg.pinv(linear.begin[0])
    return np.asarray(along @ spread @ along.T)


def effective(tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """The coordinates (n,) at which a force does anything to state or sensors."""
    n = tracks[0].linear.left.shape[3]
    found = np.zeros(n, bool)
    for one in tracks:
        found |= np.abs(one.linear.left[0]).max(axis=(0, 1), initial=0.0) > 0
        found |= np.abs(one.linear.by_force[0]).max(axis=(0, 1), initial=0.0) > 0
    return found


def showing(tracks: Sequence[Track]) -> NDArray[np.bool_]:
    """The sensors (m,) that show anything but given motion, so that a colour of theirs could stand
    for what a structure lacks."""
    found = np.zeros(tracks[0].seen.shape[1], bool)
    for linear in (one.linear for one in tracks):
        for part in (linear.by_state, linear.by_force, linear.direct):
            found |= np.abs(part[0]).max(axis=(0, 2), initial=0.0) > 0
    return found


@dataclass(frozen=True, slots=True)
class _Acting:
    """What the filter has states for: unknown ``forces`` (f,) and the colours of ``tinted`` sensors
    (c,), those of any size. All others are exactly 0."""

    forces: NDArray[np.int64]
    tinted: NDArray[np.int64]

    def keeps(self, one: Track, noise: NoiseModel) -> tuple[Array, Array]:
        """What is left of forces (N − 1, f) and colours (N − 1, c) after a step."""
        keep = np.exp(-one.step_s / noise.memory_s)
        hold = np.exp(-one.step_s / noise.colour_s)
        return (
            np.repeat(keep[:, None], self.forces.size, axis=1),
            np.repeat(hold[:, None], self.tinted.size, axis=1),
        )

    def variances(self, noise: NoiseModel) -> tuple[Array, Array, Array]:
        """Of forces (f,), white noise (m,) and colours (c,), SI."""
        return noise.force[self.forces] ** 2, noise.white**2, noise.colour[self.tinted] ** 2

    def place(self, sensors: int) -> NDArray[np.int64]:
        """Where the colour of each of ``sensors`` stands among these (m,), −1 where it has none."""
        found = np.full(sensors, -1)
        found[self.tinted] = np.arange(self.tinted.size)
        return found


def _acting(noise: NoiseModel) -> _Acting:
    return _Acting(np.flatnonzero(noise.force > 0), np.flatnonzero(noise.colour > 0))


def _among(values: Array, which: NDArray[np.int64], size: int) -> Array:
    """Values (…, some) as those of ``which`` of ``size`` (…, size), 0 for all others."""
    whole = np.zeros((*values.shape[:-1], size))
    whole[..., which] = values
    return whole


def white_columns(one: Track, noise: NoiseModel, b: Array, e: Array, begin: Array) -> Array:
    """White innovations (N·m, K) of columns with drives ``b`` (N − 1, X, K), output parts ``e``
    (N, m, K) and first states ``begin`` (X, K), SI."""
    made, _ = _whitened(one, noise, b, e, begin)
    return np.asarray(made.reshape(-1, made.shape[2]))


def _whitened(
    one: Track, noise: NoiseModel, b: Array, e: Array, begin: Array
) -> tuple[Array, float]:
    acts = _acting(noise)
    made = whiten(
        *_system(one.linear, acts.forces),
        one.seen,
        np.ascontiguousarray(b),
        np.ascontiguousarray(e),
        np.ascontiguousarray(begin),
        one.P0,
        *acts.keeps(one, noise),
        *acts.variances(noise),
        acts.place(noise.white.size),
    )
    return made


def _system(linear: Linear, forces: NDArray[np.int64]) -> tuple[Array, Array, Array, Array, Array]:
    """Transition, these ``forces`` left and right, and what sensors see of state and force;
    contiguous."""
    whole = np.ascontiguousarray
    return (
        whole(linear.transition[0]),
        whole(linear.left[0][..., forces]),
        whole(linear.right[0][..., forces]),
        whole(linear.by_state[0]),
        whole(linear.by_force[0][..., forces]),
    )


def white_problem(one: Track, noise: NoiseModel) -> tuple[Array, Array, float]:
    """White residual (N·m,), dimensionless, the columns of the free parameters (N·m, F) for each SI
    unit, and Σ ln S, such that residual + columns·θ is what a change θ (F,) leaves."""
    linear = one.linear
    free = linear.by_free.shape[3]
    b = np.concatenate([-linear.defect[0][:, :, None], linear.by_free[0]], axis=2)
    e = np.concatenate([one.residual[:, :, None], -linear.direct[0]], axis=2)
    begin = np.zeros((one.x.shape[1], 1 + free))
    begin[:, 0] = one.first
    if linear.begin_free is not None:
        begin[:, 1:] = linear.begin_free[0]
    made, logs = _whitened(one, noise, b, e, begin)
    flat = made.reshape(-1, 1 + free)
    return flat[:, 0], flat[:, 1:], logs


def log_likelihood(one: Track, noise: NoiseModel) -> float:
    """ln L of a track as it is."""
    made, logs = _whitened(
        one,
        noise,
        -one.linear.defect[0][:, :, None],
        one.residual[:, :, None],
        one.first[:, None],
    )
    with np.errstate(over="ignore"):  # a run that grows without bound is infinitely unlikely
        squares = np.sum(made**2)
    return float(-0.5 * (logs + squares + one.count * np.log(2 * np.pi)))


def white_forces(one: Track, noise: NoiseModel, forces: Array) -> Array:
    """White columns (N·m, C) of forces (N, n, C), SI, such that residual + columns·x is left when
    they act x times."""
    linear = one.linear
    b = linear.left[0] @ forces[:-1] + linear.right[0] @ forces[1:]
    e = -(linear.by_force[0] @ forces)
    return white_columns(one, noise, b, e, np.zeros((one.x.shape[1], forces.shape[2])))


def still(one: Track) -> Array:
    """No change of the track's free parameters: zeros (F,), SI."""
    return np.zeros(one.linear.by_free.shape[3])


def smoothed(one: Track, noise: NoiseModel, change: Array, wanted: bool = True) -> Smoothed:
    """State, unknown force and colour with the free parameters changed by ``change`` (F,), SI;
    where these are not ``wanted``, ln L and its derivatives alone."""
    linear, acts = one.linear, _acting(noise)
    begin = one.first.copy()
    if linear.begin_free is not None:
        begin = begin + linear.begin_free[0] @ change
    # the filter begins at no deviation: what is known of the first state goes with the drives
    offset = begin
    b = linear.by_free[0] @ change - linear.defect[0]
    e = one.residual - linear.direct[0] @ change
    b, e = b.copy(), e.copy()
    e[0] -= linear.by_state[0, 0] @ offset
    if len(b):
        b[0] += linear.transition[0, 0] @ offset
    mean, variance, logs, chi2, by_force, by_white, by_colour, by_times = smooth(
        *_system(linear, acts.forces),
        one.seen,
        np.ascontiguousarray(b),
        np.ascontiguousarray(e),
        one.P0,
        *acts.keeps(one, noise),
        *acts.variances(noise),
        acts.place(noise.white.size),
        wanted,
    )
    states, n, m = one.x.shape[1], noise.force.size, noise.white.size
    first = states + acts.forces.size
    state = mean[:, :states]
    state[0] += offset
    return Smoothed(
        state,
        _among(mean[:, states:first], acts.forces, n),
        _among(np.sqrt(np.maximum(variance[:, states:first], 0.0)), acts.forces, n),
        _among(mean[:, first:], acts.tinted, m if acts.tinted.size else 0),
        -0.5 * (logs + chi2 + one.count * np.log(2 * np.pi)),
        _among(by_force, acts.forces, n),
        by_white,
        _among(by_colour, acts.tinted, m),
        by_times,
    )
