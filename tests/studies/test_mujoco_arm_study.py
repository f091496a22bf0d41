"""The arm that MuJoCo simulates: the real one differs from its owner's file by what is stated, it
is recorded as the page says, and a diagnosis names what was concealed."""

import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import symhyb as sh
from symhyb.model.types import At, On
from tests.scripts import scripts

mujoco = pytest.importorskip("mujoco", reason="the extra mjcf is not installed")

# case -> MuJoCo's arrays that differ from those of the owner's file, and by how much at most
CONCEALED = {
    "nothing": {},
    "friction": {"dof_frictionloss": 0.5},
    "soft_friction": {"dof_frictionloss": 0.5},
    "damping": {"dof_damping": 1.5},
    "rotor": {"dof_armature": 0.03},
    "payload": {"body_mass": 0.4},
    "payload_point": {"body_mass": 0.4},
    "spring": {"jnt_stiffness": 12.0},
    "play": {"jnt_stiffness": 400.0},
}
ARRAYS = (
    *("dof_frictionloss", "dof_damping", "dof_armature", "body_mass", "body_pos", "jnt_stiffness"),
    *("jnt_axis", "jnt_pos", "qpos0", "jnt_range", "actuator_gear"),
)


@pytest.fixture(scope="module")
def study() -> Iterator[ModuleType]:
    """The study, scripts beside each other."""
    with scripts("mujoco_arm", ("recordings", "diagnose")) as found:
        yield found["diagnose"]


@pytest.fixture(scope="module")
def recordings(study: ModuleType) -> ModuleType:
    return sys.modules["recordings"]


@pytest.mark.parametrize("name", CONCEALED)
def test_one_thing_is_concealed(recordings: ModuleType, name: str) -> None:
    case = recordings.CASES[name]
    given, real = recordings.real_arm(case.arm, None), recordings.real_arm(case.arm, case.change)
    differences = {key: np.abs(getattr(real, key) - getattr(given, key)).max() for key in ARRAYS}
    found = {key: value for key, value in differences.items() if value}
    assert found == pytest.approx(CONCEALED[name])


def test_the_gear_pulls_beyond_its_play_alone(recordings: ModuleType) -> None:
    model = recordings.real_arm(recordings.GEARED, recordings.CASES["play"].change)
    data = mujoco.MjData(model)
    for twist, torque in ((0.004, 0.0), (0.005, 0.0), (0.015, -4.0), (-0.025, 8.0)):
        data.qpos[2] = twist
        mujoco.mj_forward(model, data)
        assert data.qfrc_spring[2] == pytest.approx(torque, abs=1e-12)


@pytest.mark.parametrize(("name", "creep"), [("friction", 4e-6), ("soft_friction", 0.02)])
def test_friction_holds_as_hard_as_is_stated(
    recordings: ModuleType, name: str, creep: float
) -> None:
    model = recordings.real_arm(recordings.ARM, recordings.CASES[name].change)
    model.opt.gravity[:] = 0
    data = mujoco.MjData(model)
    data.ctrl[2] = 0.49
    for _ in range(2000):
        mujoco.mj_step(model, data)
    assert data.qvel[2] == pytest.approx(creep, rel=0.1)
    data.qvel[2] = 1.0
    mujoco.mj_forward(model, data)
    assert data.qfrc_constraint[2] == pytest.approx(-0.5, abs=1e-9)


def test_a_recording_is_counted_and_its_commands_act_late(
    recordings: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same commands, played again 3 ms late, move MuJoCo's arm along what was recorded."""
    monkeypatch.setitem(recordings.SECONDS, "train", 0.8)
    case = recordings.CASES["damping"]
    run = recordings.record(case, "train")
    assert all((run[key] == again).all() for key, again in recordings.record(case, "train").items())
    angles = np.stack([run[joint] for joint in case.arm.joints], axis=1)
    assert angles / recordings.COUNT == pytest.approx(np.round(angles / recordings.COUNT))
    torques = np.stack([run[f"{joint}_torque"] for joint in case.arm.joints], axis=1)
    model = recordings.real_arm(case.arm, case.change)
    data = mujoco.MjData(model)
    data.qpos[:] = case.arm.middle
    late, each = 15, 20  # steps of 0.2 ms
    errors = []
    for step in range(each * len(angles)):
        if step % each == 0:
            errors.append(data.qpos - angles[step // each])
        if step >= late:
            data.ctrl[:] = torques[(step - late) // each]
        mujoco.mj_step(model, data)
    noise = np.hypot(recordings.NOISE, recordings.COUNT / np.sqrt(12))
    assert np.std(errors) == pytest.approx(noise, rel=0.1)


def test_the_hand_is_a_point_of_the_imported_model(recordings: ModuleType, tmp_path: Path) -> None:
    model = recordings.owners_model(recordings.CASES["payload"], tmp_path / "model.toml")
    ((name, body, at),) = ((one.name, one.body, one.at) for one in model.points)
    assert (name, body, [part.text for part in at]) == ("hand", "fore", ["hand_x", "0", "0"])
    (x,) = (one.value for one in model.parameters if one.name == "hand_x")
    assert x == pytest.approx(0.3)


@pytest.mark.slow
def test_the_owner_says_that_torques_are_held(recordings: ModuleType, tmp_path: Path) -> None:
    for name, case in recordings.CASES.items():
        model = recordings.owners_model(case, tmp_path / f"{name}.toml")
        assert [one.between for one in model.inputs] == ["held"] * len(case.arm.driven)
        stated = {one.name for one in model.parameters if one.sd is not None}
        expected = {"payload_stated": {"payload"}, "play_stated": {"gear_spring"}}
        assert stated == expected.get(name, set())
        delays = {one.delay.value if one.delay else 0.0 for one in model.inputs}
        assert delays == ({0.003} if name in ("play_delay", "play_stated") else {0.0})


def assert_one_delay(diagnosis: sh.Diagnosis, *joints: str) -> None:
    """All commands act 3 ms late, by one number, and nothing else is wrong with a channel."""
    faults = diagnosis.measurement
    assert [(one.channel, one.kind) for one in faults] == [
        (f"{joint}_torque", "delay") for joint in joints
    ]
    assert {(one.value, one.together) for one in faults} == {(faults[0].value, 1)}
    assert faults[0].value == pytest.approx(3e-3, abs=1e-5)
    late = {one.channel for one in diagnosis.alternatives if one.kind == "delay"}
    assert late >= {*joints}


@pytest.mark.slow
def test_a_rotor_and_the_delay_are_named(study: ModuleType, tmp_path: Path) -> None:
    answer = study.diagnosed(study.CASES["rotor"], tmp_path)
    diagnosis = answer.diagnosis
    assert diagnosis.verdict == "missing physics"
    (rotor,) = diagnosis.found
    assert rotor.element.kind == "added_mass"
    assert rotor.element.place == On("elbow")
    assert rotor.mass.value == pytest.approx(0.03, rel=0.005)
    assert_one_delay(diagnosis, "base", "shoulder", "elbow")
    scores = answer.verdict.to_frame()
    runs = scores[scores.score == "free_run_rmse"]
    assert (runs.before > 1e-2).all()
    assert (runs.after < 1e-4).all()


@pytest.mark.thorough
def test_a_payload_and_the_delay_are_named(study: ModuleType, tmp_path: Path) -> None:
    diagnosis = study.diagnosed(study.CASES["payload_point"], tmp_path).diagnosis
    assert diagnosis.verdict == "missing physics"
    (payload,) = diagnosis.found
    assert (payload.element.kind, payload.element.place) == ("payload", At("hand"))
    assert payload.mass.value == pytest.approx(0.4, rel=0.005)
    assert payload.mass.sd < 0.002
    assert_one_delay(diagnosis, "base", "shoulder", "elbow")


@pytest.mark.thorough
def test_play_in_a_gear_is_named_beside_the_delay(study: ModuleType, tmp_path: Path) -> None:
    diagnosis = study.diagnosed(study.CASES["play"], tmp_path).diagnosis
    assert diagnosis.verdict == "missing physics"
    (play,) = diagnosis.found
    assert (play.element.kind, play.element.place) == ("play", On("gear"))
    assert play.clearance.value == pytest.approx(5e-3, rel=0.003)
    assert play.stiffness.value == pytest.approx(400, rel=0.005)
    assert_one_delay(diagnosis, "shoulder", "elbow")


@pytest.mark.thorough
def test_a_ball_in_the_hand_is_named_with_its_own_inertia(
    study: ModuleType, tmp_path: Path
) -> None:
    answer = study.diagnosed(study.CASES["payload"], tmp_path)
    found = {one.element.kind: one for one in answer.diagnosis.found}
    assert found.keys() == {"payload", "added_inertia"}
    assert {one.element.place for one in found.values()} == {At("hand")}
    assert found["payload"].mass.value == pytest.approx(0.4, rel=0.005)
    assert found["added_inertia"].inertia.value == pytest.approx(0.4 * 0.4 * 0.03**2, rel=0.02)
    assert_one_delay(answer.diagnosis, "base", "shoulder", "elbow")
    scores = answer.verdict.to_frame()
    windows = scores[scores.score == "window_rmse"]
    assert (windows.after < 1e-4).all()


LIKE_PUSHER = """<mujoco>
  <option gravity="0 0 0"/>
  <worldbody>
    <body name="r_shoulder_pan_link">
      <joint name="r_shoulder_pan_joint" axis="0 0 1" armature="0.04"/>
      <geom size="0.1" mass="2"/>
      <body name="r_shoulder_lift_link">
        <joint name="r_shoulder_lift_joint" axis="0 1 0" armature="0.04"/>
        <joint name="roll" axis="1 0 0"/>
        <geom size="0.1" pos="0.2 0 0" mass="2"/>
        <body name="r_elbow_flex_link" pos="0.4 0 0">
          <joint name="r_elbow_flex_joint" axis="0 1 0" armature="0.04"/>
          <geom size="0.05" pos="0.1 0 0" mass="1"/>
          <body name="r_wrist_flex_link" pos="0.3 0 0">
            <joint name="r_wrist_flex_joint" axis="0 1 0" armature="0.04"/>
            <geom size="0.03" mass="0.2"/>
          </body>
        </body>
      </body>
    </body>
  </worldbody>
  <actuator>
    <motor joint="r_shoulder_pan_joint" ctrlrange="-2 2"/>
    <motor joint="r_shoulder_lift_joint"/>
    <motor joint="roll"/>
    <motor joint="r_elbow_flex_joint"/>
    <motor joint="r_wrist_flex_joint"/>
  </actuator>
</mujoco>"""


def test_what_is_concealed_in_the_arm_of_a_package_is_in_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot = tmp_path / "robot.xml"
    robot.write_text(LIKE_PUSHER, encoding="utf-8")
    with scripts("mujoco_arm", ("recordings", "pusher")) as found:
        pusher, recordings = found["pusher"], found["recordings"]
        monkeypatch.setattr(pusher, "owners_file", lambda: robot)
        monkeypatch.setitem(recordings.SECONDS, "train", 0.4)
        for name, case in pusher.cases(tmp_path).items():
            given = recordings.real_arm(case.arm, None)
            real = recordings.real_arm(case.arm, case.change)
            joints = [given.joint(k).name for k in range(given.njnt)]
            assert joints == [*case.arm.joints]  # no joint that rolls
            assert given.nu == real.nu == 4
            elbow = joints.index("r_elbow_flex_joint")
            concealed = {
                "friction": real.dof_frictionloss[elbow],
                "load": real.body_mass.sum() - given.body_mass.sum(),
                "play": max(given.jnt_stiffness) - max(real.jnt_stiffness),
            }
            true = {"friction": 0.15, "load": 0.15, "play": 150.0}
            there = {*true} if name == "all" else {name}
            assert concealed == pytest.approx({k: true[k] * (k in there) for k in true})
            run = recordings.record(case, "train")
            assert all(np.abs(run[f"{joints[k]}_torque"]).max() <= 2 for k in case.arm.driven)
            model = recordings.owners_model(case, tmp_path / "model.toml")
            assert [one.name for one in model.coordinates] == joints
            assert [one.name for one in model.points] == ["tips"]
