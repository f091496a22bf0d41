"""Columns of generic classes: functions of a motion, and their prior sizes.

Sizes: N samples, n coordinates, m sensors, K columns.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.signal import lfilter

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.discrepancy.likelihood.track import Extra
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import ClassName
from symhyb.model.types import Place
from symhyb.numeric.kernels.buffers import Array

SIZE = 0.3  # of what acts there: prior deviation of a column's size (RMS)
KNOTS_TIME = 12  # of a function of time
LENGTHS = (1.0, 0.4, 0.12)  # of a smooth function, in half ranges, that are tried
LAGS = 5  # time constants that are tried
CHANGE = 1e-4  # relative, of an input or a number, for its direction
PUSHED = 1e-4  # of the largest push of a place: a coordinate that gets less is not pushed
GRID = 80  # points of a smooth function
FINEST = 1e-5  # of the largest variance of a direction of a smooth function


Motions = tuple[tuple[Array, Array, Array], ...]
_Pushes = tuple[tuple[Array, Array], ...]
_motions: WeakKeyDictionary[Recorded, Motions] = WeakKeyDictionary()
_pushes: WeakKeyDictionary[Recorded, dict[int, _Pushes]] = WeakKeyDictionary()


def motions(recorded: Recorded) -> Motions:
    """Stretch and rate (N, places) and directions (N, n, places) along every stretch, SI."""
    if recorded not in _motions:
        _motions[recorded] = tuple(_moved(recorded, item) for item in recorded.items)
    return _motions[recorded]


def _moved(recorded: Recorded, item: Cut) -> tuple[Array, Array, Array]:
    course, rows = item.course(recorded.library.machine), item.rows[0]
    directions = recorded.library.directions(course)[rows]
    return *recorded.library.motion(course, rows), directions


def pushed_at(recorded: Recorded, which: int) -> frozenset[int]:
    """The coordinates that a force at a place pushes."""
    size = np.max(
        [np.abs(toward[:, :, which]).max(axis=0) for _, _, toward in motions(recorded)], 0
    )
    return frozenset(int(i) for i in np.flatnonzero(size > PUSHED * size.max()))


def pushes(recorded: Recorded, which: int) -> _Pushes:
    """An input (N,) and the generalized force (N, n) of one unit of it, along every stretch, SI."""
    known = _pushes.setdefault(recorded, {})
    if which not in known:
        known[which] = tuple(_pushed(recorded, item, which) for item in recorded.items)
    return known[which]


def _pushed(recorded: Recorded, item: Cut, which: int) -> tuple[Array, Array]:
    machine, (recording, motion) = recorded.windows.machine, item.source
    model, rows = machine.model, item.rows[0]
    name = model.inputs[which].name
    values = recording.inputs[name]
    change = CHANGE * (float(np.std(values)) or 1.0)
    moved = machine.values.copy()
    moved[machine.column(f"{name}.offset")] += change
    course = course_of(recording, machine, motion)
    force = discrepancy(machine, course, machine.values) - discrepancy(machine, course, moved)
    return course.u[rows, which], force[rows] / change


def slow(t: Array) -> Array:
    """Piecewise linear functions (N, K), dimensionless, of the times t (N,), s: 1 at one knot
    each."""
    knots = np.linspace(t[0], t[-1], KNOTS_TIME)
    return np.stack([np.interp(t, knots, row) for row in np.eye(knots.size)], axis=1)


def waves(t: Array, lines: Array) -> Array:
    """Sine and cosine (N, 2K) of each frequency, Hz."""
    turn = 2 * np.pi * np.outer(t - t[0], lines)
    return np.stack([np.sin(turn), np.cos(turn)], axis=2).reshape(t.size, -1)


def lag_times(recorded: Recorded) -> Array:
    """The time constants (K,), s, that are tried."""
    return np.geomspace(recorded.step_s, recorded.period_s, LAGS)


def lagged(recorded: Recorded, values: Array) -> Array:
    """What first-order lags of these times take off a signal (N, K), in its unit."""
    columns = []
    for time in lag_times(recorded):
        keep = float(np.exp(-recorded.step_s / time))
        late = lfilter([1 - keep], [1.0, -keep], values, zi=[keep * values[0]])[0]
        columns.append(late - values)
    return np.stack(columns, axis=1)


def smooth(values: Array, low: float, high: float, length: float) -> Array:
    """Functions (N, K), dimensionless, of ``values`` (N,) whose sum with independent standard
    normal coefficients is a Gaussian process of variance 1 between ``low`` and ``high``, constant
    beyond: Matérn 5/2 with ``length`` in half ranges, its Karhunen-Loève directions on a grid
    (Rasmussen & Williams, Gaussian Processes for Machine Learning, 2006, §4.2)."""
    at = np.clip((2 * values - low - high) / (high - low), -1.0, 1.0)
    found: Array = _directions(length)(at)
    return found


def matern(apart: Array, length: float) -> Array:
    """The correlation (P, Q), dimensionless, of a smooth function at places so far ``apart`` (P,
    Q), or (S, P, Q) of many, by Matérn 5/2; both lengths in half ranges."""
    far = np.sqrt(5.0) * np.abs(apart) / length
    return np.asarray((1 + far + far**2 / 3) * np.exp(-far))


@lru_cache(maxsize=2 * len(LENGTHS))
def _directions(length: float) -> CubicSpline:
    """The functions of :func:`smooth` (K,) between −1 and 1."""
    grid = np.linspace(-1.0, 1.0, GRID)
    size, directions = np.linalg.eigh(matern(grid[:, None] - grid, length))
    kept = np.flatnonzero(size > FINEST * size[-1])[::-1]
    return CubicSpline(grid, directions[:, kept] * np.sqrt(size[kept]))


def smooth_options(each: Sequence[Array]) -> list[list[Array]]:
    """Smooth functions, dimensionless, of what was recorded in every stretch (N,), at each of the
    lengths that are tried."""
    low = min(float(values.min()) for values in each)
    high = max(float(values.max()) for values in each)
    high = high if high > low else low + 1.0
    return [[smooth(values, low, high, length) for values in each] for length in LENGTHS]


def without_span(columns: Sequence[Array], basis: Sequence[Array]) -> list[Array]:
    """Columns (N, K), SI, of every stretch without what those of a basis (N, B), SI, would do."""
    parts = np.linalg.lstsq(np.concatenate(basis), np.concatenate(columns), rcond=None)[0]
    return [c - given @ parts for c, given in zip(columns, basis, strict=True)]


def without_gain(columns: Sequence[Array], seen: Sequence[Array]) -> list[Array]:
    """Columns (N, K), SI, of every stretch without what a gain and an offset of the sensor would
    do, for what it should show (N,): what it shows follows the measured motion, and with a gain of
    its own the record would explain itself."""
    return without_span(columns, [np.stack([np.ones_like(y), y], axis=1) for y in seen])


def showing(
    recorded: Recorded,
    which: int,
    shown: Sequence[Array],
    does: Literal["drifts", "bends", "fades", "lags"],
    joint: bool = False,
) -> Generic:
    """A class of what a sensor shows (N, K), SI, with a prior of the size of what it recorded;
    ``joint``: of all columns together."""
    model = recorded.windows.machine.model
    each, n = [], len(model.coordinates)
    for columns in shown:
        output = np.zeros((len(columns), len(model.sensors), columns.shape[1]))
        output[:, which] = columns
        each.append(Extra(np.zeros((len(columns), n, columns.shape[1])), output))
    seen = [item.block.y[0][:, which] for item in recorded.items]
    sizes = [float(np.nanstd(y)) if np.isfinite(y).any() else 0.0 for y in seen]
    power = np.mean([np.mean(c**2, axis=0) for c in shown], axis=0)
    spread = SIZE * max(sizes) * _over(np.sqrt(power), joint)
    return Generic("sensor", model.sensors[which].name, tuple(each), spread, does=does)


def pushing(
    recorded: Recorded,
    kind: ClassName,
    where: Place | str,
    forces: Sequence[Array],
    figure: float = float("nan"),
    joint: bool = False,
) -> Generic:
    """A class of forces (N, n, K), SI, with a prior of the size of what moves the coordinates;
    ``joint``: of all columns together."""
    m = len(recorded.windows.machine.model.sensors)
    each = tuple(Extra(f, np.zeros((len(f), m, f.shape[2]))) for f in forces)
    return made_of(recorded, kind, where, each, figure, joint)


def made_of(
    recorded: Recorded,
    kind: ClassName,
    where: Place | str,
    each: tuple[Extra, ...],
    figure: float = float("nan"),
    joint: bool = False,
) -> Generic:
    """The same of forces with what they show at once."""
    power = np.mean([np.mean(one.force**2, axis=0) for one in each], axis=0)
    share = np.max(np.sqrt(power) / recorded.scale_or_inf, axis=0)
    return Generic(kind, where, each, SIZE * _over(share, joint), figure)


def _over(size: Array, joint: bool) -> Array:
    """1 over the size of each column (K,), or of all of them together."""
    if joint:
        size = np.full_like(size, np.sqrt(np.sum(size**2)))
    # a column that is zero has no say, whatever its prior
    return np.where(size > 0, 1 / np.where(size > 0, size, 1.0), 1.0)
