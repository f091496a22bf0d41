"""Where what a model file writes jumps: sign(...), and the comparisons of where(...).

Exact simulation locates these jumps. What decides one is its argument, which is positive on one
side and negative on the other. x > 0, 0 < x and sign(-x) are one jump.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from symhyb.model.expression import Expression, Node, Number, Operation, names, show
from symhyb.model.types import Element, Model

ZERO = Number(0.0)


@dataclass(frozen=True, slots=True)
class Jump:
    """A jump where ``argument``, as it is written first, is 0. ``name`` is that of the element, or
    ``states.<name>``, where that is, ``element`` the one whose own parameters it contains, if it
    does."""

    name: str
    element: str
    argument: Node


@dataclass(frozen=True, slots=True)
class Written:
    """How a jump is written in a place: sign(``argument``) is ``way`` (+1 or −1) times the side of
    the jump."""

    argument: Node
    element: str
    way: int
    jump: int


def jumps(model: Model) -> tuple[Jump, ...]:
    """All jumps of the forces, the rates of states and gravity, each once."""
    return _found(model)[0]


def written_jumps(model: Model) -> tuple[Written, ...]:
    """Every way in which each of :func:`jumps` is written."""
    return _found(model)[1]


def _found(model: Model) -> tuple[tuple[Jump, ...], tuple[Written, ...]]:
    varying = {"t"} | {
        item.name for items in (model.coordinates, model.states, model.inputs) for item in items
    }
    found: dict[tuple[str, Node], tuple[int, Jump]] = {}
    ways: dict[tuple[str, Node], Written] = {}
    for name, element, expression in _places(model):
        own = {one.name for one in element.parameters} if element is not None else set[str]()
        for argument in _arguments(expression.tree):
            used = {one.name for one in names(argument)}
            if not used & varying:
                continue
            scope = element.name if element is not None and used & own else ""
            way, plain = _plain(argument)
            first, _ = found.setdefault((scope, plain), (way, Jump(name, scope, argument)))
            which = list(found).index((scope, plain))
            ways.setdefault((scope, argument), Written(argument, scope, first * way, which))
    return tuple(jump for _, jump in found.values()), tuple(ways.values())


def _places(model: Model) -> Iterator[tuple[str, Element | None, Expression]]:
    for element in model.elements:
        for _, value in element.values:
            yield element.name, element, value
    for state in model.states:
        yield f"states.{state.name}", None, state.rate
    for part in model.gravity or ():
        yield "gravity", None, part


def _arguments(node: Node) -> Iterator[Node]:
    """What the signs in a tree are of, inner ones first."""
    if isinstance(node, Operation):
        for part in node.arguments:
            yield from _arguments(part)
        if node.operator == "sign":
            yield node.arguments[0]


def _plain(node: Node) -> tuple[int, Node]:
    """A node with its way: the same jump is the same node, whichever side is written first."""
    match node:
        case Operation("neg", (inner,)):
            way, plain = _plain(inner)
            return -way, plain
        case Operation("-", (left, right)) if right == ZERO:
            return _plain(left)
        case Operation("-", (left, right)) if left == ZERO:
            way, plain = _plain(right)
            return -way, plain
        case Operation("-", (left, right)) if show(left) > show(right):
            return -1, Operation("-", (right, left))
    return 1, node
