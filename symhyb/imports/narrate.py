"""The comments of a model file that was written from a robot: what hangs where, what was changed,
and what the file of the robot does not say."""

from collections.abc import Iterator, Sequence
from textwrap import wrap

from symhyb.imports.declare import Declared
from symhyb.imports.draft import AXES
from symhyb.imports.reduction import Moved, Reduced
from symhyb.imports.rigid import SAME
from symhyb.imports.robot import TURNED, Robot
from symhyb.model.render import Comments

WIDTH = 96  # letters of a line of a comment
SHOWN = 12  # links of one body, and joints that are locked, by name
DEEP = 12  # levels by which the tree is indented


def comments(robot: Robot, reduced: Reduced, declared: Declared) -> Comments:
    """Comments by the place above which they stand."""
    said: dict[str, Sequence[str]] = {"": tuple(_head(robot, reduced, declared))}
    for body in reduced.bodies:
        group = declared.groups[body.name]
        if group:
            joint = f"joint {body.joint.name} ({body.joint.kind})"
            said[f"parameters.{group[0]}"] = (f"{body.name}, behind the {joint}",)
        if body.links:
            text = f"rigid with it: {_listed(body.links)}"
            said[f"bodies.{declared.names.links[body.name]}"] = tuple(wrap(text, WIDTH))
    if declared.model.points:
        text = "ends of what is rigid with a body, or marked places: a payload is looked for there"
        said["points"] = (text,)
    for constraint in declared.model.constraints:
        said[f"constraints.{constraint.name}"] = ("holds exactly; in MuJoCo by a soft force",)
    if declared.groups.get(""):
        said[f"parameters.{declared.groups[''][0]}"] = ("what holds bodies and joints to others",)
    if reduced.bodies:
        said["sensors"] = ("state sd, one standard deviation of the noise, where it is known",)
        said["inputs"] = tuple(_of_inputs(robot))
    return said


def notes(robot: Robot, reduced: Reduced, declared: Declared) -> tuple[str, ...]:
    """What a model file says otherwise than the file of the robot; what stands on the ground is not
    part of it."""
    renamed = tuple(
        f"the {kind} '{old}' is called {new} here" for kind, old, new in declared.names.changed
    )
    read = (said for about, said in robot.notes if about not in reduced.grounded)
    return (*read, *reduced.notes, *renamed)


def _head(robot: Robot, reduced: Reduced, declared: Declared) -> Iterator[str]:
    count = len(declared.model.coordinates)
    source = f"{_article(robot)} {robot.source}"
    yield f"{robot.name}, from {source} with {len(robot.links)} links: {count} coordinates"
    yield ""
    yield from _tree(robot, reduced)
    yield ""
    yield from wrap(
        "Lengths in m, angles in rad; the origin of each body is its joint, its axes are those of "
        "the link. A body holds the links that are rigid with it. Gravity acts along -z.",
        WIDTH,
    )
    if reduced.locked:
        places = [f"{name} at {value:g}" for name, value in reduced.locked.items()]
        yield from wrap(f"Locked: {_listed(places)}.", WIDTH)
    noted = notes(robot, reduced, declared)
    if noted:
        yield ""
        yield f"Otherwise than in the {robot.source}:"
        for note in noted:
            yield from wrap(note, WIDTH - 2, initial_indent="- ", subsequent_indent="  ")
    yield ""
    yield from wrap(
        f"What {source} does not say: how well its numbers are known (give a parameter sd "
        f"= one standard deviation, and it may be estimated){_of_rotors(robot)}.",
        WIDTH,
    )


def _of_rotors(robot: Robot) -> str:
    if any(joint.armature for joint in robot.joints):
        return ""
    return (
        ", and the rotors of the motors. A rotor of inertia J behind a gear of ratio n adds n**2*J "
        "to its joint: an element of the kind added_mass on that coordinate"
    )


def _tree(robot: Robot, reduced: Reduced) -> Iterator[str]:
    """One line for each body, indented under its carrier."""
    depth = {"": 0}
    count = len(reduced.grounded)
    more = f", with {count - 1} more links that do not move" if count > 1 else ""
    yield f"ground: {robot.root}{more}" if count else "ground"
    for body in reduced.bodies:
        depth[body.name] = depth[body.carrier] + 1
        indent = "   " * min(depth[body.name] - 1, DEEP)
        yield f"{indent}`- {body.joint.name}, {_motion(body)}: {body.name}"


def _motion(body: Moved) -> str:
    joint = body.joint
    if joint.kind in TURNED:
        return joint.kind
    along = [k for k in range(3) if abs(joint.axis[k]) >= SAME]
    sign = "-" if len(along) == 1 and joint.axis[along[0]] < 0 else ""
    axis = (
        sign + AXES[along[0]]
        if len(along) == 1
        else f"({', '.join(f'{a:.4g}' for a in joint.axis)})"
    )
    word = {"prismatic": "along", "planar": "across"}.get(joint.kind, "about")
    said = f"{joint.kind} {word} {axis}"
    if body.drive is not None and not body.own:
        offset = f" + {body.drive.offset:g}" if body.drive.offset else ""
        said += f", {body.drive.ratio:g}*{body.drive.joint}{offset}"
    return said


def _of_inputs(robot: Robot) -> Iterator[str]:
    yield "what acts on the joint: behind the gear, in N*m or N"
    gears = [f"{name} {ratio:g}" for name, ratio in robot.gears.items() if ratio != 1]
    if gears:
        yield from wrap(f"Ratios of gears in the {robot.source}: {_listed(gears)}.", WIDTH)


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more


def _article(robot: Robot) -> str:
    return "an" if robot.source == "MJCF" else "a"
