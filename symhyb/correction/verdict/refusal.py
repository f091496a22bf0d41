"""What a diagnosis must not claim: physics where a recording is at fault, laws that let the model
run away, anything from a recording shorter than its own motion.

Each function takes a diagnosis and returns it with the claim withdrawn or the fault reported first.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.advice.advice import other_speeds
from symhyb.correction.search.score import part_left
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.verdict.proof import Proof
from symhyb.discrepancy.checks.suspicion import gain_of
from symhyb.discrepancy.places.meeting import meeting
from symhyb.discrepancy.recorded.ends import margin_of
from symhyb.discrepancy.recorded.passages import one_way, passed_at_one_speed
from symhyb.discrepancy.recorded.runs import Run, cut_into_windows
from symhyb.discrepancy.results import Alternative, Diagnosis, Found, Measurement, RecordingFault
from symhyb.discrepancy.words.effects import words_of
from symhyb.discrepancy.words.wording import (
    capital,
    effect_phrase,
    joined,
    measurement_phrases,
    number_text,
    parameter_phrase,
    percent_text,
)
from symhyb.judgement import NOTABLE, RUNAWAY, SMALL, UNEXPLAINED
from symhyb.model.types import Model, place_text
from symhyb.model.vocabulary import said_of
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.windows import WindowModel

REPAIRED_LEFT = (
    " Put right, recordings and model still differ by more than the noise, and no cause that "
    "symhyb knows accounts for the rest."
)


def with_faults(
    diagnosis: Diagnosis, model: Model, faults: Sequence[RecordingFault], scale: float
) -> Diagnosis:
    """The diagnosis of repaired recordings with the faults that were claimed said first.

    ``scale`` is χ² per sample of what was decided. A suspicion that was not claimed withdraws
    physics that leaves more than noise.
    """
    claimed = [fault for fault in faults if fault.claimed]
    suspected = [fault.sentence for fault in faults if not fault.claimed]
    known = {(fault.channel, fault.kind) for fault in diagnosis.measurement}
    gains = [
        Measurement(name, "gain", gain_of(model, fault, name), 0.0, "1")
        for fault in claimed
        if fault.kind in ("unit", "sign")
        for name in fault.channels
        if (name, "gain") not in known
    ]
    equals = [
        Alternative(None, "gain", (), 0.0, channel=name)
        for fault in claimed
        for rival in fault.rivals
        if rival.kind in ("unit", "sign")
        for name in rival.channels
    ]
    answer = replace(
        diagnosis,
        faults=tuple(faults),
        measurement=(*gains, *diagnosis.measurement),
        alternatives=(*equals, *diagnosis.alternatives),
        notes=(*suspected, *diagnosis.notes),
    )
    if claimed:
        return _faults_first(answer, "; ".join(fault.sentence for fault in claimed))
    if suspected and diagnosis.found and scale > UNEXPLAINED:
        reason = f"A channel may lie: {suspected[0]}."
        return withdrawn(answer, f"{reason} Until that is settled no physics is named")
    if suspected and diagnosis.verdict == "undecided":
        return replace(answer, sentence=f"{diagnosis.sentence} {capital(suspected[0])}.")
    return answer


def _faults_first(diagnosis: Diagnosis, fault: str) -> Diagnosis:
    match diagnosis.verdict:
        case "nothing missing":
            sentence = f"The physics of the model holds, the measurement does not: {fault}."
        case "undecided":
            sentence = f"The measurement is wrong: {fault}.{REPAIRED_LEFT}"
        case _:
            sentence = f"The measurement is wrong: {fault}. Put right: {diagnosis.sentence}"
    verdict = diagnosis.verdict
    if verdict != "missing physics":
        verdict = "measurement"
    return replace(diagnosis, verdict=verdict, sentence=sentence)


def withdrawn(diagnosis: Diagnosis, reason: str, best: str = "what fits best") -> Diagnosis:
    """The diagnosis undecided for a reason; what was found stands among the alternatives."""
    found = [_as_alternative(item) for item in diagnosis.found]
    named = [
        f"{effect_phrase(item.element.kind, item.estimates, words_of(item.element))} "
        f"{place_text(item.element.place)}"
        for item in diagnosis.found
    ]
    named += map(parameter_phrase, diagnosis.parameters)
    named += measurement_phrases([fault for fault in diagnosis.measurement if fault.sd > 0])
    fitting = f" ({best}: {joined(named)})" if named else ""
    return replace(
        diagnosis,
        verdict="undecided",
        sentence=f"{reason}{fitting}.",
        found=(),
        parameters=(),
        measurement=tuple(m for m in diagnosis.measurement if m.sd == 0),
        alternatives=(*found, *diagnosis.alternatives),
        remainder=1.0,
    )


def _as_alternative(item: Found) -> Alternative:
    element = item.element
    return Alternative(
        None, element.kind, item.estimates, 0.0, place=element.place, options=said_of(element)
    )


def if_explained(diagnosis: Diagnosis, selected: Refined, nothing: Refined) -> Diagnosis:
    """The diagnosis, undecided where the best structure leaves a part of the mismatch that is more
    than noise: what it holds then may stand in for something else."""
    claims = diagnosis.found or diagnosis.parameters or diagnosis.measurement
    left = part_left(selected, nothing)
    if not claims or not left > SMALL or not selected.fit.scale > UNEXPLAINED:
        return diagnosis
    times = f"{number_text(float(np.sqrt(selected.fit.scale)), digits=2)} times the noise"
    return withdrawn(
        diagnosis,
        "Model and recordings differ by more than the noise, and no cause that symhyb knows "
        f"accounts for it: the best leaves {percent_text(left)} of the squared mismatch, "
        f"{times}, and may stand in for something else",
    )


def if_confirmed(diagnosis: Diagnosis, held: Proof, shown: Proof) -> Diagnosis:
    """The diagnosis, undecided where windows that were ``held`` out of the fit are foretold worse
    with what is claimed than without, or cannot be simulated with it at all.

    Where that holds of the unseen recordings (``shown``) it is only said: what is unseen proves
    and never chooses.
    """
    claims = diagnosis.found or diagnosis.parameters or diagnosis.measurement
    if not claims:
        return diagnosis
    if _worse(held):
        return withdrawn(
            diagnosis,
            "The best correction is refused, for it foretells less than the model as given: on "
            f"windows held out of the fit the window NRMSE {_rise(held)}",
        )
    if _worse(shown):
        said = (
            f"On unseen recordings the window NRMSE {_rise(shown)}: what was found does not hold "
            "there."
        )
        sentence = f"{diagnosis.sentence} {said}"
        return replace(diagnosis, sentence=sentence, notes=(said, *diagnosis.notes))
    return diagnosis


def _worse(shown: Proof) -> bool:
    """Whether windows are foretold worse than without; where they cannot be compared, no."""
    return bool(np.isfinite(shown.before) and not shown.after <= (1 + NOTABLE) * shown.before)


def _rise(shown: Proof) -> str:
    before, after = percent_text(shown.before), percent_text(shown.after)
    return f"rises from {before} to {after}" if np.isfinite(shown.after) else "is not finite"


def if_bounded(
    diagnosis: Diagnosis,
    final: Refined,
    nothing: Refined,
    runs: Sequence[Run],
    unseen: Sequence[Run] = (),
) -> Diagnosis:
    """The diagnosis, undecided where the corrected model runs away in a simulation of one of the
    ``runs`` and of the same inputs once more, and the model as given does not.

    Along an ``unseen`` recording that is only said: what is unseen proves and never chooses.
    """
    if not final.causes:
        return diagnosis
    for run in runs:
        when = _runs_away_alone(final, nothing, run)
        if when is None:
            continue
        reason = (
            f"The best correction is refused, for it makes the model unstable: simulated along "
            f"{run.recording.name} it leaves the measured range {RUNAWAY:g}-fold after "
            f"{when:.3g} s, which the machine does not"
        )
        return withdrawn(diagnosis, reason)
    for run in unseen if diagnosis.found else ():
        when = _runs_away_alone(final, nothing, run)
        if when is not None:
            said = (
                f"Simulated along {run.recording.name}, which it has not seen, the corrected model "
                f"leaves the measured range {RUNAWAY:g}-fold after {when:.3g} s: what was found "
                "holds within the motion that it was learned from."
            )
            sentence = f"{diagnosis.sentence} {said}"
            return replace(diagnosis, sentence=sentence, notes=(said, *diagnosis.notes))
    return diagnosis


def _runs_away_alone(final: Refined, nothing: Refined, run: Run) -> float | None:
    """The time in s after which the corrected machine runs away; None if it or the one before does
    not."""
    after, before = (replace(one.machine, values=one.of(run.recording)) for one in (final, nothing))
    when = runs_away(after, run)
    return None if when is None or runs_away(before, run) is not None else when


def runs_away(machine: Machine, run: Run) -> float | None:
    """The time in s after which a simulation of a recording, and of its inputs once more from where
    it ended, leaves the measured range a hundredfold; None if it stays."""
    ends = 2 * margin_of(run.motion)  # where smoothing may swing: room to begin behind it
    duration = run.recording.duration
    cuts = cut_into_windows(run, machine, max(duration * (1 - 1e-9) - ends, duration / 2))
    if cuts is None:
        return None
    cuts = cuts.suited(machine).first()
    y = cuts.block.y[0]
    seen = np.isfinite(y).any(axis=0)
    reach = np.nanmax(y[:, seen], axis=0) - np.nanmin(y[:, seen], axis=0)
    centre = np.nanmean(y[:, seen], axis=0)
    model, start, passed = WindowModel(machine), cuts.start, 0.0
    for _ in range(2):
        with np.errstate(all="ignore"):
            x, output = model.simulate(cuts.block, start, machine.values)
            far = ~(np.abs(output[0][:, seen] - centre) < RUNAWAY * reach + 1e-12).all(axis=1)
        if far.any():
            t = cuts.block.t[0]
            return passed + float(t[int(np.argmax(far))] - t[0])
        start, passed = x[:, -1], passed + run.recording.duration
    return None


def if_long_enough(diagnosis: Diagnosis, runs: Sequence[Run]) -> Diagnosis:
    """The diagnosis, undecided where no recording lasts one period of any motion in it; where
    nothing comes back there is no period, and passages at several speeds do as well."""
    claims = diagnosis.found or diagnosis.parameters or diagnosis.measurement
    if not claims or any(_whole_period(run) for run in runs):
        return diagnosis
    if not all(one_way(run.motion) for run in runs):
        longest = max(run.recording.duration for run in runs)
        return withdrawn(
            diagnosis,
            f"These recordings cannot tell: the longest lasts {longest:.3g} s, less than one "
            "period of its motion, and over so short a time one cause looks like another",
        )
    if not passed_at_one_speed(runs):
        return diagnosis
    reported = withdrawn(
        diagnosis,
        "These recordings cannot tell: nothing comes back in them, and every place is passed at "
        "one speed alone, so that forces of place, of speed and of time look alike",
    )
    return replace(reported, record_next=other_speeds(runs))


def if_apart(diagnosis: Diagnosis, model: Model, runs: Sequence[Run]) -> Diagnosis:
    """The diagnosis, undecided where two points that a force joins pass through each other."""
    met = None if diagnosis.verdict == "nothing missing" else meeting(model, runs)
    if met is None:
        return diagnosis
    first, second = met.place.first, met.place.second
    return withdrawn(
        diagnosis,
        f"{first} and {second} pass through each other in {met.recording} at {met.t:.3g} s, where "
        f"the force of {met.element} turns round: so the geometry of the model is not that of the "
        "machine (a length too short, an offset of a sensor, or points on one line that move side "
        "by side in truth), and until it is, no physics is named",
    )


def _whole_period(run: Run) -> bool:
    return bool(np.min(run.motion.periods()) < (1 - 1e-9) * run.recording.duration)
