"""The sentences that a diagnosis is made of: effects, parameters, channels, rivals, the verdict.

Everything here is plain text, so that the same sentence serves the terminal, JSON and the report.
"""

import math
import re
from collections.abc import Sequence

from symhyb.discrepancy.results import (
    Alternative,
    Estimate,
    Found,
    Measurement,
    Reestimated,
    VerdictName,
)
from symhyb.discrepancy.words.amounts import (
    UNKNOWN,
    capital,
    joined,
    number_text,
    percent_text,
    power_text,
    quantity_text,
    small_text,
    unit_text,
)
from symhyb.discrepancy.words.effects import (
    Options,
    action_of,
    amount_text,
    phrase_of,
    secondary_of,
    words_of,
)
from symhyb.discrepancy.words.formula import LAW, law_text
from symhyb.model.actuators import ACTUATOR_KEYS
from symhyb.model.types import Place, place_text

__all__ = [
    "UNKNOWN",
    "alternative_phrase",
    "capital",
    "effect_phrase",
    "effect_sentence",
    "joined",
    "measurement_phrase",
    "number_text",
    "parameter_phrase",
    "percent_text",
    "power_text",
    "quantity_text",
    "small_text",
    "unit_text",
    "verdict_sentence",
]

_RIVALS_NAMED = 3
_INVOLVED = (", ", " and ", " that ", " beyond ")  # a phrase with these is numbered in a list


def effect_phrase(kind: str, estimates: Sequence[Estimate], options: Options = ()) -> str:
    """Name an effect with its main numbers: ``dry (Coulomb) friction of 20.4 ± 0.1 N``.

    ``options`` are the words of its element: the side of a gap.
    """
    words = phrase_of(kind, estimates, options)
    return f"{words.head} {words.tail}".rstrip()


def effect_sentence(
    kind: str,
    place: Place,
    estimates: Sequence[Estimate],
    share: float | None = None,
    options: Options = (),
    meaning: str = "",
) -> str:
    """Say one found effect: where, what, how large, what it does and what leaving it out costs.

    ``meaning`` is what its value means in the terms of a textbook.
    """
    words = phrase_of(kind, estimates, options)
    action = action_of(words, kind, place, estimates)
    clause = f"{capital(place_text(place))}, {words.head} {action} {words.tail}".rstrip()
    clause += secondary_of(words, kind, estimates) + (f", {meaning}" if meaning else "")
    if share is None or not math.isfinite(share):
        return f"{clause}."
    return f"{clause}; without it {_cost(share)}."


def parameter_phrase(parameter: Reestimated) -> str:
    """Say a re-estimated parameter: ``k = 1010 ± 5 N/m (the model said 980 N/m)``."""
    value = quantity_text(parameter.value, parameter.unit, parameter.sd)
    return f"{parameter.name} = {value} (the model said {_given(parameter.was, parameter.unit)})"


def measurement_phrases(faults: Sequence[Measurement]) -> list[str]:
    """Say faults of channels, one that several share once: ``x and y arrive 12 ms late, all by one
    delay``."""
    said: list[str] = []
    for fault in faults:
        sharing = [one for one in faults if fault.together and one.together == fault.together]
        if len(sharing) < 2:
            said.append(measurement_phrase(fault))
        elif fault is sharing[0]:
            names = joined([one.channel for one in sharing])
            said.append(f"{names} arrive {_late(fault)}, all by one delay")
    return said


def measurement_phrase(fault: Measurement) -> str:
    """Say a fault of a channel: ``laser has an offset of 2.1 ± 0.3 mm``, ``f arrives 12 ms late``,
    and what an actuator does: ``f saturates at 2.1 ± 0.1 N``.

    Late is right of both: an input acts, a sensor shows, by its delay later than it should.
    """
    if fault.kind in ACTUATOR_KEYS:
        return f"{fault.channel} {_acts(fault)}"
    if fault.kind == "sensor_lag":
        time = small_text(fault.value, fault.unit, fault.sd)
        return f"{fault.channel} shows what it measures through a lag of {time}"
    if fault.kind == "held":
        hold = small_text(fault.value, fault.unit, digits=3)
        return f"{fault.channel} is held between its recorded values, for {hold} each"
    if fault.kind == "delay":
        return f"{fault.channel} arrives {_late(fault)}"
    article = "an" if fault.kind == "offset" else "a"
    amount = quantity_text(fault.value, fault.unit, fault.sd)
    return f"{fault.channel} has {article} {fault.kind} of {amount}"


def _late(fault: Measurement) -> str:
    """By how much a channel is late, or early."""
    late = "early" if fault.value < 0.0 else "late"
    return f"{small_text(abs(fault.value), fault.unit, fault.sd)} {late}"


def _acts(fault: Measurement) -> str:
    """What an actuator does, behind the name of its input."""
    amount = quantity_text(fault.value, fault.unit, fault.sd)
    match fault.kind:
        case "quantum":
            return f"acts in steps of {amount} (quantisation)"
        case "backlash":
            return f"acts behind a play (backlash) of {amount}"
        case "dead_band":
            return f"acts only beyond a dead band of {amount}"
        case "limit":
            return f"saturates at {amount}"
        case "rate_limit":
            return f"changes by no more than {amount} (rate limit)"
        case _:
            return f"acts through a lag of {small_text(fault.value, fault.unit, fault.sd)}"


def alternative_phrase(rival: Alternative, *others: Alternative) -> str:
    """Say a rival explanation: an effect at its place, a channel's fault or a parameter; with
    ``others`` that hold only together with it."""
    if others:
        return f"{joined([alternative_phrase(one) for one in (rival, *others)])} together"
    if rival.place is not None:
        named = effect_phrase(rival.kind, rival.estimates, rival.options)
        return f"{named} {place_text(rival.place)}"
    listed = joined([_channel_amount(estimate) for estimate in rival.estimates])
    if rival.channel is not None:
        article = "an" if rival.kind[:1] in "aeiou" else "a"
        kind = rival.kind.removeprefix("sensor_").replace("_", " ")
        named = f"{article} {kind} of {listed}" if listed else f"{article} {kind}"
        return f"{named} in channel {rival.channel}"
    return f"parameter {rival.parameter} = {listed}" if listed else f"parameter {rival.parameter}"


def verdict_sentence(
    verdict: VerdictName,
    found: Sequence[Found] = (),
    parameters: Sequence[Reestimated] = (),
    measurement: Sequence[Measurement] = (),
    alternatives: Sequence[Alternative] = (),
    beyond: bool = False,
) -> str:
    """Say the verdict with what it rests on; what else was found follows in a second sentence. That
    the physics holds is said only where nothing acts ``beyond`` what is named."""
    acts = measurement_phrases([one for one in measurement if one.kind in ACTUATOR_KEYS])
    wrong = measurement_phrases([one for one in measurement if one.kind not in ACTUATOR_KEYS])
    channels = joined(wrong)
    values = joined([parameter_phrase(parameter) for parameter in parameters])
    match verdict:
        case "missing physics":
            said, besides = f"{_missing(found, acts)}.", [channels, values]
        case "measurement":
            said = f"The physics of the model holds, the measurement does not: {channels}."
            if beyond:
                said = f"The measurement is wrong: {channels}."
            besides = [values]
        case "parameters":
            holds = "The model's" if beyond else "The model lacks no physics, but its"
            said, besides = f"{holds} numbers are off: {values}.", []
        case "nothing missing":
            said = "Nothing is missing: model and recordings differ by no more than the noise."
            besides = []
        case "undecided":
            said, besides = _undecided(alternatives), []
    further = joined([part for part in besides if part])
    return f"{said} Besides, {further}." if further else said


def _undecided(alternatives: Sequence[Alternative]) -> str:
    if not alternatives:
        return (
            "Model and recordings differ by more than the noise, "
            "but no cause that symhyb knows accounts for it."
        )
    groups = grouped_alternatives(alternatives)[:_RIVALS_NAMED]
    rivals = [alternative_phrase(*group) for group in groups]
    if len(rivals) == 1 and len(groups[0]) > 1:
        return (
            "Model and recordings differ by more than the noise, but what fits best "
            f"is in doubt: {rivals[0]}."
        )
    return (
        "Model and recordings differ by more than the noise, but these recordings "
        f"cannot tell the causes apart: {_listed(rivals, 'or')}."
    )


def grouped_alternatives(alternatives: Sequence[Alternative]) -> list[tuple[Alternative, ...]]:
    """Each alternative by itself, those that hold only together as one, in the same order."""
    groups: dict[object, tuple[Alternative, ...]] = {}
    for i, rival in enumerate(alternatives):
        key = rival.together or (i,)
        groups[key] = (*groups.get(key, ()), rival)
    return list(groups.values())


def _missing(found: Sequence[Found], acts: Sequence[str]) -> str:
    """What the model lacks: effects at their places, and what actuators do (``acts``)."""
    actuators = f"the model lacks what the actuator does: {joined(acts)}"
    if not found:
        return capital(actuators)
    return "; ".join([_lacking(found), *([actuators] if acts else [])])


def _lacking(found: Sequence[Found]) -> str:
    """Effects grouped by place, each place said once."""
    places: dict[Place, list[str]] = {}
    for effect in found:
        element = effect.element
        words = words_of(element)
        if element.kind == LAW:
            words = (("formula", effect.law.removeprefix(law_text("", "coefficient"))),)
        phrase = effect_phrase(element.kind, effect.estimates, words)
        places.setdefault(element.place, []).append(phrase)
    (first, lacking), *others = places.items()
    said = f"{capital(place_text(first))} the model lacks {_listed(lacking)}"
    return said + "".join(
        f"; {place_text(place)} it lacks {_listed(lacking)}" for place, lacking in others
    )


def _listed(phrases: Sequence[str], last: str = "and") -> str:
    """Join phrases; those that hold lists themselves get numbers, or nobody sees where one ends."""
    plain = [re.sub(r"\([^()]*\)", "", phrase) for phrase in phrases]  # a bracket is no list
    if len(phrases) > 1 and any(word in phrase for phrase in plain for word in _INVOLVED):
        phrases = [f"({i}) {phrase}" for i, phrase in enumerate(phrases, 1)]
    return joined(phrases, last)


def _cost(share: float) -> str:
    if share <= 0.0:
        return "the squared error on unseen data does not grow"
    if share <= 1.0:
        return f"{percent_text(share)} of the squared error on unseen data comes back"
    grown = number_text(share, digits=2)
    return f"the squared error on unseen data grows by {grown} times what it was uncorrected"


def _given(value: float, unit: str) -> str:
    """A number that a person wrote, with all its digits."""
    return quantity_text(value, unit, digits=8)


def _channel_amount(estimate: Estimate) -> str:
    if estimate.unit == "s":
        return small_text(estimate.value, estimate.unit, estimate.sd)
    return amount_text(estimate)
