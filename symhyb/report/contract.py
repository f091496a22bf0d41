"""The output contract: a diagnosis and its verdict as the mapping that ``diagnosis.json`` holds.

Valid under ``diagnosis.schema.json`` beside this file. Keys of that schema are stable; ``format``,
``options``, ``channels``, ``classes``, ``log``, ``memory``, ``notes``, ``stability``,
``probability``, ``own``, ``misfits``, ``repeats``, ``isolability``, ``manoeuvre``,
``remainder.notes`` and the scores ``*_rmse``, ``force_residual``, ``force_band_hz`` and ``carries``
are extensions of it.
"""

import math
import sys
from collections.abc import Iterable, Mapping
from typing import Any

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
from symhyb.model.types import At, Between, On, Place

FORMAT = 1
UNBOUNDED = sys.float_info.max
"""Stands for a standard deviation or an evidence that is infinite: JSON has no infinity."""

_SCORES = (
    "force_nrmse",
    "window_nrmse",
    "free_run_nrmse",
    "force_residual",
    "window_rmse",
    "free_run_rmse",
)


def to_json(diagnosis: Diagnosis, verdict: Verdict) -> dict[str, Any]:
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
        "parameters": [
            {
                "name": parameter.name,
                "was": _fitted(parameter.was, parameter.name),
                "value": _fitted(parameter.value, parameter.name),
                "sd": _bounded(parameter.sd),
                "unit": parameter.unit,
                **_own(parameter),
            }
            for parameter in diagnosis.parameters
        ],
        "measurement": [
            {
                "channel": fault.channel,
                "kind": fault.kind,
                "value": _fitted(fault.value, f"{fault.kind} of {fault.channel}"),
                "sd": _bounded(fault.sd),
                "unit": fault.unit,
            }
            for fault in diagnosis.measurement
        ],
        "channels": [_recording_fault(fault) for fault in diagnosis.faults],
        "alternatives": [_alternative(rival) for rival in diagnosis.alternatives],
        "record_next": diagnosis.record_next,
        "manoeuvre": _manoeuvre(diagnosis.manoeuvre),
        "isolability": _isolability(diagnosis.isolability),
        "remainder": {
            "share": finite(diagnosis.remainder),
            "notes": list(diagnosis.remainder_notes),
        },
        "scores": scores_json(verdict),
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
        "log": list(diagnosis.log),
        "notes": list(diagnosis.notes),
    }


def exit_status(diagnosis: Diagnosis) -> int:
    """Give the exit status of a diagnosis: 0 if nothing is missing, 1 for any other verdict."""
    return 0 if diagnosis.verdict == "nothing missing" else 1


def finite(value: float | None) -> float | None:
    """Give the number if it is one, else None: what could not be computed is never a number."""
    return None if value is None or not math.isfinite(value) else float(value)


def _found(effect: Found) -> dict[str, Any]:
    element = effect.element
    return {
        "name": element.name,
        "kind": element.kind,
        "place": _place(element.place),
        **_options(element.options),
        "law": effect.law,
        "parameters": _estimates(effect.estimates),
        "share": finite(effect.share),
        "sentence": effect.sentence,
        **_active(effect.active),
        "stability": finite(effect.stability),
        "probability": finite(effect.probability),
        **({"own": {name: _estimates(own) for name, own in effect.own}} if effect.own else {}),
    }


def _own(parameter: Reestimated) -> dict[str, Any]:
    """The key ``own`` with the values of every recording, or nothing."""
    rows = {name: {"value": value, "sd": _bounded(sd)} for name, value, sd in parameter.own}
    return {"own": rows} if rows else {}


def _misfit(one: Misfit) -> dict[str, Any]:
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


def _recording_fault(fault: RecordingFault) -> dict[str, Any]:
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


def _alternative(rival: Alternative) -> dict[str, Any]:
    where: dict[str, Any] = {
        "place": None if rival.place is None else _place(rival.place),
        "channel": rival.channel,
        "parameter": rival.parameter,
    }
    return {
        "instead_of": rival.instead_of,
        "kind": rival.kind,
        **{key: value for key, value in where.items() if value is not None},
        **_options(rival.options),
        **({"together": rival.together} if rival.together else {}),
        "parameters": _estimates(rival.estimates),
        "evidence": _bounded(rival.evidence),
    }


def _manoeuvre(plan: Manoeuvre | None) -> dict[str, Any] | None:
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


def _isolability(matrix: Isolability | None) -> dict[str, Any] | None:
    if matrix is None:
        return None
    return {
        "causes": list(matrix.causes),
        "found": list(matrix.found),
        "evidence": [[finite(value) for value in row] for row in matrix.evidence.tolist()],
    }


def _place_share(share: PlaceShare) -> dict[str, Any]:
    return {
        "place": _place(share.place),
        "explained": finite(share.explained),
        **_active(share.active),
        **_occurrence(share.occurrence),
    }


def _occurrence(reported: Occurrence | None) -> dict[str, Any]:
    """The keys that say when and how a mismatch acts, as far as they are known."""
    if reported is None:
        return {}
    change = None
    if reported.change is not None:
        change = {
            "recording": reported.change.recording,
            "kind": reported.change.kind,
            "time_s": float(reported.change.time_s),
            "width_s": float(reported.change.width_s),
        }
    return {
        "change": change,
        "band_hz": None if reported.band_hz is None else [float(f) for f in reported.band_hz],
        "beyond": finite(reported.beyond),
        "sentence": reported.sentence,
    }


def _class(one: ClassFound) -> dict[str, Any]:
    """A generic class with its probability and where it acts: exactly one of place, channel and
    parameter."""
    where: dict[str, Any] = {"channel": one.channel, "parameter": one.parameter}
    where = {key: name for key, name in where.items() if name is not None}
    if one.place is not None:
        where = {"place": _place(one.place)}
    return {
        "kind": one.kind,
        **where,
        "probability": float(one.probability),
        "figure": finite(one.figure),
        "sentence": one.sentence,
    }


def _memory(memory: Memory | None) -> dict[str, Any] | None:
    if memory is None:
        return None
    return {
        "state": finite(memory.state),
        "past": finite(memory.past),
        "sentence": memory.sentence,
    }


def scores_json(verdict: Verdict) -> dict[str, Any]:
    """Give the scores of a verdict; ``window_s`` is null where none is over windows."""
    return {
        "window_s": finite(verdict.window_s),
        "initial_states": verdict.initial_states,
        "force_band_hz": finite(verdict.force_band_hz),
        "carries": verdict.carries,
        "train": _comparison(verdict.train),
        "holdout": None if verdict.holdout is None else _comparison(verdict.holdout),
    }


def _comparison(comparison: Comparison) -> dict[str, Any]:
    return {"before": _score(comparison.before), "after": _score(comparison.after)}


def _score(score: Score) -> dict[str, dict[str, float | None]]:
    return {name: _channels(getattr(score, name)) for name in _SCORES}


def _channels(values: Mapping[str, float | None]) -> dict[str, float | None]:
    return {name: finite(value) for name, value in values.items()}


def _estimates(estimates: Iterable[Estimate]) -> dict[str, dict[str, Any]]:
    return {
        estimate.name: {
            "value": _fitted(estimate.value, estimate.name),
            "sd": _bounded(estimate.sd),
            "unit": estimate.unit,
            "term": estimate.term,
        }
        for estimate in estimates
    }


def _place(place: Place) -> dict[str, Any]:
    match place:
        case On(coordinate):
            return {"on": coordinate}
        case Between(first, second):
            return {"between": [first, second]}
        case At(point):
            return {"at": point}


def _options(options: Iterable[tuple[str, str]]) -> dict[str, Any]:
    """The key ``options`` with the words of an element (the side of a gap), or nothing."""
    words = dict(options)
    return {"options": words} if words else {}


def _active(active: Activity | None) -> dict[str, Any]:
    """The key ``active`` with the ranges that are known, or nothing."""
    if active is None:
        return {}
    ranges = {"stretch": active.stretch, "rate": active.rate}
    known: dict[str, Any] = {
        name: [float(bound) for bound in bounds]
        for name, bounds in ranges.items()
        if all(map(math.isfinite, bounds))
    }
    return {"active": {**known, "time": [[float(start), float(end)] for start, end in active.time]}}


def _bounded(value: float) -> float:
    """A number that must be one: what is not finite is larger than anything."""
    return float(value) if math.isfinite(value) else UNBOUNDED


def _fitted(value: float, name: str) -> float:
    if not math.isfinite(value):
        raise NumericsError(f"{name} came out as {value}, so that there is nothing to report")
    return float(value)
