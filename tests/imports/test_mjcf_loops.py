"""Closed loops of MJCF against MuJoCo's masses, forces and the Jacobians of its equalities."""

import mujoco
import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.imports.deliver import Order, model_of
from symhyb.imports.mjcf import parse_mjcf
from symhyb.imports.robot import Robot
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.constrained import PULL
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import closed

CLOSE = 1e-9
INERTIAL = (
    '<inertial pos="0.1 0.02 -0.03" mass="1.3" fullinertia="0.02 0.03 0.025 .001 -.002 .0015"/>'
)
Y = 'axis="0 1 0"'


def mjcf(world: str, equality: str) -> str:
    inner = f"<worldbody>{world}</worldbody><equality>{equality}</equality>"
    return f'<mujoco model="m"><compiler angle="radian"/>{inner}</mujoco>'


def imported(text: str, order: Order | None = None) -> tuple[Robot, Model]:
    robot = parse_mjcf(text.encode(), "f.xml")
    return robot, model_of(robot, order or Order())[0]


def link(name: str, pos: str, more: str = "", joint: str = Y) -> str:
    words = f'<joint name="{name}" damping="0.03" {joint}/>'
    return f'<body name="{name}" pos="{pos}">{words}{INERTIAL}{more}</body>'


END, TOP = '<site name="end" pos="0.3 0 0.1"/>', '<site name="top" pos="0 0 0.2"/>'
SPRUNG = f'{Y} stiffness="2" springref="0.1"'
FOUR = link("crank", "0 0 0", link("rod", "0 0 0.1", END)) + link("rocker", "0.3 0 0", TOP, SPRUNG)
KNEE = '<connect name="knee" body1="rod" body2="rocker" anchor="0.3 0 0.1"/>'
ACROSS = link("table", "0 0 0", FOUR, 'axis="1 2 2"')
GIMBAL = f"""<body name="rod" pos="0 0 0.1"><joint name="x" axis="1 0 0"/>
 <joint name="y" axis="0 1 0"/><joint name="z" axis="0 0 1" pos="0 0.01 0"/>{INERTIAL}</body>"""
SPATIAL = link("crank", "0 0 0", GIMBAL, f'{Y} armature="0.1"') + link(
    "slide", "0.3 0.1 0", "", 'type="slide" axis="1 0 0.3" ref="0.2"'
)
ARMS = link(
    "a", "0 0 0", link("b", "0.3 0 0", link("c", "0.2 0.1 0", "", 'axis="0 0 1"'), 'axis="1 0 2"')
) + link(
    "d",
    "0.5 0 0.2",
    link(
        "e",
        "0 0.2 0",
        link("f", "-.1 0 .2", link("h", "0 0 -.3", "", 'axis="1 1 0"')),
        'axis="1 0 0"',
    ),
    'axis="0 1 1"',
)
PARALLEL = link("a", "0 0 0", link("b", "0 0 0.2")) + link("d", "0.5 0 0", link("e", "0 0 0.3"))
CAM = link("cam", "0 0 0", "", f'{Y} ref="0.2"') + link(
    "follower", "0.2 0 0", "", 'type="slide" axis="0 0 1" ref="-0.1"'
)
POLYNOMIAL = '<joint joint1="follower" joint2="cam" polycoef="0.01 0.2 -0.3 0.1 0.05"/>'

MACHINES = {
    "four bars": (mjcf(FOUR, KNEE), 1),
    "by sites": (mjcf(FOUR, '<connect site1="end" site2="top"/>'), 1),
    "on a table that turns": (mjcf(ACROSS, KNEE), 2),
    "a rod in space": (mjcf(SPATIAL, KNEE.replace("rocker", "slide")), 2),
    "two arms": (mjcf(ARMS, '<weld body1="c" body2="h"/>'), 1),
    "parallel": (mjcf(PARALLEL, '<weld body1="b" body2="e" anchor="0 0.1 0.2"/>'), 1),
    "to the world": (mjcf(PARALLEL, '<connect body1="b" anchor="0.1 0 0.1"/>'), 2),
    "turned": (mjcf(PARALLEL, '<weld body1="b" body2="e" relpose=".45 0 .1 1 0 .1 0"/>'), 1),
    "a weld without torques": (mjcf(FOUR, '<weld site1="end" site2="top" torquescale="0"/>'), 1),
    "a polynomial": (mjcf(CAM, POLYNOMIAL), 1),
}


def states(machine: Machine, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Places and rates (5, n) near the start that hold the constraints."""
    start = np.array(machine.model.start()[0])
    q, v = np.random.default_rng(seed).uniform(-1, 1, (2, 5, machine.n))
    found = closed(machine, (start + 0.3 * q, v, 0 * v), np.zeros(5), machine.values)
    assert np.abs(found.left).max() < 1e-11
    return found.q, found.v


def accelerations(machine: Machine, q: np.ndarray, v: np.ndarray, pushed: np.ndarray) -> np.ndarray:
    still = np.zeros(len(machine.model.inputs))
    none, inner = np.zeros(0), np.zeros(machine.inner_states)
    return call(machine.acceleration, (q, v, inner, still, 0.0, machine.values, pushed, none))[
        0
    ].ravel()


def rows(bodies: mujoco.MjModel, q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What MuJoCo's equalities leave open at q (n,), (m,), and their Jacobian (m, n)."""
    state = mujoco.MjData(bodies)
    state.qpos[:] = q
    mujoco.mj_forward(bodies, state)
    of = state.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    return state.efc_pos[of], state.efc_J.reshape(-1, bodies.nv)[of]


def turning(bodies: mujoco.MjModel, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """d/dt of the Jacobian (m, n) along v, by differences of fourth order."""
    step = 1e-3
    along = (rows(bodies, q + k * step * v)[1] for k in (-2, -1, 1, 2))
    weights = (1 / 12, -2 / 3, 2 / 3, -1 / 12)
    return sum(weight * part for weight, part in zip(weights, along, strict=True)) / step


@pytest.mark.parametrize("which", MACHINES)
def test_a_loop_moves_as_masses_and_jacobians_of_mujoco_say(which: str) -> None:
    """The accelerations keep MuJoCo's equalities, and along what these leave free the forces are
    those of its inverse dynamics."""
    text, freedoms = MACHINES[which]
    bodies = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(bodies)
    _, model = imported(text)
    machine = build(model, keep=False)
    assert [c.name for c in model.coordinates] == [bodies.joint(k).name for k in range(bodies.njnt)]
    assert machine.n - machine.constraints == freedoms
    for q, v in zip(*states(machine, 3), strict=True):
        pushed = np.random.default_rng(0).uniform(-1, 1, machine.n)
        a = accelerations(machine, q, v, pushed)
        gap, slope = rows(bodies, q)
        size = np.abs(a).max()
        assert np.abs(gap).max() < CLOSE
        assert np.abs(slope @ v).max() < CLOSE
        pulled = 2 * PULL * (slope @ v) + PULL**2 * gap  # of what the projection leaves open
        assert np.abs(slope @ a + turning(bodies, q, v) @ v + pulled).max() < CLOSE * size
        state.qpos[:], state.qvel[:], state.qacc[:] = q, v, a
        bodies.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        mujoco.mj_inverse(bodies, state)
        bodies.opt.disableflags = 0
        free = np.linalg.svd(slope)[2][machine.constraints :]
        assert len(free) == freedoms
        assert (
            np.abs(free @ (state.qfrc_inverse - pushed)).max()
            < CLOSE * np.abs(state.qfrc_inverse).max()
        )


def product(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    w, x, y, z = left
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ right


def test_a_loop_over_a_ball_and_a_free_body_moves_as_mujoco_says() -> None:
    """q'' of quaternions as angular accelerations: ω' = 2 conj(q) q'', but for its scalar part."""
    mast = f"""<body name="mast" pos="0.2 0 0"><joint name="ball" type="ball" pos="0.1 0 0"/>
      {INERTIAL}</body>"""
    ship = f'<body name="ship"><freejoint name="free"/>{INERTIAL}{mast}</body>'
    lash = '<connect body1="mast" body2="rocker" anchor="0.1 0.05 0.3"/>'
    text = mjcf(ship + link("rocker", "0.3 0 0"), lash)
    bodies = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(bodies)
    machine = build(imported(text)[1], keep=False)
    assert (machine.n, machine.constraints) == (12, 3)
    for q, v in zip(*states(machine, 1), strict=True):
        for turn in (slice(3, 7), slice(7, 11)):  # of length 1, and no rate along it
            size = np.linalg.norm(q[turn])
            q[turn], v[turn] = q[turn] / size, v[turn] / size
            v[turn] -= (q[turn] @ v[turn]) * q[turn]
        a = accelerations(machine, q, v, np.zeros(12))
        spins = []
        for rates in (v, a):
            turned = [
                2 * product(q[turn] * [1, -1, -1, -1], rates[turn])[1:]
                for turn in (slice(3, 7), slice(7, 11))
            ]
            spins.append(np.concatenate([rates[:3], *turned, rates[11:]]))
        state.qpos[:], state.qvel[:], state.qacc[:] = q, *spins
        bodies.opt.disableflags = 0
        mujoco.mj_forward(bodies, state)
        of = state.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
        slope, gap = state.efc_J.reshape(-1, bodies.nv)[of], state.efc_pos[of]
        assert np.abs(gap).max() < CLOSE
        assert np.abs(slope @ spins[0]).max() < CLOSE
        state.qacc[:] = spins[1]
        bodies.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
        mujoco.mj_inverse(bodies, state)
        free = np.linalg.svd(slope)[2][3:]
        size = np.abs(state.qfrc_inverse).max()
        assert np.abs(free @ state.qfrc_inverse).max() < CLOSE * size


def test_a_loop_starts_as_it_is_drawn_and_follows_what_is_asked_for() -> None:
    text = mjcf(FOUR, KNEE)
    drawn = imported(text)[1]
    assert [(c.start, c.stated) for c in drawn.coordinates] == [(0.0, ("start",))] * 3
    _, found = imported(text, Order(at=("crank=3",)))
    crank, rod, rocker = (c.start for c in found.coordinates)
    assert crank == 3
    assert max(abs(crank + rod), abs(rocker)) < np.pi / 2
    gap, _ = rows(mujoco.MjModel.from_xml_string(text), np.array([crank, rod, rocker]))
    assert np.abs(gap).max() < CLOSE
    build(found, keep=False)


def test_ends_that_are_drawn_apart_are_brought_together() -> None:
    """Driven joints stay where they are as long as the others can close the loop."""
    apart = FOUR.replace('pos="0 0 0.2"', 'pos="0 0 0.21"')
    text = mjcf(apart, '<connect site1="end" site2="top"/>').replace(
        "</mujoco>", '<actuator><motor joint="crank"/></actuator></mujoco>'
    )
    robot, model = imported(text)
    places = np.array([c.start for c in model.coordinates])
    assert places[0] == 0.0
    assert np.all(places[1:] != 0.0)
    gap, _ = rows(mujoco.MjModel.from_xml_string(text), places)
    assert np.abs(gap).max() < CLOSE
    _, said = model_of(robot, Order())
    assert "from the constraints: the start of rod is" in said[-1]


def test_hinges_that_are_parallel_to_six_digits_do_not_lock_a_loop() -> None:
    nearly = FOUR.replace('<body name="rocker"', '<body name="rocker" euler="4e-6 0 0"')
    _, model = imported(mjcf(nearly, KNEE), Order(at=("crank=1",)))
    machine = build(model, keep=False)
    exact = build(imported(mjcf(FOUR, KNEE), Order(at=("crank=1",)))[1], keep=False)
    assert machine.constraints == exact.constraints == 2
    starts = [np.array(one.model.start()[0]) for one in (machine, exact)]
    assert np.abs(starts[0] - starts[1]).max() < 1e-9
    a = [
        accelerations(one, q, 0 * q, 0 * q + 1)
        for one, q in zip((machine, exact), starts, strict=True)
    ]
    assert np.abs(a[0] - a[1]).max() < 1e-4 * np.abs(a[1]).max()


def test_the_file_says_that_it_holds_exactly() -> None:
    text = imported(mjcf(FOUR, KNEE))[1].text
    assert "# holds exactly; in MuJoCo by a soft force\n[constraints.knee]\n" in text
    assert "# what holds bodies and joints to others\nknee_a_x" in text


def joint(first: str, second: str, line: str) -> str:
    return f'<joint joint1="{first}" joint2="{second}" polycoef="{line} 0 0 0"/>'


ALONE = '<joint joint1="crank" polycoef="0.3 0 0 0 0"/>'
BOX = f'<body name="box"><freejoint name="free"/>{INERTIAL}</body>'
LEFT_OUT = "condition {} under <equality> is left out: "


@pytest.mark.parametrize(
    ("world", "equality", "constraints", "notes"),
    [
        (FOUR, KNEE.replace("name", 'active="false" name'), 0, (LEFT_OUT + "it is not active",)),
        (
            FOUR,
            joint("rod", "crank", "0 2").replace("joint ", 'joint active="false" ', 1),
            0,
            (LEFT_OUT + "it is not active",),
        ),
        (
            FOUR + '<body name="hand" mocap="true"/>',
            '<weld body1="hand" body2="rod"/>',
            0,
            (LEFT_OUT + "a mocap body is moved from outside",),
        ),
        (FOUR, '<weld body1="crank"/>', 0, ("the weld 'crank_world' locks the joint 'crank'",)),
        (FOUR + BOX, '<weld body1="box"/>', 0, ("the weld 'box_world' locks the joint 'free'",)),
        (FOUR + BOX, '<weld body1="box" body2="crank"/>', 6, ()),
        (FOUR + '<body name="post"/>', '<connect body1="post" anchor="0 0 0"/>', 0, ()),
        (FOUR, ALONE, 0, ()),
        (
            FOUR,
            ALONE * 2,
            0,
            ("condition 2 under <equality> is left out: the joint 'crank' is locked already",),
        ),
        (FOUR, ALONE + joint("crank", "rod", "0 2"), 1, ()),
        (FOUR, joint("crank", "rod", "0 2") * 2, 0, ()),
        (FOUR, joint("crank", "rod", "0 2") + joint("rod", "crank", "0 .5"), 0, ()),
        (FOUR, joint("crank", "rod", "0 2") + joint("rod", "crank", "0 2"), 1, ()),
        (FOUR, joint("crank", "rod", "0 2") + '<weld body1="crank"/>', 1, ()),
        (FOUR, '<weld body1="rod"/>', 2, ()),
        (FOUR, KNEE + KNEE.replace("knee", "again"), 2, ()),
    ],
)
def test_what_equalities_hold(
    world: str, equality: str, constraints: int, notes: tuple[str, ...]
) -> None:
    """Also those that go round, that repeat each other, or that hold what is held already."""
    robot, model = imported(mjcf(world, equality))
    assert tuple(said for _, said in robot.notes) == tuple(note.format(1) for note in notes)
    assert build(model, keep=False).constraints == constraints


def test_a_joint_that_follows_one_that_is_locked_stands_where_that_puts_it() -> None:
    text = mjcf(FOUR, ALONE + joint("rod", "crank", "0.1 2"))
    model = imported(text)[1]
    assert [c.name for c in model.coordinates] == ["rocker"]
    assert "Locked: crank at 0.3, rod at 0.7." in model.text


def test_a_joint_that_is_held_alone_is_held_from_where_it_is_drawn() -> None:
    """MuJoCo's polynomial has a slope of 1 unless it is said, which then counts for nothing."""
    robot = parse_mjcf(mjcf(CAM, '<joint joint1="cam"/>').encode(), "f.xml")
    (cam,) = (one for one in robot.joints if one.name == "cam")
    assert cam.held == 0.2


def test_a_loop_that_is_rigid_is_said_to_hold_nothing() -> None:
    robot = parse_mjcf(mjcf(FOUR, KNEE).encode(), "f.xml")
    model, said = model_of(robot, Order(joints=("rocker",)))
    assert len(model.constraints) == 1  # the rocker is held by a point that stands
    robot = parse_mjcf(mjcf(FOUR + BOX, KNEE).encode(), "f.xml")
    model, said = model_of(robot, Order(joints=("free",), at=("crank=1",)))
    assert model.constraints == ()
    assert "the loop 'knee' holds nothing and is left out: its ends are rigid" in said[-1]


@pytest.mark.parametrize(
    ("text", "order", "said"),
    [
        (
            mjcf(
                FOUR.replace('pos="0 0 0.2"', 'pos="9 0 0"'), '<connect site1="end" site2="top"/>'
            ),
            Order(),
            "f.xml: constraints.rod_rocker: the loop cannot be closed: nearest to the start",
        ),
        (
            mjcf(
                FOUR.replace('pos="0 0 0.2"', 'pos="0 .05 .2"'),
                '<connect site1="end" site2="top"/>',
            ),
            Order(),
            "f.xml: constraints.rod_rocker: nothing moves along rod_rocker.y, and there it is off",
        ),
        (
            mjcf(FOUR, KNEE),
            Order(joints=("rocker",), at=("crank=1",)),
            "f.xml: constraints.knee: the loop cannot be closed: nearest to the start",
        ),
        (
            mjcf(FOUR, '<weld body1="crank" relpose="1 0 0 1 0 0 0"/>'),
            Order(),
            "f.xml: constraints.crank_world_1: the loop cannot be closed: nearest to the start",
        ),
        (mjcf(FOUR, ALONE), Order(at=("crank=1",)), "'crank' is held at 0.3 by the MJCF"),
        (mjcf(FOUR, ALONE), Order(joints=("crank",)), "'crank' is held at 0.3 by the MJCF"),
        (
            mjcf(FOUR, '<connect body1="rod" body2="nobody" anchor="0 0 0"/>'),
            Order(),
            "MuJoCo says",
        ),
        (mjcf(FOUR, '<connect body1="rod" body2="rod" anchor="0 0 0"/>'), Order(), "MuJoCo says"),
    ],
)
def test_what_is_refused_says_where(text: str, order: Order, said: str) -> None:
    with pytest.raises(InputError) as error:
        imported(text, order)
    assert said in str(error.value)
    if "constraints" in said:
        assert str(error.value).endswith('; active="false" in the MJCF opens a loop')
