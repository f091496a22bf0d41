"""What a decision works on: motion, noise, thinned runs, lowered hypotheses and windows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.search.fleet import check_own, owning
from symhyb.correction.search.setting import Setting, Stage
from symhyb.data.cleaning import cleaned
from symhyb.data.groups import Own, by_name, require_groups
from symhyb.data.known import require_known
from symhyb.data.recording import Recording, several
from symhyb.data.thin import thinned
from symhyb.discrepancy.checks.repeats import Repeated, floor_of, repeated
from symhyb.discrepancy.checks.suspicion import repaired, suspect
from symhyb.discrepancy.places.candidates import (
    force_hypotheses,
    joined,
    lacking,
    transition_share,
)
from symhyb.discrepancy.places.hypotheses import (
    Hypothesis,
    library,
    parametric_hypotheses,
    places_of,
    with_channels,
)
from symhyb.discrepancy.places.points import point_hypotheses
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.local import along_recordings
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.runs import Run, cut_within, noise_sd, with_noise
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.discrepancy.recorded.windows import SAMPLES_LEAST as WINDOW_LEAST
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.discrepancy.results import RecordingFault
from symhyb.errors import InputError, Problem
from symhyb.judgement import ACCURACY, GROWN, LARGE, NEGLIGIBLE, WINDOWS_LEAST
from symhyb.laws.reach import Reach
from symhyb.model.delays import with_shared_delays
from symhyb.model.types import Model, On, Place
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.between import held_columns
from symhyb.numeric.runs.windows import WindowModel

SAMPLES_PERIOD = 80  # of the shortest period, that are kept
SAMPLES_LEAST = 4000  # of a recording, that are kept
SAMPLES_MOST = 12_000  # over all recordings, in the windows that decide
FIRST_WINDOW = 0.25  # of the shortest period
GROWTH = 3.0  # from stage to stage, at most
STAGES_MOST = 4
SHORTER = 0.7  # ... shortened to this


@dataclass(frozen=True, slots=True)
class Prepared:
    """Model with channels, lowered; runs thinned to what the motion needs,
    noise ``sd`` (m,) SI, not below what ``repeats`` of one manoeuvre differ by, and the
    ``shortest`` period of the motion in s; ``faults`` of the recordings were put right, or are
    suspected. ``steady``: the machine with what forces show, where without it hardly any window
    can be foreseen."""

    model: Model
    machine: Machine
    runs: tuple[Run, ...]
    holdout: tuple[Run, ...]
    sd: Array
    shortest: float
    faults: tuple[RecordingFault, ...] = ()
    repeats: tuple[Repeated, ...] = ()
    steady: Machine | None = None


def prepare(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    clocks: tuple[RecordingFault, ...] = (),
    own: Sequence[str] | Own = (),
) -> Prepared:
    """Lower the model, thin the recordings and estimate motion and noise.

    Recording faults are put right first, those whose ``clocks`` are known to drift among them.

    Raises:
        InputError: no recording, a coordinate that no sensor sees, known values of parameters that
            not all recordings state or that are to be fitted, or groups that are not stated.
    """
    recordings, holdout = several(recordings), several(holdout)
    if not recordings:
        raise InputError(Problem("no recording was given; a diagnosis needs at least one"))
    require_known(model, (*recordings, *holdout), tuple(own))
    require_groups(recordings, holdout, by_name(own))
    recordings, holdout = cleaned(recordings, model), cleaned(holdout, model)
    model, (recordings, holdout) = along_recordings(model, recordings, holdout)
    extended = _extended(as_sampled(model, recordings), recordings)
    machine = build(extended)
    first = [Run(r, motion_of(r, machine), np.empty(0)) for r in recordings]
    repair = suspect(machine, first)
    faults = (*repair.faults, *clocks)
    if any(fault.claimed for fault in faults):
        recordings, holdout = repaired(recordings, faults), repaired(holdout, faults)
        extended, (recordings, holdout) = along_recordings(repair.model, recordings, holdout)
        extended = as_sampled(extended, recordings)
        machine = build(extended)
        first = [Run(r, motion_of(r, machine), np.empty(0)) for r in recordings]
    periods = np.concatenate([run.motion.periods() for run in first])
    shortest = float(np.min(periods))
    runs = [thinned_run(run, machine, shortest) for run in first]
    proofs = [
        thinned_run(Run(r, motion_of(r, machine), np.empty(0)), machine, shortest) for r in holdout
    ]
    sd = noise_sd(runs, machine)
    # recordings that have numbers of their own are of different machines: no repeats of one run
    names = [sensor.name for sensor in machine.model.sensors]
    repeats = () if own else repeated(runs, names)
    between = floor_of(repeats, sd.size)
    sd = np.maximum(sd, between)
    floor = float(np.mean(np.square(between / sd)[_recorded(runs)])) if repeats else 0.0
    runs = [replace(run, floor=floor) for run in runs]
    windows = WindowModel(machine)
    train, unseen = (with_noise(group, sd, windows) for group in (runs, proofs))
    return Prepared(extended, machine, train, unseen, sd, shortest, faults, repeats)


def _extended(model: Model, recordings: Sequence[Recording]) -> Model:
    """The model with all numbers of channels that may be fitted to these recordings."""
    shown = {name for recording in recordings for name in recording.sensors}
    return with_shared_delays(with_channels(model), shown)


def _recorded(runs: Sequence[Run]) -> NDArray[np.bool_]:
    """The sensors (m,) that recorded something."""
    return np.asarray(np.isfinite([run.motion.sd for run in runs]).any(axis=0))


def settle(
    prepared: Prepared,
    own: Sequence[str] | Own = (),
    more: Sequence[On] = (),
    besides: Sequence[Hypothesis] = (),
) -> Setting:
    """Lower all hypotheses, also at ``more`` places and ``besides`` those of the list, and make
    windows of growing lengths; ``own`` names what each recording has its own value of, or maps it
    to the grouping of those that share one.

    Raises:
        InputError: ``own`` names neither a parameter of the model nor a key of a law.
    """
    own = by_name(own)
    check_own(prepared.model, own)
    model, machine = prepared.model, prepared.machine
    places = (*places_of(model), *more)
    laws = owning(model, laws_at(prepared, places), own)
    causes = library(model, places, (*laws, *besides))
    parametric = owning(model, parametric_hypotheses(model), own)
    windows = WindowModel(machine, tuple(machine.column(cause.path) for cause in parametric))
    sag = _sag(prepared)
    return Setting(
        causes,
        parametric,
        windows,
        stages_of(prepared),
        prepared.sd,
        gain_floor=max(NEGLIGIBLE, sag),
        accuracy=max(ACCURACY, sag),
    )


def laws_at(prepared: Prepared, places: Sequence[Place]) -> tuple[Hypothesis, ...]:
    """Every law that may act at these places or at points, scaled by what they move through."""
    narrow = transition_share(_relative_noise(prepared))
    motions = [(run.motion.q, run.motion.v, run.motion.t) for run in prepared.runs]
    return (
        *force_hypotheses(prepared.model, _reaches(prepared, places), narrow),
        *point_hypotheses(prepared.model, motions, narrow),
    )


def _relative_noise(prepared: Prepared) -> float:
    """Noise over spread of the sensor that shows most."""
    ratios = [
        sd / spread
        for run in prepared.runs
        for sensor, sd in zip(prepared.model.sensors, prepared.sd, strict=True)
        if (values := run.recording.sensors.get(sensor.name)) is not None
        and (spread := float(np.nanstd(values))) > 0
    ]
    return min(ratios, default=0.0)


def _sag(prepared: Prepared) -> float:
    """What first-order hold may take from an input, relative to it: the hold error |Δ²u|/8 of the
    true signal's chord between two samples; nothing where the input is known to be smooth or
    held."""
    worst = 0.0
    lines = [
        item.name
        for item in prepared.model.recorded_inputs
        if item.between not in ("smooth", "held")
    ]
    for run in prepared.runs:
        for values in map(run.recording.inputs.__getitem__, lines):
            size = float(np.std(values))
            if size > 0:
                worst = max(worst, float(np.sqrt(np.mean(np.diff(values, n=2) ** 2))) / 8 / size)
    return worst


def _reaches(prepared: Prepared, places: Sequence[Place]) -> Mapping[Place, Reach]:
    """What each place moves through in all runs, and the force that the model lacks there."""
    gauge = library(prepared.model, tuple(places), ())
    parts: list[list[Reach]] = [[] for _ in places]
    for run in prepared.runs:
        course = course_of(run.recording, gauge.machine, run.motion)
        stretch, rate = gauge.motion(course)
        missing = discrepancy(
            prepared.machine,
            course_of(run.recording, prepared.machine, run.motion),
            prepared.machine.values,
        )
        directions = gauge.directions(course)
        for i, part in enumerate(parts):
            force = lacking(missing, directions, i)
            part.append(Reach(stretch[:, i], rate[:, i], force, course.t))
    return {place: joined(part) for place, part in zip(places, parts, strict=True)}


def foresees(prepared: Prepared) -> bool:
    """Whether most of the shortest windows can be foreseen."""
    return _mostly_calm(prepared, _shortest(prepared))


def stages_of(prepared: Prepared) -> tuple[Stage, ...]:
    """Windows of growing lengths, from short to long.

    Raises:
        InputError: the recordings are too short, or too full of gaps, for any.
    """
    share = SAMPLES_MOST / sum(run.recording.t.size for run in prepared.runs)
    shortest = _shortest(prepared)
    total = sum(run.recording.duration for run in prepared.runs)
    longest = _foreseen(prepared, shortest, total / WINDOWS_LEAST)
    if longest <= shortest:
        shortest = longest = _foreseen(prepared, WINDOW_LEAST * _step(prepared), shortest)
    stages: list[Stage] = []
    for length in _lengths(shortest, longest):
        cuts = [_spread(cut_within(run, prepared.machine, length), share) for run in prepared.runs]
        calm = [None if item is None else _foreseeable(prepared, item) for item in cuts]
        kept = tuple(item for item in calm if item is not None)
        enough = sum(len(item.start) for item in kept) >= WINDOWS_LEAST
        if not kept or (stages and not enough):
            break
        stages.append(Stage(length, kept))
    if not stages:
        names = ", ".join(run.recording.name for run in prepared.runs)
        text = f"{names}: too short or too full of gaps for a window of {shortest:.3g} s"
        raise InputError(Problem(text))
    return tuple(stages)


def last_windows(prepared: Prepared, *, spread: bool) -> tuple[Cut, ...]:
    """The windows of the last stage: those that decide, or where not ``spread`` all of their
    length, for values."""
    last = stages_of(prepared)[-1]
    if spread:
        return last.cuts
    cuts = [cut_within(run, prepared.machine, last.length_s) for run in prepared.runs]
    calm = [None if item is None else _foreseeable(prepared, item) for item in cuts]
    return tuple(item for item in calm if item is not None)


def _shortest(prepared: Prepared) -> float:
    """The length in s of the windows of the first stage, if most of them can be foreseen."""
    return max(FIRST_WINDOW * prepared.shortest, WINDOW_LEAST * _step(prepared))


def _step(prepared: Prepared) -> float:
    """The time in s between two samples of the slowest recording."""
    return max(float(np.median(np.diff(run.recording.t))) for run in prepared.runs)


def _foreseen(prepared: Prepared, shortest: float, longest: float) -> float:
    """The longest windows in s of which most can be foreseen."""
    while longest > shortest and not _mostly_calm(prepared, longest):
        longest *= SHORTER
    return longest


def _mostly_calm(prepared: Prepared, length_s: float) -> bool:
    """Whether most of all windows of a length in s can be foreseen."""
    cuts = [cut_within(run, prepared.machine, length_s) for run in prepared.runs]
    calm = [_calm(prepared, item) for item in cuts if item is not None]
    return bool(calm) and float(np.mean(np.concatenate(calm))) >= 1 - LARGE


def _foreseeable(prepared: Prepared, item: Cut) -> Cut | None:
    """The windows that can be foreseen, if there are any."""
    calm = _calm(prepared, item)
    if calm.all():
        return item
    return item.chosen(np.flatnonzero(calm)) if calm.any() else None


def _calm(prepared: Prepared, item: Cut) -> NDArray[np.bool_]:
    """The windows (W,) along whose measured motion no error of the state at the start shows
    ``GROWN`` times more in the outputs than if no force acted."""
    machine = prepared.steady or prepared.machine
    model = WindowModel(machine)
    half, item = len(model.form.free), item.suited(machine)
    if half == 0:  # all motion is given
        return np.ones(len(item.start), bool)
    linear = model.along(item.block, item.states, machine.values)
    reply = linear.from_states()[..., : 2 * half] / prepared.sd[:, None]
    reply = reply * _errors(reply[:, 0, :, :half], item.states)
    coasting = np.repeat(reply[:, :1], reply.shape[1], axis=1)
    past = (item.block.t - item.block.t[:, :1])[..., None, None]
    coasting[..., half:] += past * _rates(item.states, half) * coasting[..., :half]
    return np.asarray(np.all(_size(reply) <= GROWN * _size(coasting), axis=1))


def _rates(states: Array, half: int) -> Array:
    """Spread of every speed over that of its position, 1/s, of states (W, L, X)."""
    spread = states.reshape(-1, states.shape[2]).std(axis=0)
    return np.asarray(spread[half : 2 * half] / np.maximum(spread[:half], 1e-300))


def _errors(seen: Array, states: Array) -> Array:
    """Errors of positions that sensors see as one standard deviation, from whitened slopes
    ``seen`` (W, m, q), and of the speeds that go with them; a position that no sensor sees is off
    by its spread. SI."""
    half = seen.shape[2]
    size = np.sqrt(np.mean(np.sum(seen**2, axis=1), axis=0))
    spread = states.reshape(-1, states.shape[2]).std(axis=0)[:half]
    position = np.where(size > 0, 1 / np.where(size > 0, size, 1.0), spread)
    return np.concatenate([position, position * _rates(states, half)])


def _size(reply: Array) -> Array:
    """Root of the squares (W, L) of replies (W, L, m, X)."""
    return np.asarray(np.sqrt(np.sum(reply**2, axis=(2, 3))))


def _lengths(shortest: float, longest: float) -> list[float]:
    """Lengths of windows in s, at equal ratios."""
    ratio = min(longest / shortest, GROWTH ** (STAGES_MOST - 1))
    if ratio < 1:
        return [shortest]
    steps = int(np.ceil(np.log(ratio) / np.log(GROWTH) - 1e-9))
    return [shortest * ratio ** (i / max(steps, 1)) for i in range(steps + 1)]


def _spread(item: Cut | None, share: float) -> Cut | None:
    """A share of the windows, evenly spread, of recordings that are longer than a search needs."""
    if item is None or share >= 1:
        return item
    rows = np.unique(np.linspace(0, len(item.start) - 1, max(int(share * len(item.start)), 9)))
    return item.chosen(rows.astype(np.int64))


def thinned_run(run: Run, machine: Machine, shortest: float) -> Run:
    """A run with as many samples as motion of a ``shortest`` period in s needs; all of them where
    an input is held."""
    step = float(np.median(np.diff(run.recording.t)))
    dense = int(shortest / SAMPLES_PERIOD / step)
    factor = max(min(dense, run.recording.t.size // SAMPLES_LEAST), 1)
    if factor == 1 or held_columns(machine.model.inputs):  # averages of what is held are not held
        return run
    short = thinned(run.recording, factor)
    return Run(short, motion_of(short, machine), run.sd)
