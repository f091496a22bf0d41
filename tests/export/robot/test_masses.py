"""Masses of a corrected model go into the robot's own file, and an import finds them there."""

import difflib
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from robots import ARM, drawn, joint, link, robot

from symhyb.export.robot.robot_file import Rewritten, rewritten
from symhyb.imports.deliver import Order, model_of, read_robot
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.model.write import replace_parameters
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build

CLOSE = 1e-9  # of the largest


def imported(source: Path, order: Order | None = None) -> Model:
    return model_of(read_robot(source), order or Order())[0]


def estimated(model: Model, factors: Mapping[str, float]) -> Model:
    """The model with parameters that a diagnosis changed by factors."""
    values = {name: (model.parameters[name].value * by, 0.01) for name, by in factors.items()}
    return replace_parameters(model, values)


def forces(model: Model, states: np.ndarray) -> np.ndarray:
    """M a + k_c − k_e at each of ``states`` (N, 3, n): places, speeds, accelerations."""
    machine = build(model, keep=False)
    inputs, inner = np.zeros(len(model.inputs)), np.zeros(machine.inner_states)
    found = [
        call(machine.discrepancy, (*state, inner, inputs, 0.0, machine.values))[0].ravel()
        for state in states
    ]
    return np.array(found)


def written(
    model: Model, source: Path, order: Order | None = None
) -> tuple[Rewritten, Model, Path]:
    """The file with what the model says, and an import of it."""
    form = "mjcf" if source.suffix == ".xml" else "urdf"
    done = rewritten(model, source, form)
    out = source.with_name(f"new{source.suffix}")
    out.write_text(done.text)
    return done, imported(out, order), out


def agree(one: Model, other: Model, seed: int = 1) -> None:
    """Both need the same forces for random motions, at rest and without weight too."""
    rng, n = np.random.default_rng(seed), len(one.coordinates)
    states = rng.uniform(-2, 2, (6, 3, n))
    states[0, 1:] = 0  # gravity alone
    states[1, 1] = 0
    left, right = forces(one, states), forces(other, states)
    assert np.abs(left - right).max() < CLOSE * np.abs(left).max()


def diff(source: Path, done: Rewritten) -> list[str]:
    """The lines that are gone (-) and new (+)."""
    lines = difflib.ndiff(source.read_text().splitlines(), done.text.splitlines())
    return [line for line in lines if line[0] in "+-"]


def payload(body: str, x: float = 0.3, y: float = 0.1, z: float = 0.0, bulk: float = 0.002) -> str:
    """A load of 0.37 kg that was found at a point of a body, with an inertia of its own."""
    return f"""
[points.hand]
body = "{body}"
at = ["{x} m", "{y} m", "{z} m"]
[elements.found_load]
kind = "payload"
at = "hand"
mass = "m_load"
found = {{ by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }}
[elements.found_load.parameters]
m_load = {{ value = 370.0, sd = 1.0, unit = "g" }}
[elements.found_bulk]
kind = "added_inertia"
at = "hand"
inertia = "J_load"
found = {{ by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }}
[elements.found_bulk.parameters]
J_load = {{ value = {bulk}, sd = 1e-4, unit = "kg*m^2" }}
"""


FIXED = """
[bodies.gripper]
mass = "0.4 kg"
parent = "{body}"
joint = ["0.1 m", "-0.05 m", "0.2 m"]
rotations = [["z", "0.4"], ["x", "-0.9"]]
at = ["0.02 m", "0.03 m", "-0.01 m"]
inertia = ["3 g*m^2", "4 g*m^2", "5 g*m^2", "0.2 g*m^2", "-0.1 g*m^2", "0.3 g*m^2"]
[bodies.cup]
mass = "0.1 kg"
parent = "gripper"
joint = ["0", "0", "5 cm"]
at = ["0", "1 cm", "0"]
inertia = "1e-4 kg*m^2"
"""


@pytest.mark.parametrize("seed", range(8))
def test_drawn_robots_are_read_back_with_all_that_changed(seed: int, tmp_path: Path) -> None:
    """Masses, centres and tensors by a diagnosis; a payload; bodies added by hand."""
    source = tmp_path / "robot.urdf"
    source.write_text(drawn(seed))
    model, rng = imported(source), np.random.default_rng(seed)
    factors: dict[str, float] = {}
    for body in rng.choice([one.name for one in model.bodies], size=2, replace=False):
        size = float(rng.uniform(1.1, 1.3))
        known = {name: size for name in model.parameters.names() if name.startswith(f"{body}_J")}
        factors |= {**known, f"{body}_m": 1.05, f"{body}_cx": float(rng.uniform(0.9, 1.1))}
    model = estimated(model, factors)
    first, last = model.bodies[0].name, model.bodies[-1].name
    more = payload(last, 0.1, 0.2, -0.3) + FIXED.format(body=first)
    corrected = parse_model(model.text + more)
    done, back, _ = written(corrected, source)
    assert not any("not written" in note for note in done.notes)
    agree(corrected, back, seed)


@pytest.mark.parametrize("text", [ARM, drawn(3), drawn(7)])
def test_an_unchanged_robot_is_the_same_byte_by_byte(text: str, tmp_path: Path) -> None:
    source = tmp_path / "robot.urdf"
    source.write_text(text)
    done = rewritten(imported(source), source, "urdf")
    assert done == Rewritten(text, ())


def test_one_mass_is_one_number(tmp_path: Path) -> None:
    source = tmp_path / "arm.urdf"
    source.write_text(ARM)
    model = estimated(imported(source), {"fore_m": 1.1})
    done, back, _ = written(model, source)
    assert (
        diff(source, done)[0].replace('value="1.5"', 'value="1.65"')[1:]
        == diff(source, done)[1][1:]
    )
    assert len(diff(source, done)) == 2
    assert done.notes == ("fore: mass 1.65 kg (before 1.5)",)
    agree(model, back)


def test_a_repair_is_written_with_a_change_of_that_body_alone(tmp_path: Path) -> None:
    """Tensors of no body are repaired on import; the file keeps them, but for what changed."""
    bad = (0.02, 0.0, 0.0, 0.03, 0.0, 0.09)
    text = robot(
        *(link("base"), link("a", tensor=bad), link("b", tensor=bad)),
        joint("one", "revolute", "base", "a"),
        joint("two", "revolute", "a", "b", (0.3, 0, 0), axis=(0, 1, 0)),
    )
    source = tmp_path / "arm.urdf"
    source.write_text(text)
    model = imported(source)
    assert rewritten(model, source, "urdf").text == text
    corrected = parse_model(model.text + payload("b", 0.1, 0, 0))
    done, back, _ = written(corrected, source)
    assert [line[:15] for line in diff(source, done)] == ['- <link name="b', '+ <link name="b']
    agree(corrected, back)


def test_links_without_an_inertial_and_without_an_end_tag_get_one(tmp_path: Path) -> None:
    text = robot(
        *(link("base"), '  <link name="frame"/>\n', link("tool")),
        joint("turn", "revolute", "base", "frame", (0, 0, 0.2), (0.3, 0, 0), (1, 1, 0)),
        joint("weld", "fixed", "frame", "tool", (0.1, 0.2, 0.3), (0.4, 0.5, 0.6)),
    )
    source = tmp_path / "arm.urdf"
    source.write_text(text)
    corrected = parse_model(imported(source).text + payload("frame", 0.1, 0, 0.2, 0))
    done, back, _ = written(corrected, source)
    assert diff(source, done) == [
        '-   <link name="frame"/>',
        '+   <link name="frame">',
        "+     <inertial>",
        '+       <origin xyz="0.1 0 0.2"/>',
        '+       <mass value="0.37"/>',
        '+       <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>',
        "+     </inertial>",
        "+   </link>",
    ]
    agree(corrected, back)


def test_a_change_that_the_first_link_cannot_take_goes_to_one_that_can(tmp_path: Path) -> None:
    text = robot(
        *(link("base"), '<link name="frame"/>', link("tool", 2.0)),
        joint("turn", "revolute", "base", "frame", axis=(1, 1, 0)),
        joint("weld", "fixed", "frame", "tool", (0.1, 0.2, 0.3), (0.4, 0.5, 0.6)),
    )
    source = tmp_path / "arm.urdf"
    source.write_text(text)
    model = estimated(imported(source), {"frame_m": 0.9})
    done, back, _ = written(model, source)
    assert done.notes == ("tool: mass 1.8 kg (before 2)",)
    agree(model, back)


def test_what_no_link_can_have_is_said(tmp_path: Path) -> None:
    """Of 3.4 kg in two links of 3 and 0.4 kg no one can lose 3.06 kg."""
    source = tmp_path / "arm.urdf"
    source.write_text(ARM)
    model = estimated(imported(source), {"upper_m": 0.1, "tool_m": 1.5})
    done, back, out = written(model, source)
    assert done.notes[0] == "tool: mass 0.3 kg (before 0.2)"
    assert done.notes[1].startswith("upper: not written, -3.06 kg more, with first moments of (")
    gone, comment, *rest = diff(source, done)
    assert gone.startswith('- <link name="upper">')
    assert comment == '+ <link name="upper">'
    assert rest[0].startswith("+   <!-- symhyb found, and a link cannot have: -3.06 kg more, with")
    assert out.exists()
    same = ("upper_m", "upper_cx", "upper_Jxy")
    assert [back.parameters[name] for name in same] == [
        imported(source).parameters[name] for name in same
    ]


def test_a_mass_that_was_without_inertia_keeps_that_of_the_model(tmp_path: Path) -> None:
    point = (0.0,) * 6
    text = robot(
        *(link("base"), link("bob", 1.0, tensor=point)),
        joint("turn", "revolute", "base", "bob", axis=(1, 1, 0)),
    )
    source = tmp_path / "pendulum.urdf"
    source.write_text(text)
    model = imported(source)
    assert rewritten(model, source, "urdf").text == text
    heavier = estimated(model, {"bob_m": 2.0})
    agree(heavier, written(heavier, source)[1])


def test_locked_joints_are_where_the_model_has_them(tmp_path: Path) -> None:
    """The model file does not state where: values from before the diagnosis stand for the file."""
    source = tmp_path / "arm.urdf"
    source.write_text(ARM)
    order = Order(joints=("elbow", "twist"), at=("shoulder=0.7", "reach=-0.2", "grip=0.4"))
    model = imported(source, order)
    assert rewritten(model, source, "urdf").text == ARM
    corrected = parse_model(
        estimated(model, {"tool_m": 1.2, "fore_cx": 1.1}).text + payload("tool", 0.1, 0, 0.2)
    )
    done, back, _ = written(corrected, source, order)
    assert not any("not written" in note for note in done.notes)
    agree(corrected, back)
    by_hand = parse_model(re.sub(r"(fore_m +=) { value = 2.2", r"\1 { value = 2.3", model.text))
    assert by_hand.parameters["fore_m"].value == 2.3
    done = rewritten(by_hand, source, "urdf")
    assert done.text == ARM
    assert any("only what was estimated or added is written" in note for note in done.notes)


def test_a_floating_robot_carries_a_load(tmp_path: Path) -> None:
    source = tmp_path / "arm.urdf"
    source.write_text(ARM)
    order = Order(floating=True)
    corrected = parse_model(
        estimated(imported(source, order), {"base_m": 1.5}).text + payload("upper", 0.1, 0, 0.2)
    )
    agree(corrected, written(corrected, source, order)[1])


def test_what_is_rigid_with_no_link_is_said_and_not_written(tmp_path: Path) -> None:
    source = tmp_path / "arm.urdf"
    source.write_text(ARM)
    loose = """
[coordinates.s]
unit = "m"
[bodies.bead]
mass = "0.1 kg"
parent = "fore"
joint = ["s", "0", "0"]
at = ["0", "0", "0"]
"""
    head, _, tail = imported(source).text.partition("[parameters]")
    coordinate, _, body = loose.partition("[bodies.bead]")
    model = parse_model(f"{head}{coordinate}\n[parameters]{tail}\n[bodies.bead]{body}")
    done = rewritten(model, source, "urdf")
    assert done == Rewritten(ARM, ("bead: a body that is rigid with no link; not written",))


def test_a_length_that_was_estimated_is_said_and_not_written(tmp_path: Path) -> None:
    source = tmp_path / "arm.urdf"
    source.write_text(ARM)
    model = estimated(imported(source), {"twist_ox": 1.5, "fore_cx": 1.1})
    done = rewritten(model, source, "urdf")
    assert done.notes == (
        "fore: its centre",
        "twist_ox = 0.15 m: not written, the file keeps 0.1",
    )


MJCF = """<mujoco model="arm">
  <compiler angle="radian"/>
  <default> <joint damping="0.2"/> </default>
  <worldbody>
    <body name="upper" euler="0.3 0.2 -0.5">
      <joint name="shoulder" type="hinge" axis="0 1 0.5" pos="0.05 0.02 -0.01"/>
      <joint name="roll" type="hinge" axis="1 0 0" pos="0.03 0 0.02" ref="0.3" stiffness="2"/>
      <inertial pos="0.1 0.02 0.03" mass="2" euler="0.3 0.1 0.7" diaginertia="0.02 0.03 0.04"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04"/>
      <body name="fore" pos="0.4 0 0">
        <joint name="elbow-1" type="hinge" axis="0 0 1" armature="0.005"/>
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
        <body name="palm" pos="0.3 0 0" euler="0.1 0.2 0.3">
          <inertial pos="0.1 0.02 0.03" mass="0.2" diaginertia="0.002 0.003 0.005"/>
        </body>
      </body>
      <body name="plate" pos="0 0.4 0">
        <joint name="slide" type="slide" axis="0 1 1"/>
        <inertial pos="0.1 0 0" mass="0.3" fullinertia="0.002 0.003 0.004 0.0002 0.0001 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def test_an_unchanged_mjcf_is_the_same_byte_by_byte(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF)
    assert rewritten(imported(source), source, "mjcf") == Rewritten(MJCF, ())


@pytest.mark.parametrize("body", ["upper", "fore", "plate"])
def test_an_mjcf_is_read_back_with_all_that_changed(body: str, tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF)
    factors = {"upper_m": 1.1, "fore_cx": 1.1, "plate_Jxy": 1.2, "fore_m": 1.3}
    model = estimated(imported(source), factors)
    more = payload(body, 0.1, 0.2, -0.3) + FIXED.format(body="fore")
    corrected = parse_model(model.text + more)
    agree(corrected, written(corrected, source)[1])


def test_a_mass_of_shapes_becomes_a_stated_one(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF)
    corrected = parse_model(imported(source).text + payload("fore", 0.3, 0, 0))
    done, back, _ = written(corrected, source)
    new = diff(source, done)
    assert [line.split()[1] for line in new] == ["<!--", "<inertial"]
    assert new[0].startswith("+         <!-- by symhyb: this counts")
    agree(corrected, back)


def test_of_a_stated_mass_one_number_changes(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF)
    model = estimated(imported(source), {"upper_m": 1.1})
    done, back, _ = written(model, source)
    assert done.text == MJCF.replace('mass="2"', 'mass="2.2"')
    agree(model, back)


def test_a_body_without_thickness_is_one_that_mujoco_takes(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    flat = '<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.02 0.03"/>'
    body = f'<body name="flat"><joint name="turn" axis="1 2 3"/>{flat}</body>'
    source.write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
    corrected = parse_model(imported(source).text + payload("flat", 0.1, 0.1, 0, 0))
    done, back, _ = written(corrected, source)
    assert done.notes == ("flat: mass 1.37 kg (before 1), its centre, its inertia",)
    agree(corrected, back)


def test_a_setting_by_which_shapes_count_alone_is_changed(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    stated = re.compile(r"<inertial [^>]*/>")
    text = stated.sub('<geom type="box" size="0.1 0.2 0.3"/>', MJCF)
    source.write_text(text.replace('angle="radian"', 'angle="radian" inertiafromgeom="true"'))
    corrected = parse_model(imported(source).text + payload("fore"))
    done, back, _ = written(corrected, source)
    assert 'compiler: inertiafromgeom "auto", so that what is stated counts' in done.notes
    assert '<compiler angle="radian" inertiafromgeom="auto"/>' in done.text
    agree(corrected, back)


def test_settings_that_overrule_what_is_written_are_found(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF.replace('angle="radian"', 'angle="radian" settotalmass="7"'))
    corrected = parse_model(imported(source).text + payload("fore"))
    done = rewritten(corrected, source, "mjcf")
    (new,) = diff(source, done)
    assert "symhyb found: masses are not written: as the file would be read they are others" in new
    assert "masses are not written" in done.notes[-1]


def test_a_body_that_the_file_does_not_spell_out_is_said(tmp_path: Path) -> None:
    """MuJoCo repeats one body; the copies have no element of their own."""
    source = tmp_path / "row.xml"
    body = (
        '<body name="bob"><joint name="turn" axis="0 1 0"/><geom pos="0 0 -1" size="0.1"/></body>'
    )
    row = f'<replicate count="2" offset="0 1 0">{body}</replicate>'
    source.write_text(f"<mujoco><worldbody>{row}</worldbody></mujoco>")
    model = estimated(imported(source), {"bob0_m": 1.1})
    done = rewritten(model, source, "mjcf")
    assert done.text == source.read_text()
    assert "bob0: its mass is not written, no element of the file has its name" in done.notes


def test_a_body_without_a_name_is_found(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF.replace('body name="fore"', "body"))
    corrected = parse_model(imported(source).text + payload("body_2"))
    agree(corrected, written(corrected, source)[1])


def test_a_mass_that_mujoco_has_as_a_parameter(tmp_path: Path) -> None:
    source = tmp_path / "arm.xml"
    source.write_text(MJCF)
    short = """symhyb = 1
[mujoco]
file = "arm.xml"
[mujoco.coordinates]
a = "slide"
[mujoco.parameters]
m = { body = "plate", field = "mass" }
M = { body = "fore", field = "mass" }
[coordinates]
a = { unit = "m" }
[parameters]
m = { value = 0.45, was = 0.3, unit = "kg" }
M = { value = 1.3, was = 1.0, unit = "kg" }
"""
    before = read_robot(source).links
    done = rewritten(parse_model(short, str(tmp_path / "arm.toml")), source, "mjcf")
    out = tmp_path / "new.xml"
    out.write_text(done.text)
    after = read_robot(out).links
    for name, mass in (("plate", 0.45), ("fore", 1.3), ("upper", 2.0)):
        old, new = before[name].inertial, after[name].inertial
        assert old is not None
        assert new is not None
        assert new.mass == pytest.approx(mass, rel=1e-12)
        assert new.tensor == pytest.approx(old.tensor, rel=1e-9, abs=1e-12)
        assert new.centre == pytest.approx(old.centre, rel=1e-12)
