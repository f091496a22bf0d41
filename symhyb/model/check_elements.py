"""Check the elements of a model: places, what their expressions may contain, and units."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from fractions import Fraction

from symhyb.errors import did_you_mean
from symhyb.laws.base import Key
from symhyb.model.curves import Curve
from symhyb.model.expression import Expression, Name, Number, Operation, Quantity
from symhyb.model.frames import point_faults
from symhyb.model.scope import (
    ADDED,
    COEFFICIENT,
    FORCE,
    PLACE,
    SEEN,
    Scope,
    Use,
    expression_faults,
    unit_in,
)
from symhyb.model.source import Path
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import At, Between, Element, Model, On, Pair, Parameter
from symhyb.model.vocabulary import KINDS, curve_units, key_unit, map_units, stretch_unit
from symhyb.units import ONE, Unit

_HIGHEST = 20  # the highest power that a unit has


def element_faults(
    element: Element, model: Model, scope: Scope, energy: Unit | None, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """Yield what is wrong with one element; units that need the unit of ``energy`` are not checked
    where that is None."""
    path = ("elements", element.name)
    faults = list(_place_faults(element, model, scope, unreadable))
    yield from faults
    own = {parameter.name: parameter.unit for parameter in element.parameters}
    local = replace(scope, units={**scope.units, **own})
    stretches = _stretches(element)
    placed = not faults and all(unit_in(one.expression, scope) is not None for one in stretches)
    known = replace(model, energy_unit=energy) if energy is not None and placed else None
    for key, value in element.values:
        declared = KINDS[element.kind].key(key.split(".")[0])
        if declared is None:
            continue
        needed = _needed(element, key, declared, value, known, local) if known else None
        use = _use(declared)
        yield from expression_faults((*path, key), value, local, use, needed)
        if needed is not None and declared.exponent:
            yield from _scale_faults((*path, key), value, element, model, local, needed)
        if declared.divides and _plain(value, element, model) == 0.0:
            yield (*path, key), f"'{shorten(value.text)}' is 0; the law divides by it"
    yield from _exponent_faults(element, model)
    for seen in element.network.inputs if element.network else ():
        yield from expression_faults((*path, "inputs"), seen, local, SEEN, None)
    if element.curve is not None and known is not None:
        yield from _curve_faults(element, element.curve, known)
    if element.map is not None and known is not None:
        where, axes = (*path, "units" if element.map.owned else "map"), ("x", "y", "the value")
        wanted = map_units(known, element.place)
        yield from _unit_faults(where, "map", axes, element.map.units, wanted)


def _curve_faults(element: Element, curve: Curve, model: Model) -> Iterator[Fault]:
    """The units of a curve must be those of its place, and only one over the stretch is a factor of
    the speed."""
    if element.option("over", "") == "rate" and element.option("times", ""):
        text = "is for a curve over the stretch; one over the rate is a force by itself"
        yield ("elements", element.name, "times"), text
        return
    path = ("elements", element.name, "units" if curve.owned else "curve")
    needed = curve_units(model, element.place, element.options)
    yield from _unit_faults(path, "curve", "xy", curve.units, needed)
    factor = element.by_stretch
    if factor is None:
        return
    path = ("elements", element.name, "by_stretch")
    if element.option("over", "") != "rate":
        yield path, "is a factor of a curve over the rate; state over = 'rate', or leave it out"
        return
    needed = stretch_unit(model, element.place), ONE
    yield from _unit_faults(path, "curve", "xy", factor.units, needed)


def _unit_faults(
    path: Path, word: str, axes: Sequence[str], units: Sequence[Unit], needed: Sequence[Unit]
) -> Iterator[Fault]:
    for axis, unit, wanted in zip(axes, units, needed, strict=True):
        if not unit.same_dimension(wanted):
            yield path, f"{axis} of the {word} is {unit}, needs {wanted}"


def _use(key: Key) -> Use:
    if key.inertia:
        return ADDED
    return FORCE if key.signal else COEFFICIENT


def _needed(
    element: Element, key: str, declared: Key, value: Expression, model: Model, scope: Scope
) -> Unit | None:
    """Return the unit that a key must have, None where it cannot be known."""
    if not declared.exponent:
        return key_unit(model, element.kind, key, element.place)
    exponent = element.value(declared.exponent)
    if exponent is None:
        return key_unit(model, element.kind, key, element.place)
    n = _plain(exponent, element, model)
    if n is None or not 1.0 <= n <= _HIGHEST:
        return None  # said at the exponent
    source = _parameter(exponent, element, model)
    if source is not None and source.was is not None:
        # The unit was written for the exponent before its re-estimation, and cannot follow it.
        n = _written_power(unit_in(value, scope), stretch_unit(model, element.place)) or n
    return key_unit(model, element.kind, key, element.place, n)


def _written_power(unit: Unit | None, stretch: Unit) -> float | None:
    """Return the n of a unit 1/[stretch]^n, None if it has another form or n is below 1."""
    if unit is None or stretch.is_number:
        return None
    pairs = zip(unit.dimension, stretch.dimension, strict=True)
    powers: set[Fraction] = {-ours / theirs for ours, theirs in pairs if theirs}
    n = float(powers.pop())
    return n if n >= 1.0 and not powers else None


def _exponent_faults(element: Element, model: Model) -> Iterator[Fault]:
    """An exponent sets the units of other keys, so its value must be known here."""
    for name in {key.exponent for key in KINDS[element.kind].keys if key.exponent}:
        value = element.value(name)
        if value is None:
            continue
        path, text = ("elements", element.name, name), shorten(value.text)
        n = _plain(value, element, model)
        others = " and ".join(key.name for key in KINDS[element.kind].keys if key.exponent)
        if n is None:
            sentence = f"'{text}' is a unit that hides in an exponent: that of {others} follows"
            yield path, f"{sentence} from it; it must be a number or one parameter"
        elif not 1.0 <= n <= _HIGHEST:
            yield path, f"'{text}' is {n:g}; it must be at least 1 and at most {_HIGHEST}"


def _scale_faults(
    path: Path, value: Expression, element: Element, model: Model, scope: Scope, needed: Unit
) -> Iterator[Fault]:
    """Between the powers that a unit can have, 1/mm^n would be converted with another n."""
    exponent, unit = element.value("exponent"), unit_in(value, scope)
    if exponent is None or unit is None or unit.factor == 1.0 or not unit.same_dimension(needed):
        return
    source = _parameter(exponent, element, model)
    n = _plain(exponent, element, model)
    if n is None or (source is not None and source.was is not None):
        return
    if abs(n - Fraction(n).limit_denominator(12)) > 1e-9:
        yield path, f"is in {unit}; with an exponent of {n:g} it must be in SI: {needed}"


def _plain(value: Expression, element: Element, model: Model) -> float | None:
    """Return the value of a plain number or of one parameter, SI; None of anything else."""
    match value.tree:
        case Number(number) | Quantity(number, _):
            return number
        case Operation("neg", (Number(number) | Quantity(number, _),)):
            return -number
    parameter = _parameter(value, element, model)
    return None if parameter is None else parameter.si


def _parameter(value: Expression, element: Element, model: Model) -> Parameter | None:
    """Return the parameter that an expression is, the element's own before those of the model."""
    if not isinstance(value.tree, Name) or value.tree.order:
        return None
    name = value.tree.name
    every = (*element.parameters, *model.parameters)
    return next((parameter for parameter in every if parameter.name == name), None)


def _place_faults(
    element: Element, model: Model, scope: Scope, unreadable: frozenset[str]
) -> Iterator[Fault]:
    """An element must stand on a known coordinate or at known points."""
    path: Path = ("elements", element.name)
    match element.place:
        case On() as on:
            yield from _on_faults((*path, "on"), on, scope)
        case Between(first, second):
            for name in (first, second):
                yield from point_faults((*path, "between"), name, model, scope, unreadable)
        case At(point):
            yield from point_faults((*path, "at"), point, model, scope, unreadable)
        case Pair() as pair:
            for on in pair.each:
                yield from _on_faults((*path, "pair"), on, scope)


def _stretches(element: Element) -> tuple[On, ...]:
    """The stretches that the place of an element states."""
    match element.place:
        case On() as on:
            return (on,)
        case Pair() as pair:
            return pair.each
        case _:
            return ()


def _on_faults(path: Path, place: On, scope: Scope) -> Iterator[Fault]:
    """A coordinate must be known; an expression must contain one, and have a unit."""
    text = shorten(place.coordinate)
    if place.plain:
        if place.coordinate not in scope.coordinates:
            cure = did_you_mean(place.coordinate, sorted(scope.coordinates))
            yield path, f"'{text}' is not a known coordinate{cure}"
        return
    faults = list(expression_faults(path, place.expression, scope, PLACE, None))
    yield from faults
    if not faults and not place.names & scope.coordinates:
        yield path, f"'{text}' contains no coordinate; nothing moves there"
