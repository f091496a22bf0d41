"""Linear combinations inside expressions: where a model itself writes x − y or phi − n·psi."""

from collections.abc import Callable, Iterator, Mapping

from symhyb.model.trees import Name, Node, Number, Operation, names

Form = Mapping[Name, Node]
"""Coefficients by name; what contains no such name is left out."""
_ONE = Number(1.0)


def linear_parts(tree: Node, moving: frozenset[str]) -> Iterator[Form]:
    """Yield the largest parts of a tree that are linear in two or more of the ``moving`` names."""
    if not isinstance(tree, Operation):
        return
    form = linear_form(tree, moving)
    if form is not None and len(form) > 1:
        yield form
    if form is None or any(not isinstance(c, Number) for c in form.values()):
        for part in tree.arguments:  # k*(x - y) - d*x is linear, and x - y inside of it too
            yield from linear_parts(part, moving)


def linear_form(tree: Node, moving: frozenset[str]) -> Form | None:
    """The coefficients of a tree that is linear in the ``moving`` names, None if it is not."""
    if not any(name.name in moving for name in names(tree)):
        return {}
    match tree:
        case Name():
            return {tree: _ONE}
        case Operation("neg", (part,)):
            return _scaled(linear_form(part, moving), _negative)
        case Operation("+" | "-" as sign, (left, right)):
            return _sum(sign, linear_form(left, moving), linear_form(right, moving))
        case Operation("*", (left, right)):
            for factor, part in ((left, right), (right, left)):
                if not any(name.name in moving for name in names(factor)):
                    return _scaled(linear_form(part, moving), _times(factor))
        case Operation("/", (left, right)) if not any(n.name in moving for n in names(right)):
            return _scaled(linear_form(left, moving), _over(right))
    return None


def _scaled(form: Form | None, by: Callable[[Node], Node]) -> Form | None:
    return None if form is None else {name: by(value) for name, value in form.items()}


def _sum(sign: str, left: Form | None, right: Form | None) -> Form | None:
    if left is None or right is None:
        return None
    found = dict(left)
    for name, value in right.items():
        if name in found:
            found[name] = _number_of(Operation(sign, (found[name], value)))
        else:
            found[name] = value if sign == "+" else _negative(value)
    return found


def _negative(node: Node) -> Node:
    match node:
        case Number(value):
            return Number(-value)
        case Operation("neg", (part,)):
            return part
    return Operation("neg", (node,))


def _times(factor: Node) -> Callable[[Node], Node]:
    return lambda node: factor if node == _ONE else _number_of(Operation("*", (factor, node)))


def _over(divisor: Node) -> Callable[[Node], Node]:
    return lambda node: _number_of(Operation("/", (node, divisor)))


def _number_of(node: Operation) -> Node:
    """The value of an operation on two plain numbers, else itself."""
    match node:
        case Operation(operator, (Number(a), Number(b))) if operator != "/" or b:
            results = {"+": a + b, "-": a - b, "*": a * b, "/": a / b if b else a}
            return Number(results[operator])
    return node
