"""A found curve: its values at its points with deviations, and the element that holds them."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from symhyb.discrepancy.places.hypotheses import CurvePoint, Hypothesis
from symhyb.discrepancy.results import Estimate
from symhyb.laws.curve import SYMBOLS, factor_name, value_name
from symhyb.model.curves import Curve
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, Parameter, Place
from symhyb.model.vocabulary import Words, curve_units, stretch_unit
from symhyb.units import ONE, Unit

DIGITS = 6  # of points as they are written
BEYOND = "beyond its points, where next to nothing was recorded, it goes on straight"

Pair = tuple[float, float]
"""A value and its deviation."""


class Through(NamedTuple):
    """Where a curve acts, and the points that it, and what it is multiplied by, run through, SI."""

    place: Place
    options: Words
    points: tuple[CurvePoint, ...]
    by_stretch: tuple[CurvePoint, ...] = ()


def curve_values(cause: Hypothesis, fitted: Mapping[str, Pair]) -> dict[str, Pair]:
    """The fitted values of a curve as they are reported, SI: what few points cannot follow is a
    part of their deviations, and what it is multiplied by is stated as a whole."""
    values = {
        key: (fitted[key][0], max(fitted[key][1], shift))
        for key, (_, _, shift) in cause.unknown.items()
    }
    for key, (_, about, shift) in cause.factors.items():
        change, sd = fitted[key]
        values[key] = about + change, max(sd, shift)
    return values


def value_estimates(
    model: Model, curve: Through, values: Mapping[str, Pair]
) -> tuple[Estimate, ...]:
    """The ``values`` of a curve, and of what it is multiplied by, with their deviations, all SI, in
    the units of the model file; what was not fitted is left out."""
    along, up = curve_units(model, curve.place, curve.options)
    letter = SYMBOLS[dict(curve.options).get("times", "")]
    own = _estimates(letter, value_name, curve.points, values, (along, up))
    units = stretch_unit(model, curve.place), ONE
    return (*own, *_estimates("w", factor_name, curve.by_stretch, values, units))


def _estimates(
    letter: str,
    named: Callable[[int], str],
    points: Sequence[CurvePoint],
    values: Mapping[str, Pair],
    units: tuple[Unit, Unit],
) -> list[Estimate]:
    along, up = units
    found = []
    for i, (x, _, _) in enumerate(points):
        if named(i) in values:
            value, sd = (one / up.factor for one in values[named(i)])
            name = f"{letter}_{i + 1}"
            found.append(Estimate(name, value, sd, up.text, named(i), x / along.factor, along.text))
    return found


def curve_element(
    model: Model,
    name: str,
    curve: Through,
    values: Sequence[Estimate],
    length: Parameter | None,
    provenance: tuple[tuple[str, object], ...],
) -> Element:
    """The element with a curve of its own through the ``values``; their deviations stand in its
    provenance, 0 of a point that is as it stands. A stretch between two points is counted from
    ``length``."""
    known = {one.term: one for one in values}
    units = curve_units(model, curve.place, curve.options)
    own, sds = _written(f"elements.{name}", value_name, curve.points, known, units)
    by_stretch = None
    if curve.by_stretch:
        units, named = (stretch_unit(model, curve.place), ONE), f"elements.{name}.by_stretch"
        by_stretch, more = _written(named, factor_name, curve.by_stretch, known, units)
        provenance = (*provenance, ("sd_by_stretch", more))
    return Element(
        name,
        "curve",
        curve.place,
        () if length is None else (("length", parse_expression(length.name)),),
        () if length is None else (length,),
        (*provenance, ("sd", sds)),
        options=curve.options,
        curve=own,
        by_stretch=by_stretch,
    )


def _written(
    name: str,
    named: Callable[[int], str],
    points: Sequence[CurvePoint],
    known: Mapping[str, Estimate],
    units: tuple[Unit, Unit],
) -> tuple[Curve, tuple[float, ...]]:
    """A curve as the file states it, and the deviation of its value at each point."""
    along, up = units
    rows, sds = [], []
    for i, (x, y, _) in enumerate(points):
        one = known.get(named(i))
        value, sd = (y / up.factor, 0.0) if one is None else (one.value, one.sd)
        rows.append((_rounded(x / along.factor), _rounded(value)))
        sds.append(float(f"{sd:.3g}"))
    return Curve(name, tuple(rows), units), tuple(sds)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
