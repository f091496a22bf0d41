"""Products of what moves and what acts: forces that no law of the vocabulary writes.

They are the last resort. Each is linear in one coefficient, on one coordinate: nonlinear damping,
damping and dry friction that vary with place or load, couplings between coordinates, and inputs
that change stiffness and damping.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from symhyb.discrepancy.places.hypotheses import Hypothesis, Library
from symhyb.discrepancy.places.standing import inputs_beside, named_by
from symhyb.discrepancy.words.formula import LAW
from symhyb.model.types import Element, Model, On
from symhyb.numeric.lowered.machine import build

MOST_COORDINATES = 8  # products of two of them grow with the square


def products(model: Model, transitions: Mapping[str, float]) -> tuple[Hypothesis, ...]:
    """All products on every coordinate that moves; ``transitions`` are the speeds over which dry
    friction is smoothed by coordinate, SI."""
    found: list[Hypothesis] = []
    moving = [c.name for c in model.coordinates][:MOST_COORDINATES]
    for name in moving:
        if name not in transitions:
            continue
        shape = (("transition", transitions[name]),)
        stated = _numbers_with_channels(model, name)
        for formula in formulas(name, moving, [item.name for item in model.recorded_inputs]):
            if formula in stated:
                continue
            own = shape if "transition" in formula else ()
            found.append(Hypothesis(LAW, On(name), ("coefficient",), (False,), own, path=formula))
    return tuple(found)


def _numbers_with_channels(model: Model, x: str) -> set[str]:
    """The products on ``x`` that a number of the model is, which may be another one and changes
    with a channel that moves nothing: that number has a course over the channel."""
    beside = inputs_beside(model)
    uncertain = {item.name for item in model.parameters if item.sd is not None}
    here = [
        one
        for one in model.elements
        if isinstance(one.place, On)
        and x in one.place.names
        and not uncertain.isdisjoint(named_by(one))
    ]
    factors = {"spring": x, "damper": f"{x}'"}
    return {f"{u}*{factors[one.kind]}" for u in beside for one in here if one.kind in factors}


def formulas(x: str, coordinates: Sequence[str], inputs: Sequence[str]) -> tuple[str, ...]:
    """The products on the coordinate ``x``."""
    slides = f"tanh({x}'/transition)"
    own = (
        f"{x}*{x}'",
        f"abs({x})*{x}'",
        f"{x}**2*{x}'",
        f"{x}'**3",
        f"{x}*{slides}",
        f"abs({x})*{slides}",
        f"{x}**2*{slides}",
    )
    others = [y for y in coordinates if y != x]
    coupled = [
        product
        for y in others
        for product in (
            f"{y}",
            f"{y}'",
            f"{x}*{y}",
            f"{x}*{y}'",
            f"{y}*{x}'",
            f"{y}**2",
            f"{y}'**2",
        )
    ]
    driven = [
        product for u in inputs for product in (f"{u}*{x}", f"{u}*{x}'", f"abs({u})*{slides}")
    ]
    return (*own, *coupled, *driven)


def product_library(model: Model, tried: Sequence[Hypothesis]) -> Library:
    """Lower a model with one probe, coefficient 1, for every product."""
    probes: list[Element] = [
        hypothesis.element(model, f"product{i}", {"coefficient": 1.0})
        for i, hypothesis in enumerate(tried)
    ]
    machine = build(replace(model, elements=(*model.elements, *probes)), keep=False)
    return Library(machine, (), tuple(tried), tuple((i,) for i in range(len(tried))))
