"""Models of MuJoCo against MuJoCo: what it computes, and what a model file of them computes."""

from pathlib import Path

import mujoco
import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.imports.deliver import Order, model_of, read_robot
from symhyb.imports.mjcf import parse_mjcf
from symhyb.imports.robot import Mimic, Robot
from symhyb.limits import DECLARED
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build

CLOSE = 1e-9
INERTIAL = (
    '<inertial pos="0.1 0.02 -0.03" mass="1.3" fullinertia="0.02 0.03 0.025 .001 -.002 .0015"/>'
)


def mjcf(world: str, more: str = "") -> str:
    return f'<mujoco model="m"><worldbody>{world}</worldbody>{more}</mujoco>'


ARM = mjcf(
    f"""
  <body name="base" pos="0 0 0.2" euler="10 20 30">{INERTIAL}
   <body name="upper" pos="0.1 0.2 0.3" quat="0.9 0.1 -0.3 0.2">{INERTIAL}
    <joint name="shoulder" axis="0 1 0" pos="0.05 -0.1 0.2" ref="25" range="-90 90"
           damping="0.4" armature="0.3"/>
    <body name="fore" pos="0.4 0 0.1">{INERTIAL}
     <joint name="lift" type="slide" axis="1 2 2" ref="0.1" stiffness="30" springref="0.25"/>
     <joint name="elbow" axis="1 0 -1" pos="0.1 0 0"/>
     <body name="plate" pos="0 0.1 0" euler="0 90 0"><geom type="box" size="0.1 0.05 0.02"/>
      <body name="hand" pos="0.1 0 0"><geom type="capsule" size="0.03 0.1" euler="30 0 0"/>
       <joint name="roll" axis="0 0 -1"/></body></body></body></body></body>""",
    '<option><flag constraint="disable"/></option>'  # limits of travel are soft forces there
    '<actuator><motor joint="shoulder"/><position joint="elbow"/></actuator>',
)


def imported(text: str) -> tuple[Robot, Model, Machine]:
    robot = parse_mjcf(text.encode(), "f.xml")
    model, _ = model_of(robot, Order())
    return robot, model, build(model, keep=False)


def needed(machine: Machine, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    still, inner = np.zeros(len(machine.model.inputs)), np.zeros(machine.inner_states)
    (forces,) = call(machine.discrepancy, (q, v, a, inner, still, 0.0, machine.values))
    return forces.ravel()


def test_an_arm_needs_the_torques_that_mujoco_says() -> None:
    """Anchors, references, two joints of one body, springs, rotors, shapes, degrees."""
    bodies = mujoco.MjModel.from_xml_string(ARM)
    state = mujoco.MjData(bodies)
    _, model, machine = imported(ARM)
    assert [one.name for one in model.coordinates] == ["shoulder", "lift", "elbow", "roll"]
    for q, v, a in np.random.default_rng(0).uniform(-1, 1, (5, 3, 4)):
        state.qpos[:], state.qvel[:], state.qacc[:] = q, v, a
        mujoco.mj_inverse(bodies, state)
        difference = needed(machine, q, v, a) - state.qfrc_inverse
        assert np.abs(difference).max() < CLOSE * np.abs(state.qfrc_inverse).max()


def test_what_is_driven_has_an_input() -> None:
    _, model, _ = imported(ARM)
    assert [one.name for one in model.inputs] == ["shoulder_torque", "elbow_torque"]
    kinds = {one.name: one.kind for one in model.elements}
    assert kinds == {
        "shoulder_damping": "damper",
        "shoulder_rotor": "added_mass",
        "shoulder_motor": "torque",
        "lift_spring": "spring",
        "elbow_motor": "torque",
    }
    (limit,) = model.limits
    assert limit.between == pytest.approx((-np.pi / 2, np.pi / 2))
    undriven = ARM[: ARM.index("<actuator>")] + "</mujoco>"
    assert len(imported(undriven)[1].inputs) == 4


def test_what_an_actuator_adds_to_its_joint_is_behind_its_gear() -> None:
    """MuJoCo 4 states the rotor and the damping of a motor at the motor."""
    world = f'<body name="a">{INERTIAL}<joint name="j" damping="0.3" armature="0.2"/></body>'
    ball = f'<body name="b">{INERTIAL}<joint name="k" type="ball"/></body>'
    motors = """<motor joint="j" gear="3" armature="0.5" damping="2" delay="0.003" nsample="9"/>
      <motor jointinparent="j" gear="2" armature="0.1" damping="0.7"/>"""
    text = mjcf(world, f"<actuator>{motors}</actuator>")
    bodies = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(bodies)
    robot, _, machine = imported(text)
    assert [said for _, said in robot.notes] == ["left out: delays of actuators"]
    for q, v, a in np.random.default_rng(0).uniform(-1, 1, (5, 3, 1)):
        state.qpos[:], state.qvel[:], state.qacc[:] = q, v, a
        mujoco.mj_inverse(bodies, state)
        assert needed(machine, q, v, a) == pytest.approx(state.qfrc_inverse, rel=CLOSE)
    motors = '<motor joint="j"/><motor joint="k" armature="1"/>'
    elsewhere, _, _ = imported(mjcf(world + ball, f"<actuator>{motors}</actuator>"))
    assert [said for _, said in elsewhere.notes] == [
        "left out: damping and armature of actuators that act on no hinge or slide"
    ]


@pytest.mark.parametrize(
    ("motors", "own", "effort"),
    [
        ('<motor joint="j" gear="3" ctrlrange="-2 2"/>', "", 6.0),
        ('<motor joint="j" gear="-3" forcerange="-5 4" ctrlrange="-2 2"/>', "", 6.0),
        ('<motor joint="j" forcerange="-1 1.5"/><motor joint="j" ctrlrange="-1 1"/>', "", 2.0),
        ('<motor joint="j" ctrlrange="-2 2"/><motor joint="j"/>', "", None),
        ('<motor joint="j" ctrlrange="-2 2"/><motor joint="j"/>', "-7 7", 7.0),
        ('<position joint="j" kp="50" ctrlrange="-2 2"/>', "", None),  # of a place, no force
        ('<position joint="j" kp="50" ctrlrange="-2 2" forcerange="-9 9"/>', "", 9.0),
        ('<motor joint="j" ctrlrange="0 2"/>', "", None),
        ('<motor joint="j"/>', "", None),
    ],
)
def test_how_strongly_a_joint_may_be_driven(motors: str, own: str, effort: float | None) -> None:
    limit = f'actuatorfrcrange="{own}"' if own else ""
    world = f'<body name="a">{INERTIAL}<joint name="j" {limit}/></body>'
    robot, model, _ = imported(mjcf(world, f"<actuator>{motors}</actuator>"))
    (joint,) = robot.joints
    assert joint.range.effort == effort
    stated = [one.between for one in model.limits if one.name == "j_torque"]
    assert stated == ([] if effort is None else [(-effort, effort)])


def product(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    w, x, y, z = left
    return np.array([[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]) @ right


def test_balls_and_free_bodies_have_the_energies_that_mujoco_says() -> None:
    text = mjcf(
        f"""<body name="ship" pos="1 2 3" euler="10 0 40"><freejoint name="free"/>{INERTIAL}
         <body name="mast" pos="0 0.1 0.4" euler="0 50 0">{INERTIAL}
          <joint name="ball" type="ball" pos="0.1 0 0.2"/></body></body>""",
        '<option><flag energy="enable"/></option>',
    )
    bodies = mujoco.MjModel.from_xml_string(text)
    state = mujoco.MjData(bodies)
    _, model, machine = imported(text)
    start, _ = (np.array(part) for part in model.start())
    found, expected = [], []
    for drawn in np.random.default_rng(1).uniform(-1, 1, (4, 17)):
        place, rate = drawn[:3], drawn[3:6]
        turns = [part / np.linalg.norm(part) for part in (drawn[6:10], drawn[10:14])]
        spins = drawn[3:6][::-1], drawn[14:17]
        state.qpos[:] = [*place, *turns[0], *turns[1]]
        state.qvel[:] = [*rate, *spins[0], *spins[1]]
        mujoco.mj_forward(bodies, state)
        q = np.array([*(place - [1, 2, 3]), *turns[0], *product(start[7:11], turns[1])])
        halves = [np.array([0, *spin]) / 2 for spin in spins]
        v = np.array([*rate, *product(q[3:7], halves[0]), *product(q[7:11], halves[1])])
        kinetic, potential, _ = call(machine.energy, (q, v, np.zeros(0), 0.0, machine.values))
        found.append((kinetic.item(), potential.item()))
        expected.append((state.energy[1], state.energy[0]))
    assert np.allclose(found, expected, rtol=1e-9)


def test_an_equality_of_two_joints_is_a_ratio() -> None:
    world = f"""<body name="a">{INERTIAL}<joint name="j" ref="30"/>
      <body name="b" pos="1 0 0">{INERTIAL}<joint name="k" ref="-20" axis="0 1 0"/></body></body>"""
    one = '<joint joint1="k" joint2="j" polycoef="0.1 2 0 0 0"/>'
    robot, model, _ = imported(mjcf(world, f"<equality>{one}</equality>"))
    (mimic,) = (joint.mimic for joint in robot.joints if joint.name == "k")
    assert mimic == Mimic("j", 2.0, pytest.approx(np.radians(-20) + 0.1 - 2 * np.radians(30)))
    assert [c.name for c in model.coordinates] == ["j"]


def test_gravity_in_any_direction_and_what_is_left_out() -> None:
    balls = f'<body name="b">{INERTIAL}<joint name="k" type="ball" damping="1"/></body>'
    world = f'<body name="a" gravcomp="1">{INERTIAL}<joint name="j"/></body>{balls}'
    robot, model, _ = imported(mjcf(world, '<option gravity="1 0 -2" density="1.2"/>'))
    assert robot.gravity == (1, 0, -2)
    assert [part.text for part in model.gravity or ()] == ["g_x", "0", "g_z"]
    assert [said for _, said in robot.notes] == [
        "left out: damping, friction and armature of ball and free joints",
        "left out: gravity compensation",
        "left out: the medium around",
    ]
    assert "from a MJCF" not in model.text
    assert "from an MJCF" in model.text


def test_meshes_and_textures_are_not_opened_nor_memory_claimed() -> None:
    mesh = """<asset><mesh name="m" file="/etc/passwd"/><texture name="t" file="/etc/passwd.png"/>
      <material name="p" texture="t"/></asset><size memory="900G"/>"""
    paint = '<site material="p"/><geom type="mesh" mesh="m" material="p"/>'
    world = f'<body name="a">{INERTIAL}<joint name="j"/>{paint}</body>'
    assert [c.name for c in imported(mjcf(world, mesh))[1].coordinates] == ["j"]


def test_a_mass_that_is_that_of_a_mesh_is_not_guessed() -> None:
    mesh = '<asset><mesh name="m" file="a.stl"/></asset>'
    shape = '<geom type="mesh" mesh="m" {}/>'
    joint = '<joint name="j"/><geom size="0.1"/>'
    light = "".join(shape.format(words) for words in ('mass="0"', 'density="0"'))
    assert imported(mjcf(f'<body name="a">{joint}{light}</body>{shape.format("")}', mesh))
    with pytest.raises(InputError) as error:
        parse_mjcf(mjcf(f'<body name="a">{joint}{shape.format("")}</body>', mesh).encode(), "f")
    assert str(error.value) == (
        "f: body.a: its mass is that of a mesh, which is not read; give it an <inertial>"
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (mjcf("<include file='/etc/passwd'/>"), "f.xml:1: <include> is not read; put in what"),
        ("<mujoco><extension/></mujoco>", "<extension> is not read; remove it"),
        (mjcf("<body><joint/></body>"), "f.xml: MuJoCo says: "),
        (mjcf("<body><joynt/></body>"), "f.xml: MuJoCo says: "),
        (mjcf("<body/>" * (DECLARED + 1)), f"at most {DECLARED} are read"),
        ("<!DOCTYPE a []><mujoco/>", "declares a document type"),
    ],
)
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(InputError) as error:
        parse_mjcf(text.encode(), "f.xml")
    assert said in str(error.value)


def test_bodies_and_joints_without_names_get_some() -> None:
    world = f"<body><joint/>{INERTIAL}<body><joint/><joint axis='1 0 0'/>{INERTIAL}</body></body>"
    robot, model, _ = imported(mjcf(world))
    assert [c.name for c in model.coordinates] == ["joint_0", "joint_1", "joint_2"]
    assert list(robot.links) == ["world", "body_1", "body_2_joint_1", "body_2"]


def test_the_outermost_element_tells_the_format(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    assert read_robot(path).source == "MJCF"
