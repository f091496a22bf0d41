"""From a model and recordings to a diagnosis: the story, step by step.

Motion and noise → all causes screened together on growing windows → structures refined on
trajectories and judged on held windows → the map of places → what was found, in words. The unseen
recordings prove; they never choose. docs/method.md has the statistics and what was measured.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.decide import Decision, decide
from symhyb.correction.findings import (
    Named,
    alternatives_of,
    channel_faults,
    doubtful,
    element_names,
    found_of,
    named,
    reestimated,
)  # fmt: skip
from symhyb.correction.leftover import leftover
from symhyb.correction.preparing import Prepared, prepare, settle
from symhyb.correction.proof import Proof, prove
from symhyb.correction.setting import Setting, Stage
from symhyb.correction.sparse import propose
from symhyb.correction.trajectory import Refined, grouped, refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.course import course_of
from symhyb.discrepancy.formula import LAW, WARNING, law_text
from symhyb.discrepancy.hypotheses import Hypothesis
from symhyb.discrepancy.locate import activity, locate
from symhyb.discrepancy.memoryless import memoryless
from symhyb.discrepancy.residual import blind_notes, discrepancy, force_band, noise_notes
from symhyb.discrepancy.results import (
    Activity,
    Cloud,
    Diagnosis,
    Found,
    PlaceShare,
    VerdictName,
)  # fmt: skip
from symhyb.discrepancy.runs import Run, too_poor
from symhyb.discrepancy.wording import verdict_sentence
from symhyb.errors import NumericsError
from symhyb.model.types import Model, On
from symhyb.numeric.buffers import Array
from symhyb.numeric.vector import along

MISMATCH = 1.15  # χ²/N that noise may reach by the error of its own measurement

COLOURED_MOST = 0.05  # of a signal's spread, that coloured noise may have
PLACE_LEAST = 0.1  # share of the mismatch that a place must explain to count
COLOURED = (
    " What is left is more than white noise, but no force of the machine's own motion explains any "
    "of it: the sensors' noise is coloured."
)

RECORD_NEXT = (
    "a longer run, of at least ten periods of the slowest motion, driven so that every coordinate "
    "moves at least thirty times its sensor's noise"
)

Say = Callable[[str], None]


def diagnose(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    *,
    say: Say | None = None,
) -> Diagnosis:
    """Say what the model lacks, from recordings of the machine.

    ``holdout`` are unseen recordings: they prove (shares and scores) and never choose. ``say`` gets
    a short line at every step.

    Raises:
        InputError: recordings that cannot be used with this model.
        NumericsError: the model cannot be simulated along the recordings at all.
    """
    tell = say or (lambda line: None)
    tell("estimating motion and noise")
    prepared = prepare(model, recordings, holdout)
    setting = settle(prepared)
    tell("sparse regression on the weak form")
    middle = setting.stages[min(1, len(setting.stages) - 1)]
    proposals = propose(prepared.machine, setting.library, middle.laid, 5 / prepared.shortest)
    decision = decide(setting, proposals, tell)
    if decision.nothing.fit.reason and not decision.winner.causes:
        raise NumericsError(f"the model cannot be simulated: {decision.nothing.fit.reason}")
    tell("estimating values")
    certain = _certain(setting, decision, prepared)
    final, stage = valued(setting, certain, prepared)
    tell("mapping the places")
    values = prepared.machine.values
    places = locate(setting.library, setting.windows, middle.laid, values, setting.sd)
    longest = setting.stages[-1].laid  # there the missing force stands out of the noise most
    memory = memoryless(setting.library, setting.windows, longest, values, setting.sd)
    tell("removing each cause once, for its share")
    items = named(final)
    shown = prove(prepared, setting, final, stage, items)
    told = _told(model, prepared, final, items, shown)
    left = leftover(setting, certain) if certain.causes else ()
    diagnosis = _concluded(model, prepared, decision, final, told, (shown.remainder, left), places)
    return replace(diagnosis, memory=memory if _missing(diagnosis) else None)


def valued(setting: Setting, winner: Refined, prepared: Prepared) -> tuple[Refined, Stage]:
    """The winner refitted on all windows, at the window length that determines its values best:
    short windows carry more noise, long ones more of what the model still lacks."""
    best: tuple[float, Refined, Stage] | None = None
    for stage in setting.stages:
        trial = refine(
            prepared.model, winner.causes, grouped(winner), stage.laid, setting.sd,
            everything=True, careful=True,
        )  # fmt: skip
        spread = np.sqrt(np.diag(trial.fit.covariance))
        width = float(np.sum(np.log(np.maximum(spread, 1e-300)))) if spread.size else 0.0
        if not trial.fit.reason and (best is None or width < best[0] or not spread.size):
            best = width, trial, stage
    if best is None:
        return winner, setting.stages[-1]
    return replace(best[1], accuracy=setting.accuracy), best[2]


def _certain(setting: Setting, decision: Decision, prepared: Prepared) -> Refined:
    """The winner without the causes that a rival replaces almost as well."""
    doubt = doubtful(decision)
    if not doubt:
        return decision.winner
    rows = dict(zip(decision.winner.causes, grouped(decision.winner), strict=True))
    kept = [cause for cause in decision.winner.causes if cause not in doubt]
    first = [rows[cause] for cause in kept]
    return refine(prepared.model, kept, first, setting.stages[-1].laid, setting.sd)


def _told(
    model: Model, prepared: Prepared, final: Refined, items: Sequence[Named], shown: Proof
) -> tuple[Found, ...]:
    """Every found effect with its element, share, activity and sentence."""
    provenance = (
        ("by", "sparse"),
        ("from", ", ".join(run.recording.name for run in prepared.runs)),
        ("nrmse", (float(f"{shown.before:.4g}"), float(f"{shown.after:.4g}"))),
    )
    names = element_names(model, items)
    found = [
        found_of(model, item, name, provenance, share, _active(prepared, final, item))
        for item, name, share in zip(items, names, shown.shares, strict=True)
    ]
    return tuple(sorted(found, key=lambda item: -(item.share or 0.0)))


def _active(prepared: Prepared, final: Refined, item: Named) -> Activity | None:
    """Where and when an effect acts along the first recording."""
    run = prepared.runs[0]
    forces, stretch, rate = element_forces(final, run)
    own = len(prepared.model.elements)
    forceful = [i for i, cause in enumerate(final.causes) if cause.place is not None]
    rows = [own + forceful.index(i) for i in item.causes]
    size = np.abs(forces[:, :, rows].sum(axis=2)).max(axis=1)
    return activity(run.motion.t, stretch[:, rows[0]], rate[:, rows[0]], size)


def element_forces(final: Refined, run: Run) -> tuple[Array, Array, Array]:
    """Generalized forces (N, n, E) of all elements along a run, stretches and rates (N, E), SI."""
    machine = replace(final.machine, values=final.p)
    c = course_of(run.recording, machine, run.motion)
    given = c.q, c.v, c.z, c.u, c.t, final.p
    (flat,) = along(machine.elements, given, (5,), c.t.size)
    flat = flat + along(machine.carried, (c.q, c.v, c.a, c.t, final.p), (4,), c.t.size)[0]
    forces = flat.reshape(c.t.size, -1, machine.n).swapaxes(1, 2)
    stretch, rate, _ = along(machine.pathways, (c.q, c.v, c.t, final.p), (3,), c.t.size)
    return forces, stretch, rate


def _concluded(
    model: Model,
    prepared: Prepared,
    decision: Decision,
    final: Refined,
    found: tuple[Found, ...],
    remainder: tuple[float | None, tuple[str, ...]],
    places: tuple[PlaceShare, ...],
) -> Diagnosis:
    parameters, faults = reestimated(model, final), channel_faults(final)
    titles = {cause: _title(cause, found) for cause in decision.winner.causes}
    alternatives = alternatives_of(model, decision, titles)
    verdict = _verdict(decision, found, bool(faults), bool(parameters))
    coloured = verdict == "undecided" and _only_coloured(prepared, decision, places)
    if coloured:
        verdict = "nothing missing"
    sentence = verdict_sentence(verdict, found, parameters, faults, alternatives)
    if coloured:
        sentence += COLOURED
    poor = too_poor(prepared.runs, [sensor.name for sensor in model.sensors])
    if verdict == "nothing missing" and poor:
        verdict = "undecided"
        sentence = f"These recordings cannot tell: {poor}. Nothing in them contradicts the model."
    noise = _measured_noise(model, prepared)
    notes = [
        note for run in prepared.runs for note in (*run.recording.notes, *blind_notes(run.motion))
    ]
    return Diagnosis(
        verdict, sentence, found, parameters, faults, alternatives,
        record_next=RECORD_NEXT if poor and verdict == "undecided" else None,
        remainder=1.0 if verdict == "undecided" and not poor else remainder[0],
        remainder_notes=remainder[1],
        noise=noise,
        places=places,
        clouds=tuple(cloud for run in prepared.runs for cloud in _clouds(prepared, final, run)),
        log=decision.log,
        notes=(*dict.fromkeys(notes), *noise_notes(model, noise), *_warnings(found)),
    )  # fmt: skip


def _missing(diagnosis: Diagnosis) -> bool:
    """Whether there is a force of which anything can be asked."""
    return diagnosis.verdict == "missing physics" or diagnosis.remainder == 1.0


def _warnings(found: Sequence[Found]) -> tuple[str, ...]:
    """Say of every product that it is no law known by name."""
    return tuple(
        f"{item.element.name} is {WARNING}: it holds where the recordings moved, and nowhere else"
        for item in found
        if item.element.kind == LAW
    )


def _measured_noise(model: Model, prepared: Prepared) -> dict[str, float]:
    """Noise of every sensor that recorded something, as measured, in its own unit."""
    noise = {}
    for j, sensor in enumerate(model.sensors):
        spreads = [run.motion.sd[j] for run in prepared.runs if np.isfinite(run.motion.sd[j])]
        if spreads:
            noise[sensor.name] = float(np.sqrt(np.mean(np.square(spreads)))) / sensor.unit.factor
    return noise


def _title(cause: Hypothesis, found: Sequence[Found]) -> str:
    for item in found:
        mine = item.element
        if cause.kind == LAW and (mine.place, item.law) == (cause.place, law_text(cause.path)):
            return mine.name
        if (mine.kind, mine.place, mine.options) == (cause.kind, cause.place, cause.options):
            return item.element.name
    return cause.path


def _verdict(
    decision: Decision, found: Sequence[Found], faults: bool, parameters: bool
) -> VerdictName:
    if found:
        return "missing physics"
    if faults:
        return "measurement"
    if parameters:
        return "parameters"
    nothing = decision.nothing.fit
    slack = 4 * np.sqrt(2 * nothing.correlation / max(float(nothing.count.sum()), 1.0))
    return "nothing missing" if nothing.scale <= MISMATCH + slack else "undecided"


def _only_coloured(prepared: Prepared, decision: Decision, places: Sequence[PlaceShare]) -> bool:
    """Whether what is left looks like noise of the sensors that is coloured: no cause was believed,
    no place explains a part of it out of sample, and it is small against every signal."""
    if decision.winner.causes or any((p.explained or 0.0) > PLACE_LEAST for p in places):
        return False
    left = prepared.sd * np.sqrt(decision.nothing.fit.scale)
    spreads = np.array(
        [
            max((float(np.nanstd(y)) for run in prepared.runs
                 if (y := run.recording.sensors.get(sensor.name)) is not None), default=np.inf)
            for sensor in prepared.model.sensors
        ]
    )  # fmt: skip
    return bool(np.all(left < COLOURED_MOST * spreads))


def _clouds(prepared: Prepared, final: Refined, run: Run) -> list[Cloud]:
    """ΔF of every coordinate along a run, with the force of what was found there."""
    machine, motion = prepared.machine, run.motion
    course = course_of(run.recording, machine, motion)
    force = discrepancy(machine, course, machine.values)
    band = force_band(machine, motion, course)
    law = element_forces(final, run)[0][:, :, len(prepared.model.elements) :].sum(axis=2)
    return [
        Cloud(
            On(c.name), run.recording.name, motion.t, motion.q[:, i], motion.v[:, i],
            force[:, i], band[:, i], law[:, i],
        )
        for i, c in enumerate(prepared.model.coordinates)
    ]  # fmt: skip
