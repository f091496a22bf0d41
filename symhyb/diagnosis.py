"""From a model and recordings to a diagnosis: the story, step by step.

Motion and noise → all causes screened together on growing windows → structures refined on
trajectories and judged on held windows → the map of places → what was found, in words. The unseen
recordings prove; they never choose. docs/method.md has the statistics and what was measured.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.advice import advise, better_recording
from symhyb.correction.beginnings import active_part, changed, contradicted, in_part
from symhyb.correction.clocks import drifting as clock_drift
from symhyb.correction.decide import Decision, decide
from symhyb.correction.evidence import NEAR_NOISE, weak
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
from symhyb.correction.fleet import Stranger, drifting, parted, strangers, widened, without
from symhyb.correction.fleet_words import (
    drift_sentence,
    misfit,
    parameters_with_own,
    repeats_said,
    with_own,
)
from symhyb.correction.isolability import completed, isolability
from symhyb.correction.leftover import leftover
from symhyb.correction.preparing import Prepared, prepare, settle
from symhyb.correction.proof import Proof, prove
from symhyb.correction.refusal import if_bounded, if_long_enough, with_lies
from symhyb.correction.setting import Setting, Stage
from symhyb.correction.sparse import propose
from symhyb.correction.stability import stabilities, weakest
from symhyb.correction.strength import element_forces
from symhyb.correction.trajectory import Refined, grouped, refine
from symhyb.data.cleaning import still
from symhyb.data.recording import Recording, several
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
    Misfit,
    PlaceShare,
    Repeats,
    VerdictName,
)  # fmt: skip
from symhyb.discrepancy.runs import Run, too_poor
from symhyb.discrepancy.wording import verdict_sentence
from symhyb.errors import NumericsError
from symhyb.model.types import Model, On

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

STILL = (
    "These recordings cannot tell: no sensor changes in any of them, so that the machine stands "
    "still or its sensors are dead. Nothing in them contradicts the model."
)

Say = Callable[[str], None]


def diagnose(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    *,
    own: Sequence[str] = (),
    say: Say | None = None,
) -> Diagnosis:
    """Say what the model lacks, from recordings of the machine.

    ``holdout`` are unseen recordings: they prove (shares and scores) and never choose. ``own``
    names what every recording has its own value of: parameters of the model, or keys of laws that
    may be found (``drag``); the phase of a harmonic force always. ``say`` gets a short line at
    every step.

    Raises:
        InputError: recordings that cannot be used with this model, or an unknown name in ``own``.
        NumericsError: the model cannot be simulated along the recordings at all.
    """
    tell = say or (lambda line: None)
    if still(several(recordings)):
        return Diagnosis("undecided", STILL, record_next=RECORD_NEXT)
    tell("estimating motion and noise")
    prepared = prepare(model, recordings, holdout)
    setting = settle(prepared, own)
    clock = clock_drift(
        setting, lambda clocks: settle(prepare(model, recordings, holdout, clocks), own)
    )
    if clock is not None:
        prepared = prepare(model, recordings, holdout, (clock,))
        setting = settle(prepared, own)
    tell("sparse regression on the weak form")
    middle = setting.stages[min(1, len(setting.stages) - 1)]
    proposals = propose(prepared.machine, setting.library, middle.laid, 5 / prepared.shortest)
    tell("mapping the places")
    values = prepared.machine.values
    places = locate(
        setting.library, setting.windows, middle.laid, values, setting.sd, setting.stages[0].laid
    )
    change = changed(places)
    whole, setting = setting, active_part(setting, change)
    decision = decide(setting, proposals, tell)
    if change is not None and not contradicted(whole, decision.winner, change):
        tell("deciding again, for it may act throughout")
        change, setting = None, whole
        decision = decide(setting, proposals, tell)
    laid = setting.stages[-1].laid
    odd: tuple[Stranger, ...] = ()
    if len(laid) > 1:
        tell("holding the recordings against each other")
        odd = strangers(prepared.model, decision.winner, setting.stages[-1], setting.sd)
    misfits = tuple(misfit(decision.winner, one, [i.source[0] for i in laid]) for one in odd)
    if odd:
        tell("deciding again, with what does not fit by itself")
        setting = (
            without(setting, [one.recording for one in odd])
            if len(laid) > 2
            else parted(setting, decision.winner, odd[0])
        )
        decision = decide(setting, proposals, tell)
    decision = completed(setting, decision)
    if decision.nothing.fit.reason and not decision.winner.causes:
        raise NumericsError(f"the model cannot be simulated: {decision.nothing.fit.reason}")
    tell("estimating values")
    final, stage = valued(setting, decision.winner, prepared)
    doubt = {*doubtful(decision), *(final.causes[i] for i in weak(final))}
    drift = drifting(prepared.model, final, stage, setting.sd)
    drifts = () if drift is None else (drift_sentence(final, drift),)
    final = final if drift is None else widened(final, drift)
    longest = setting.stages[-1].laid  # there the missing force stands out of the noise most
    memory = memoryless(setting.library, setting.windows, longest, values, setting.sd)
    tell("removing each cause once, for its share")
    items = [item for item in named(final) if not doubt & {final.causes[i] for i in item.causes}]
    shown = prove(prepared, setting, final, stage, items)
    firm = dict(zip(decision.winner.causes, stabilities(decision), strict=True))
    told = _told(model, prepared, final, items, shown, firm)
    left = leftover(setting, decision.winner) if doubt < {*final.causes} else ()
    rest = shown.remainder, left
    answer = _concluded(model, prepared, decision, final, told, doubt, rest, places)
    answer = _of_several(answer, final, misfits, repeats_said(prepared))
    answer = in_part(noted(answer, drifts), change)
    answer = if_bounded(answer, final, decision.nothing, (*prepared.runs, *prepared.holdout))
    answer = if_long_enough(answer, prepared.runs)
    answer = with_lies(answer, model, prepared.lies, final.fit.scale)
    answer = replace(answer, memory=memory if _missing(answer) else None)
    tell("looking for what to record next")
    return _advised(answer, prepared, setting, decision)


def noted(found: Diagnosis, sentences: Sequence[str]) -> Diagnosis:
    """The diagnosis with sentences that its answer and its notes must not go without."""
    return replace(
        found,
        sentence=" ".join([found.sentence, *sentences]),
        notes=(*sentences, *found.notes),
    )


def _of_several(
    found: Diagnosis, final: Refined, misfits: Sequence[Misfit], repeats: Sequence[Repeats]
) -> Diagnosis:
    """The diagnosis with what several recordings say of each other."""
    said = [*(one.sentence for one in misfits), *(one.sentence for one in repeats)]
    return replace(
        found,
        sentence=" ".join([found.sentence, *(one.sentence for one in misfits)]),
        parameters=parameters_with_own(final, found.parameters),
        misfits=tuple(misfits),
        repeats=tuple(repeats),
        notes=(*said, *found.notes),
    )


def valued(setting: Setting, winner: Refined, prepared: Prepared) -> tuple[Refined, Stage]:
    """The winner refitted on all windows, at the window length that determines its values best:
    short windows carry more noise, long ones more of what the model still lacks. Where nothing more
    is lacking that is the longest."""
    best: tuple[float, Refined, Stage] | None = None
    for stage in reversed(setting.stages):
        starts = winner.fit.starts if stage is setting.stages[-1] else None
        trial = refine(
            prepared.model, winner.causes, grouped(winner), stage.laid, setting.sd, starts,
            everything=True, careful=True,
        )  # fmt: skip
        spread = np.sqrt(np.diag(trial.fit.covariance))
        width = float(np.sum(np.log(np.maximum(spread, 1e-300)))) if spread.size else 0.0
        if not trial.fit.reason and (best is None or width < best[0] or not spread.size):
            best = width, trial, stage
        if best is not None and best[1].fit.scale < NEAR_NOISE:
            break
    if best is None:
        return winner, setting.stages[-1]
    return replace(best[1], accuracy=setting.accuracy), best[2]


def _told(
    model: Model,
    prepared: Prepared,
    final: Refined,
    items: Sequence[Named],
    shown: Proof,
    firm: Mapping[Hypothesis, float | None],
) -> tuple[Found, ...]:
    """Every found effect with its element, share, activity and sentence."""
    provenance = (
        ("by", "sparse"),
        ("from", ", ".join(run.recording.name for run in prepared.runs)),
        ("nrmse", (float(f"{shown.before:.4g}"), float(f"{shown.after:.4g}"))),
    )
    names = element_names(model, items)
    found = [
        replace(
            with_own(
                model,
                final,
                item,
                found_of(model, item, name, provenance, share, _active(prepared, final, item)),
            ),
            stability=weakest(firm, [final.causes[i] for i in item.causes]),
        )
        for item, name, share in zip(items, names, shown.shares, strict=True)
    ]
    return tuple(sorted(found, key=lambda item: -(item.share or 0.0)))


def _active(prepared: Prepared, final: Refined, item: Named) -> Activity | None:
    """Where and when an effect acts along the first recording."""
    run = prepared.runs[0]
    forces, stretch, rate = element_forces(final, run.recording, run.motion)
    own = len(prepared.model.elements)
    forceful = [i for i, cause in enumerate(final.causes) if cause.place is not None]
    rows = [own + forceful.index(i) for i in item.causes]
    size = np.abs(forces[:, :, rows].sum(axis=2)).max(axis=1)
    return activity(run.motion.t, stretch[:, rows[0]], rate[:, rows[0]], size)


def _concluded(
    model: Model,
    prepared: Prepared,
    decision: Decision,
    final: Refined,
    found: tuple[Found, ...],
    doubt: Collection[Hypothesis],
    remainder: tuple[float | None, tuple[str, ...]],
    places: tuple[PlaceShare, ...],
) -> Diagnosis:
    parameters, faults = reestimated(model, final, doubt), channel_faults(final, doubt)
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
        record_next=better_recording(prepared) if poor and verdict == "undecided" else None,
        remainder=1.0 if verdict == "undecided" and not poor else remainder[0],
        remainder_notes=remainder[1],
        noise=noise,
        places=places,
        clouds=tuple(cloud for run in prepared.runs for cloud in _clouds(prepared, final, run)),
        log=decision.log,
        notes=(*dict.fromkeys(notes), *noise_notes(model, noise), *_warnings(found)),
    )  # fmt: skip


def _advised(
    answer: Diagnosis, prepared: Prepared, setting: Setting, decision: Decision
) -> Diagnosis:
    """The answer with what the recordings tell apart, and the manoeuvre for what they do not."""
    told = replace(answer, isolability=isolability(setting, decision))
    if answer.record_next is not None:
        return told
    sentence, manoeuvre = advise(prepared, setting, decision)
    return replace(told, record_next=sentence, manoeuvre=manoeuvre)


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
    if decision.winner.causes:
        return "undecided"  # something earned its place, and all of it is in doubt
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
    forces = element_forces(final, run.recording, run.motion)[0]
    law = forces[:, :, len(prepared.model.elements) :].sum(axis=2)
    return [
        Cloud(
            On(c.name), run.recording.name, motion.t, motion.q[:, i], motion.v[:, i],
            force[:, i], band[:, i], law[:, i],
        )
        for i, c in enumerate(prepared.model.coordinates)
    ]  # fmt: skip
