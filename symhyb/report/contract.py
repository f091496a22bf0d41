"""The output contract: a diagnosis and its verdict as the mapping that ``diagnosis.json`` holds.

What it holds is stated as types in :mod:`symhyb.report.document`; what is not required there was
added to the first contract.
"""

import math
import sys
from collections.abc import Iterable, Mapping
from typing import Literal

from symhyb.discrepancy.results import (
    Activity,
    Alternative,
    ClassFound,
    Comparison,
    Diagnosis,
    Estimate,
    Found,
    Isolability,
    Manoeuvre,
    Memory,
    Misfit,
    Occurrence,
    PlaceShare,
    RecordingFault,
    Reestimated,
    Score,
    Verdict,
)
from symhyb.errors import NumericsError
from symhyb.model.types import At, Between, On, Pair, Place
from symhyb.model.vocabulary import said_of
from symhyb.report.budget_entry import budget_entry
from symhyb.report.course_entries import course_entry
from symhyb.report.document import (
    ActivityEntry,
    AlternativeEntry,
    ClassEntry,
    ComparisonEntry,
    DiagnosisDocument,
    EstimateEntry,
    Estimates,
    FaultEntry,
    FoundEntry,
    IsolabilityEntry,
    LearnedScoresEntry,
    ManoeuvreEntry,
    MemoryEntry,
    MisfitEntry,
    Numbers,
    OccurrenceKeys,
    ParameterEntry,
    PlaceEntry,
    PlaceShareEntry,
    ScoreEntry,
    Somewhere,
    ValueEntry,
)
from symhyb.report.doubt_entries import correlations_entry, rival_entry, whiteness_entry

FORMAT: Literal[1] = 1
UNBOUNDED = sys.float_info.max
"""Stands for a standard deviation or an evidence that is infinite: JSON has no infinity."""


def to_json(diagnosis: Diagnosis, verdict: Verdict) -> DiagnosisDocument:
    """Give the diagnosis as plain mappings, lists, text and finite numbers.

    A number that could not be computed becomes null; where the contract demands a number, a
    standard deviation or evidence that is not finite becomes :data:`UNBOUNDED` and a noise level
    that is not known is left out.

    Raises:
        NumericsError: a fitted value is not finite, so that there is nothing to report.
    """
    return {
        "format": FORMAT,
        "verdict": diagnosis.verdict,
        "sentence": diagnosis.sentence,
        "found": [_found(effect) for effect in diagnosis.found],
        "parameters": [_parameter(parameter) for parameter in diagnosis.parameters],
        "measurement": [
            {
                "channel": fault.channel,
                "kind": fault.kind,
                "value": _fitted(fault.value, f"{fault.kind} of {fault.channel}"),
                "sd": _bounded(fault.sd),
                "unit": fault.unit,
                "together": fault.together,
            }
            for fault in diagnosis.measurement
        ],
        "channels": [_recording_fault(fault) for fault in diagnosis.faults],
        "alternatives": [_alternative(rival) for rival in diagnosis.alternatives],
        "record_next": diagnosis.record_next,
        "manoeuvre": _manoeuvre(diagnosis.manoeuvre),
        "isolability": _isolability(diagnosis.isolability),
        "rivals": [rival_entry(one) for one in diagnosis.rivals],
        "remainder": {
            "share": finite(diagnosis.remainder),
            "notes": list(diagnosis.remainder_notes),
        },
        "scores": {**scores_json(verdict), "window_s": _fitted(verdict.window_s, "window_s")},
        "noise": {sensor: float(sd) for sensor, sd in diagnosis.noise.items() if math.isfinite(sd)},
        "places": [_place_share(share) for share in diagnosis.places],
        "misfits": [_misfit(one) for one in diagnosis.misfits],
        "repeats": [
            {
                "recordings": list(group.recordings),
                "noise": _channels(group.noise),
                "between": _channels(group.between),
                "sentence": group.sentence,
            }
            for group in diagnosis.repeats
        ],
        "memory": _memory(diagnosis.memory),
        "classes": [_class(one) for one in diagnosis.classes],
        "courses": [course_entry(one) for one in diagnosis.courses],
        "correlations": correlations_entry(diagnosis.correlations),
        "whiteness": [whiteness_entry(one) for one in verdict.whiteness],
        "without": [
            {"element": one.element, "free_run_rmse": _channels(one.free_run_rmse)}
            for one in verdict.without
        ],
        "log": list(diagnosis.log),
        "notes": list(diagnosis.notes),
        "budget": budget_entry(diagnosis.budget),
    }


def exit_status(diagnosis: Diagnosis) -> int:
    """Give the exit status of a diagnosis: 0 if nothing is missing, 1 for any other verdict."""
    return 0 if diagnosis.verdict == "nothing missing" else 1


def finite(value: float | None) -> float | None:
    """Give the number if it is one, else None: what could not be computed is never a number."""
    return None if value is None or not math.isfinite(value) else float(value)


def _found(effect: Found) -> FoundEntry:
    element = effect.element
    entry: FoundEntry = {
        "name": element.name,
        "kind": element.kind,
        "place": _place(element.place),
        "law": effect.law,
        "parameters": _estimates(effect.estimates),
        "share": finite(effect.share),
        "sentence": effect.sentence,
        "stability": finite(effect.stability),
        "probability": finite(effect.probability),
        "worth": None
        if effect.worth is None
        else {"energy": finite(effect.worth.energy), "force": finite(effect.worth.force)},
    }
    if said := said_of(element):
        entry["options"] = dict(said)
    if effect.active is not None:
        entry["active"] = _active(effect.active)
    if effect.own:
        entry["own"] = {name: _estimates(own) for name, own in effect.own}
    if effect.groups:
        grouped: dict[str, dict[str, Estimates]] = {}
        for by, label, own in effect.groups:
            grouped.setdefault(by, {})[label] = _estimates(own)
        entry["groups"] = grouped
    return entry


def _parameter(parameter: Reestimated) -> ParameterEntry:
    entry: ParameterEntry = {
        "name": parameter.name,
        "was": _fitted(parameter.was, parameter.name),
        "value": _fitted(parameter.value, parameter.name),
        "sd": _bounded(parameter.sd),
        "unit": parameter.unit,
    }
    if parameter.own:
        entry["own"] = {
            name: {"value": value, "sd": _bounded(sd)} for name, value, sd in parameter.own
        }
    if parameter.groups:
        grouped: dict[str, dict[str, ValueEntry]] = {}
        for by, label, value, sd in parameter.groups:
            grouped.setdefault(by, {})[label] = {"value": value, "sd": _bounded(sd)}
        entry["groups"] = grouped
    return entry


def _misfit(one: Misfit) -> MisfitEntry:
    return {
        "recording": one.recording,
        "quantity": one.quantity,
        "value": _fitted(one.value, one.quantity),
        "sd": _bounded(one.sd),
        "others": _fitted(one.others, one.quantity),
        "others_sd": _bounded(one.others_sd),
        "unit": one.unit,
        "chance": _fitted(one.chance, "chance"),
        "sentence": one.sentence,
    }


def _recording_fault(fault: RecordingFault) -> FaultEntry:
    return {
        "kind": fault.kind,
        "channels": list(fault.channels),
        "factor": _fitted(fault.factor, f"{fault.kind} of {', '.join(fault.channels)}"),
        "unit": fault.word or None,
        "claimed": fault.claimed,
        "sentence": fault.sentence,
        "rivals": [
            {"kind": rival.kind, "channels": list(rival.channels)} for rival in fault.rivals
        ],
    }


def _alternative(rival: Alternative) -> AlternativeEntry:
    entry: AlternativeEntry = {
        "instead_of": rival.instead_of,
        "kind": rival.kind,
        "parameters": _estimates(rival.estimates),
        "evidence": _bounded(rival.evidence),
    }
    _put_where(entry, rival)
    if rival.options:
        entry["options"] = dict(rival.options)
    if rival.together:
        entry["together"] = rival.together
    return entry


def _put_where(entry: Somewhere, one: Alternative | ClassFound) -> None:
    if one.place is not None:
        entry["place"] = _place(one.place)
    if one.channel is not None:
        entry["channel"] = one.channel
    if one.parameter is not None:
        entry["parameter"] = one.parameter


def _manoeuvre(plan: Manoeuvre | None) -> ManoeuvreEntry | None:
    if plan is None:
        return None
    return {
        "channel": plan.channel,
        "signal": plan.signal,
        "amplitude": _fitted(plan.amplitude, "amplitude"),
        "unit": plan.unit,
        "offset": _fitted(plan.offset, "offset"),
        "frequency_hz": None if plan.frequency is None else list(plan.frequency),
        "duration_s": plan.duration,
        "sampling_s": plan.sampling,
        "between": list(plan.between),
        "evidence": _bounded(plan.evidence),
        "beyond": plan.beyond,
    }


def _isolability(matrix: Isolability | None) -> IsolabilityEntry | None:
    if matrix is None:
        return None
    return {
        "causes": list(matrix.causes),
        "found": list(matrix.found),
        "evidence": [[finite(value) for value in row] for row in matrix.evidence.tolist()],
    }


def _place_share(share: PlaceShare) -> PlaceShareEntry:
    entry: PlaceShareEntry = {
        "place": _place(share.place),
        "explained": finite(share.explained),
    }
    if share.active is not None:
        entry["active"] = _active(share.active)
    if share.occurrence is not None:
        _put_occurrence(entry, share.occurrence)
    return entry


def _put_occurrence(entry: OccurrenceKeys, known: Occurrence) -> None:
    """When and how a mismatch acts."""
    entry["change"] = None
    if known.change is not None:
        entry["change"] = {
            "recording": known.change.recording,
            "kind": known.change.kind,
            "time_s": float(known.change.time_s),
            "width_s": float(known.change.width_s),
        }
    entry["band_hz"] = None if known.band_hz is None else [float(f) for f in known.band_hz]
    entry["beyond"] = finite(known.beyond)
    entry["sentence"] = known.sentence


def _class(one: ClassFound) -> ClassEntry:
    """A generic class with its probability and where it acts: exactly one of place, channel and
    parameter."""
    entry: ClassEntry = {
        "kind": one.kind,
        "probability": float(one.probability),
        "figure": finite(one.figure),
        "leaves_noise": one.leaves_noise,
        "sentence": one.sentence,
    }
    _put_where(entry, one)
    return entry


def _memory(memory: Memory | None) -> MemoryEntry | None:
    if memory is None:
        return None
    return {
        "state": finite(memory.state),
        "past": finite(memory.past),
        "sentence": memory.sentence,
    }


def scores_json(verdict: Verdict) -> LearnedScoresEntry:
    """Give the scores of a verdict; ``window_s`` is null where none is over windows."""
    return {
        "window_s": finite(verdict.window_s),
        "initial_states": verdict.initial_states,
        "force_band_hz": finite(verdict.force_band_hz),
        "carries": verdict.carries,
        "train": _comparison(verdict.train),
        "holdout": None if verdict.holdout is None else _comparison(verdict.holdout),
    }


def _comparison(comparison: Comparison) -> ComparisonEntry:
    return {"before": _score(comparison.before), "after": _score(comparison.after)}


def _score(score: Score) -> ScoreEntry:
    return {
        "force_nrmse": _channels(score.force_nrmse),
        "window_nrmse": _channels(score.window_nrmse),
        "free_run_nrmse": _channels(score.free_run_nrmse),
        "force_residual": _channels(score.force_residual),
        "window_rmse": _channels(score.window_rmse),
        "free_run_rmse": _channels(score.free_run_rmse),
    }


def _channels(values: Mapping[str, float | None]) -> Numbers:
    return {name: finite(value) for name, value in values.items()}


def _estimates(estimates: Iterable[Estimate]) -> Estimates:
    return {estimate.name: _estimate(estimate) for estimate in estimates}


def _estimate(estimate: Estimate) -> EstimateEntry:
    entry: EstimateEntry = {
        "value": _fitted(estimate.value, estimate.name),
        "sd": _bounded(estimate.sd),
        "unit": estimate.unit,
        "term": estimate.term,
    }
    if estimate.at is not None:
        entry |= {"at": _fitted(estimate.at, estimate.name), "at_unit": estimate.at_unit}
    return entry


def _place(place: Place) -> PlaceEntry:
    match place:
        case On(coordinate):
            return {"on": coordinate}
        case Between(first, second):
            return {"between": [first, second]}
        case At(point):
            return {"at": point}
        case Pair(first, second):
            return {"pair": [first, second]}


def _active(active: Activity) -> ActivityEntry:
    """When a force acts, and the ranges that are known."""
    entry: ActivityEntry = {"time": [[float(start), float(end)] for start, end in active.time]}
    if all(map(math.isfinite, active.stretch)):
        entry["stretch"] = [float(bound) for bound in active.stretch]
    if all(map(math.isfinite, active.rate)):
        entry["rate"] = [float(bound) for bound in active.rate]
    return entry


def _bounded(value: float) -> float:
    """A number that must be one: what is not finite is larger than anything."""
    return float(value) if math.isfinite(value) else UNBOUNDED


def _fitted(value: float, name: str) -> float:
    if not math.isfinite(value):
        raise NumericsError(f"{name} came out as {value}, so that there is nothing to report")
    return float(value)
