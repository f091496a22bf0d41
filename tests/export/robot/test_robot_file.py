"""A robot's own file gets what was found in its joints, and nothing else changes."""

import difflib
import sys
from pathlib import Path

import pytest

from symhyb.cli.app import main
from symhyb.errors import InputError
from symhyb.export.robot.robot_file import rewritten
from symhyb.imports.deliver import Order, model_of, read_robot
from symhyb.model.read import parse_model
from symhyb.model.types import Model

ARM = """<?xml version="1.0"?>
<!-- an arm: Schulter → Ellbogen -->
<robot name="arm">
  <link name="base"/>
  <link name="upper"> <inertial> <origin xyz="0.2 0 0"/> <mass value="2.5"/>
    <inertia ixx="0.004" ixy="0" ixz="0" iyy="0.04" iyz="0" izz="0.04"/> </inertial> </link>
  <link name="fore"> <inertial> <origin xyz="0.1 0 0"/> <mass value="1.2"/>
    <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/> </inertial> </link>
  <joint name="shoulder" type="continuous">
    <parent link="base"/> <child link="upper"/>
    <axis xyz="0 0 1"/>
    <dynamics damping='0.1' friction="0"/>
  </joint>
  <!-- ü > -->  <joint name="elbow-1" type="continuous">
    <parent link="upper"/> <child link="fore"/>
    <origin xyz="0.4 0 0"/>
    <axis xyz="0 0 1"/>
  </joint>
  <transmission name="t"> <joint name="elbow-1"/> </transmission>
</robot>
"""
FOUND = """
[elements.found_friction]
kind = "friction"
on = "shoulder"
coulomb = "F"
found = { by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }
[elements.found_friction.parameters]
F = { value = 3.25, sd = 0.1, unit = "N*m" }

[elements.found_damper]
kind = "damper"
on = "shoulder"
damping = "d"
found = { by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }
[elements.found_damper.parameters]
d = { value = 40.0, sd = 1.0, unit = "mN*m*s/rad" }

[elements.found_loss]
kind = "damper"
on = "elbow_1"
damping = "d"
found = { by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }
[elements.found_loss.parameters]
d = { value = 0.5, sd = 0.1, unit = "N*m*s/rad" }

[elements.found_rotor]
kind = "added_mass"
on = "elbow_1"
mass = "J"
found = { by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }
[elements.found_rotor.parameters]
J = { value = 0.02, sd = 0.001, unit = "kg*m^2" }

[elements.found_drag]
kind = "drag"
on = "elbow_1"
drag = "b"
found = { by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }
[elements.found_drag.parameters]
b = { value = 0.3, sd = 0.01, unit = "N*m*s^2/rad^2" }

[elements.found_sum]
kind = "damper"
on = "shoulder + elbow_1"
damping = "d"
found = { by = "trajectories", from = "run.csv", nrmse = [0.2, 0.02] }
[elements.found_sum.parameters]
d = { value = 0.7, sd = 0.1, unit = "N*m*s/rad" }
"""
MJCF = """<mujoco model="arm">
  <default> <joint damping="0.2"/> </default>
  <worldbody>
    <body name="upper">
      <joint name="shoulder" type="hinge" axis="0 0 1"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.04"/>
      <body name="fore" pos="0.4 0 0">
        <joint name="elbow-1" type="hinge" axis="0 0 1" armature="0.005" />
        <geom type="capsule" fromto="0 0 0 0.3 0 0" size="0.03"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


def corrected(source: Path, more: str = FOUND) -> Model:
    model, _ = model_of(read_robot(source), Order())
    return parse_model(model.text + more)


@pytest.fixture(params=["\n", "\r\n"])
def arm(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_bytes(ARM.replace("\n", request.param).encode())
    return path


def test_a_urdf_states_the_losses_and_keeps_every_other_letter(arm: Path, tmp_path: Path) -> None:
    before = arm.read_bytes().decode()
    done = rewritten(corrected(arm), arm, "urdf")
    out = tmp_path / "new.urdf"
    out.write_bytes(done.text.encode())
    joints = {joint.name: joint for joint in read_robot(out).joints}
    assert (joints["shoulder"].damping, joints["shoulder"].friction) == (0.14, 3.25)
    assert (joints["elbow-1"].damping, joints["elbow-1"].friction) == (0.5, 0.0)
    lines = list(difflib.ndiff(before.splitlines(), done.text.splitlines()))
    assert [line[2:].strip() for line in lines if line[0] == "-"] == [
        """<dynamics damping='0.1' friction="0"/>"""
    ]
    added = [line[2:].strip() for line in lines if line[0] == "+"]
    assert '<dynamics damping="0.14" friction="3.25"/>' in added
    assert '<dynamics damping="0.5"/>' in added
    assert len(added) == 5  # with a rotor and a drag, and what acts at both joints
    assert ("\r\n" in done.text) == ("\r\n" in before)
    assert done.text.count("\n") - before.count("\n") == 4


def test_what_a_urdf_has_no_place_for_stands_in_comments_and_notes(arm: Path) -> None:
    done = rewritten(corrected(arm), arm, "urdf")
    assert "no place for: inertia of the rotor 0.02 (kg*m^2, on a slide kg) -->" in done.text
    assert "no place for: found_drag, drag (b = 0.3 N*m*s^2/rad^2) -->" in done.text
    assert "<!-- symhyb found: found_sum, damper (d = 0.7 N*m*s/rad): it acts at no" in done.text
    assert any(note.startswith("elbow-1: no place for found_drag") for note in done.notes)
    assert "shoulder: damping 0.14" in done.notes


def test_an_mjcf_states_the_rotor_too(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(MJCF)
    done = rewritten(corrected(path), path, "mjcf")
    out = tmp_path / "new.xml"
    out.write_text(done.text)
    joints = {joint.name: joint for joint in read_robot(out).joints}
    assert joints["shoulder"].damping == pytest.approx(0.24)  # of the default and found
    assert joints["shoulder"].friction == 3.25
    assert joints["elbow-1"].armature == pytest.approx(0.025)
    assert joints["elbow-1"].damping == pytest.approx(0.7)
    assert '<joint damping="0.2"/>' in done.text
    assert 'axis="0 0 1" armature="0.025" damping="0.7" />' in done.text
    assert "an MJCF has no place for: found_drag" in done.text


@pytest.mark.parametrize(("format", "name"), [("urdf", "a URDF"), ("mjcf", "an MJCF")])
def test_friction_that_turns_over_gradually_has_its_level_and_a_comment(
    format: str, name: str, tmp_path: Path
) -> None:
    path = tmp_path / ("arm.urdf" if format == "urdf" else "arm.xml")
    path.write_text(ARM if format == "urdf" else MJCF)
    wide = FOUND.replace('coulomb = "F"', 'coulomb = "F"\ntransition = "v_t"').replace(
        "F = {", 'v_t = { value = 0.25, SD unit = "rad/s" }\nF = {'
    )
    for sd, said in (("sd = 0.01,", 1), ("", 0)):
        done = rewritten(corrected(path, wide.replace("SD", sd)), path, format)
        out = tmp_path / f"new{path.suffix}"
        out.write_text(done.text)
        joints = {joint.name: joint for joint in read_robot(out).joints}
        assert joints["shoulder"].friction == 3.25
        comment = f"{name} has no place for: found_friction, friction (v_t = 0.25 rad/s, F = 3.25"
        assert done.text.count(comment) == said
        assert done.text.count("that it turns over gradually") == said


def test_what_actuators_have_stays_at_them(tmp_path: Path) -> None:
    """MuJoCo 4 states the damping and the rotor of a motor at the motor."""
    path = tmp_path / "arm.xml"
    geared = '<motor joint="shoulder" gear="3" damping="0.5" armature="0.1"/>'
    path.write_text(MJCF.replace("</mujoco>", f"<actuator>{geared}</actuator></mujoco>"))
    before = {joint.name: joint for joint in read_robot(path).joints}["shoulder"]
    assert before.damping == pytest.approx(0.2 + 9 * 0.5)
    out = tmp_path / "new.xml"
    out.write_text(rewritten(corrected(path), path, "mjcf").text)
    after = {joint.name: joint for joint in read_robot(out).joints}["shoulder"]
    assert after.damping == pytest.approx(before.damping + 0.04)
    assert after.armature == pytest.approx(before.armature)


def test_what_was_found_beside_mujoco_is_added_to_its_file(tmp_path: Path) -> None:
    path = tmp_path / "machine.xml"
    path.write_text(MJCF)
    short = """symhyb = 1
[mujoco]
file = "machine.xml"
[mujoco.coordinates]
a = "shoulder"
b = "elbow-1"
[mujoco.parameters]
J = { joint = "elbow-1", field = "armature" }
[coordinates]
a = { unit = "rad" }
b = { unit = "rad" }
[parameters]
J = { value = 0.04, unit = "kg*m^2" }
[elements.rub]
kind = "friction"
on = "a"
coulomb = "F"
found = { by = "sparse" }
[elements.rub.parameters]
F = { value = 0.25, unit = "N*m" }
"""
    done = rewritten(parse_model(short, str(tmp_path / "machine.toml")), path, "mjcf")
    out = tmp_path / "new.xml"
    out.write_text(done.text)
    before, after = (
        {joint.name: joint for joint in read_robot(file).joints} for file in (path, out)
    )
    assert before["shoulder"].damping == after["shoulder"].damping == 0.2
    assert after["shoulder"].friction == pytest.approx(before["shoulder"].friction + 0.25)
    assert after["elbow-1"].armature == pytest.approx(0.04)
    assert after["elbow-1"].damping == before["elbow-1"].damping


def test_a_model_that_says_nothing_new_changes_nothing(arm: Path) -> None:
    assert rewritten(corrected(arm, ""), arm, "urdf").text == arm.read_bytes().decode()


def test_what_follows_a_joint_has_its_own_damping(arm: Path) -> None:
    """The damping of both acts on one coordinate; the file states each at its joint."""
    mimic = '<axis xyz="0 0 1"/> <mimic joint="shoulder"/> <dynamics damping="0.7"/>'
    parts = arm.read_bytes().decode().rpartition('<axis xyz="0 0 1"/>')
    arm.write_bytes((parts[0] + mimic + parts[2]).encode())
    assert rewritten(corrected(arm, ""), arm, "urdf").text == arm.read_bytes().decode()
    found = FOUND[FOUND.index("[elements.found_damper]") : FOUND.index("[elements.found_loss]")]
    done = rewritten(corrected(arm, found), arm, "urdf")
    assert "shoulder: damping 0.14" in done.notes
    assert '<dynamics damping="0.7"/>' in done.text


def test_the_verb_writes_it_and_says_what_has_no_place(
    arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "corrected.toml"
    model.write_text(corrected(arm).text)
    out = tmp_path / "new.urdf"
    command = ["symhyb", "export", str(model), "--to", "urdf", "--robot", str(arm), "-o", str(out)]
    monkeypatch.setattr(sys, "argv", command)
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code in (0, None)
    assert "shoulder: friction 3.25" in capsys.readouterr().out
    assert 'friction="3.25"' in out.read_text()


@pytest.mark.parametrize(
    ("form", "robot", "said"),
    [("urdf", False, "go with --robot FILE"), ("fmu", True, "no other form does")],
)
def test_a_robot_goes_with_its_forms(
    form: str,
    robot: bool,
    said: str,
    arm: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    model = tmp_path / "corrected.toml"
    model.write_text(corrected(arm).text)
    more = ["--robot", str(arm)] if robot else []
    command = ["symhyb", "export", str(model), "--to", form, *more, "-o", str(tmp_path / "out.x")]
    monkeypatch.setattr(sys, "argv", command)
    with pytest.raises(SystemExit) as stop:
        main()
    assert stop.value.code == 2
    assert said in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "out.x").exists()


def test_the_wrong_format_and_another_robot_are_refused(arm: Path) -> None:
    with pytest.raises(InputError, match="is urdf, not mjcf; use --to urdf"):
        rewritten(corrected(arm), arm, "mjcf")
    other = arm.with_name("other.urdf")
    other.write_text(ARM.replace('"shoulder"', '"hip"').replace('"elbow-1"', '"knee"'))
    with pytest.raises(InputError, match=r"no coordinate of the model .* is a joint"):
        rewritten(corrected(arm), other, "urdf")


def test_a_hostile_file_is_refused(arm: Path) -> None:
    model = corrected(arm)
    bomb = arm.with_name("bomb.urdf")
    bomb.write_text('<!DOCTYPE r [<!ENTITY a "x">]><robot name="r">&a;</robot>')
    with pytest.raises(InputError, match="document type"):
        rewritten(model, bomb, "urdf")
    latin = arm.with_name("latin.urdf")
    latin.write_bytes(ARM.replace("utf-8", "latin-1").encode("latin-1", "replace"))
    with pytest.raises(InputError):
        rewritten(model, latin, "urdf")
