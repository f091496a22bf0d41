"""Before against after, on training and unseen recordings, and which score decides."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from symhyb.asked import asked
from symhyb.data.known import require_known
from symhyb.data.recording import Recording, several
from symhyb.discrepancy.evidence import Correlations, Whiteness, Without
from symhyb.discrepancy.fitting.bands import bands_of, without_each
from symhyb.discrepancy.fitting.scores import Errors, errors, score, yardstick
from symhyb.discrepancy.fitting.whiteness import whiteness
from symhyb.discrepancy.recorded.local import along_recordings, beside
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run, noise_sd, with_noise
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.signals import measured
from symhyb.discrepancy.results import Comparison, Score, Trace, Verdict
from symhyb.discrepancy.words.wording import percent_text
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.either import model_of
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.windows import WindowModel

WINDOW_PERIODS = 0.5  # length of a window, where none is given
BAND_PERIODS = 20.0  # upper end of the force band per period, where none is given
STARTS = "fitted to every window and every run, unseen ones too"


@asked
def judge(
    model: Model | Machine,
    corrected: Model | Machine,
    on: Recording | Sequence[Recording] = (),
    *,
    train: Recording | Sequence[Recording] = (),
    window_s: float | None = None,
    force_band_hz: float | None = None,
    correlations: Correlations | None = None,
    own: Mapping[str, Mapping[str, float]] | None = None,
) -> Verdict:
    """Score a model and its correction on unseen recordings ``on`` and on those of the training.

    ``window_s`` is the length of the short windows in s (default: half the shortest period of the
    motion), ``force_band_hz`` the upper end of the band in Hz in which forces are compared
    (default: 20 of those periods). With the ``correlations`` of the numbers of the correction its
    free runs get bands. ``own`` has by the name of a recording the values, in the units of the
    corrected model, that it does not share with all others (:meth:`.Diagnosis.values_of`).

    Raises:
        InputError: known values of parameters that not all recordings state.
    """
    model, corrected = model_of(model), model_of(corrected)
    unseen, seen = several(on), several(train)
    require_known(model, (*seen, *unseen))
    same = corrected == model
    model, (seen, unseen) = along_recordings(model, seen, unseen)
    corrected = beside(corrected, model)
    used = seen or unseen
    machines = build(as_sampled(model, used)), build(as_sampled(corrected, used))
    runs = {"train": _runs(machines[0], seen), "holdout": _runs(machines[0], unseen)}
    period = min(
        (float(run.motion.periods().min()) for group in runs.values() for run in group), default=1.0
    )
    window = window_s or WINDOW_PERIODS * period
    band = force_band_hz or BAND_PERIODS / period
    comparisons: dict[str, Comparison | None] = {"train": None, "holdout": None}
    traces: list[Trace] = []
    white: tuple[Whiteness, ...] = ()
    without: tuple[Without, ...] = ()
    proof = runs["holdout"] or runs["train"]
    for role, group in runs.items():
        if not group:
            continue
        by = yardstick(machines[0], group, band)
        before = errors(machines[0], group, window, band)
        mine = group if same else _with_own(machines[1], group, own or {})
        after = before if same else errors(machines[1], mine, window, band)
        comparisons[role] = Comparison(
            score(machines[0], before, group, by), score(machines[1], after, mine, by)
        )
        bands = bands_of(machines[1], mine, after, None if same else correlations)
        traces += _traces(machines[0], group, role, before, after, bands)
        if group is proof:
            white = _whiteness(machines[1], mine, after)
            without = without_each(model, corrected, mine, after.scenarios)
    carries = _carries(comparisons["holdout"] or comparisons["train"], window, bool(unseen), same)
    empty = Comparison(*(Score({}, {}, {}, {}, {}, {}) for _ in range(2)))
    return Verdict(
        window,
        STARTS,
        band,
        comparisons["train"] or empty,
        comparisons["holdout"],
        carries,
        tuple(traces),
        white,
        without,
    )


def _with_own(
    machine: Machine, runs: Sequence[Run], own: Mapping[str, Mapping[str, float]]
) -> tuple[Run, ...]:
    """The runs with the values that their recordings do not share with all others (``own``, in the
    units of the model) among what is known of them."""
    declared = {item.path: item for item in machine.model.all_parameters()}
    found = []
    for run in runs:
        values = own.get(run.recording.name, {})
        mine = {path: value * declared[path].unit.factor for path, value in values.items()}
        known = {**run.recording.parameters, **mine}
        found.append(replace(run, recording=replace(run.recording, parameters=known)))
    return tuple(found)


def _whiteness(machine: Machine, runs: Sequence[Run], found: Errors) -> tuple[Whiteness, ...]:
    model = machine.model
    names = [[item.name for item in kind] for kind in (model.sensors, model.recorded_inputs)]
    return tuple(
        one
        for run, left in zip(runs, found.residuals, strict=True)
        if left is not None
        for one in whiteness(run.recording.name, left, *names)
    )


def _runs(machine: Machine, recordings: Sequence[Recording]) -> tuple[Run, ...]:
    runs = [Run(recording, motion_of(recording, machine), np.empty(0)) for recording in recordings]
    return with_noise(runs, noise_sd(runs, machine), WindowModel(machine)) if runs else ()


def _traces(
    machine: Machine,
    runs: Sequence[Run],
    role: str,
    before: Errors,
    after: Errors,
    bands: Sequence[Array | None],
) -> list[Trace]:
    names = [sensor.name for sensor in machine.model.sensors]
    coordinates = [coordinate.name for coordinate in machine.model.coordinates]

    def moved(q: Array) -> dict[str, Array]:
        return dict(zip(coordinates, q.T, strict=True))

    def table(values: Array, present: Sequence[str]) -> dict[str, Array]:
        return {name: values[:, i] for i, name in enumerate(names) if name in present}

    traces = []
    pairs = zip(before.trajectories, after.trajectories, strict=True)
    for run, (first, second), band in zip(runs, pairs, bands, strict=True):
        present = list(run.recording.sensors)
        said = (("before correction", first), ("after correction", second))
        failures = [f"{when}: {run_.reason}" for when, run_ in said if run_.reason]
        kind: Literal["train", "holdout"] = "train" if role == "train" else "holdout"
        traces.append(
            Trace(
                run.recording.name,
                kind,
                run.recording.t,
                table(measured(run.recording, machine), present),
                table(first.y, present),
                table(second.y, present),
                tuple(failures),
                {sensor.name: sensor.unit for sensor in machine.model.sensors},
                {} if band is None else table(band, present),
                moved(run.motion.q),
                moved(first.q),
            )
        )
    return traces


def _carries(comparison: Comparison | None, window: float, unseen: bool, same: bool) -> str:
    """The sentence on the sensor whose errors change most, and on which score decides."""
    if comparison is None:
        return "No recording was given to judge on."
    where = "unseen recordings" if unseen else "the training recordings (no unseen one was given)"
    why = (
        "The verdict is based on the windows: short windows show forces, where a long free run "
        "adds up every small error and drifts."
    )
    before, after = comparison.before, comparison.after
    seen = {name: value for name, value in before.window_nrmse.items() if value is not None}
    over = f"over windows of {window:.3g} s with fitted initial states"
    if not seen:
        return f"On {where} the error {over} is not computable. {why}"
    name = max(seen, key=lambda one: (_changed(comparison, one), seen[one]))
    windows = _went(seen[name], None if same else after.window_nrmse.get(name))
    runs = before.free_run_nrmse.get(name), after.free_run_nrmse.get(name)
    free = "" if None in runs else f", in a free run {_went(runs[0], None if same else runs[1])}"
    return f"On {where} the error of {name} {over} {windows} of its range{free}. {why}"


def _changed(comparison: Comparison, name: str) -> float:
    """By which factor the errors of a sensor change most, as a logarithm of either sign."""
    before, after = comparison.before, comparison.after
    pairs = (
        (before.window_nrmse.get(name), after.window_nrmse.get(name)),
        (before.free_run_nrmse.get(name), after.free_run_nrmse.get(name)),
    )
    factors = [old / new for old, new in pairs if old and new]
    return max((abs(float(np.log(factor))) for factor in factors), default=0.0)


def _went(before: float | None, after: float | None) -> str:
    """How a score changed, as a verb; what it is where there is nothing after it."""
    if before is None or after is None:
        return f"is {'not computable' if before is None else percent_text(before)}"
    verb = "rises" if after > before else "falls"
    return f"{verb} from {percent_text(before)} to {percent_text(after)}"
