"""Numbers, units and effects in words: the sentences that a diagnosis is made of.

Everything here is plain text (a blank before a unit, ``±`` between value and one standard
deviation, a true minus sign), so that the same sentence serves the terminal, JSON and the report.
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
from symhyb.model.types import Between, On, Place, place_text
from symhyb.model.vocabulary import KINDS

UNKNOWN = "not known"
_MINUS = "\N{MINUS SIGN}"
_SUPERSCRIPTS = str.maketrans("0123456789-", "⁰¹²³⁴⁵⁶⁷⁸⁹⁻")
_EXACT = 1e-6  # a standard deviation below this part of the value says nothing to a reader
_RIVALS_NAMED = 3

_RESISTING = {  # kind: (key of its main number, words where it is a torque)
    "friction": ("coulomb", "dry (Coulomb) friction torque"),
    "damper": ("damping", "viscous damping"),
    "drag": ("drag", "drag torque quadratic in speed"),
}
_STIFFNESS = {  # key: (noun, meaning of a positive value, of a negative value)
    "stiffness": ("linear stiffness", "", "pushes away from rest"),
    "quadratic": (
        "quadratic stiffness",
        "harder at positive stretch",
        "softer at positive stretch",
    ),
    "cubic": ("cubic stiffness", "hardening", "softening"),
}
_SECONDARY = {
    "static": "breakaway friction",
    "stribeck": "Stribeck speed",
    "transition": "transition speed",
    "length": "slack length",
}


def number_text(value: float | None, sd: float | None = None, digits: int = 4) -> str:
    """Write ``value ± sd`` with the digits that ``sd`` supports, else with ``digits`` digits.

    ``sd`` is shown with two digits if the first is 1, else with one, and the value ends at the same
    place: ``20.3 ± 0.2``, ``203.5 ± 1.3``. Below 1e-3 and from 1e6 on a power of ten stands apart.
    """
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if sd is None or not math.isfinite(sd) or sd <= _EXACT * abs(value):
        return _plain(value, digits)
    shift = _shift(max(abs(value), sd))
    value, sd = value / 10.0**shift, sd / 10.0**shift
    mantissa, exponent = f"{sd:.1e}".split("e")
    places = (1 if mantissa.startswith("1") else 0) - int(exponent)
    both = f"{_fixed(value, places)} ± {_fixed(sd, places)}"
    return f"({both})·{power_text(shift)}" if shift else both


def unit_text(unit: str) -> str:
    """Write a unit as in print: ``N*s^2/m^2`` becomes ``N·s²/m²``, ``1`` nothing."""
    if unit == "1":
        return ""
    raised = re.sub(r"\^(-?\d+)(?![\d.])", lambda found: _superscript(int(found[1])), unit)
    return raised.replace("*", "·")


def quantity_text(value: float | None, unit: str, sd: float | None = None, digits: int = 4) -> str:
    """Write a number with its unit: ``20.3 ± 0.2 N``, ``(1.23 ± 0.02)·10⁻⁵ m``."""
    number = number_text(value, sd, digits)
    return number if number == UNKNOWN else f"{number} {unit_text(unit)}".rstrip()


def power_text(exponent: int) -> str:
    """Write a power of ten: ``10⁻⁵``."""
    return f"10{_superscript(exponent)}"


def percent_text(share: float | None) -> str:
    """Write a share in percent with two digits; what is not all or nothing never reads so."""
    if share is None or not math.isfinite(share):
        return UNKNOWN
    if 0.995 <= share < 1.0:
        return "more than 99.9 %" if share > 0.999 else f"{math.floor(1000.0 * share) / 10.0:.1f} %"
    if 0.0 < abs(share) < 1e-4:
        return "less than 0.01 %"
    return f"{_plain(100.0 * share, 3 if abs(share) >= 1.0 else 2)} %"


def joined(parts: Sequence[str], last: str = "and") -> str:
    """Join parts as a sentence does: ``A``, ``A and B``, ``A, B and C``."""
    if len(parts) < 2:
        return "".join(parts)
    return f"{', '.join(parts[:-1])} {last} {parts[-1]}"


def effect_phrase(kind: str, estimates: Sequence[Estimate]) -> str:
    """Name an effect with its main numbers: ``dry (Coulomb) friction of 20.4 ± 0.1 N``."""
    terms = {estimate.term: estimate for estimate in estimates}
    if kind in _RESISTING:
        key, torque = _RESISTING[kind]
        noun = torque if _turns(estimates) else KINDS[kind].words
        if key not in terms:
            return noun
        amount = _amount(terms[key])
        return f"{noun} ({amount})" if kind == "drag" else f"{noun} of {amount}"
    if kind == "spring" and (present := [key for key in _STIFFNESS if key in terms]):
        return joined([_stiffness(terms[key]) for key in present])
    if kind == "constant" and "constant" in terms:
        noun = "torque" if _turns(estimates) else "force"
        return f"a constant {noun} of {_amount(terms['constant'])}"
    listed = joined([f"{_term(estimate)} {_amount(estimate)}" for estimate in estimates])
    noun = KINDS[kind].words if kind in KINDS else f"an element of kind {kind.replace('_', ' ')}"
    return f"{noun} with {listed}" if listed else noun


def effect_sentence(
    kind: str, place: Place, estimates: Sequence[Estimate], share: float | None = None
) -> str:
    """Say one found effect: where, what, how large, what it does and what leaving it out costs."""
    said = f"{_capital(place_text(place))}, {effect_phrase(kind, estimates)} "
    said += _action(kind, place, estimates) + _secondary(kind, estimates)
    if share is None or not math.isfinite(share):
        return f"{said}."
    return f"{said}; without it {_cost(share)}."


def parameter_phrase(parameter: Reestimated) -> str:
    """Say a re-estimated parameter: ``k = 1010 ± 5 N/m (the model said 980 N/m)``."""
    value = quantity_text(parameter.value, parameter.unit, parameter.sd)
    return f"{parameter.name} = {value} (the model said {_given(parameter.was, parameter.unit)})"


def measurement_phrase(fault: Measurement) -> str:
    """Say a fault of a channel: ``laser has a delay of 0.0020 ± 0.0001 s``."""
    return f"{fault.channel} has {_fault(fault.kind, fault.value, fault.unit, fault.sd)}"


def alternative_phrase(rival: Alternative) -> str:
    """Say a rival explanation: an effect at its place, a channel's fault or a parameter."""
    if rival.place is not None:
        return f"{effect_phrase(rival.kind, rival.estimates)} {place_text(rival.place)}"
    listed = joined([_amount(estimate) for estimate in rival.estimates])
    if rival.channel is not None:
        article = "an" if rival.kind[:1] in "aeiou" else "a"
        named = f"{article} {rival.kind} of {listed}" if listed else f"{article} {rival.kind}"
        return f"{named} in channel {rival.channel}"
    return f"parameter {rival.parameter} = {listed}" if listed else f"parameter {rival.parameter}"


def verdict_sentence(
    verdict: VerdictName,
    found: Sequence[Found] = (),
    parameters: Sequence[Reestimated] = (),
    measurement: Sequence[Measurement] = (),
    alternatives: Sequence[Alternative] = (),
) -> str:
    """Say the verdict with what it rests on; what else was found follows in a second sentence."""
    channels = joined([measurement_phrase(fault) for fault in measurement])
    values = joined([parameter_phrase(parameter) for parameter in parameters])
    match verdict:
        case "missing physics":
            said, besides = f"{_lacking(found)}.", [channels, values]
        case "measurement":
            said = f"The physics of the model holds, the measurement does not: {channels}."
            besides = [values]
        case "parameters":
            said, besides = f"The model lacks no physics, but its numbers are off: {values}.", []
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
    rivals = [alternative_phrase(rival) for rival in alternatives[:_RIVALS_NAMED]]
    return (
        "Model and recordings differ by more than the noise, but these recordings "
        f"cannot tell the causes apart: {joined(rivals, 'or')}."
    )


def _lacking(found: Sequence[Found]) -> str:
    """Effects grouped by place, each place said once."""
    places: dict[Place, list[str]] = {}
    for effect in found:
        phrase = effect_phrase(effect.element.kind, effect.estimates)
        places.setdefault(effect.element.place, []).append(phrase)
    (first, lacking), *others = places.items()
    said = f"{_capital(place_text(first))} the model lacks {joined(lacking)}"
    return said + "".join(
        f"; {place_text(place)} it lacks {joined(lacking)}" for place, lacking in others
    )


def _action(kind: str, place: Place, estimates: Sequence[Estimate]) -> str:
    value = {estimate.term: estimate.value for estimate in estimates}
    if kind in _RESISTING:
        motion = "rotation" if _turns(estimates) else "motion"
        motion = f"relative {motion}" if isinstance(place, Between) else motion
        drives = value.get(_RESISTING[kind][0], 0.0) < 0.0
        return f"drives the {motion} instead of resisting it" if drives else f"resists the {motion}"
    if kind == "constant" and isinstance(place, Between):
        ends = "apart" if value.get("constant", 0.0) < 0.0 else "together"
        return f"acts, {'pushing' if ends == 'apart' else 'pulling'} the two points {ends}"
    if kind == "constant" and isinstance(place, On):
        sign = "negative" if value.get("constant", 0.0) < 0.0 else "positive"
        return f"acts towards {sign} {place.coordinate}"
    several = kind == "spring" and sum(key in value for key in _STIFFNESS) > 1
    return "act" if several else "acts"


def _secondary(kind: str, estimates: Sequence[Estimate]) -> str:
    """The numbers that the phrase of the effect leaves out, for kinds that have a phrase."""
    main = {_RESISTING[kind][0]} if kind in _RESISTING else set()
    main = set(_STIFFNESS) if kind == "spring" else {"constant"} if kind == "constant" else main
    rest = [estimate for estimate in estimates if main and estimate.term not in main]
    listed = joined([f"{_term(estimate)} {_amount(estimate)}" for estimate in rest])
    return f", with {listed}" if listed else ""


def _cost(share: float) -> str:
    if share <= 0.0:
        return "the squared error on unseen data does not grow"
    if share <= 1.0:
        return f"{percent_text(share)} of the squared error on unseen data comes back"
    grown = number_text(share, digits=2)
    return f"the squared error on unseen data grows by {grown} times what it was uncorrected"


def _stiffness(estimate: Estimate) -> str:
    noun, hard, soft = _STIFFNESS[estimate.term]
    meaning = hard if estimate.value >= 0.0 else soft
    return f"{noun} of {_amount(estimate)}" + (f" ({meaning})" if meaning else "")


def _fault(kind: str, value: float, unit: str, sd: float) -> str:
    article = "an" if kind == "offset" else "a"
    return f"{article} {kind} of {quantity_text(value, unit, sd)}"


def _given(value: float, unit: str) -> str:
    """A number that a person wrote, with all its digits."""
    return quantity_text(value, unit, digits=8)


def _amount(estimate: Estimate) -> str:
    return quantity_text(estimate.value, estimate.unit, estimate.sd)


def _term(estimate: Estimate) -> str:
    return _SECONDARY.get(estimate.term, estimate.term.replace("_", " "))


def _turns(estimates: Sequence[Estimate]) -> bool:
    """Whether the numbers belong to an angle: torques carry N*m, rates and stretches rad."""
    return any(re.search(r"N\*m|rad|deg", estimate.unit) for estimate in estimates)


def _shift(size: float) -> int:
    """The power of ten to take out of numbers of this size, 0 where they read well as they are."""
    return 0 if size == 0.0 or 1e-3 <= size < 1e6 else math.floor(math.log10(size))


def _plain(value: float, digits: int) -> str:
    shift = _shift(abs(value))
    rounded = float(f"{value / 10.0**shift:.{digits - 1}e}")
    places = max(0, digits - 1 - (math.floor(math.log10(abs(rounded))) if rounded else 0))
    text = _fixed(rounded, places)
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return f"{text}·{power_text(shift)}" if shift else text


def _fixed(value: float, places: int) -> str:
    text = f"{round(value, places):.{max(places, 0)}f}"
    return text.replace("-", _MINUS) if text.strip("-0.") else text.lstrip("-")


def _capital(words: str) -> str:
    return words[:1].upper() + words[1:]


def _superscript(exponent: int) -> str:
    return str(exponent).translate(_SUPERSCRIPTS)
