"""What a diagnosis concludes: effects as elements, the verdict with its sentence, what is drawn."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.beyond import Beyond
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.advice.advice import better_recording
from symhyb.correction.naming.actuator_rivals import (
    LagDoubt,
    actuator_rivals,
    lag_doubt,
    named_on_the_way,
)
from symhyb.correction.naming.classes import class_found, classes_said
from symhyb.correction.naming.delays import channel_by_channel
from symhyb.correction.naming.findings import (
    Named,
    alternatives_of,
    channel_faults,
    element_names,
    found_of,
    reestimated,
)
from symhyb.correction.naming.fleet_words import with_groups, with_own
from symhyb.correction.naming.mode_words import sensors_of_modes
from symhyb.correction.naming.other_side import late_on_the_other_side
from symhyb.correction.naming.probability import probabilities
from symhyb.correction.naming.stability import stabilities, weakest
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.strength import element_forces
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.verdict.choice import Choice
from symhyb.correction.verdict.estimate import Estimated
from symhyb.correction.verdict.proof import Proof
from symhyb.correction.verdict.whole_words import added_alternatives
from symhyb.correction.verdict.worth import law_spread, worth_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.locate import activity
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
    ClassFound,
    Cloud,
    Diagnosis,
    Found,
    VerdictName,
)
from symhyb.discrepancy.words.formula import LAW, WARNING, law_text
from symhyb.discrepancy.words.wording import (
    joined,
    percent_text,
    quantity_text,
    verdict_sentence,
)
from symhyb.judgement import NEGLIGIBLE, NOISE_FACTOR
from symhyb.model.actuators import ACTUATOR_KEYS
from symhyb.model.types import Model, On, place_text
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.kernels.buffers import Array


def concluded(
    model: Model,
    prepared: Prepared,
    choice: Choice,
    known: Estimated,
    shown: Proof,
    left: tuple[str, ...],
    judged: Adequacy,
) -> Diagnosis:
    """The diagnosis of one choice, and what acts beyond it (``judged``); ``left`` are sentences on
    what is visible in the rest."""
    decision, final = choice.decision, known.final
    judged = named_on_the_way(judged, choice.behind)
    found = _found(model, prepared, decision, known, shown)
    parameters = reestimated(model, final, known.doubt)
    faults = channel_faults(final, known.doubt)
    titles = {cause: _title(cause, found) for cause in decision.selected.causes}
    alternatives = (
        *added_alternatives(model, known.completed),
        *alternatives_of(model, decision, titles, known.doubt),
    )
    alternatives = channel_by_channel(final.machine.model, alternatives)
    group = 1 + max((one.together for one in alternatives), default=0)
    alternatives += late_on_the_other_side(model, faults, group, alternatives)
    alternatives = (*actuator_rivals(choice.behind, group + 1), *alternatives)
    acts = any(fault.kind in ACTUATOR_KEYS for fault in faults)
    verdict = _verdict(known, judged, bool(found) or acts, bool(faults), bool(parameters))
    sentence = verdict_sentence(
        verdict, found, parameters, faults, alternatives, beyond=not judged.adequate
    )
    classes = _classes(model, judged)
    beyond = "fits best" if final.causes else ""
    beyond = "is named" if found or parameters or faults else beyond
    rest = _rest(model, judged, beyond)
    lag = lag_doubt(choice.behind)
    rest = f"{lag.said} {rest}".rstrip() if lag else rest
    poor = too_poor(prepared.runs, [sensor.name for sensor in model.sensors])
    if verdict == "nothing missing" and poor:
        verdict = "undecided"
        sentence = f"These recordings cannot tell: {poor}. Nothing in them contradicts the model."
    elif verdict == "nothing missing" and judged.unjudged:
        verdict = "undecided"
        sentence = f"No cause that symhyb knows earned its place. {rest}"
    elif rest:
        sentence = f"{sentence} {rest}"
    noise = _measured_noise(model, prepared, _noise_beside(judged, choice.setting.sd))
    return Diagnosis(
        verdict,
        sentence,
        found,
        parameters,
        faults,
        alternatives,
        record_next=_record_next(prepared, bool(poor) and verdict == "undecided", lag),
        remainder=1.0 if verdict == "undecided" and not poor else shown.remainder,
        remainder_notes=(rest, *left) if rest else left,
        noise=noise,
        places=choice.places,
        clouds=tuple(cloud for run in prepared.runs for cloud in _clouds(prepared, final, run)),
        log=(*decision.log, *(known.completed.log if known.completed else ())),
        notes=(
            *_run_notes(prepared),
            *noise_notes(model, noise),
            *_warnings(found),
            *sensors_of_modes(found),
        ),
        classes=classes,
    )


def _record_next(prepared: Prepared, poor: bool, lag: LagDoubt | None) -> str | None:
    """What to record next where that does not depend on the causes that compete."""
    if poor:
        return better_recording(prepared)
    return lag.record_next if lag else None


def _run_notes(prepared: Prepared) -> tuple[str, ...]:
    """What was handled in the recordings, each said once."""
    said = [(*run.recording.notes, *blind_notes(run.motion)) for run in prepared.runs]
    said.append(held_notes(prepared.machine))
    return tuple(dict.fromkeys(note for notes in said for note in notes))


def _noise_beside(judged: Adequacy, decided: Array) -> Array:
    """The noise (m,) of the sensors, SI, that was ``decided`` (m,) with; where smoothing took what
    is faster than it for noise, what the innovations measured beside an adequate structure."""
    if not judged.adequate or judged.structure is None:
        return decided
    noise = judged.structure.fit.noise
    size = np.hypot(noise.white, noise.colour)
    return np.where((size > 0) & (NOISE_FACTOR * size < decided), size, decided)


def _measured_noise(model: Model, prepared: Prepared, decided: Array) -> dict[str, float]:
    """Noise of every sensor that recorded something, as measured, in its own unit; another one
    where it was ``decided`` (m,), SI, what it is."""
    noise = {}
    more = decided / prepared.sd
    for j, sensor in enumerate(model.sensors):
        spreads = [run.motion.sd[j] for run in prepared.runs if np.isfinite(run.motion.sd[j])]
        if spreads:
            size = float(np.sqrt(np.mean(np.square(spreads))) * more[j])
            noise[sensor.name] = size / sensor.unit.factor
    return noise


def _found(
    model: Model, prepared: Prepared, decision: Decision, known: Estimated, shown: Proof
) -> tuple[Found, ...]:
    """Every found effect with its element, share, activity, stability, probability and sentence."""
    provenance = (
        ("by", "sparse"),
        ("from", ", ".join(run.recording.name for run in prepared.runs)),
        ("nrmse", (float(f"{shown.before:.4g}"), float(f"{shown.after:.4g}"))),
    )
    final, items = known.final, known.items
    causes = decision.selected.causes
    firm = dict(zip(causes, stabilities(decision), strict=True))
    sure = dict(zip(causes, probabilities(decision), strict=True))
    found = []
    worths = worth_of(final, items, prepared.runs)
    rows = zip(items, element_names(model, items), shown.shares, worths, strict=True)
    for item, name, share, worth in rows:
        active = _active(prepared, final, item)
        one = found_of(model, item, name, provenance, share, active)
        mine = [final.causes[i] for i in item.causes]
        one = with_groups(model, final, item, with_own(model, final, item, one))
        stable, chance = weakest(firm, mine), weakest(sure, mine)
        found.append(replace(one, stability=stable, probability=chance, worth=worth))
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
    known: Estimated, judged: Adequacy, found: bool, faults: bool, parameters: bool
) -> VerdictName:
    if found:
        return "missing physics"
    if faults:
        return "measurement"
    if parameters:
        return "parameters"
    # something earned its place, and all of it is in doubt; or a force acts that none explains
    acts = not (judged.adequate or judged.unjudged)
    return "undecided" if known.final.causes or acts else "nothing missing"


def _classes(model: Model, judged: Adequacy) -> tuple[ClassFound, ...]:
    """The generic classes that act; an unmeasured force where something acts and none of them."""
    found = tuple(map(class_found, judged.classes))
    if found or not judged.beyond.acts:
        return found
    i = int(np.argmax(judged.beyond.share))
    place = On(model.coordinates[i].name)
    unit = force_unit(model, place)
    amount = quantity_text(float(judged.beyond.force[i]) / unit.factor, unit.text, digits=2)
    said = f"An unmeasured force of {amount} RMS acts {place_text(place)}."
    return (ClassFound("unmeasured force", judged.beyond.probability, said, place=place),)


def _rest(model: Model, judged: Adequacy, beyond: str) -> str:
    """What acts that was not named, in words; empty if nothing does. How large an unmeasured force
    is, ``beyond`` what, stands in the last sentence."""
    said = classes_said([one for one in judged.classes if one.generic.kind != "unmeasured force"])
    if judged.unjudged:
        said.append(f"Whether anything acts beyond it could not be judged: {judged.unjudged}.")
    if judged.beyond.acts:
        how = f"Beyond what {beyond} acts a force" if beyond else "A force acts"
        said.append(f"{how} that no cause explains: {_amounts(model, judged.beyond)}.")
    return " ".join(said)


def _amounts(model: Model, beyond: Beyond) -> str:
    """The unknown force at every coordinate where it acts."""
    parts = []
    for i, coordinate in enumerate(model.coordinates):
        if beyond.share[i] > NEGLIGIBLE:
            unit = force_unit(model, On(coordinate.name))
            amount = quantity_text(float(beyond.force[i]) / unit.factor, unit.text, digits=2)
            share = float(beyond.share[i])  # an inertia that the model lacks takes it beyond 1
            part = f"{percent_text(share)} of" if share < 1 else "more than"
            parts.append(f"{amount} RMS on {coordinate.name} ({part} what moves it)")
    return joined(parts)


def _clouds(prepared: Prepared, final: Refined, run: Run) -> list[Cloud]:
    """ΔF of every coordinate along a run, with the force of what was found there."""
    machine, motion = prepared.machine, run.motion
    course = course_of(run.recording, machine, motion)
    force = discrepancy(machine, course, machine.values)
    band = force_band(machine, motion, course)
    forces = element_forces(final, run.recording, run.motion)[0]
    own = len(prepared.model.elements)
    law = forces[:, :, own:].sum(axis=2)
    spread = law_spread(final, run, own, law)
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
            None if spread is None else spread[:, i],
        )
        for i, c in enumerate(prepared.model.coordinates)
    ]
