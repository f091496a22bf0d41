"""A found curve: its values at its points with deviations, and the element that holds them."""

from collections.abc import Sequence

from symhyb.discrepancy.results import Estimate
from symhyb.laws.curve import SYMBOLS, value_name
from symhyb.model.curves import Curve
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, Parameter, Place
from symhyb.model.vocabulary import Words, curve_units

DIGITS = 6  # of points as they are written
BEYOND = "beyond its points, where next to nothing was recorded, it goes on straight"


def value_estimates(
    model: Model,
    place: Place,
    options: Words,
    points: Sequence[float],
    values: Sequence[tuple[float, float]],
) -> tuple[Estimate, ...]:
    """The ``values`` of a curve with their deviations at its ``points``, all SI, in the units of
    the model file."""
    along, up = curve_units(model, place, options)
    letter = SYMBOLS[dict(options).get("times", "")]
    return tuple(
        Estimate(
            f"{letter}_{i + 1}",
            value / up.factor,
            sd / up.factor,
            up.text,
            value_name(i),
            x / along.factor,
            along.text,
        )
        for i, (x, (value, sd)) in enumerate(zip(points, values, strict=True))
    )


def curve_element(
    model: Model,
    name: str,
    place: Place,
    options: Words,
    values: Sequence[Estimate],
    length: Parameter | None,
    provenance: tuple[tuple[str, object], ...],
) -> Element:
    """The element with a curve of its own through the ``values``; their deviations stand in its
    provenance. A stretch between two points is counted from ``length``."""
    points = tuple(
        (0.0 if one.at is None else float(f"{one.at:.{DIGITS}g}"), float(f"{one.value:.{DIGITS}g}"))
        for one in values
    )
    sds = tuple(float(f"{one.sd:.3g}") for one in values)
    return Element(
        name,
        "curve",
        place,
        () if length is None else (("length", parse_expression(length.name)),),
        () if length is None else (length,),
        (*provenance, ("sd", sds)),
        options=options,
        curve=Curve(f"elements.{name}", points, curve_units(model, place, options)),
    )
