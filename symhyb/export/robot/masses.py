r"""What a model says of the masses of a robot: how far links differ from what its file states.

Bodies are compared by P = ∫ (r, 1)(r, 1)ᵀ dm (4, 4) about the origin of the body, in its axes. It
adds up over all that is rigid with the body:

    P(model) = the numbers of the body + what its points carry + bodies that are fixed to it
    P(file)  = the numbers that an import of the file gives the body
    P(link) += T⁻¹ (P(model) − P(file)) T⁻ᵀ         with T (4, 4), where the link lies in the body

The link that the joint carries takes the difference, or the first other one of the body that can:
its mass then is not negative, and its inertia is that of a body.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from symhyb.export.robot.counterpart import Counterpart, adrift, before_estimation
from symhyb.export.robot.rigid_parts import own, rigid_with
from symhyb.imports.reduction import Moved
from symhyb.imports.rigid import (
    Pose,
    from_pseudo_inertia,
    here,
    is_of_a_body,
    pseudo_inertia,
)
from symhyb.imports.robot import Array, Inertial, Robot
from symhyb.model.types import Body, Model

NEAR = 1e-9  # of what a body has: the same but for rounding


@dataclass(frozen=True, slots=True, eq=False)
class Masses:
    """What links get: their ``inertials`` by name. ``refused`` says by the link that carries a body
    why its change has no place, ``notes`` what could not be compared; ``taken`` are the elements
    that are part of the inertials."""

    inertials: Mapping[str, Inertial]
    refused: Mapping[str, str]
    notes: tuple[str, ...] = ()
    taken: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, eq=False)
class _Change:
    """What a body by the ``name`` of the link that carries it has ``more`` (4, 4) than the file
    says, and the ``links`` that could take it, each with its pose in the body."""

    name: str
    more: Array
    links: Mapping[str, Pose]


def masses_of(model: Model, robot: Robot, base: Counterpart | None) -> Masses:
    """The inertials that links need so that an import finds the masses of the model: ``base`` is
    the import of the file as it is."""
    if model.mujoco is not None:
        return _placed(_of_mujoco(model, robot), robot)
    known = set(model.bodies.names())
    if base is None or not any(body.name in known for body in base.declared.model.bodies):
        said = "masses are not written: the model has none of the bodies that an import would make"
        return Masses({}, {}, (said,) if model.bodies else ())
    parts, notes = rigid_with(model, base.declared.model)
    changes: list[_Change] = []
    taken: set[str] = set()
    for moved in base.reduced.bodies:
        body = base.body(moved)
        if body is None:
            continue
        part = parts[body.name]
        if body.name not in known or _hangs(model.bodies[body.name]) != _hangs(body):
            notes.append(f"{moved.name}: mass not written, the body does not hang as in an import")
        elif part.total is None:
            notes.append(f"{moved.name}: mass not written, it is no constant")
        else:
            taken |= part.carried
            stated, note = _stated(moved, body, model, base, robot)
            notes += note
            if not same(part.total, stated):
                more = part.total - stated + _filled(moved, robot)
                changes.append(_Change(moved.name, more, _able(moved, base, robot)))
    done = _placed(changes, robot)
    return replace(done, notes=tuple(notes), taken=frozenset(taken))


def _hangs(body: Body) -> tuple[object, ...]:
    return body.parent, body.joint, body.turned


def _able(moved: Moved, base: Counterpart, robot: Robot) -> Mapping[str, Pose]:
    """The links of a body whose pose in it is known."""
    loose = adrift(base.reduced, robot)
    return {link: pose for link, pose in moved.poses.items() if link not in loose}


def _stated(
    moved: Moved, body: Body, model: Model, base: Counterpart, robot: Robot
) -> tuple[Array, list[str]]:
    """P (4, 4) of a body as the file has it, and a note.

    Where a link hangs on a joint that is locked, at a position that no model file states, these are
    the values from before the diagnosis.
    """
    imported = own(body, base.declared.model)
    assert imported is not None  # all its numbers are parameters
    able = _able(moved, base, robot)
    if all(link in able or robot.links[link].inertial is None for link in moved.links):
        return imported, []
    before = own(model.bodies[body.name], before_estimation(model))
    assert before is not None  # as it is a constant now
    if abs(before[3, 3] - imported[3, 3]) <= NEAR * imported[3, 3]:
        return before, []
    said = "it holds joints that are locked, so that only what was estimated or added is written"
    return before, [f"{moved.name}: {said}"]


def _filled(moved: Moved, robot: Robot) -> Array:
    """What an import adds to the links of a body: inertia, where a mass has none."""
    links = (
        pose.matrix @ of_inertial(robot.links[link].inertial) @ pose.matrix.T
        for link, pose in moved.poses.items()
    )
    return of_inertial(moved.inertial) - sum(links, np.zeros((4, 4)))


def _of_mujoco(model: Model, robot: Robot) -> Iterator[_Change]:
    """Masses that are parameters of a machine that MuJoCo has: as there, inertias about the centre
    stay."""
    assert model.mujoco is not None
    values = {one.path: one.si for one in model.parameters}
    for one in model.mujoco.parameters:
        old = robot.links[one.part].inertial if one.part in robot.links else None
        if one.kind != "body" or old is None:
            continue
        new = pseudo_inertia(replace(old, mass=values[one.parameter]))
        if not same(new, pseudo_inertia(old)):
            yield _Change(one.part, new - pseudo_inertia(old), {one.part: here()})


def _placed(changes: Iterable[_Change], robot: Robot) -> Masses:
    """Each change at the first link that can take it."""
    inertials: dict[str, Inertial] = {}
    refused: dict[str, str] = {}
    for change in changes:
        for name, pose in change.links.items():
            back = np.linalg.inv(pose.matrix)
            whole = of_inertial(robot.links[name].inertial) + back @ change.more @ back.T
            new = from_pseudo_inertia(whole)
            possible = new.mass >= 0 and is_of_a_body(new.tensor)
            point = robot.source == "MJCF" and not new.tensor.any()  # MuJoCo takes none
            if possible and not point and same(whole, pseudo_inertia(new)):
                inertials[name] = new
                break
        else:
            moments = ", ".join(f"{part:.6g}" for part in change.more[:3, 3])
            refused[change.name] = (
                f"{change.more[3, 3]:.6g} kg more, with first moments of ({moments}) kg*m: a mass "
                "would be negative, or an inertia that of no body"
            )
    return Masses(inertials, refused)


def of_inertial(inertial: Inertial | None) -> Array:
    """P (4, 4), SI, of a link; 0 of one that states nothing."""
    return np.zeros((4, 4)) if inertial is None else pseudo_inertia(inertial)


def same(one: Array, other: Array) -> bool:
    """Whether two P (4, 4), SI, are the same but for rounding, each entry by what a body of that
    mass and extent can have."""
    sizes = [
        np.sqrt([max(np.trace(p[:3, :3]), 0.0)] * 3 + [max(p[3, 3], 0.0)]) for p in (one, other)
    ]
    size = np.maximum(*sizes)
    return bool((np.abs(one - other) <= NEAR * np.outer(size, size)).all())
