"""Effects in words: each kind of law with its main numbers, and what an engineer reads off them.

A phrase names an effect (``dry (Coulomb) friction of 20.4 ± 0.2 N``); a sentence adds what it does.
Quantities that follow from two fitted numbers (a yield travel, a time constant) are said without a
deviation, for the two are correlated.
"""

import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from symhyb.discrepancy.results import Estimate
from symhyb.discrepancy.words.amounts import (
    degrees_text,
    joined,
    number_text,
    quantity_text,
    small_text,
)
from symhyb.model.expression import Operation
from symhyb.model.types import Between, On, Place
from symhyb.model.vocabulary import KINDS
from symhyb.units import parse_unit

_DIGITS = 3  # of a quantity that follows from fitted ones
Options = Sequence[tuple[str, str]]

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
_SAID_IN = {("phase", "1"): "rad", ("frequency", "1/s"): "Hz"}
_SIDES = {"upper": "on the upper side", "lower": "on the lower side", "both": "on both sides"}


@dataclass(frozen=True, slots=True)
class Said:
    """An effect as the parts of a sentence: ``head`` [does something] ``tail``; ``terms`` are the
    keys whose numbers these words hold, ``resists`` what a resisting effect acts against."""

    head: str
    tail: str = ""
    terms: tuple[str, ...] = ()
    resists: str = ""


@dataclass(frozen=True, slots=True)
class Numbers:
    """The estimates of one effect by key, and whether they belong to an angle."""

    by_term: Mapping[str, Estimate]
    turns: bool

    def __contains__(self, term: str) -> bool:
        return term in self.by_term

    def value(self, term: str, default: float = 0.0) -> float:
        """The value under a key, ``default`` where it was not fitted."""
        return self.by_term[term].value if term in self.by_term else default

    def amount(self, term: str) -> str:
        """The number under a key with deviation and unit."""
        return amount_text(self.by_term[term])

    def small(self, term: str) -> str:
        """The same of a length, an angle or a time, in the prefix that reads best."""
        one = self.by_term[term]
        return small_text(one.value, one.unit, one.sd)

    def unit(self, above: str, below: str) -> str:
        """The unit of the ratio of two numbers."""
        ratio = parse_unit(self.by_term[above].unit) / parse_unit(self.by_term[below].unit)
        return ratio.text


def said_of(kind: str, estimates: Sequence[Estimate], options: Options = ()) -> Said:
    """Say an effect from its numbers; what has no words of its own is named with all of them."""
    numbers = Numbers({one.term: one for one in estimates}, turns(estimates))
    said = _SAYERS[kind](numbers, dict(options)) if kind in _SAYERS else None
    if said is not None:
        return said
    noun = KINDS[kind].words if kind in KINDS else f"an element of kind {kind.replace('_', ' ')}"
    if kind == "friction" and numbers.turns:
        noun += " torque"
    listed = joined([f"{_term(one)} {amount_text(one)}" for one in estimates])
    tail = _SIDES.get(dict(options).get("side", ""), "")
    head = f"{noun} with {listed}" if listed else noun
    return Said(head, tail, tuple(numbers.by_term), "motion" if kind in _RESISTING else "")


def action_of(said: Said, kind: str, place: Place, estimates: Sequence[Estimate]) -> str:
    """Say what an effect does at its place: ``resists the motion``."""
    value = {estimate.term: estimate.value for estimate in estimates}
    if said.resists:
        motion = "rotation" if said.resists == "motion" and turns(estimates) else said.resists
        motion = f"relative {motion}" if _relative(place) else motion
        drives = value.get(_RESISTING.get(kind, ""), 0.0) < 0.0
        return f"drives the {motion} instead of resisting it" if drives else f"resists the {motion}"
    if kind == "constant" and isinstance(place, Between):
        ends = "apart" if value.get("constant", 0.0) < 0.0 else "together"
        return f"acts, {'pushing' if ends == 'apart' else 'pulling'} the two points {ends}"
    if kind == "constant" and isinstance(place, On):
        negative = value.get("constant", 0.0) < 0.0
        if place.plain:
            return f"acts towards {'negative' if negative else 'positive'} {place.coordinate}"
        said_place = place.coordinate.replace("-", "−")
        return f"acts towards {'smaller' if negative else 'larger'} {said_place}"
    several = kind == "spring" and sum(key in value for key in _STIFFNESS) > 1
    return "act" if several else "acts"


def _relative(place: Place) -> bool:
    """Whether a place has two sides that move against each other: points, or a difference."""
    if isinstance(place, On):
        tree = place.expression.tree
        return isinstance(tree, Operation) and tree.operator == "-"
    return isinstance(place, Between)


def secondary_of(said: Said, estimates: Sequence[Estimate]) -> str:
    """The numbers that the words of an effect leave out."""
    rest = [f"{_term(one)} {amount_text(one)}" for one in estimates if one.term not in said.terms]
    if not rest:
        return ""
    return f" ({', '.join(rest)})" if said.tail else f", with {joined(rest)}"


def amount_text(estimate: Estimate) -> str:
    """A number with deviation and unit; a phase (1) is said in rad, a frequency (1/s) in Hz."""
    unit = _SAID_IN.get((estimate.term, estimate.unit), estimate.unit)
    return quantity_text(estimate.value, unit, estimate.sd)


def turns(estimates: Sequence[Estimate]) -> bool:
    """Whether the numbers belong to an angle: torques carry N*m, rates and stretches rad."""
    return any(
        re.search(r"N\*m|kg\*m|rad|deg", one.unit) for one in estimates if one.term != "phase"
    )


def _term(estimate: Estimate) -> str:
    return _SECONDARY.get(estimate.term, estimate.term.replace("_", " "))


def _about(value: float, unit: str) -> str:
    return small_text(value, unit, digits=_DIGITS)


def _spring(n: Numbers, _: Mapping[str, str]) -> Said | None:
    present = tuple(key for key in _STIFFNESS if key in n)
    parts = []
    for key in present:
        noun, hard, soft = _STIFFNESS[key]
        meaning = hard if n.value(key) >= 0.0 else soft
        parts.append(f"{noun} of {n.amount(key)}" + (f" ({meaning})" if meaning else ""))
    return Said(joined(parts), terms=present) if parts else None


def _damper(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "damping" not in n:
        return None
    head = f"{KINDS['damper'].words} of {n.amount('damping')}"
    sided = _directions(n, "damping")
    return Said(head + (f" ({sided})" if sided else ""), terms=("damping",), resists="motion")


def _drag(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "drag" not in n:
        return None
    noun = "drag torque quadratic in speed" if n.turns else KINDS["drag"].words
    return Said(f"{noun} ({n.amount('drag')})", terms=("drag",), resists="motion")


def _friction(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "coulomb" not in n:
        return None
    noun = KINDS["friction"].words + (" torque" if n.turns else "")
    levels, terms = _levels(n)
    sided = _directions(n, "coulomb")
    listed = ", ".join(part for part in (levels, sided) if part)
    head = f"{noun} of {n.amount('coulomb')}" + (f" ({listed})" if listed else "")
    return Said(head, terms=("coulomb", *terms), resists="motion")


def _levels(n: Numbers) -> tuple[str, tuple[str, ...]]:
    """The breakaway level and the speed at which it is gone, with the keys they use."""
    parts = [f"{n.amount('static')} at breakaway"] if "static" in n else []
    parts += [f"Stribeck speed {n.amount('stribeck')}"] if "stribeck" in n else []
    return ", ".join(parts), ("static", "stribeck")


def _directions(n: Numbers, term: str) -> str:
    """The strengths of a law that differs by direction."""
    if "asymmetry" not in n:
        return ""
    unit = n.by_term[term].unit
    forward, backward = (
        quantity_text(n.value(term) * (1.0 + sign * n.value("asymmetry")), unit, digits=_DIGITS)
        for sign in (1.0, -1.0)
    )
    return f"{forward} forward, {backward} backward"


def _gap(n: Numbers, options: Mapping[str, str]) -> Said | None:
    if "stiffness" not in n:
        return None
    side = options.get("side", "")
    tail = f"beyond a clearance of {n.small('clearance')}" if "clearance" in n else ""
    tail = " ".join(part for part in (tail, _SIDES.get(side, "")) if part)
    if side == "both" and "clearance" in n:
        travel = _about(2.0 * n.value("clearance"), n.by_term["clearance"].unit)
        tail += f", {travel} apart"
    return Said(f"an elastic stop of {n.amount('stiffness')}", tail, ("stiffness", "clearance"))


def _hysteresis(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "stiffness" not in n:
        return None
    tail = f"with a stiffness of {n.amount('stiffness')}" + _saturation(n)
    if "play" in n:
        tail += f" behind a play of {n.small('play')}"
    return Said("hysteresis (Bouc–Wen)", tail, ("stiffness", "play"), "motion")


def _saturation(n: Numbers) -> str:
    """The force at which z' = 0 on loading: stiffness·((beta + gamma)^(−1/n) − play); with a
    negative sum z grows ever faster."""
    power, both = n.value("exponent", 1.0), n.value("beta") + n.value("gamma")
    if "beta" not in n or both == 0.0 or power <= 0.0:
        return ""
    if both < 0.0:
        return " that hardens on loading"
    inverse = -1 / Fraction(power).limit_denominator(12)
    stretch = parse_unit(n.by_term["beta"].unit) ** inverse
    if "^" in stretch.text or "/" in stretch.text:  # an exponent that was set, not fitted
        return ""
    level = n.value("stiffness") * (both ** (-1.0 / power) - n.value("play"))
    unit = (parse_unit(n.by_term["stiffness"].unit) * stretch).text
    return f" that saturates at about {quantity_text(level, unit, digits=_DIGITS)}"


def _friction_dynamic(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "coulomb" not in n:
        return None
    levels, terms = _levels(n)
    head = f"dry friction{' torque' if n.turns else ''} of {n.amount('coulomb')}"
    head += f" ({levels})" if levels else ""
    if n.value("stiffness") > 0.0:
        travel = _about(n.value("coulomb") / n.value("stiffness"), n.unit("coulomb", "stiffness"))
        head += f" that yields elastically over about {travel} before it slides (LuGre)"
    return Said(head, terms=("coulomb", *terms), resists="motion")


def _relaxation(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "stiffness" not in n:
        return None
    head = f"a spring of {n.amount('stiffness')} that relaxes"
    if "damping" in n and n.value("stiffness") > 0.0:
        time = _about(n.value("damping") / n.value("stiffness"), n.unit("damping", "stiffness"))
        head += f" with the time constant {time}"
    return Said(f"{head} (Maxwell)", terms=("stiffness",))


def _constant(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "constant" not in n:
        return None
    noun = "torque" if n.turns else "force"
    return Said(f"a constant {noun} of {n.amount('constant')}", terms=("constant",))


def _harmonic(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "amplitude" not in n:
        return None
    head = f"a harmonic {'torque' if n.turns else 'force'} of {n.amount('amplitude')}"
    head += f" at {n.amount('frequency')}" if "frequency" in n else ""
    return Said(head, terms=("amplitude", "frequency"))


def _ripple(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "amplitude" not in n:
        return None
    head = f"a {'torque' if n.turns else 'force'} of {n.amount('amplitude')}"
    if "period" not in n:
        return Said(f"{head} that repeats with position", terms=("amplitude",))
    period = n.by_term["period"]
    every = f"every {n.small('period')} of travel"
    if n.turns and period.unit == "rad" and period.value > 0.0:
        count = 2.0 * math.pi / period.value
        times = number_text(count, count * period.sd / period.value)
        every = f"{times} times a turn (every {degrees_text(period.value, period.sd)})"
    return Said(f"{head} that repeats {every}", terms=("amplitude", "period"))


def _added_mass(n: Numbers, _: Mapping[str, str]) -> Said | None:
    if "mass" not in n:
        return None
    noun = "added inertia" if n.turns else "added mass"
    return Said(f"{noun} of {n.amount('mass')}", terms=("mass",), resists="acceleration")


def _law(n: Numbers, options: Mapping[str, str]) -> Said | None:
    if "formula" not in options or "coefficient" not in n:
        return None
    noun, letter = ("torque" if n.turns else "force"), n.by_term["coefficient"].name
    told = f"-{letter}*{options['formula']}".replace("-", "−")
    head = f"an empirical {noun} {told} with {letter} = {n.amount('coefficient')}"
    return Said(head, terms=("coefficient",))


_RESISTING = {"friction": "coulomb", "damper": "damping", "drag": "drag"}  # main key
_SAYERS: Mapping[str, Callable[[Numbers, Mapping[str, str]], Said | None]] = {
    "spring": _spring,
    "damper": _damper,
    "drag": _drag,
    "friction": _friction,
    "gap": _gap,
    "hysteresis": _hysteresis,
    "friction_dynamic": _friction_dynamic,
    "relaxation": _relaxation,
    "constant": _constant,
    "harmonic": _harmonic,
    "ripple": _ripple,
    "added_mass": _added_mass,
    "law": _law,
}
