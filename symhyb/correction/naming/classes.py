"""Generic classes of effects in words."""

from collections.abc import Sequence
from math import isfinite

from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.discrepancy.results import ClassFound
from symhyb.discrepancy.words.amounts import percent_text, quantity_text
from symhyb.discrepancy.words.wording import joined
from symhyb.model.types import Place, place_text

_DOES = {
    "drifts": "it drifts",
    "bends": "it is not linear",
    "fades": "its gain changes with time",
    "lags": "it lags",
    "jumps": "it jumps or freezes at times",
    "": "it deviates",
}

_BEHIND = {
    "rate_limit": "acts with a rate that is limited: it does not follow fast changes",
    "backlash": "acts behind a play (backlash): it rests after each turn",
    "quantum": "acts in steps of one size (quantisation)",
}


_NONE_OF_THEM = (
    "But what it leaves of the sensors is no noise, for it follows from its own past: it may be "
    "none of them."
)


def class_found(one: Likely) -> ClassFound:
    """A class as a result, with its sentence."""
    generic, where = one.generic, one.generic.where
    if one.white:
        part = "" if one.whole else ", which explains the better part of it"
        tail = f" (probability {percent_text(one.probability)}){part}."
    else:  # the best of what was tried, and no probability of that is one of the truth
        tail = f", of all classes that were tried. {_NONE_OF_THEM}"
    name = where if isinstance(where, str) else None
    number = generic.kind == "time-varying"
    return ClassFound(
        generic.kind,
        one.probability,
        _said(generic) + tail,
        figure=generic.figure if isfinite(generic.figure) else None,
        place=None if isinstance(where, str) else where,
        channel=None if number else name,
        parameter=name if number else None,
        leaves_noise=one.white,
    )


def classes_said(found: Sequence[Likely]) -> list[str]:
    """A sentence on each class, and one on all inputs whose records look noisy."""
    noisy = [one for one in found if one.generic.does == "noisy"]
    if len(noisy) < 2:
        return [class_found(one).sentence for one in found]
    names = joined([str(one.generic.where) for one in noisy])
    chance = percent_text(min(one.probability for one in noisy))
    said = f"The records of the inputs {names} look noisy: other forces act (probability {chance})."
    return [said, *(class_found(one).sentence for one in found if one not in noisy)]


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
        case "coupling" if generic.other:
            return (
                f"What acts {at} follows the motion of {generic.other}, or the reverse, by a "
                "coupling that the model lacks"
            )
        case "coupling":
            return f"The input {at} acts where the model says that it does not"
        case "input" if generic.does == "fades":
            return f"The input {at} acts by a factor that changes with time"
        case "input" if generic.does == "noisy":
            return f"The record of the input {at} looks noisy: another force acts"
        case "input" if generic.does == "holds":
            hold = quantity_text(figure, "s", digits=2)
            if generic.other:
                both = f"{at} and {generic.other}"
                return f"The inputs {both} act as staircases, each value held for {hold}"
            return f"The input {at} acts as a staircase, each value held for {hold}"
        case "input" if generic.does in _BEHIND:
            return f"The input {at} {_BEHIND[generic.does]}"
        case "input":
            return f"The input {at} does not act in proportion to what was recorded of it"
        case "lag" if generic.sensors:
            amount = f", of the order of {quantity_text(figure, 's', digits=2)}"
            order = amount if isfinite(figure) else ""
            return (
                f"Something lags on the way from the input {at} to {joined(generic.sensors)}{order}"
            )
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
