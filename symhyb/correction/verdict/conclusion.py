"""What a diagnosis concludes: effects as elements, the verdict with its sentence, what is drawn."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.advice.advice import better_recording
from symhyb.correction.naming.findings import (
    Named,
    alternatives_of,
    channel_faults,
    element_names,
    found_of,
    reestimated,
)
from symhyb.correction.naming.fleet_words import with_own
from symhyb.correction.naming.stability import stabilities, weakest
from symhyb.correction.search.decide import Decision
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.strength import element_forces
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.verdict.choice import Choice
from symhyb.correction.verdict.estimate import Estimated
from symhyb.correction.verdict.proof import Proof
from symhyb.correction.verdict.whole_words import added_alternatives
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.locate import activity
from symhyb.discrepancy.places.occurrence import MISMATCH
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.residual import (
    blind_notes,
    discrepancy,
    force_band,
    held_notes,
    noise_notes,
)
from symhyb.discrepancy.recorded.runs import Run, too_poor
from symhyb.discrepancy.results import (
    Activity,
    Cloud,
    Diagnosis,
    Found,
    PlaceShare,
    VerdictName,
)
from symhyb.discrepancy.words.formula import LAW, WARNING, law_text
from symhyb.discrepancy.words.wording import verdict_sentence
from symhyb.model.types import Model, On

COLOURED_MOST = 0.05  # of a signal's spread, that coloured noise may have
PLACE_LEAST = 0.1  # share of the mismatch that a place must explain to count
COLOURED = (
    " What is left is more than white noise, but no force of the machine's own motion explains any "
    "of it: the sensors' noise is coloured."
)


def concluded(
    model: Model,
    prepared: Prepared,
    choice: Choice,
    known: Estimated,
    shown: Proof,
    left: tuple[str, ...],
) -> Diagnosis:
    """The diagnosis of one choice; ``left`` are sentences on what is visible in the rest."""
    decision, final = choice.decision, known.final
    found = _told(model, prepared, decision, known, shown)
    parameters = reestimated(model, final, known.doubt)
    faults = channel_faults(final, known.doubt)
    titles = {cause: _title(cause, found) for cause in decision.winner.causes}
    alternatives = (
        *added_alternatives(model, known.completed),
        *alternatives_of(model, decision, titles),
    )
    verdict = _verdict(decision, found, bool(faults), bool(parameters))
    coloured = verdict == "undecided" and _only_coloured(prepared, decision, choice.places)
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
    return Diagnosis(
        verdict,
        sentence,
        found,
        parameters,
        faults,
        alternatives,
        record_next=better_recording(prepared) if poor and verdict == "undecided" else None,
        remainder=1.0 if verdict == "undecided" and not poor else shown.remainder,
        remainder_notes=left,
        noise=noise,
        places=choice.places,
        clouds=tuple(cloud for run in prepared.runs for cloud in _clouds(prepared, final, run)),
        log=(*decision.log, *(known.completed.log if known.completed else ())),
        notes=(*_run_notes(prepared), *noise_notes(model, noise), *_warnings(found)),
    )


def _run_notes(prepared: Prepared) -> tuple[str, ...]:
    """What was handled in the recordings, each said once."""
    said = [(*run.recording.notes, *blind_notes(run.motion)) for run in prepared.runs]
    said.append(held_notes(prepared.machine))
    return tuple(dict.fromkeys(note for notes in said for note in notes))


def _measured_noise(model: Model, prepared: Prepared) -> dict[str, float]:
    """Noise of every sensor that recorded something, as measured, in its own unit."""
    noise = {}
    for j, sensor in enumerate(model.sensors):
        spreads = [run.motion.sd[j] for run in prepared.runs if np.isfinite(run.motion.sd[j])]
        if spreads:
            noise[sensor.name] = float(np.sqrt(np.mean(np.square(spreads)))) / sensor.unit.factor
    return noise


def _told(
    model: Model, prepared: Prepared, decision: Decision, known: Estimated, shown: Proof
) -> tuple[Found, ...]:
    """Every found effect with its element, share, activity, stability and sentence."""
    provenance = (
        ("by", "sparse"),
        ("from", ", ".join(run.recording.name for run in prepared.runs)),
        ("nrmse", (float(f"{shown.before:.4g}"), float(f"{shown.after:.4g}"))),
    )
    final, items = known.final, known.items
    firm = dict(zip(decision.winner.causes, stabilities(decision), strict=True))
    found = []
    for item, name, share in zip(items, element_names(model, items), shown.shares, strict=True):
        active = _active(prepared, final, item)
        one = found_of(model, item, name, provenance, share, active)
        stable = weakest(firm, [final.causes[i] for i in item.causes])
        found.append(replace(with_own(model, final, item, one), stability=stable))
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


def _warnings(found: Sequence[Found]) -> tuple[str, ...]:
    """Say of every product that it is no law known by name."""
    return tuple(
        f"{item.element.name} is {WARNING}: it holds where the recordings moved, and nowhere else"
        for item in found
        if item.element.kind == LAW
    )


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
            max(
                (
                    float(np.nanstd(y))
                    for run in prepared.runs
                    if (y := run.recording.sensors.get(sensor.name)) is not None
                ),
                default=np.inf,
            )
            for sensor in prepared.model.sensors
        ]
    )
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
            On(c.name),
            run.recording.name,
            motion.t,
            motion.q[:, i],
            motion.v[:, i],
            force[:, i],
            band[:, i],
            law[:, i],
        )
        for i, c in enumerate(prepared.model.coordinates)
    ]
