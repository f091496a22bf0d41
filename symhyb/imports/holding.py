"""What closes loops and holds joints to others, as constraints of a model, and where it closes."""

from dataclasses import replace

import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.imports.draft import AXES, Draft, Names
from symhyb.imports.hanging import position
from symhyb.imports.reduction import Reduced
from symhyb.imports.robot import TURNED, Pin, Relation
from symhyb.model.constraints import Assembly, Constraint
from symhyb.model.expression import parse_expression
from symhyb.model.types import Model, Point

STEP, STEPS_MOST = 0.1, 200  # rad or m, from the place that is drawn to that which is asked for


def declare_pin(draft: Draft, pin: Pin) -> None:
    """Declare two points that are one."""
    stem = draft.names.held[pin.name]
    names = (f"{stem}_a", f"{stem}_b")
    for name, end in zip(names, pin.ends, strict=True):
        body = draft.names.links[end.link] if end.link else ""
        where = f"of {pin.name} in {end.link or 'the inertial axes'}"
        at = [
            draft.number(f"{name}_{axis}", value, "m", f"{axis} {where}")
            for axis, value in zip(AXES, end.at, strict=True)
        ]
        draft.points.append(Point(name, tuple(parse_expression(part) for part in at), body))
    draft.constraints.append(Constraint(stem, "pin", names))


def declare_relation(draft: Draft, relation: Relation, reduced: Reduced) -> None:
    """Declare that the position of a joint is a polynomial of that of another."""
    stem, joint, of = draft.names.held[relation.name], relation.joint, relation.of
    unit, other = relation.units
    held = _position(draft, stem, joint, unit, reduced)
    followed = _position(draft, stem, of, other, reduced) if of else ""
    terms = []
    for power, value in enumerate(relation.coefficients):
        about = f"{joint} per {of}^{power}" if power else f"{joint} where {of} is 0"
        per = f"/{other}^{power}" if power else ""
        size = draft.number(f"{stem}_c{power}", value, unit + per, about)
        if size != "0":
            terms.append(f"{size}*({followed})**{power}" if power else size)
    zero = parse_expression(" - ".join((held, *terms)))
    draft.constraints.append(Constraint(stem, "equation", (), (("zero", zero),)))


def _position(draft: Draft, stem: str, joint: str, unit: str, reduced: Reduced) -> str:
    """How far a joint is: an expression of a coordinate, or where it is locked."""
    for body in reduced.bodies:
        if body.joint.name == joint:
            return position(Draft(draft.names, draft.units), body)  # its parameters are declared
    return draft.number(f"{stem}_at", reduced.locked[joint], unit, f"where {joint} is locked")


def closed(
    model: Model, reduced: Reduced, names: Names, file: str
) -> tuple[Model, tuple[str, ...]]:
    """A model with starts at which its constraints hold, all of them stated, and notes on those
    that moved.

    Raises:
        InputError: constraints that cannot hold together, that lock, or that hold nothing.
    """
    if not model.constraints:
        return model, ()
    homes = {names.joints[body.joint.name]: body.joint.home for body in reduced.bodies if body.own}
    try:
        assembly = _assembled(model, [homes.get(c.name, c.start) for c in model.coordinates])
    except InputError as error:
        cure = 'active="false" in the MJCF opens a loop'
        problems = [Problem(f"{one.text}; {cure}", one.place, file) for one in error.problems]
        raise InputError(problems) from None
    starts = dict(zip((c.name for c in model.coordinates), assembly.q, strict=True))
    for body in reduced.bodies:
        if body.joint.kind in TURNED:  # a quaternion counts by its direction, which alone was moved
            parts = [f"{names.joints[body.joint.name]}_q{part}" for part in "wxyz"]
            size = np.linalg.norm([starts[part] for part in parts])
            starts |= {part: starts[part] / float(size) for part in parts}
    coordinates = [replace(c, start=starts[c.name], stated=("start",)) for c in model.coordinates]
    return replace(model, coordinates=tuple(coordinates)), assembly.moves


def _assembled(model: Model, drawn: list[float]) -> Assembly:
    """Where a model with constraints closes that is moved from where it is ``drawn`` (n,), SI, to
    its starts, in small steps, so that it stays assembled in the way that is drawn."""
    from symhyb.numeric.lowered.assembly import assembled  # CasADi takes half a second to import

    starts, now = [c.start for c in model.coordinates], drawn
    steps = 1 + min(STEPS_MOST, int(np.abs(np.subtract(starts, drawn)).max() / STEP))
    for step in range(1, steps + 1):
        wanted = np.array(drawn) + step / steps * np.subtract(starts, drawn)
        coordinates = [
            replace(c, start=float(to) if c.stated else was)
            for c, to, was in zip(model.coordinates, wanted, now, strict=True)
        ]
        found = assembled(replace(model, coordinates=tuple(coordinates)))
        now = list(found.start()[0])
    assert found.assembly is not None
    return found.assembly
