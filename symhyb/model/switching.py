"""What switches in a model: dry friction that can hold, stops that touch, and laws left as written.

Exact simulation (:mod:`symhyb.exact.events`) turns friction on a coordinate or between points,
every side of a gap, and every jump that a model file writes (:mod:`symhyb.model.jumps`) into an
automaton. Other laws with a corner stay what they are, and so does friction that turns over
gradually: a transition that states an ``sd`` is a number of the machine, and smooths nothing.
"""

from dataclasses import dataclass

from symhyb.model.expression import Expression, Node, Operation, names
from symhyb.model.types import At, Element, Model, On
from symhyb.model.vocabulary import KINDS


@dataclass(frozen=True, slots=True)
class Stop:
    """One side of a gap: the index of its ``element``, ``sign`` +1 (upper) or −1 (lower), and
    whether a damper acts in contact (``damped``)."""

    element: int
    sign: int
    damped: bool

    @property
    def side(self) -> str:
        """upper or lower."""
        return "upper" if self.sign > 0 else "lower"


def frictions(model: Model) -> tuple[int, ...]:
    """Indices of the elements that slide or stick exactly."""
    return tuple(i for i, element in enumerate(model.elements) if _holds(model, element))


def stops(model: Model) -> tuple[Stop, ...]:
    """The sides of all gaps, upper before lower."""
    return tuple(
        Stop(i, sign, element.value("damping") is not None)
        for i, element in enumerate(model.elements)
        if KINDS[element.kind].switch == "touches"
        for name, sign in (("upper", 1), ("lower", -1))
        if element.option("side", "both") in (name, "both")
    )


def rubbing(model: Model) -> tuple[int, ...]:
    """Indices of the elements whose dry friction turns with one rate, on imposed motion too."""
    return tuple(
        i
        for i, element in enumerate(model.elements)
        if _rubs(model, element) and not isinstance(element.place, At)
    )


def gradual(model: Model, element: Element) -> bool:
    """Whether the speed within which the friction of an element turns over is a number of the
    machine: what its transition names states an ``sd``."""
    text = element.value(KINDS[element.kind].smoothed_over)
    if text is None:
        return False
    known = {one.name: one.sd for one in (*model.parameters, *element.parameters)}
    return any(known.get(one.name) is not None for one in names(text))


def modes(model: Model) -> tuple[tuple[str, int], ...]:
    """What is in one mode at a time where nothing holds exactly, by name, and in how many modes it
    can be: a friction in 3, the sides of stops in 2, and with a damper once more in 2."""
    named = [(model.elements[i].name, 3) for i in rubbing(model)]
    sides = [stop.element for stop in stops(model)]
    for stop in stops(model):
        name = model.elements[stop.element].name
        name += f".{stop.side}" if sides.count(stop.element) > 1 else ""
        named += [(name, 2), *([(f"{name}.press", 2)] if stop.damped else [])]
    return tuple(named)


def left_smooth(model: Model) -> tuple[str, ...]:
    """One sentence for each law with a corner that an exact simulation leaves as it is written."""
    said = []
    for element in model.elements:
        name = f"elements.{element.name}"
        if KINDS[element.kind].switch == "holds" and gradual(model, element):
            said.append(f"{name} turns over gradually, by a transition with an sd: it stays so")
        elif _rubs(model, element) and isinstance(element.place, At):
            said.append(f"{name} acts at a point, in two directions: it stays smoothed")
        elif _rubs(model, element) and not _holds(model, element):
            said.append(
                f"{name} acts on an imposed motion, which it cannot hold: it stays smoothed"
            )
        elif KINDS[element.kind].states and KINDS[element.kind].steep:
            said.append(f"{name} has an inner state and is smooth by itself: it stays as it is")
    return tuple(said)


def switches(node: Node) -> bool:
    """Whether an expression jumps, with sign(...)."""
    if not isinstance(node, Operation):
        return False
    return node.operator == "sign" or any(switches(part) for part in node.arguments)


def switching_word(expression: Expression) -> str:
    """With what an expression jumps, as it is written; empty if it does not."""
    if not switches(expression.tree):
        return ""
    return "where(...)" if "where" in expression.text else "sign(...)"


def _rubs(model: Model, element: Element) -> bool:
    return KINDS[element.kind].switch == "holds" and not gradual(model, element)


def _holds(model: Model, element: Element) -> bool:
    if not _rubs(model, element) or isinstance(element.place, At):
        return False
    if not isinstance(element.place, On):
        return True
    imposed = {c.name for c in model.coordinates if c.imposed}
    moving = {c.name for c in model.coordinates} & element.place.names
    return not moving <= imposed
