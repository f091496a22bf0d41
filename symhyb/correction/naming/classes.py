"""Generic classes of effects in words."""

from math import isfinite

from symhyb.correction.adequacy.structure import Generic
from symhyb.discrepancy.results import ClassFound
from symhyb.discrepancy.words.amounts import percent_text, quantity_text
from symhyb.model.types import Place, place_text

_DOES = {
    "drifts": "it drifts",
    "bends": "it is not linear",
    "lags": "it lags",
    "": "it deviates",
}


def class_found(generic: Generic, probability: float) -> ClassFound:
    """A class as a result, with its sentence."""
    where = generic.where
    name = where if isinstance(where, str) else None
    number = generic.kind == "time-varying"
    return ClassFound(
        generic.kind,
        probability,
        f"{_said(generic)} (probability {percent_text(probability)}).",
        figure=generic.figure if isfinite(generic.figure) else None,
        place=None if isinstance(where, str) else where,
        channel=None if number else name,
        parameter=name if number else None,
    )


def _said(generic: Generic) -> str:
    where = generic.where
    at = where if isinstance(where, str) else _at(where)
    figure = generic.figure
    match generic.kind:
        case "law":
            return (
                f"What acts {at} looks like a force of stretch and rate that is none of the laws "
                "known by name"
            )
        case "hidden mode":
            frequency = quantity_text(figure, "Hz", digits=2)
            return f"What acts {at} looks like a hidden mode near {frequency}"
        case "input":
            return f"The input {at} does not act in proportion to what was recorded of it"
        case "lag":
            time = quantity_text(figure, "s", digits=2)
            return f"The input {at} acts through a lag, of the order of {time}"
        case "time-varying":
            return f"{at} changes with time"
        case "sensor":
            return f"The sensor {at} does not show what it should: {_DOES[generic.does]}"
        case _:
            return f"An unmeasured force acts {at}"


def _at(place: Place) -> str:
    return place_text(place)
