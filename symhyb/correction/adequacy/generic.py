"""Generic rivals: whole classes of effects, none of which is a law by name.

A class is a set of columns (forces at a place, along an input, or parts of what a sensor shows)
whose coefficients have a Gaussian prior of the size of what acts there. It competes by the same
evidence as any named cause: a named law has to beat the class that it belongs to, and where it does
not, the class is the answer. The columns follow the measured motion.
Sizes: N samples, n coordinates, m sensors, K columns.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Literal

import numpy as np
from scipy.signal import cont2discrete, lfilter, ss2tf

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import ClassName, Fitted, Generic, tracks_of
from symhyb.discrepancy.likelihood.track import Extra, white_columns, white_problem
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.model.types import Place
from symhyb.numeric.kernels.buffers import Array

SIZE = 0.3  # of what acts there: prior deviation of a column's size (RMS)
KNOTS = 7  # of a function of one variable
KNOTS_TIME = 12  # of a function of time
LAGS = 5  # time constants that are tried
MODES = 40  # frequencies of a hidden mode that are tried
IN_BAND = 0.999  # of the power of an acceleration
DAMPINGS = (0.02, 0.2)  # of a hidden mode
PULSES = 200  # frequencies of a pulsating number that are tried at most
SHARES = (1.0, 0.1, 0.01)  # of the unknown force that may be left beside a class
CHANGE = 1e-4  # relative, of an input or a number, for its direction

Maker = Callable[[Recorded, Fitted], Generic]


def classes_of(recorded: Recorded) -> list[Maker]:
    """Every class that this machine may show, to be made around a structure."""
    model = recorded.windows.machine.model
    uncertain = [item.path for item in model.parameters if item.sd is not None]
    found: list[Maker] = []
    for i in range(len(recorded.library.places)):
        found += [partial(force_law, which=i), partial(hidden_mode, which=i)]
    for j in range(len(model.inputs)):
        found += [partial(input_curve, which=j), partial(input_lag, which=j)]
    found += [partial(pulsating, path=path) for path in uncertain]
    for j in range(len(model.sensors)):
        if not any(np.isfinite(item.block.y[0][:, j]).any() for item in recorded.items):
            continue
        for maker in (drifting_sensor, sensor_curve, sensor_lag):
            found.append(partial(maker, which=j))
    return found


def force_law(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """A smooth force of stretch and rate at a place."""
    parts = [_moved(recorded, item) for item in recorded.items]
    stretch = np.concatenate([s[:, which] for s, _, _ in parts])
    rate = np.concatenate([r[:, which] for _, r, _ in parts])
    knots = _knots(stretch, 5), _knots(rate, KNOTS)
    forces = []
    for s, r, directions in parts:
        both = _hats(s[:, which], knots[0])[:, :, None] * _hats(r[:, which], knots[1])[:, None]
        forces.append(directions[:, :, which, None] * both.reshape(len(s), 1, -1))
    return _pushing(recorded, "law", recorded.library.places[which], forces)


def hidden_mode(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """A mass on a spring and a damper at a place, in the coordinates of no one."""
    lines = np.geomspace(*_band(recorded, which), MODES)
    best: tuple[float, float, float] | None = None
    for damping in DAMPINGS:
        tried = _pushing(recorded, "hidden mode", "", _mode_forces(recorded, which, lines, damping))
        gains = gain_of(recorded, trial, tried, 2)
        i = int(np.argmax(gains))
        if best is None or gains[i] > best[0]:
            best = float(gains[i]), float(lines[i]), damping
    assert best is not None
    _, line, damping = best
    near = line * np.array([0.94, 1.0, 1.06])
    forces = _mode_forces(recorded, which, near, damping)
    return _pushing(recorded, "hidden mode", recorded.library.places[which], forces, line)


def _band(recorded: Recorded, which: int) -> tuple[float, float]:
    """The frequencies, Hz, between which a mode could show at a place: up to an octave above where
    almost all power of its acceleration lies. A mode above only adds stiffness and mass."""
    low, high = 0.3 / recorded.period_s, 0.4 / recorded.step_s
    ends = []
    for item in recorded.items:
        t = item.block.t[0]
        stretch = _moved(recorded, item)[0][:, which]
        push = np.gradient(np.gradient(stretch, t), t) * np.hanning(t.size)
        power = np.cumsum(np.abs(np.fft.rfft(push)) ** 2)
        line = np.searchsorted(power, IN_BAND * power[-1])
        ends.append(2 * float(line / (t.size * recorded.step_s)))
    return low, min(max([*ends, 2 * low]), high)


def _mode_forces(recorded: Recorded, which: int, lines: Array, damping: float) -> list[Array]:
    """Two columns for each frequency (Hz): what a mode presses and drags with, driven by the
    acceleration of the place."""
    found = []
    for item in recorded.items:
        s, _, directions = _moved(recorded, item)
        t = item.block.t[0]
        drive = np.gradient(np.gradient(s[:, which], t), t)
        columns = []
        for line in lines:
            w = 2 * np.pi * line
            A = np.array([[0.0, 1.0], [-(w**2), -2 * damping * w]])
            state = _driven(A, np.array([[0.0], [1.0]]), drive, recorded.step_s)
            columns += [w**2 * state[:, 0], w * state[:, 1]]
        both = np.stack(columns, axis=1)
        found.append(directions[:, :, which, None] * both[:, None])
    return found


def input_curve(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """An input that acts by a smooth function of itself."""
    parts = [_push(recorded, item, which) for item in recorded.items]
    knots = _knots(np.concatenate([u for u, _ in parts]), KNOTS + 2)
    forces = [push[:, :, None] * _hats(u, knots)[:, None] for u, push in parts]
    name = recorded.windows.machine.model.inputs[which].name
    return _pushing(recorded, "input", name, forces)


def input_lag(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """An input that acts through a first-order lag."""
    parts = [_push(recorded, item, which) for item in recorded.items]
    times = np.geomspace(recorded.step_s, recorded.period_s, LAGS)
    forces = [push[:, :, None] * _lagged(u, times, recorded.step_s)[:, None] for u, push in parts]
    name = recorded.windows.machine.model.inputs[which].name
    found = _pushing(recorded, "lag", name, forces)
    best = times[int(np.argmax(gain_of(recorded, trial, found, 1)))]
    return replace(found, figure=float(best))


def pulsating(recorded: Recorded, trial: Fitted, path: str) -> Generic:
    """A number of the model that changes with time: slowly, or at one frequency."""
    machine = recorded.windows.machine
    column = machine.column(path)
    value = machine.values[column]
    change = CHANGE * (abs(value) or 1.0)
    slopes = []
    for item in recorded.items:
        recording, motion = item.source
        moved = machine.values.copy()
        moved[column] += change
        course = course_of(recording, machine, motion)
        force = discrepancy(machine, course, moved) - discrepancy(machine, course, machine.values)
        slopes.append(-force[item.rows[0]] / change * abs(value))
    lasts = max(float(np.ptp(item.block.t[0])) for item in recorded.items)
    most = 2 / recorded.period_s
    lines = np.linspace(0.5 / lasts, most, min(int(2 * lasts * most) + 1, PULSES))
    pairs = [
        slope[:, :, None] * _waves(item.block.t[0], lines)[:, None]
        for slope, item in zip(slopes, recorded.items, strict=True)
    ]
    gains = gain_of(recorded, trial, _pushing(recorded, "time-varying", path, pairs), 2)
    line = lines[int(np.argmax(gains))]
    forces = []
    for slope, item in zip(slopes, recorded.items, strict=True):
        t = item.block.t[0]
        slow = _hats(t, np.linspace(t[0], t[-1], KNOTS_TIME))
        both = np.concatenate([slow, _waves(t, line + np.array([-0.5, 0.0, 0.5]) / lasts)], axis=1)
        forces.append(slope[:, :, None] * both[:, None])
    return _pushing(recorded, "time-varying", path, forces, float(line))


def drifting_sensor(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """A sensor that drifts."""
    shown = []
    for item in recorded.items:
        t = item.block.t[0]
        shown.append(_hats(t, np.linspace(t[0], t[-1], KNOTS_TIME)))
    return _sensor(recorded, which, shown, "drifts")


def sensor_curve(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """A sensor that shows a smooth function of what it should."""
    seen = [_computed(recorded, trial, i)[:, which] for i in range(len(recorded.items))]
    knots = _knots(np.concatenate(seen), KNOTS + 2)
    return _sensor(recorded, which, [_hats(y, knots) for y in seen], "bends")


def sensor_lag(recorded: Recorded, trial: Fitted, which: int) -> Generic:
    """A sensor that shows what it should through a first-order lag."""
    times = np.geomspace(recorded.step_s, recorded.period_s, LAGS)
    shown = [
        _lagged(_computed(recorded, trial, i)[:, which], times, recorded.step_s)
        for i in range(len(recorded.items))
    ]
    return _sensor(recorded, which, shown, "lags")


def _sensor(
    recorded: Recorded, which: int, shown: Sequence[Array], does: Literal["drifts", "bends", "lags"]
) -> Generic:
    model = recorded.windows.machine.model
    each, n = [], len(model.coordinates)
    for columns in shown:
        output = np.zeros((len(columns), len(model.sensors), columns.shape[1]))
        output[:, which] = columns
        each.append(Extra(np.zeros((len(columns), n, columns.shape[1])), output))
    seen = [item.block.y[0][:, which] for item in recorded.items]
    sizes = [float(np.nanstd(y)) if np.isfinite(y).any() else 0.0 for y in seen]
    size = np.sqrt(np.mean([np.mean(c**2, axis=0) for c in shown], axis=0))
    spread = np.where(size > 0, SIZE * max(sizes) / np.where(size > 0, size, 1.0), 1.0)
    return Generic("sensor", model.sensors[which].name, tuple(each), spread, does=does)


def _pushing(
    recorded: Recorded,
    kind: ClassName,
    where: Place | str,
    forces: Sequence[Array],
    figure: float = float("nan"),
) -> Generic:
    """A class of forces (N, n, K) with a prior of the size of what moves the coordinates."""
    m = len(recorded.windows.machine.model.sensors)
    each = tuple(Extra(f, np.zeros((len(f), m, f.shape[2]))) for f in forces)
    power = np.mean([np.mean(f**2, axis=0) for f in forces], axis=0)
    share = np.max(np.sqrt(power) / recorded.scale_or_inf, axis=0)
    # a column that is zero has no say, whatever its prior
    spread = np.where(share > 0, SIZE / np.where(share > 0, share, 1.0), 1.0)
    return Generic(kind, where, each, spread, figure)


def gain_of(recorded: Recorded, trial: Fitted, columns: Generic, group: int = 0) -> Array:
    """What K columns would add to ln evidence around a structure, in the linear problem (1,),
    dimensionless; with a ``group`` of so many columns each, every group by itself (K / group,)."""
    gram = np.zeros((columns.spread.size + 1, columns.spread.size + 1))
    for one, extra in zip(tracks_of(recorded, trial), columns.each, strict=True):
        residual, own, _ = white_problem(one, trial.fit.noise)
        linear = one.linear
        pushed = linear.left[0] @ extra.force[:-1] + linear.right[0] @ extra.force[1:]
        shown = linear.by_force[0] @ extra.force + extra.output
        begin = np.zeros((one.x.shape[1], columns.spread.size))
        white = white_columns(one, trial.fit.noise, pushed, -shown, begin) * columns.spread
        joined = np.column_stack([white, residual])
        if own.size:  # what the structure's own numbers would take is theirs
            joined = joined - own @ np.linalg.lstsq(own, joined, rcond=None)[0]
        gram += joined.T @ joined
    size = columns.spread.size
    groups = [range(i, i + group) for i in range(0, size, group)] if group else [range(size)]
    return np.array([_gain(gram, list(rows)) for rows in groups])


def worth_of(recorded: Recorded, trial: Fitted, columns: Generic) -> float:
    """What columns would add to ln evidence where less of the unknown force is left beside them:
    the best over some sizes of it. While it acts in full it explains what the columns would."""
    found, full = [], trial.fit.noise
    for share in SHARES:
        noise = replace(full, force=share * full.force)
        less = replace(trial, fit=replace(trial.fit, noise=noise))
        found.append(float(gain_of(recorded, less, columns)[0]) + _profile(recorded, less))
    return max(found) - _profile(recorded, trial)


def _profile(recorded: Recorded, trial: Fitted) -> float:
    """ln L of a structure with what its own numbers would take, but for a constant."""
    likely = 0.0
    for one in tracks_of(recorded, trial):
        residual, own, logs = white_problem(one, trial.fit.noise)
        if own.size:
            residual = residual - own @ np.linalg.lstsq(own, residual, rcond=None)[0]
        likely -= 0.5 * float(logs + residual @ residual)
    return likely


def _gain(gram: Array, rows: list[int]) -> float:
    block = gram[np.ix_(rows, rows)] + np.eye(len(rows))
    right = gram[rows, -1]
    solved = np.linalg.solve(block, right)
    return float(0.5 * right @ solved - 0.5 * np.linalg.slogdet(block)[1])


def _computed(recorded: Recorded, trial: Fitted, which: int) -> Array:
    """What the sensors should show (N, m) along the trajectory of a structure."""
    return np.asarray(tracks_of(recorded, trial)[which].linear.output[0])


def _moved(recorded: Recorded, item: Cut) -> tuple[Array, Array, Array]:
    """Stretch and rate (N, places) and directions (N, n, places) along a stretch."""
    course = item.course(recorded.library.machine)
    stretch, rate = recorded.library.motion(course)
    rows = item.rows[0]
    return stretch[rows], rate[rows], recorded.library.directions(course)[rows]


def _push(recorded: Recorded, item: Cut, which: int) -> tuple[Array, Array]:
    """An input (N,) and the generalized force (N, n) of one unit of it."""
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


def _knots(values: Array, count: int) -> Array:
    """Distinct knots at quantiles of what was recorded."""
    found: Array = np.unique(np.quantile(values, np.linspace(0.005, 0.995, count)))
    return found


def _hats(values: Array, knots: Array) -> Array:
    """Piecewise linear functions (N, K) that are 1 at one knot each, constant beyond the ends."""
    return np.stack([np.interp(values, knots, row) for row in np.eye(knots.size)], axis=1)


def _waves(t: Array, lines: Array) -> Array:
    """Sine and cosine (N, 2K) of each frequency, Hz."""
    turn = 2 * np.pi * np.outer(t - t[0], lines)
    return np.stack([np.sin(turn), np.cos(turn)], axis=2).reshape(t.size, -1)


def _lagged(values: Array, times: Array, step: float) -> Array:
    """What first-order lags take off a signal (N, K)."""
    columns = []
    for time in times:
        keep = float(np.exp(-step / time))
        slow = lfilter([1 - keep], [1.0, -keep], values, zi=[keep * values[0]])[0]
        columns.append(slow - values)
    return np.stack(columns, axis=1)


def _driven(A: Array, B: Array, drive: Array, step: float) -> Array:
    """States (N, 2) of x' = A x + B u from rest, the drive (N,) straight between samples."""
    discrete = cont2discrete((A, B, np.eye(2), np.zeros((2, 1))), step, "foh")[:4]
    rows, denominator = ss2tf(*discrete)
    return np.stack([lfilter(row, denominator, drive) for row in rows], axis=1)
