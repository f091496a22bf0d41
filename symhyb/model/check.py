"""Check what a model says: names, places, signs, and the unit of every expression."""

from collections.abc import Iterator

from symhyb.model.check_constraints import constraint_faults
from symhyb.model.check_elements import element_faults
from symhyb.model.check_states import state_faults
from symhyb.model.expression import RESERVED, Expression, Name, Number, Quantity, names
from symhyb.model.fmu import fmu_faults, mass_faults
from symhyb.model.frames import frame_faults, place_unit
from symhyb.model.limits import limit_faults
from symhyb.model.mujoco import reserved, unit_faults
from symhyb.model.scope import (
    GRAVITY,
    KINETIC,
    MASS,
    POSITION,
    POTENTIAL,
    Scope,
    expression_faults,
    scope_of,
    shared_names,
    unit_in,
    vector_faults,
    vector_unit,
)
from symhyb.model.sensing import sensor_faults
from symhyb.model.source import Path
from symhyb.model.space import dimension, space_faults
from symhyb.model.tables import Fault, shorten
from symhyb.model.types import Body, Energy, Model
from symhyb.model.vocabulary import KINDS
from symhyb.units import ONE, Unit, UnitError, parse_unit


def energy_unit(model: Model, unreadable: frozenset[str]) -> tuple[Unit | None, list[Fault]]:
    """Return the unit of T and V, None where it cannot be known.

    J as soon as a coordinate is a length or an angle or a body has its place in lengths. Else it
    follows from the first mass · place² / s², or from the energies that are stated. A model needs
    no mass where every motion is imposed.
    """
    scope = scope_of(model, unreadable)
    metre, second = parse_unit("m"), parse_unit("s")
    unread = any(name.startswith(("bodies.", "energy.")) for name in unreadable)
    if model.engine is not None:
        return parse_unit("J"), []
    heavy = model.bodies or any(KINDS[element.kind].inertial for element in model.elements)
    moved = model.coordinates and all(coordinate.imposed for coordinate in model.coordinates)
    if not heavy and not moved and model.energy.kinetic is None and not unread:
        return None, [(("bodies",), "nothing has a mass; add a body or a kinetic energy")]
    places = [place_unit(body, scope) for body in model.bodies]
    units = [coordinate.unit for coordinate in model.coordinates]
    spatial = dimension(model) == 3
    if any(unit.is_angle or unit.same_dimension(metre) for unit in units) or any(
        spatial or (unit is not None and unit.same_dimension(metre)) for unit in places
    ):
        return parse_unit("J"), []
    for body, place in zip(model.bodies, places, strict=True):
        mass = unit_in(body.mass, scope)
        if mass is not None and place is not None:
            try:
                return mass * place**2 / second**2, []
            except UnitError as error:
                return None, [(("bodies", body.name, "at"), f"gives no unit of energy: {error}")]
    stated = (model.energy.kinetic, model.energy.potential)
    found = (unit_in(energy, scope) for energy in stated if energy is not None)
    return next((unit for unit in found if unit is not None), None), []


def faults_of(model: Model, energy: Unit | None, unreadable: frozenset[str]) -> Iterator[Fault]:
    """Yield everything that is wrong in a model whose tables could be read.

    ``energy`` is the unit of energies, None where it cannot be known: what depends on it is then
    not checked. An expression with an unreadable name is not checked for units.
    """
    scope = scope_of(model, unreadable)
    yield from _name_faults(model)
    if model.fmu is not None:
        yield from fmu_faults(*_beside_engine(model))
        yield from mass_faults(model.fmu, {one.name: one.unit for one in model.coordinates})
    if model.mujoco is not None:
        yield from reserved(*_beside_engine(model))
        kinds = (model.coordinates, model.inputs, model.parameters)
        coordinates, inputs, numbers = ({one.name: one.unit for one in kind} for kind in kinds)
        yield from unit_faults(model.mujoco, coordinates, inputs, numbers)
    yield from frame_faults(model, scope, unreadable)
    yield from _energy_faults(model, scope, energy)
    for body in model.bodies:
        yield from _body_faults(body, model, scope, energy)
    yield from space_faults(model, scope, _mass_unit(energy, ONE))
    for state in model.states:
        yield from state_faults(state, scope)
    for constraint in model.constraints:
        yield from constraint_faults(constraint, model, scope, unreadable)
    for element in model.elements:
        yield from element_faults(element, model, scope, energy, unreadable)
    for sensor in model.sensors:
        yield from sensor_faults(sensor, model, scope, energy, unreadable)
    units = {coordinate.name: coordinate.unit for coordinate in model.coordinates}
    units |= {item.name: item.unit for item in model.inputs}
    for limit in model.limits:
        yield from limit_faults(limit, units)


def _beside_engine(model: Model) -> tuple[list[str], list[str]]:
    """The sections that say something an FMU or MuJoCo says, and the imposed coordinates."""
    said = {
        "gravity": model.gravity is not None,
        "bodies": bool(model.bodies),
        "energy": model.energy != Energy(),
        "constraints": bool(model.constraints),
    }
    imposed = [c.name for c in model.coordinates if c.imposed]
    return [key for key, there in said.items() if there], imposed


def _name_faults(model: Model) -> Iterator[Fault]:
    """Names that are reserved, used twice, or lead to the same path of a parameter."""
    seen: dict[str, str] = {}
    for section, values in shared_names(model):
        for value in values:
            name = value.name
            if name in RESERVED:
                yield (section, name), f"'{name}' is a reserved name; choose another"
            elif name in seen:
                yield (section, name), f"'{name}' is already declared in [{seen[name]}]"
            seen.setdefault(name, section)
    for sensor in model.sensors:
        if sensor.name == "t":
            yield ("sensors", "t"), "'t' is the time column of a recording; choose another name"
    for element in model.elements:
        for own in element.parameters:
            path = ("elements", element.name, "parameters", own.name)
            if own.name in RESERVED:
                yield path, f"'{own.name}' is a reserved name; choose another"
            elif seen.get(own.name) in ("coordinates", "states", "inputs"):
                yield path, f"'{own.name}' is already declared in [{seen[own.name]}]"
    paths = [parameter.path for parameter in model.all_parameters()]
    for channel in model.sensors:
        for fault in channel.numbers:
            if paths.count(fault.path) > 1:
                place = ("sensors", channel.name, fault.name)
                yield place, f"another '{fault.path}' is stated elsewhere; rename the sensor"


def _energy_faults(model: Model, scope: Scope, energy: Unit | None) -> Iterator[Fault]:
    """Gravity and the energies that bodies cannot say."""
    if model.gravity is not None:
        yield from vector_faults(("gravity",), model.gravity, scope, GRAVITY)
        place = next((place_unit(body, scope) for body in model.bodies), None)
        needed = place and place / parse_unit("s^2")
        unit = vector_unit(model.gravity, scope)
        if unit is not None and needed is not None and not unit.same_dimension(needed):
            yield ("gravity",), f"is {unit}, needs {needed}"
    if model.energy.kinetic is not None:
        path = ("energy", "kinetic")
        yield from expression_faults(path, model.energy.kinetic, scope, KINETIC, energy)
    if model.energy.potential is not None:
        path = ("energy", "potential")
        yield from expression_faults(path, model.energy.potential, scope, POTENTIAL, energy)


def _body_faults(body: Body, model: Model, scope: Scope, energy: Unit | None) -> Iterator[Fault]:
    place = ("bodies", body.name)
    if body.joint is None and body.at not in [point.at for point in model.points]:
        yield from vector_faults((*place, "at"), body.at, scope, POSITION)
    needed = None
    try:
        needed = _mass_unit(energy, place_unit(body, scope))
    except UnitError as error:
        yield (*place, "at"), f"gives no unit of energy: {error}"
    yield from expression_faults((*place, "mass"), body.mass, scope, MASS, needed)
    if not (_is_zero(body.mass) and _acts_without_mass(body, model)):
        yield from _sign_faults((*place, "mass"), body.mass, model)
    moving = sorted({name.name for name in names(body.mass)} & scope.coordinates)
    if moving and model.gravity is not None:
        text = f"'{shorten(body.mass.text)}' depends on the place {moving[0]}, and gravity acts"
        cure = "write kinetic and potential energy under [energy], which say it"
        yield (*place, "mass"), f"{text}: at which height is what comes and goes? {cure}"
    if body.angle is not None:
        yield from expression_faults((*place, "angle"), body.angle, scope, POSITION, ONE)
    if body.inertia is not None:
        needed = _mass_unit(energy, ONE)
        yield from expression_faults((*place, "inertia"), body.inertia, scope, MASS, needed)
        yield from _sign_faults((*place, "inertia"), body.inertia, model)


def _mass_unit(energy: Unit | None, place: Unit | None) -> Unit | None:
    """Return what makes mass · place² / s² an energy: kg at a length, kg*m^2 on an angle."""
    if energy is None or place is None:
        return None
    base = parse_unit("kg*m^2/s^2") if energy.same_dimension(parse_unit("J")) else energy
    if place.same_dimension(parse_unit("m")):
        place = parse_unit("m")
    return base * parse_unit("s^2") / place**2


def _is_zero(mass: Expression) -> bool:
    return isinstance(mass.tree, Number | Quantity) and mass.tree.value == 0


def _acts_without_mass(body: Body, model: Model) -> bool:
    """Whether a body hangs and is of use with a mass of 0: it carries others, or has inertia."""
    turns = body.inertia is not None or bool(body.tensor)
    carries = any(other.parent == body.name for other in model.bodies)
    return body.joint is not None and (turns or carries)


def _sign_faults(path: Path, mass: Expression, model: Model) -> Iterator[Fault]:
    """A mass that is one plain number or parameter must be positive."""
    if _is_zero(mass):
        yield path, "is 0; it must be positive"
    if isinstance(mass.tree, Name):
        for parameter in model.parameters:
            if parameter.name == mass.tree.name and parameter.value <= 0:
                value = f"'{parameter.name}' is {parameter.value:g} {parameter.unit}"
                yield path, f"{value}; it must be positive"
