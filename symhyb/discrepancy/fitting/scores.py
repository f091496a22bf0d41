"""Scores that cannot be fooled: force, short windows and free run, initial states always fitted.

NRMSE = RMSE / (max − min) of the measurement (the paper's eq. 16). Sizes: N samples, n coordinates,
m sensors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.data.thin import coarsest, stretch, thinned
from symhyb.discrepancy.evidence import Residuals
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import starts_only
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.residual import applied_force, discrepancy
from symhyb.discrepancy.recorded.runs import Run, cut_into_windows
from symhyb.discrepancy.recorded.signals import driving, measured
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import Score
from symhyb.numeric.kernels.buffers import Array, mean_of_seen, on_lines
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.lowered.known import machine_with
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.between import held_columns
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel

FILTER_ORDER = 4
RUN_SHARES = (0.1, 0.3, 1 - 1e-9)  # of a recording, to which its initial state is fitted
RUN_SAMPLES = 6000  # of a free run, for fitting its initial state
RUN_MOST = 30_000  # where its motion needs more: from so many of the first its start is well known
WINDOWS_MOST = 5000  # their error is known to a percent


@dataclass(frozen=True, slots=True)
class Errors:
    """Mean squared errors of one model on several runs, in squared SI units: by sensor (m,) over
    windows and free runs, by coordinate (n,) of ΔF. For each run its free run with the
    ``scenarios``, and what is left of its windows; None where it has none."""

    window: Array
    free: Array
    force: Array
    scenarios: tuple[Scenario, ...]
    trajectories: tuple[Trajectory, ...]
    residuals: tuple[Residuals | None, ...] = ()


def errors(machine: Machine, runs: Sequence[Run], window_s: float, band_hz: float | None) -> Errors:
    """Simulate and compare; sensors and coordinates in the order of the model."""
    model = WindowModel(machine)
    windows, frees, forces, residuals = [], [], [], []
    scenarios, trajectories = [], []
    for run in runs:
        left = _left_of_windows(model, run, window_s)
        residuals.append(left)
        windows.append(_squares(left, len(machine.model.sensors)))
        scenarios.append(free_scenario(model, run))
        trajectories.append(free_run(machine, run, scenarios[-1]))
        frees.append((measured(run.recording, machine) - trajectories[-1].y) ** 2)
        forces.append(forces_of(machine, run, band_hz)[0] ** 2)
    window, free, force = (mean_of_seen(np.concatenate(one)) for one in (windows, frees, forces))
    return Errors(window, free, force, tuple(scenarios), tuple(trajectories), tuple(residuals))


@dataclass(frozen=True, slots=True)
class Yardstick:
    """What forces are measured by, from the model before correction: the range of ΔF and the RMS of
    the applied force k_e, by coordinate (n,), SI, through the low-pass of the scores."""

    reach: Array
    applied: Array


def yardstick(machine: Machine, runs: Sequence[Run], band_hz: float | None) -> Yardstick:
    """The yardstick of an uncorrected model."""
    pairs = [forces_of(machine, run, band_hz) for run in runs]
    delta, applied = (np.concatenate(column) for column in zip(*pairs, strict=True))
    return Yardstick(np.ptp(delta, axis=0), np.sqrt(np.mean(applied**2, axis=0)))


def score(machine: Machine, found: Errors, runs: Sequence[Run], by: Yardstick) -> Score:
    """Relative and absolute scores by name; None where a score cannot be computed."""
    y = np.concatenate([measured(run.recording, machine) for run in runs])
    reach = np.array([np.ptp(c[np.isfinite(c)]) if np.isfinite(c).any() else np.nan for c in y.T])
    names = [sensor.name for sensor in machine.model.sensors]
    units = np.array([sensor.unit.factor for sensor in machine.model.sensors])
    where = [coordinate.name for coordinate in machine.model.coordinates]
    window, free, force = np.sqrt(found.window), np.sqrt(found.free), np.sqrt(found.force)
    return Score(
        force_nrmse=_table(where, force, by.reach),
        force_residual=_table(where, force, by.applied),
        window_nrmse=_table(names, window, reach),
        window_rmse=_table(names, window, units),
        free_run_nrmse=_table(names, free, reach),
        free_run_rmse=_table(names, free, units),
    )


def free_run(machine: Machine, run: Run, scenario: Scenario) -> Trajectory:
    """Simulate a whole recording with the parameters that it knows."""
    return simulate(machine_with(machine, run.recording.parameters), scenario)


def free_scenario(model: WindowModel, run: Run, fitted: bool = True) -> Scenario:
    """What a free run is given: the fitted initial state of a recording, or the first of its
    smoothed motion, and its inputs."""
    machine, recording, motion = model.machine, run.recording, run.motion
    course, form = course_of(recording, machine, motion), model.form
    scales = np.abs(course.states).max(axis=0, initial=0.0)
    start, f = _fitted_start(model, run) if fitted else course.states[0], len(form.free)
    q, v = form.motion(start, course.drive[0])
    t_u, u = driving(recording, machine)
    return Scenario(
        recording.t,
        q,
        v,
        t_u,
        u,
        np.where(scales > 0, scales, 1.0),
        z=start[2 * f :],
        given=on_lines(recording.t, course.drive[:, form.inputs :], t_u) if form.given else None,
    )


def _fitted_start(model: WindowModel, run: Run) -> Array:
    """Initial state (X,) of a free run, fitted to the whole recording, thinned if it is long; where
    its motion needs more than ``RUN_MOST`` samples, to these.

    It is fitted to growing parts of the recording, because dry friction and large motion make the
    whole run an uneven function of its start; the best of these, the smoothed start and the one
    that the model file states is taken.
    """
    factor = coarsest(run.recording, RUN_SAMPLES, float(run.motion.periods().min()))
    if held_columns(model.machine.model.inputs):  # averages of what is held are not held
        factor = 1
    recording, motion = thinned(run.recording, factor), run.motion.every(factor)
    rows = slice(0, RUN_MOST)
    short = replace(run, recording=stretch(recording, rows), motion=motion.at(rows))
    first = course_of(run.recording, model.machine, run.motion).states[0]
    starts: list[Array] = [first, _stated(model.form, first)]
    cuts: Cut | None = None
    for share in RUN_SHARES:
        cuts = cut_into_windows(short, model.machine, share * short.recording.duration)
        if cuts is None:
            continue
        cuts = cuts.first().suited(model.machine)
        task = replace(starts_only(cuts, run.sd), iterations=10)
        begin = [starts[-1 if share > RUN_SHARES[0] else 0][None]]
        starts.append(fit(model, task, model.machine.values, begin).starts[0][0])
    if cuts is None:
        return starts[0]
    return starts[int(np.argmin(_run_costs(model, cuts, np.stack(starts), run.sd)))]


def _stated(form: StateForm, first: Array) -> Array:
    """The initial state (X,) that the model file states, SI, with inner states of ``first``."""
    q, v = (np.array(part) for part in form.machine.model.start())
    return form.state(q, v, first[2 * len(form.free) :])


def _run_costs(model: WindowModel, cuts: Cut, starts: Array, sd: Array) -> Array:
    """Squared whitened residuals (S,) of one window from each of ``starts`` (S, X), side by side;
    inf where it does not stay bounded."""
    block = cuts.chosen(np.zeros(len(starts), int)).block
    with np.errstate(over="ignore", invalid="ignore"):
        _, y = model.simulate(block, starts, model.machine.values)
        error = np.where(np.isfinite(block.y), (block.y - y) / sd, 0.0)
        costs = np.sum(error**2, axis=(1, 2))
    return np.where(np.isfinite(costs), costs, np.inf)


def _left_of_windows(model: WindowModel, run: Run, window_s: float) -> Residuals | None:
    """What is left of windows with fitted initial states, SI, of very many of some of them, evenly
    spaced; None without windows."""
    cuts = cut_into_windows(run, model.machine, window_s)
    if cuts is None:
        return None
    count = len(cuts.rows)
    if count > WINDOWS_MOST:
        cuts = cuts.chosen(np.arange(WINDOWS_MOST) * count // WINDOWS_MOST)
    cuts = cuts.suited(model.machine)
    fitted = fit(model, starts_only(cuts, run.sd), model.machine.values)
    _, y = model.simulate(cuts.block, fitted.starts[0], model.machine.values)
    step = float(np.median(np.diff(cuts.block.t, axis=1)))
    return Residuals(cuts.block.y - y, cuts.block.d[:, :, : model.form.inputs], step)


def _squares(left: Residuals | None, sensors: int) -> Array:
    """Squared errors (W·L, m) over windows, SI; no rows without windows."""
    if left is None:
        return np.empty((0, sensors))
    with np.errstate(over="ignore", invalid="ignore"):  # a window that runs away is infinitely far
        return np.asarray((left.left**2).reshape(-1, sensors))


def forces_of(machine: Machine, run: Run, band_hz: float | None) -> tuple[Array, Array]:
    """ΔF and the applied force k_e (N, n), both through the same zero-phase low-pass, SI."""
    course = course_of(run.recording, machine, run.motion)
    delta, applied = discrepancy(machine, course, machine.values), applied_force(machine, course)
    return low_pass(delta, course.t, band_hz), low_pass(applied, course.t, band_hz)


def low_pass(values: Array, t: Array, band_hz: float | None) -> Array:
    """Zero-phase Butterworth low-pass of order 4 of ``values`` (N, n), in any unit, along ``t``
    (N,), s; unchanged without a band, or where it lies above 0.9 of the Nyquist frequency."""
    rate = 1 / float(np.median(np.diff(t)))
    if band_hz is None or band_hz >= 0.45 * rate:
        return values
    from scipy.signal import butter, sosfiltfilt

    return np.asarray(
        sosfiltfilt(butter(FILTER_ORDER, band_hz, fs=rate, output="sos"), values, axis=0)
    )


def _table(names: Sequence[str], values: Array, by: Array) -> Mapping[str, float | None]:
    with np.errstate(invalid="ignore", divide="ignore"):
        ratios = values / by
    return {
        name: float(value) if np.isfinite(value) else None
        for name, value in zip(names, ratios, strict=True)
    }
