"""The run of a real arm: joints do the work of the motors, and least squares that know what is
missing find the published friction."""

from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import symhyb as sh
from tests.absent import absent
from tests.scripts import scripts

VISCOUS = (8.05, 5.53, 1.97, 1.11)  # N·m·s/rad, published, of the first four joints
DRY = (7.14, 8.26, 6.34, 2.48)  # N·m
WRIST = (0.616, 1.95)  # of motor 6, which turns with joint 5 and joint 6


@pytest.fixture(scope="module")
def study() -> Iterator[dict[str, ModuleType]]:
    """The scripts of the study beside each other."""
    with scripts("arm", ("recordings", "by_hand", "tiago")) as found:
        yield found


def folder_of(recordings: ModuleType) -> Path:
    folder: Path | None = recordings.folder_of_run()
    return folder or absent("set SYMHYB_DATA to a folder that holds staubli_tx40")


def test_joints_do_the_work_of_the_motors(study, tmp_path) -> None:
    chance = np.random.default_rng(1)
    angles, torques = chance.normal(size=(2, 9, 6))
    for name, values in (("pos_read_data.csv", angles), ("curr_data.csv", torques)):
        np.savetxt(tmp_path / name, values, "%.17g", ",", header="a,b,c,d,e,f", comments="")
    q, torque = study["recordings"].recorded(tmp_path)
    motors, joints = np.diff(angles, axis=0), np.diff(q, axis=0)
    assert np.sum(torque[1:] * joints, axis=1) == pytest.approx(
        np.sum(torques[1:] * motors, axis=1)
    )
    assert motors[:, 5] == pytest.approx(32 * (joints[:, 4] + joints[:, 5]))


def test_least_squares_give_the_numbers_back(study) -> None:
    by_hand = study["by_hand"]
    chance = np.random.default_rng(2)
    columns, numbers = chance.normal(size=(300, 6, 27)), chance.normal(size=27)
    part = by_hand.Torques(np.ones((300, 6)), columns @ numbers, columns)
    assert by_hand.solved(part) == pytest.approx(numbers)


@pytest.mark.slow
def test_least_squares_find_the_published_friction(study, tmp_path) -> None:
    recordings, by_hand = study["recordings"], study["by_hand"]
    folder = folder_of(recordings)
    model = recordings.arm(folder, tmp_path / "arm.toml")
    train, unseen = (by_hand.torques_of(model, one) for one in recordings.split(folder, model))
    numbers = by_hand.solved(train)
    found = numbers[: -recordings.JOINTS].reshape(-1, 3)
    assert found[:4, 1] == pytest.approx(VISCOUS, rel=0.05)
    assert found[:4, 2] == pytest.approx(DRY, rel=0.06)
    assert found[6, 1:] == pytest.approx(WRIST, rel=0.05)
    left = unseen.lacks - unseen.columns @ numbers
    assert by_hand.error(unseen.lacks, unseen.applied) > 0.6
    assert by_hand.error(left, unseen.applied) < 0.16


@pytest.mark.thorough
def test_the_diagnosis_of_the_urdf_leaves_as_little_as_least_squares(study, tmp_path) -> None:
    recordings, by_hand = study["recordings"], study["by_hand"]
    folder = folder_of(recordings)
    model = recordings.arm(folder, tmp_path / "arm.toml")
    train, unseen = recordings.split(folder, model)
    diagnosis = sh.diagnose(model, train, unseen)
    found = {(one.element.kind, str(one.element.place)) for one in diagnosis.found}
    joints = [f"On(coordinate='joint_{i}')" for i in range(1, 6)]
    for place in (*joints, "On(coordinate='joint_5 + joint_6')"):
        assert {("damper", place), ("friction", place)} <= found
    corrected = sh.apply(model, diagnosis.found)
    learned, rest, left = (
        by_hand.torques_of(one, part)
        for one, part in ((model, train), (model, unseen), (corrected, unseen))
    )
    known = rest.lacks - rest.columns @ by_hand.solved(learned)
    limit = 1.05 * by_hand.error(known, rest.applied)
    assert by_hand.error(left.lacks, left.applied) < limit


@pytest.fixture
def mobile(study, tmp_path) -> tuple[ModuleType, sh.Model, Path]:
    """The script of the arm of a mobile robot, its model, and the folder of its recording."""
    tiago = study["tiago"]
    folder = tiago.folder_of_run() or absent("set SYMHYB_DATA to a folder that holds tiago_arm")
    tiago.write_arm(folder, tmp_path / "tiago.toml")
    return tiago, sh.read_model(tmp_path / "tiago.toml"), folder


def test_four_joints_of_the_mobile_arm_are_free_and_know_no_friction(mobile) -> None:
    tiago, model, _ = mobile
    assert [one.name for one in model.coordinates if not one.imposed] == list(tiago.FREE)
    assert {one.name for one in model.coordinates if one.imposed} == {*tiago.GIVEN}
    assert [one.kind for one in model.elements] == ["torque"] * 4
    assert model.inputs.names() == tuple(f"{name}_torque" for name in tiago.FREE)


@pytest.mark.slow
def test_currents_of_the_mobile_arm_are_torques_by_the_stated_constants(mobile) -> None:
    tiago, model, folder = mobile
    run = tiago.columns(folder)
    kept = run["t"] < tiago.TRAIN_S
    part = {key: values[kept] for key, values in run.items()}
    rows = tiago.by_hand(model, sh.Recording.from_frame(part, model, name="train"))
    assert rows[1:, 0] == pytest.approx(1.0, abs=0.15)  # joint 1 moves too little inertia to say
    assert (rows[:, 1:3] > 0).all()  # what is lost is lost
    assert (rows[:, 3] < 0.25).all()
