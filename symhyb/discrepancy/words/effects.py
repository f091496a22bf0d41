"""Effects in words: each kind of law with its main numbers, and what an engineer reads off them.

A phrase names an effect (``dry (Coulomb) friction of 20.4 ± 0.2 N``); a sentence adds what it does.
The words of a law stand in the file of the law.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from symhyb.discrepancy.results import Estimate
from symhyb.discrepancy.words.amounts import (
    degrees_text,
    joined,
    number_text,
    quantity_text,
    small_text,
)
from symhyb.laws import LAWS
from symhyb.laws.gap import SIDES
from symhyb.laws.phrases import Phrase
from symhyb.model.expression import Operation
from symhyb.model.types import Between, Element, On, Place
from symhyb.model.vocabulary import KINDS, key_of, said_of
from symhyb.units import parse_unit

_DIGITS = 3  # of a quantity that follows from fitted ones
_SPOKEN = {
    (key.name, key.spoken[0]): key.spoken[1] for law in LAWS for key in law.keys if key.spoken[1]
}
Options = Sequence[tuple[str, str]]


@dataclass(frozen=True, slots=True)
class _Estimates:
    """The estimates of one effect by key, and whether they belong to an angle, as its law words
    them: see :class:`symhyb.laws.phrases.Numbers`."""

    by_term: Mapping[str, Estimate]
    turns: bool

    def __contains__(self, term: str) -> bool:
        return term in self.by_term

    def value(self, term: str, default: float = 0.0) -> float:
        return self.by_term[term].value if term in self.by_term else default

    def sd(self, term: str) -> float:
        return self.by_term[term].sd

    def unit(self, term: str) -> str:
        return self.by_term[term].unit

    def symbol(self, term: str) -> str:
        return self.by_term[term].name

    def amount(self, term: str) -> str:
        return amount_text(self.by_term[term])

    def small(self, term: str) -> str:
        one = self.by_term[term]
        return small_text(one.value, one.unit, one.sd)

    def derived(self, value: float, unit: str) -> str:
        return quantity_text(value, unit, digits=_DIGITS)

    def derived_small(self, value: float, unit: str) -> str:
        return small_text(value, unit, digits=_DIGITS)

    def ratio(self, above: str, below: str) -> str:
        unit = parse_unit(self.unit(above)) / parse_unit(self.unit(below))
        return self.derived_small(self.value(above) / self.value(below), unit.text)

    def counted(self, value: float, sd: float) -> str:
        return number_text(value, sd)

    def degrees(self, term: str) -> str:
        return degrees_text(self.value(term), self.sd(term))

    def place(self, term: str) -> tuple[float, str]:
        one = self.by_term[term]
        return (float("nan") if one.at is None else one.at), one.at_unit

    def listed(self, parts: Sequence[str]) -> str:
        return joined(parts)


def words_of(element: Element) -> Options:
    """What is said of an element beside its fitted numbers: words, expressions, and set values
    without which its numbers say nothing."""
    law, own = KINDS[element.kind], {one.name: one for one in element.parameters}
    told = []
    for key, value in element.values:
        declared, one = law.key(key), own.get(value.text)
        if declared is not None and declared.quoted and one is not None:
            told.append((key, quantity_text(one.value, one.unit.text)))
    return (*said_of(element), *told)


def phrase_of(kind: str, estimates: Sequence[Estimate], options: Options = ()) -> Phrase:
    """Word an effect from its numbers; what has no words of its own is named with all of them."""
    numbers = _Estimates({one.term: one for one in estimates}, turns(estimates))
    law = KINDS.get(kind)
    phrase = law.phrase(numbers, dict(options)) if law else None
    if phrase is not None:
        return phrase
    noun = law.words if law else f"an element of kind {kind.replace('_', ' ')}"
    if law and law.torque_words and numbers.turns:
        noun = law.torque_words
    listed = joined([f"{_term(kind, one)} {amount_text(one)}" for one in estimates])
    tail = SIDES.get(dict(options).get("side", ""), "")
    head = f"{noun} with {listed}" if listed else noun
    return Phrase(head, tail, tuple(numbers.by_term), "motion" if law and law.resists else "")


def action_of(phrase: Phrase, kind: str, place: Place, estimates: Sequence[Estimate]) -> str:
    """Say what an effect does at its place: ``resists the motion``."""
    value = {estimate.term: estimate.value for estimate in estimates}
    law = KINDS.get(kind)
    if phrase.resists:
        turned = phrase.resists == "motion" and turns(estimates)
        motion = "rotation" if turned else phrase.resists
        motion = f"relative {motion}" if _relative(place) else motion
        drives = value.get(law.resists if law else "", 0.0) < 0.0
        return f"drives the {motion} instead of resisting it" if drives else f"resists the {motion}"
    pushes = law.pushes if law else ""
    if pushes and isinstance(place, Between):
        ends = "apart" if value.get(pushes, 0.0) < 0.0 else "together"
        return f"acts, {'pushing' if ends == 'apart' else 'pulling'} the two points {ends}"
    if pushes and isinstance(place, On):
        negative = value.get(pushes, 0.0) < 0.0
        if place.plain:
            return f"acts towards {'negative' if negative else 'positive'} {place.coordinate}"
        said_place = place.coordinate.replace("-", "−")
        return f"acts towards {'smaller' if negative else 'larger'} {said_place}"
    return "act" if phrase.plural else "acts"


def _relative(place: Place) -> bool:
    """Whether a place has two sides that move against each other: points, or a difference."""
    if isinstance(place, On):
        tree = place.expression.tree
        return isinstance(tree, Operation) and tree.operator == "-"
    return isinstance(place, Between)


def secondary_of(phrase: Phrase, kind: str, estimates: Sequence[Estimate]) -> str:
    """The numbers that the words of an effect leave out."""
    left = [one for one in estimates if one.term not in phrase.terms]
    rest = [f"{_term(kind, one)} {amount_text(one)}" for one in left]
    if not rest:
        return ""
    return f" ({', '.join(rest)})" if phrase.tail else f", with {joined(rest)}"


def amount_text(estimate: Estimate) -> str:
    """A number with deviation and unit; a phase (1) is read in rad, a frequency (1/s) in Hz."""
    unit = _SPOKEN.get((estimate.term, estimate.unit), estimate.unit)
    return quantity_text(estimate.value, unit, estimate.sd)


def turns(estimates: Sequence[Estimate]) -> bool:
    """Whether the numbers belong to an angle: torques carry N*m, rates and stretches rad."""
    return any(
        re.search(r"N\*m|kg\*m|rad|deg", one.unit) for one in estimates if one.term != "phase"
    )


def _term(kind: str, estimate: Estimate) -> str:
    key = key_of(kind, estimate.term)
    return (key.label if key else "") or estimate.term.replace("_", " ")
