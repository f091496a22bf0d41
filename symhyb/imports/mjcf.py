"""Read an MJCF, the model of MuJoCo: bodies, joints, and what their dynamics states.

MuJoCo itself reads the file, in a process of its own with limits, and its compiled model is what
counts: defaults, angles in degrees, Euler sequences and inertias of plain shapes are its work.
Meshes are removed before, and no file that an MJCF names is opened.

A hinge about an anchor that is not the origin of its body moves the body's origin there:

    body o───────● anchor            the link has its origin at the anchor, which stays in place
"""

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from symhyb.data.files.apart import read_apart
from symhyb.data.files.extras import needed
from symhyb.data.files.table import Column, Table
from symhyb.data.files.xml_file import parse_xml
from symhyb.data.hosts.mjcf_file import ROOT, WEIGHS, problems_of, stripped
from symhyb.errors import InputError, Problem, visible
from symhyb.imports.compiled import Compiled, unused
from symhyb.imports.equalities import Held, equalities
from symhyb.imports.rigid import Pose, about_vector, from_quaternion, here, to_rpy
from symhyb.imports.robot import Array, Inertial, Joint, Link, Pin, Range, Robot, Site

_BODIES = ("body_parentid", "body_pos", "body_quat", "body_mass", "body_ipos", "body_iquat")
_ARRAYS = (
    *_BODIES,
    *("body_inertia", "body_jntnum", "body_jntadr", "jnt_type", "jnt_pos", "jnt_axis"),
    *("jnt_qposadr", "jnt_dofadr", "jnt_range", "jnt_limited", "jnt_stiffness", "qpos0"),
    *("qpos_spring", "dof_damping", "dof_frictionloss", "dof_armature", "eq_type", "eq_objtype"),
    *("eq_obj1id", "eq_obj2id", "eq_data", "eq_active0", "actuator_trntype", "actuator_trnid"),
    *("actuator_gear", "actuator_armature", "actuator_damping", "body_mocapid", "site_bodyid"),
    *("site_pos", "site_quat", "jnt_actfrclimited", "jnt_actfrcrange", "actuator_forcelimited"),
    *("actuator_forcerange", "actuator_ctrllimited", "actuator_ctrlrange", "actuator_gaintype"),
    *("actuator_gainprm", "actuator_biastype"),
)
_KINDS = {0: "floating", 1: "ball", 2: "prismatic", 3: "revolute"}
_AT_JOINT = (0, 1)  # the types of an actuator that acts on a joint
_FIXED, _NONE = 0, 0  # the types of gain and bias of a motor


def parse_mjcf(data: bytes, file: str = "") -> Robot:
    """Read an MJCF from its bytes.

    Raises:
        InputError: what MuJoCo says of it, or that it includes other files.
    """
    root = parse_xml(data, file)
    problems = list(problems_of(root, file))
    if problems:
        raise InputError(problems)
    table = read_apart(compiled, data, file)
    return _robot(Compiled.of(table), file)


def compiled(content: bytes, file: str) -> Table:
    """The arrays of MuJoCo's compiled model, as columns with their names; runs in a process of its
    own.

    Raises:
        InputError: MuJoCo is not installed, or refuses the model.
    """
    mujoco = needed("mujoco", "mjcf", file)
    try:
        spec = mujoco.MjSpec.from_string(content.decode("utf-8-sig"))
        heavy = stripped(mujoco, spec)
        model = None if heavy else spec.compile()
    except (ValueError, RuntimeError, TypeError) as error:
        said = " ".join(visible(str(error)).split())
        raise InputError(Problem(f"MuJoCo says: {said}", file=file)) from None
    if model is None:
        raise InputError([Problem(WEIGHS, f"body.{name}", file) for name in heavy])
    columns = [Column(name, np.asarray(getattr(model, name), float)) for name in _ARRAYS]
    columns.append(Column("gravity", np.asarray(model.opt.gravity, float)))
    words = {
        "name": spec.modelname,
        "bodies": [model.body(k).name for k in range(model.nbody)],
        "joints": [model.joint(k).name for k in range(model.njnt)],
        "sites": [model.site(k).name for k in range(model.nsite)],
        "equalities": [model.eq(k).name for k in range(model.neq)],
        "left_out": list(_left_out(model)),
    }
    return Table(file, tuple(columns), (json.dumps(words),))


def _left_out(model: Any) -> Iterator[str]:
    """What acts in MuJoCo's model and not in a model file that is made of it."""
    many = np.isin(model.jnt_type[model.dof_jntid], (0, 1))  # speeds of free and ball joints
    losses = np.abs([model.dof_damping, model.dof_frictionloss, model.dof_armature]).sum(axis=0)
    targets = zip(model.actuator_trntype, model.actuator_trnid[:, 0], strict=True)
    at_one = [k in _AT_JOINT and model.jnt_type[joint] not in (0, 1) for k, joint in targets]
    motors = np.abs([model.actuator_damping, model.actuator_armature]).sum(axis=0)
    acting = (
        ("damping, friction and armature of ball and free joints", losses[many].any()),
        (
            "damping and armature of actuators that act on no hinge or slide",
            motors[np.logical_not(at_one)].any(),
        ),
        ("delays of actuators", model.actuator_delay.any()),
        ("tendons", model.ntendon),
        ("flexible bodies", model.nflex),
        ("gravity compensation", model.body_gravcomp.any()),
        ("the medium around", model.opt.density or model.opt.viscosity),
        ("polynomials of springs", model.jnt_stiffnesspoly.any()),
        ("polynomials of dampers", model.dof_dampingpoly.any() or model.actuator_dampingpoly.any()),
    )
    yield from (f"left out: {what}" for what, there in acting if there)


def _robot(model: Compiled, file: str) -> Robot:
    """The tree of links: one for each body, and one without mass between two joints of a body."""
    parents, origins = model.arrays["body_parentid"], {0: (ROOT, here())}
    links, joints, taken = {ROOT: Link(ROOT)}, [], {*model.bodies, *model.joints}
    held = equalities(model)
    notes = [("", text) for text in (*held.notes, *model.left_out)]
    for number in range(1, len(model.bodies)):
        name = model.bodies[number]
        parent, shift = origins[int(parents[number])]
        pose = shift.then(_pose(model, "body_pos", "body_quat", number))
        mine = range(
            model.index("body_jntadr", number),
            model.index("body_jntadr", number) + model.index("body_jntnum", number),
        )
        for place, one in enumerate(mine):
            last = place == len(mine) - 1
            child = name if last else unused(f"{name}_{model.joints[one]}", taken)
            joint, pose = _joint(model, one, parent, child, pose, held)
            joints.append(joint)
            links.setdefault(child, Link(child))
            parent = child
        if not len(mine):
            joints.append(_tied(unused(f"{name}_fixed", taken), parent, name, pose))
            parent, pose = name, here()
        origins[number] = parent, pose
        links[name] = Link(name, _inertial(model, number, pose), origin=_three(pose.at))
    driven = _driven(model)
    gravity = _three(model.arrays["gravity"])
    return Robot(
        model.name or "robot",
        ROOT,
        links,
        tuple(joints),
        file,
        notes=tuple(notes),
        gravity=gravity,
        driven=driven,
        source="MJCF",
        sites=tuple(_sites(model, links, origins)),
        pins=tuple(_pins(held, origins)),
        relations=tuple(held.relations),
    )


def _sites(
    model: Compiled, links: Mapping[str, Link], origins: Mapping[int, tuple[str, Pose]]
) -> Iterator[Site]:
    """The sites on links that bodies have their ``origins`` in, with names of no link."""
    taken = set(links)
    for number, name in enumerate(model.sites):
        link, pose = origins[model.index("site_bodyid", number)]
        at = pose.turned @ model.arrays["site_pos"][number] + pose.at
        yield Site(unused(name, taken), link, _three(at))


def _pins(held: Held, origins: Mapping[int, tuple[str, Pose]]) -> Iterator[Pin]:
    """The pins between links that bodies have their ``origins`` in."""
    for name, ends in held.pins.items():
        first, second = (
            Site(name, link, _three(pose.turned @ at + pose.at))
            for (link, pose), at in ((origins[end.body], end.at) for end in ends)
        )
        yield Pin(name, first, second)


def _pose(model: Compiled, at: str, turned: str, number: int) -> Pose:
    return Pose(from_quaternion(model.arrays[turned][number]), model.arrays[at][number])


def _tied(name: str, parent: str, child: str, pose: Pose) -> Joint:
    return Joint(name, "fixed", parent, child, _three(pose.at), to_rpy(pose.turned))


def _three(vector: Array) -> tuple[float, float, float]:
    x, y, z = (float(part) for part in vector)
    return x, y, z


def _inertial(model: Compiled, number: int, pose: Pose) -> Inertial | None:
    """Mass and tensor in the axes of the link, in which the body lies at ``pose``."""
    mass = float(model.arrays["body_mass"][number])
    own = pose.then(_pose(model, "body_ipos", "body_iquat", number))
    moments = np.diag(model.arrays["body_inertia"][number])
    if not mass and not moments.any():
        return None
    return Inertial(mass, own.at, own.turned @ moments @ own.turned.T)


def _joint(
    model: Compiled, one: int, parent: str, child: str, pose: Pose, held: Held
) -> tuple[Joint, Pose]:
    """A joint by which a body at ``pose`` moves, and where the body lies in the link behind it."""
    arrays, kind = model.arrays, _KINDS[model.index("jnt_type", one)]
    dof, slot = model.index("jnt_dofadr", one), model.index("jnt_qposadr", one)
    anchor, axis = arrays["jnt_pos"][one], arrays["jnt_axis"][one]
    if kind in ("floating", "ball"):
        anchor = np.zeros(3) if kind == "floating" else anchor
        frame = pose.then(Pose(np.eye(3), anchor))
        kind = "fixed" if model.joints[one] in held.locked else kind
        free = Joint(model.joints[one], kind, parent, child, _three(frame.at), to_rpy(frame.turned))
        return free, Pose(np.eye(3), -anchor)
    zero = float(arrays["qpos0"][slot])
    if kind == "prismatic":
        frame = pose.then(Pose(np.eye(3), -zero * axis))
        anchor = np.zeros(3)
    else:
        frame = pose.then(Pose(about_vector(_three(axis), -zero), anchor))
    stiffness = float(arrays["jnt_stiffness"][one])
    name = model.joints[one]
    motors = tuple(_of_motors(model, f"actuator_{what}", one) for what in ("damping", "armature"))
    low, high = (float(part) for part in arrays["jnt_range"][one])
    joint = Joint(
        name,
        kind,
        parent,
        child,
        _three(frame.at),
        to_rpy(frame.turned),
        _three(axis),
        damping=float(arrays["dof_damping"][dof]) + motors[0],
        friction=float(arrays["dof_frictionloss"][dof]),
        range=Range(
            (low, high) if arrays["jnt_limited"][one] else None, effort=_effort(model, one)
        ),
        mimic=held.mimics.get(name),
        armature=float(arrays["dof_armature"][dof]) + motors[1],
        spring=(stiffness, float(arrays["qpos_spring"][slot])) if stiffness else None,
        motors=(motors[0], motors[1]),
        home=zero,
        held=held.locked.get(name),
    )
    return joint, Pose(np.eye(3), -anchor)


def _of_motors(model: Compiled, name: str, joint: int) -> float:
    """What the actuators of a joint add to it: theirs is at the motor, before the gear."""
    return sum(_gear(model, k) ** 2 * float(model.arrays[name][k]) for k in _at(model, joint))


def _at(model: Compiled, joint: int) -> list[int]:
    """The actuators that act on a joint."""
    targets = model.arrays["actuator_trnid"].reshape(-1, 2)[:, 0]
    mine = np.isin(model.arrays["actuator_trntype"], _AT_JOINT) & (targets == joint)
    return [int(k) for k in np.flatnonzero(mine)]


def _gear(model: Compiled, actuator: int) -> float:
    return float(model.arrays["actuator_gear"].reshape(-1, 6)[actuator, 0])


def _effort(model: Compiled, joint: int) -> float | None:
    """How strongly a joint may be driven in either direction, N or N·m: by all its actuators, and
    as it is limited itself; None where neither is."""
    motors = [abs(_gear(model, k)) * _strength(model, k) for k in _at(model, joint)]
    together = sum(motors) if motors else np.inf
    least = min(together, _either_way(model, "jnt_actfrc", joint))
    return least if 0 < least < np.inf else None


def _strength(model: Compiled, actuator: int) -> float:
    """The largest force of an actuator, before its gear; infinite where it is not limited."""
    strength = _either_way(model, "actuator_force", actuator)
    arrays = model.arrays
    kinds = arrays["actuator_gaintype"][actuator], arrays["actuator_biastype"][actuator]
    if kinds == (_FIXED, _NONE):
        gain = abs(float(arrays["actuator_gainprm"][actuator, 0]))
        strength = min(strength, gain * _either_way(model, "actuator_ctrl", actuator))
    return strength


def _either_way(model: Compiled, name: str, row: int) -> float:
    """The end of a range that is nearer to zero; infinite where there is none."""
    if not model.arrays[f"{name}limited"][row]:
        return np.inf
    return float(np.abs(model.arrays[f"{name}range"].reshape(-1, 2)[row]).min())


def _driven(model: Compiled) -> frozenset[str] | None:
    """The joints that have an actuator; None if nothing has one."""
    targets = zip(
        model.arrays["actuator_trntype"], model.arrays["actuator_trnid"].reshape(-1, 2), strict=True
    )
    found = frozenset(model.joints[int(ids[0])] for kind, ids in targets if kind in _AT_JOINT)
    return found or None
