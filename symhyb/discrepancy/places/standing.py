"""What the model has at a place already, beside which a cause may stand."""

from collections.abc import Collection, Sequence

from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import quantities_of
from symhyb.model.expression import names
from symhyb.model.types import Element, Model, Place
from symhyb.model.vocabulary import KINDS, stretch_unit
from symhyb.units import parse_unit


def alike(model: Model, kind: str, place: Place | None) -> tuple[Element, ...]:
    """The elements of a model of one kind at one place."""
    return tuple(one for one in model.elements if one.kind == kind and one.place == place)


def inputs_of_elements(model: Model) -> tuple[str, ...]:
    """The recorded inputs that an element names; others move nothing, unless they impose a motion
    or change a body."""
    used = {name for one in model.elements for name in named_by(one)}
    return tuple(item.name for item in model.recorded_inputs if item.name in used)


def inputs_beside(model: Model) -> tuple[str, ...]:
    """The recorded inputs that no element names: what was recorded beside the machine, as a
    temperature or a wind, unless it imposes a motion or changes a body."""
    used = inputs_of_elements(model)
    return tuple(item.name for item in model.recorded_inputs if item.name not in used)


def flows_at(model: Model, place: Place) -> tuple[str, ...]:
    """The inputs beside the machine that show a speed in a unit of the rate of a place."""
    imposed = {one.name for one in model.coordinates if one.imposed}
    beside = {*inputs_beside(model)} - imposed
    if not beside:
        return ()
    speed = stretch_unit(model, place) / parse_unit("s")
    found = (item for item in model.recorded_inputs if item.name in beside)
    return tuple(item.name for item in found if item.unit.same_dimension(speed))


def named_by(element: Element, keys: Collection[str] | None = None) -> set[str]:
    """What the values of an element name, or those of some ``keys``."""
    texts = (text for key, text in element.values if keys is None or key in keys)
    return {item.name for text in texts for item in names(text)}


def _paths(element: Element, used: Collection[str]) -> set[str]:
    """Names that an element uses, as paths of parameters."""
    own = {item.name for item in element.parameters}
    return {f"{element.name}.{name}" if name in own else name for name in used}


def numbers_over(model: Model, place: Place, known: frozenset[str]) -> frozenset[str]:
    """The numbers of the model, by path, in elements at a place that are functions of these
    quantities alone (``stretch``, ``rate``)."""
    found: set[str] = set()
    for element in model.elements:
        law = KINDS.get(element.kind)
        if element.place != place or law is None or not law.of_state:
            continue
        mine = quantities_of(element.kind, dict(element.values))
        if mine and mine <= known:
            found |= _paths(element, named_by(element))
    return frozenset(found)


def uncertain_beside(
    model: Model, parametric: Sequence[Hypothesis], causes: Sequence[Hypothesis]
) -> tuple[Hypothesis, ...]:
    """The parameters that state an sd and are not among the causes."""
    stated = {item.path for item in model.all_parameters() if item.sd is not None}
    left = stated - {cause.path for cause in causes if cause.place is None}
    return tuple(one for one in parametric if one.kind == "parameter" and one.path in left)


def taken_over(model: Model, cause: Hypothesis) -> frozenset[str]:
    """The parameters, by path, in the keys that a variant of a law and an element of its kind at
    its place both have: of the two together the recordings determine the sum alone. None of a plain
    law: that is what the parameter itself may be."""
    found: set[str] = set()
    if not cause.variant:
        return frozenset(found)
    for element in alike(model, cause.kind, cause.place):
        found |= _paths(element, named_by(element, cause.keys))
    return frozenset(found)
