r"""Stretches that nobody named: the sums and differences of two coordinates that a model couples.

    [m1]──/\/\/──[m2]      a force between the two acts on q1 − q2, behind a gear on q1 − r·q2
      └▶ q1        └▶ q2

Found where the model writes them, and in the Jacobians of its forces, whatever way those are
written. Sizes: N samples, n coordinates.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np

from symhyb.discrepancy.places.probing import PARALLEL, states_about_start
from symhyb.model.expression import Expression, Name, Node, Number, Operation, names, show
from symhyb.model.linear import Form, linear_parts
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import stretch_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.couplings import DAMPING, STIFFNESS, Couplings, couplings_of
from symhyb.numeric.lowered.machine import build

MOST_COORDINATES = 8  # of which every pair is looked at
LEAST = 1e-9  # relative: smaller entries couple nothing
LARGEST = 12  # denominator of a ratio that is read as a simple fraction


def written_stretches(model: Model) -> tuple[On, ...]:
    """The combinations q_i ± r·q_j with which energies, laws and places of bodies are
    written; r is a number or made of parameters."""
    moving = frozenset(c.name for c in model.coordinates)
    fixed = {item.name for item in model.parameters}
    found: dict[On, None] = {}
    for expression in _expressions(model):
        for form in linear_parts(expression.tree, moving):
            place = _stretch_of(form, fixed)
            if place is not None and _has_unit(model, place):
                found[place] = None
    return tuple(found)


def _expressions(model: Model) -> Iterator[Expression]:
    energies = (model.energy.potential, model.energy.kinetic)
    yield from (item for item in energies if item is not None)
    for element in model.elements:
        yield from (value for _, value in element.values)
    for body in model.bodies:  # where one slides; the sums of angles of an arm are no such place
        yield from (item for item in body.at if item and not _turns(item.tree))


def _turns(node: Node) -> bool:
    """Whether an expression holds a function, as those of links do that turn."""
    if isinstance(node, Operation):
        plain = node.operator in ("+", "-", "*", "/", "**", "neg")
        return not plain or any(_turns(part) for part in node.arguments)
    return False


def _stretch_of(form: Form, fixed: set[str]) -> On | None:
    """The place of a form c_i·q_i + c_j·q_j with c_i = ±1, or with two plain numbers."""
    if len(form) != 2 or len({name.order for name in form}) != 1:
        return None
    (first, one), (second, other) = sorted(
        form.items(), key=lambda item: not isinstance(item[1], Number)
    )
    if not isinstance(one, Number) or one.value == 0:
        return None
    if isinstance(other, Number):
        ratio = _fraction(-other.value / one.value)
        return None if ratio is None else On(_text(first.name, second.name, ratio))
    if abs(one.value) != 1 or not {name.name for name in names(other)} <= fixed:
        return None
    return On(_combined(first.name, second, other, one.value < 0))


def _combined(first: str, second: Name, factor: Node, turned: bool) -> str:
    """``first + factor*second``, or with ``turned`` signs ``first − factor*second``."""
    minus, plain = turned, Name(second.name)
    if isinstance(factor, Operation) and factor.operator == "neg":
        minus, factor = not turned, factor.arguments[0]
    product = Operation("*", (factor, plain))
    if isinstance(factor, Operation) and factor.operator == "/":
        above, below = factor.arguments
        top = plain if above == Number(1.0) else Operation("*", (above, plain))
        product = Operation("/", (top, below))
    return f"{first} {'-' if minus else '+'} {show(product)}"


def _has_unit(model: Model, place: On) -> bool:
    try:
        stretch_unit(model, place)
    except LookupError:
        return False
    return True


def coupled_stretches(model: Model, coordinates: Sequence[str]) -> tuple[On, ...]:
    """The combinations q_i − r·q_j of ``coordinates`` through which energies, or laws that stand on
    coordinates, couple two of them, by the Jacobians of the lowered model. Weight and inertia
    couple the links of any arm, at whose sums of angles nothing is joined: they do not count."""
    order = [c.name for c in model.coordinates]
    if len(order) > MOST_COORDINATES:
        return ()
    placed = (e for e in model.elements if isinstance(e.place, On) and e.place.plain)
    machine = build(replace(model, elements=tuple(placed), sensors=(), gravity=None))
    q, v, t = states_about_start(machine)
    u = np.random.default_rng(1).standard_normal((t.size, len(model.inputs)))
    u[:, len(model.recorded_inputs) :] = 0.0  # of local equations the mean counts
    seen = couplings_of(machine, q, v, u, t)
    if seen is None:
        return ()
    found: dict[On, None] = {}
    for i, j in combinations([order.index(name) for name in coordinates], 2):
        for place in _pair(model, seen, i, j):
            found[place] = None
    return tuple(found)


def _pair(model: Model, seen: Couplings, i: int, j: int) -> Iterator[On]:
    """The stretches through which the coordinates i and j are coupled; a ratio is guessed only
    where none is determined."""
    units = [stretch_unit(model, On(model.coordinates[k].name)) for k in (i, j)]
    alike = units[0].same_dimension(units[1])
    coupled = [what for what in (STIFFNESS, DAMPING) if _couples(seen.entries[what], i, j)]
    determined = [_ratio_of_change(seen.slopes[what][:, i, j], i, j) for what in coupled]
    if any(ratio is not None for ratio in determined):
        for ratio in determined:
            yield from _named(model, i, j, alike, [] if ratio is None else [ratio])
        return
    for what in coupled:
        if not np.any(seen.slopes[what][:, i, j]):
            yield from _named(model, i, j, alike, _even_ratios(seen.entries[what], i, j, alike))
            return


def _couples(entries: Array, i: int, j: int) -> bool:
    """Whether both rows of (N, n, n) entries feel the other coordinate alike."""
    one, other = entries[:, i, j], entries[:, j, i]
    if not np.all(np.isfinite(entries)) or not np.any(one):
        return False
    size = np.sqrt(np.abs(entries[:, i, i] * entries[:, j, j]))
    same = np.abs(one - other) <= PARALLEL * np.abs(one)
    return bool(np.any(np.abs(one) > LEAST * size) and np.all(same))


def _ratio_of_change(slopes: Array, i: int, j: int) -> float | None:
    """r where an entry with slopes (N, n) changes along q_i − r·q_j alone, else None."""
    size = np.abs(slopes).max(axis=1)
    rows = slopes[size > 0]
    if not np.all(np.isfinite(slopes)) or not rows.size:
        return None
    others = np.delete(rows, [i, j], axis=1)
    if not np.all(rows[:, i]) or np.abs(others).max(initial=0.0) > PARALLEL * size.max():
        return None
    ratios = -rows[:, j] / rows[:, i]
    ratio = float(ratios[0])
    same = np.abs(ratios - ratio) <= PARALLEL * abs(ratio)
    return ratio if ratio and bool(same.all()) else None


def _even_ratios(entries: Array, i: int, j: int, alike: bool) -> list[float]:
    """Ratios of a coupling that is the same everywhere, the likeliest first: if nothing else acts
    on the two, their own entries decide; else it is 1, with the sign of the coupling."""
    own, cross, other = entries[0, i, i], entries[0, i, j], entries[0, j, j]
    found = [-cross / own] if own else []
    if abs(own * other - cross**2) > PARALLEL * cross**2:
        found += [-other / cross]
        found = [float(np.sign(cross)), *found] if alike else found
    return [float(ratio) for ratio in found if ratio and np.isfinite(ratio)]


def _named(model: Model, i: int, j: int, alike: bool, ratios: Sequence[float]) -> Iterator[On]:
    """The first of the ``ratios`` that is ±1, a parameter or a simple fraction, as a place; without
    a unit a ratio joins coordinates of like units alone."""
    first, second = (model.coordinates[k].name for k in (i, j))
    for ratio in ratios:
        simple = _fraction(ratio) if alike else None
        unit = simple is not None and abs(simple) == 1
        for said in () if unit else _by_parameter(model, ratio):
            place = On(_text(first, second, Fraction(1 if ratio > 0 else -1), said))
            if _has_unit(model, place):
                yield place
                return
        if simple is not None:
            yield On(_text(first, second, simple))
            return


def _by_parameter(model: Model, ratio: float) -> Iterator[str]:
    """``*n`` and ``/n`` of the parameters n that are the size of a ratio, or one over it, SI."""
    for item in model.parameters:
        for said, value in (("*", item.si), ("/", 1 / item.si if item.si else 0.0)):
            if abs(value - abs(ratio)) <= PARALLEL * abs(ratio):
                yield f"{said}{item.name}"


def _fraction(ratio: float) -> Fraction | None:
    """A ratio as a simple fraction, None if it is none."""
    simple = Fraction(ratio).limit_denominator(LARGEST)
    near = simple != 0 and abs(float(simple) - ratio) <= PARALLEL * abs(ratio)
    return simple if near else None


def _text(first: str, second: str, ratio: Fraction, by: str = "") -> str:
    """``first − ratio*second``, the second multiplied or divided ``by`` a parameter."""
    sign, size = "-" if ratio > 0 else "+", abs(ratio)
    factor = "" if size == 1 else f"{size}*"
    if by.startswith("*"):
        return f"{first} {sign} {factor}{by[1:]}*{second}"
    return f"{first} {sign} {factor}{second}{by}"
