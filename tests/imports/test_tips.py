"""Where a robot may carry something is a point of the model: the ends of what is welded."""

import mujoco
import numpy as np
import pytest
from newton_euler import inverse_dynamics
from robots import ARM, joint, link, robot

from symhyb.discrepancy.places.points import moving_points
from symhyb.imports.deliver import Order, model_of
from symhyb.imports.mjcf import parse_mjcf
from symhyb.imports.reduction import reduced
from symhyb.imports.urdf import parse_urdf
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build

MASS = 0.4  # kg
LOAD = f"""
[elements.load]
kind = "payload"
at   = "{{}}"
mass = "load"
[elements.load.parameters]
load = {{{{ value = {MASS}, unit = "kg" }}}}
"""
INERTIAL = '<inertial pos="0.1 0 0.02" mass="1.3" diaginertia="0.02 0.03 0.025"/>'


def frame(name: str) -> str:
    """A link without mass."""
    return f'<link name="{name}"/>'


def end(name: str, on: str, *xyz: float, rpy: tuple[float, ...] = (0.0, 0.0, 0.0)) -> str:
    """A link without mass, welded to another."""
    return frame(name) + joint(f"{name}_weld", "fixed", on, name, xyz, rpy)


def hung(*ends: str) -> str:
    """A link b that turns about the z axis of the ground, and what is welded to it."""
    return robot(link("a"), link("b"), joint("j", "revolute", "a", "b"), *ends)


def imported(text: str, order: Order | None = None) -> tuple[Model, tuple[str, ...]]:
    return model_of(parse_urdf(text.encode()), order or Order())


def tips(text: str) -> list[tuple[str, list[float]]]:
    (body,) = reduced(parse_urdf(text.encode())).bodies
    return [(tip.name, list(tip.at)) for tip in body.tips]


def torques(model: Model, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """What the motors have to give, (n,), along a motion of n coordinates, SI."""
    machine = build(model, keep=False)
    still, inner = np.zeros(len(model.inputs)), np.zeros(machine.inner_states)
    (forces,) = call(machine.discrepancy, (q, v, a, inner, still, 0.0, machine.values))
    return forces.ravel()


def test_a_leaf_is_a_point_with_each_component_a_parameter() -> None:
    text = hung(end("wrist", "b", 0.3, 0.0, 0.1), end("hand", "wrist", 0.0, 0.0, -0.2))
    model, notes = imported(text)
    assert notes == ()
    assert (
        "\n# ends of what is rigid with a body, or marked places: a payload is looked for there\n"
        '[points]\nhand = { body = "b", at = ["hand_x", "0", "hand_z"] }\n'
    ) in model.text
    assert 'hand_x = { value = 0.3, unit = "m", about = "x of hand in b" }\n' in model.text
    assert 'hand_z = { value = -0.1, unit = "m", about = "z of hand in b" }\n' in model.text


def test_turns_between_welds_leave_no_rounding() -> None:
    text = hung(
        end("wrist", "b", 0.0, 0.0, 0.1, rpy=(0.0, 0.0, 0.7)),
        end("hand", "wrist", 0.0, 0.0, 0.2, rpy=(0.3, 0.0, 0.0)),
        end("tool", "hand", 0.1, 0.0, 0.0, rpy=(0.0, 0.0, 0.1)),
        end("back", "tool", -0.1 * np.cos(0.1), 0.1 * np.sin(0.1), 0.0),
    )
    ((name, at),) = tips(text)
    assert name == "back"
    assert at[:2] == [0.0, 0.0]
    assert at[2] == pytest.approx(0.3)


def test_a_place_counts_once_and_the_origin_of_the_body_not_at_all() -> None:
    text = hung(
        end("here", "b", 0.0, 0.0, 0.0),
        end("tool0", "b", 0.1, 0.0, 0.0),
        end("flange", "b", 0.1, 0.0, 0.0, rpy=(0.0, 1.0, 0.0)),
    )
    assert tips(text) == [("tool0", [0.1, 0.0, 0.0])]


def test_a_link_that_carries_others_and_the_ground_have_no_point() -> None:
    rest = joint("k", "revolute", "hand", "c", axis=(1, 0, 0))
    text = hung(end("hand", "b", 0.1, 0.0, 0.0), end("camera", "a", 1.0, 0.0, 0.0), link("c"), rest)
    assert imported(text)[0].points == ()
    locked = imported(text, Order(joints=("j",)))[0]
    assert [point.name for point in locked.points] == ["c"]
    assert imported(ARM)[0].points == ()


def test_of_many_ends_those_farthest_from_the_origin_are_kept_and_said() -> None:
    text = hung(*(end(f"s{k}", "b", 0.1 * (k % 3 + 1), 0.0, 0.01 * k) for k in range(6)))
    model, notes = imported(text)
    assert [point.name for point in model.points] == ["s2", "s4", "s5"]
    said = (
        "6 ends are rigid with the link 'b': points are the 3 that are farthest from its origin, "
        "s2, s4, s5"
    )
    assert notes == (said,)
    assert "# - 6 ends are rigid with the link 'b': points are" in model.text


def test_names_of_points_are_no_other_names() -> None:
    """A link that is called as a joint, as a parameter, as a body, or as no name can be."""
    text = robot(
        link("a"),
        link("b"),
        link("hand-1"),
        joint("j", "revolute", "a", "b"),
        joint("k", "revolute", "b", "hand-1"),
        end("k", "b", 0.1, 0.0, 0.0),
        end("b_m", "b", 0.2, 0.0, 0.0),
        end("hand 1", "b", 0.3, 0.0, 0.0),
        end("0 tip", "hand-1", 0.1, 0.0, 0.0),
    )
    model, notes = imported(text)
    assert [point.name for point in model.points] == ["k_2", "b_m_2", "hand_1_2", "link_0_tip"]
    assert "the point 'hand 1' is called hand_1_2 here" in notes
    assert "the point '0 tip' is called link_0_tip here" in notes


@pytest.mark.slow
def test_a_payload_at_a_point_is_a_mass_at_that_link() -> None:
    """Torques with a payload are those of Newton-Euler with the mass in the URDF."""
    hand = joint("hand_weld", "fixed", "finger", "hand", (0.1, -0.05, 0.02), (0.4, 0.2, -0.3))
    palm = joint("palm_weld", "fixed", "hand", "palm", (0.03, 0.0, 0.1))
    ends = ARM.replace("</robot>", frame("hand") + hand + palm + "{}</robot>")
    light = ends.replace("{}", frame("palm"))
    heavy = ends.replace("{}", link("palm", MASS, (0, 0, 0), (0,) * 6))
    model, _ = imported(light)
    assert [at.point for at in moving_points(model)] == ["palm"]
    names = [one.name for one in model.coordinates]
    motion = np.random.default_rng(7).uniform(-1, 1, (3, len(names)))
    given = [dict(zip(names, map(float, x), strict=True)) for x in motion]
    for text, found in ((light, model), (heavy, parse_model(model.text + LOAD.format("palm")))):
        expected = np.array([inverse_dynamics(text, *given)[name] for name in names])
        assert torques(found, *motion) == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("place", ["tool", "grip", "elbow_mark"])
def test_bodies_without_joints_and_sites_of_mujoco_are_points(place: str) -> None:
    """A body that is welded, a site on it, and one on a body with two joints: torques with a
    payload are MuJoCo's with a small ball there."""
    ball = f'<inertial pos="0 0 0" mass="{MASS}" diaginertia="1e-12 1e-12 1e-12"/>'
    places = {"tool": ("tool", "0 0 0"), "grip": ("tool", "0 0.03 0.1")}
    carrier, at = places.get(place, ("fore", "0.1 0 -0.05"))

    def world(load: str = "") -> str:
        loads = {name: load if name == carrier else "" for name in ("tool", "fore")}
        return f"""<mujoco><worldbody><site name="mark" pos="1 1 1"/>
          <body name="upper" euler="10 20 30">{INERTIAL}<joint name="shoulder" axis="0 1 0"/>
          <site name="upper_mark" pos="0 0 0"/>
          <body name="fore" pos="0.4 0 0.1">{INERTIAL}<site name="elbow_mark" pos="0.1 0 -0.05"/>
          <joint name="lift" axis="1 2 2" pos="0.1 0 0.2"/>
          <joint name="elbow" axis="1 0 -1" pos="0.05 0.1 0"/>{loads["fore"]}
          <body name="tool" pos="0.3 0 0" euler="0 40 0"><site name="grip" pos="0 0.03 0.1"/>
          <site pos="0 0 0"/>{loads["tool"]}</body></body></body></worldbody></mujoco>"""

    light, _ = model_of(parse_mjcf(world().encode(), "f.xml"), Order())
    assert [point.name for point in light.points] == ["tool", "elbow_mark", "grip"]
    loaded = parse_model(light.text + LOAD.format(place))
    body = f'<body name="load" pos="{at}">{ball}</body>'
    for text, found in ((world(), light), (world(body), loaded)):
        bodies = mujoco.MjModel.from_xml_string(text)
        state = mujoco.MjData(bodies)
        motion = np.random.default_rng(3).uniform(-1, 1, (3, 3))
        state.qpos[:], state.qvel[:], state.qacc[:] = motion
        mujoco.mj_inverse(bodies, state)
        assert torques(found, *motion) == pytest.approx(state.qfrc_inverse, rel=1e-8, abs=1e-8)
