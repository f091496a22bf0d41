"""The closed vocabulary of elements: kinds of force laws, and the units of their keys at a place.

The same vocabulary serves people who write a model and the diagnosis that looks for what is
missing; each kind is one file of :mod:`symhyb.laws`. With s the stretch of a place and s' its rate,
*passive* kinds resist,

    Q = −(∂s/∂q)ᵀ F(s, s')        a tension pulls:   a o──▶ F    F ◀──o b

and *active* kinds push: Q = +F on a coordinate, a tension between two points, a vector at a point.
"""

from collections.abc import Mapping
from fractions import Fraction

from symhyb.laws import LAWS
from symhyb.laws.base import Key, Law, Placement, State
from symhyb.laws.curve import SPEED_POWERS
from symhyb.model.expression import Expression, parse_expression
from symhyb.model.scope import scope_of, unit_in
from symhyb.model.types import At, Between, Element, Model, On, Pair, Place
from symhyb.units import ONE, Unit, parse_unit

KINDS: Mapping[str, Law] = {law.name: law for law in LAWS}

Words = tuple[tuple[str, str], ...]
# unit of a mass by the unit of force, and by the power of the stretch in the key
_INERTIA = {("N", -1): "kg", ("N*m", -1): "kg*m^2", ("N", 1): "kg*m^2"}


def key_of(kind: str, key: str) -> Key | None:
    """The key of a kind by its name; None of what is no kind, or has no such key."""
    law = KINDS.get(kind)
    return None if law is None else law.key(key)


def expressed(kind: str, options: Words) -> tuple[tuple[str, Expression], ...]:
    """Those of the ``options`` of a cause that are expressions of an element (a ``load``)."""
    return tuple((key, parse_expression(word)) for key, word in options if _signal(kind, key))


def worded(kind: str, options: Words) -> Words:
    """Those of the ``options`` of a cause that are words of an element (a ``side``)."""
    return tuple((key, word) for key, word in options if not _signal(kind, key))


def said_of(element: Element) -> Words:
    """The words of an element, and its expressions beside its strengths, as a cause has them."""
    law = KINDS[element.kind]
    given = [(key, value.text) for key, value in element.values if _signal(element.kind, key)]
    return (*element.options, *(pair for pair in given if pair[0] not in law.strengths))


def _signal(kind: str, key: str) -> bool:
    declared = key_of(kind, key.split(".")[0])
    return declared is not None and declared.signal


def memories(model: Model) -> tuple[tuple[Element, State], ...]:
    """Every inner state with the element that it belongs to, in the order of z."""
    return tuple((one, state) for one in model.elements for state in KINDS[one.kind].states)


def steep(model: Model) -> bool:
    """Whether any law of a model needs finer steps near reversals."""
    return any(KINDS[element.kind].steep for element in model.elements)


def placement_of(place: Place) -> Placement:
    """Return the key under which the file writes this kind of place."""
    match place:
        case On():
            return "on"
        case Between():
            return "between"
        case At():
            return "at"
        case Pair():
            return "pair"


def stretch_unit(model: Model, place: Place) -> Unit:
    """Return the unit of s: m along any length, rad on any angle, else the coordinate's own (V); of
    a pair that of its first stretch.

    An expression of angles that has no dimension is an angle: ``phi - ratio*psi``.

    Raises:
        LookupError: a place on unknown names, or of units that do not fit.
    """
    if isinstance(place, Pair):
        return stretch_unit(model, place.each[0])
    if not isinstance(place, On):
        return parse_unit("m")
    units = {c.name: c.unit for c in model.coordinates}
    scope = scope_of(model)
    unit = units[place.coordinate] if place.plain else unit_in(place.expression, scope)
    if unit is None or place.names & scope.inputs:
        raise LookupError(place.coordinate)
    angles = any(units[name].is_angle for name in place.names & units.keys())
    if unit.is_number and angles:
        return parse_unit("rad")
    return parse_unit("m") if unit.same_dimension(parse_unit("m")) else unit


def force_unit(model: Model, place: Place) -> Unit:
    """Return the unit of F: N along a length, N*m on an angle, else energy over coordinate."""
    stretch = stretch_unit(model, place)
    if stretch.text == "m":
        return parse_unit("N")
    if stretch.text == "rad":
        return parse_unit("N*m")
    return model.energy_unit / stretch


def curve_units(model: Model, place: Place, options: Words) -> tuple[Unit, Unit]:
    """The units of x and of F of a ``curve`` at a place: of one that is a factor of the speed F is
    a damping or a drag.

    Raises:
        LookupError: as :func:`stretch_unit`.
    """
    stretch, force, words = stretch_unit(model, place), force_unit(model, place), dict(options)
    power = SPEED_POWERS[words.get("times", "")]
    along = stretch / parse_unit("s") if words.get("over") == "rate" else stretch
    return along, _product((force, 1), (parse_unit("s"), power), (stretch, -power))


def map_units(model: Model, place: Place) -> tuple[Unit, Unit, Unit]:
    """The units of stretch, rate and F of a ``map`` at a place.

    Raises:
        LookupError: as :func:`stretch_unit`.
    """
    stretch = stretch_unit(model, place)
    return stretch, stretch / parse_unit("s"), force_unit(model, place)


def key_unit(
    model: Model, element_kind: str, key: str, place: Place, exponent: float = 1.0
) -> Unit:
    """Return the unit that a key of a kind has at a place, as readable text (``N*s^2/m^2``).

    ``force.x`` and ``force.y`` are components of a force at a point (in space a torque may stand
    there too); ``exponent`` is the n of a hysteresis, on which the units of its beta and gamma
    depend: no unit has finer powers than twelfths, so an n between them (1.37) takes the nearest,
    and the number counts in SI.

    Raises:
        KeyError: an unknown kind or key.
    """
    declared = KINDS[element_kind].key(key.split(".")[0])
    if declared is None:
        raise KeyError(f"{element_kind} has no key '{key}'")
    if isinstance(place, Pair):
        return _pair_unit(model, place, declared)
    force, stretch = force_unit(model, place), stretch_unit(model, place)
    if element_kind == "torque" and isinstance(place, At):
        return parse_unit("N*m")
    if declared.inertia and (force.text, declared.stretch) in _INERTIA:
        return parse_unit(_INERTIA[force.text, declared.stretch])
    n = Fraction(exponent).limit_denominator(12) if declared.exponent else Fraction(1)
    along = declared.stretch * n
    return _product((force, declared.force), (parse_unit("s"), declared.time), (stretch, along))


def _pair_unit(model: Model, place: Pair, key: Key) -> Unit:
    """The unit of a key of a coupling: the force on one over the stretch of the other, which is the
    same both ways; N between a length and an angle."""
    first, second = place.each
    if stretch_unit(model, first).text == "rad":
        first, second = second, first
    force, stretch = force_unit(model, first), stretch_unit(model, second)
    return _product((force, key.force), (parse_unit("s"), key.time), (stretch, key.stretch))


def _product(*parts: tuple[Unit, Fraction | int]) -> Unit:
    """The product of powers of units, in this order."""
    unit = ONE
    for part, power in parts:
        unit = unit * part**power
    return unit
