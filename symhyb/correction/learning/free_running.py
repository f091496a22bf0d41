"""Scores of a correction of rates that is in no model file: free runs, and the force that is left.

Windows with fitted initial states need a model; here every run begins as the smoothed motion does.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from symhyb.correction.learning.corrected import Correction, Law, simulate_corrected
from symhyb.correction.learning.formulations import lacking, values_along
from symhyb.correction.search.preparing import Prepared
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.residual import applied_force, discrepancy
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import driving, measured
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import Comparison, Score, Trace, Verdict
from symhyb.discrepancy.words.wording import percent_text
from symhyb.judgement import MARGIN
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array, on_lines
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.known import machine_with
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.scenario import Scenario

STARTS = "those of the smoothed motion"
Role = Literal["train", "holdout"]


def closer(prepared: Prepared, cuts: Sequence[Cut], law: Law) -> bool:
    """Whether the rates of held windows are significantly closer to those measured, over windows;
    each coordinate counts by the size of its rates."""
    gains, machine = [], prepared.machine
    for item in cuts:
        course = item.course(machine)
        wanted, made = lacking(machine, course, "rates"), values_along(machine, course, law)
        scale = np.sqrt(np.mean(wanted**2, axis=0))
        scale = np.where(scale > 0, scale, np.inf)
        without, left = ((part / scale) ** 2 for part in (wanted, wanted - made))
        gain = (without - left).sum(axis=1)
        gains.append(gain[item.rows[item.held]].mean(axis=1))
    gain = np.concatenate(gains)
    if gain.size < 2:
        return False
    return bool(gain.mean() > MARGIN * gain.std(ddof=1) / np.sqrt(gain.size))


def judge_rates(
    model: Model,
    correction: Correction,
    on: Sequence[Recording],
    train: Sequence[Recording],
) -> Verdict:
    """Score a model with and without a correction of rates on unseen recordings ``on`` and on those
    of the training; scores over windows are left out."""
    machine = build(as_sampled(model, train))
    groups: dict[Role, Sequence[Recording]] = {"train": train, "holdout": on}
    shown = {
        role: [_trace(machine, correction, one, role) for one in group]
        for role, group in groups.items()
        if group
    }
    tables = {
        role: _compared(machine, correction, groups[role], traces) for role, traces in shown.items()
    }
    best = tables.get("holdout", tables["train"])
    before, after = (max(_known(s.free_run_nrmse), default=None) for s in (best.before, best.after))
    where = "unseen recordings" if on else "the training recordings (no unseen one was given)"
    carries = (
        f"On {where} the free-run NRMSE goes from {percent_text(before)} to {percent_text(after)}; "
        "no model file holds this correction, so that there are no windows with fitted states."
    )
    traces = tuple(one for group in shown.values() for one in group)
    nan = float("nan")
    return Verdict(nan, STARTS, None, tables["train"], tables.get("holdout"), carries, traces)


def _known(values: Mapping[str, float | None]) -> list[float]:
    return [value for value in values.values() if value is not None]


def _trace(machine: Machine, correction: Correction, recording: Recording, role: Role) -> Trace:
    """Both free runs of a recording."""
    machine = machine_with(machine, recording.parameters)
    course, form = course_of(recording, machine, motion_of(recording, machine)), state_form(machine)
    scales = np.abs(course.states).max(axis=0, initial=0.0)
    t_u, u = driving(recording, machine)
    scenario = Scenario(
        recording.t,
        course.q[0],
        course.v[0],
        t_u,
        u,
        np.where(scales > 0, scales, 1.0),
        z=course.z[0],
        given=on_lines(recording.t, course.drive[:, form.inputs :], t_u) if form.given else None,
    )
    names = [s.name for s in machine.model.sensors if s.name in recording.sensors]
    columns = [s.name for s in machine.model.sensors]

    def table(values: Array) -> dict[str, Array]:
        return {name: values[:, columns.index(name)] for name in names}

    runs = [simulate_corrected(machine, scenario, one) for one in (None, correction)]
    moments = ("before correction", "after correction")
    failed = [f"{m}: {run.reason}" for m, run in zip(moments, runs, strict=True) if run.reason]
    return Trace(
        recording.name,
        role,
        recording.t,
        table(measured(recording, machine)),
        table(runs[0].y),
        table(runs[1].y),
        tuple(failed),
        {sensor.name: sensor.unit for sensor in machine.model.sensors},
    )


def _compared(
    machine: Machine,
    correction: Correction,
    recordings: Sequence[Recording],
    traces: Sequence[Trace],
) -> Comparison:
    courses = [course_of(one, machine, motion_of(one, machine)) for one in recordings]
    before = np.concatenate([discrepancy(machine, c, machine.values) for c in courses])
    after = np.concatenate([_left(machine, c, correction) for c in courses])
    applied = np.concatenate([applied_force(machine, c) for c in courses])
    reach, size = np.ptp(before, axis=0), np.sqrt(np.mean(applied**2, axis=0))
    return Comparison(
        _score(machine, before, reach, size, traces, "before"),
        _score(machine, after, reach, size, traces, "after"),
    )


def _left(machine: Machine, course: Course, correction: Correction) -> Array:
    """ΔF (N, n), SI, less M Δv': that of the acceleration that the rates leave to the model."""
    free = list(machine.free)
    a = course.a.copy()
    for law in correction.laws:
        a[:, free] -= values_along(machine, course, law)[:, len(free) :]
    return discrepancy(machine, replace(course, a=a), machine.values)


def _score(
    machine: Machine,
    force: Array,
    reach: Array,
    applied: Array,
    traces: Sequence[Trace],
    moment: str,
) -> Score:
    size = np.sqrt(np.mean(force**2, axis=0))
    names = [c.name for c in machine.model.coordinates]
    with np.errstate(invalid="ignore", divide="ignore"):
        by_reach = dict(zip(names, map(_finite, (size / reach).tolist()), strict=True))
        by_applied = dict(zip(names, map(_finite, (size / applied).tolist()), strict=True))
    free, free_unit = {}, {}
    for sensor in machine.model.sensors:
        pairs = [
            (one.measured[sensor.name], getattr(one, moment)[sensor.name])
            for one in traces
            if sensor.name in one.measured
        ]
        if not pairs:
            continue
        y, simulated = (np.concatenate(column) for column in zip(*pairs, strict=True))
        there = np.isfinite(y)
        error = float(np.sqrt(np.mean((y - simulated)[there] ** 2))) if there.any() else np.nan
        free[sensor.name] = _finite(error / np.ptp(y[there])) if there.any() else None
        free_unit[sensor.name] = _finite(error / sensor.unit.factor)
    return Score(by_reach, by_applied, {}, {}, free, free_unit)


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
