"""A machine that is a file of MuJoCo, end to end: its runs and windows are MuJoCo's, what is
concealed in it is named, and the correction is written and exported."""

import json
from pathlib import Path

import numpy as np
import pytest
from command import Call

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.residual import compare
from symhyb.imports.deliver import Order, model_of, read_robot
from symhyb.model.closed import CLOSED
from symhyb.model.types import On
from tests.mujoco_rigs import FINGER, PRESS, drive, finger, press, recorded, rubbing

NOISE = {"finger": 1e-4, "press": 2e-6}  # rad, m
FRICTION = 0.5  # N


def of_finger(seed: int, end: float = 4.0, xml: str = FINGER) -> Recording:
    return recorded(xml, drive(seed, 2.0, 2.0, 5.0), NOISE["finger"], end, seed)


def of_press(seed: int, end: float = 4.0, xml: str = PRESS) -> Recording:
    return recorded(xml, drive(seed, 3.0, -5.0, 12.0), NOISE["press"], end, seed)


@pytest.mark.parametrize(
    ("make", "run"), [pytest.param(finger, of_finger, marks=pytest.mark.slow), (press, of_press)]
)
def test_what_mujoco_recorded_lacks_nothing_and_windows_are_its_own(make, run, tmp_path) -> None:  # type: ignore[no-untyped-def]
    model, recording = make(tmp_path), run(1)
    found = compare(model, recording)
    inner = slice(50, -50)
    assert np.sqrt(np.mean((found.force / found.band)[inner] ** 2)) < 2
    verdict = sh.judge(model, model, on=recording)
    assert verdict.holdout is not None
    before, width = verdict.holdout.before, np.ptp(recording.sensors["laser"])
    noise = NOISE[make.__name__] / width
    assert before.window_nrmse["laser"] == pytest.approx(noise, rel=0.1)
    assert before.free_run_nrmse["laser"] == pytest.approx(noise, rel=0.1)


@pytest.mark.slow
def test_a_tendon_and_a_contact_are_what_an_import_leaves_out(tmp_path: Path) -> None:
    """The same recordings, with the model file that the import makes of the file."""
    for make, run, what in ((finger, of_finger, "tendons"), (press, of_press, "")):
        model, recording = make(tmp_path), run(1)
        imported, notes = model_of(read_robot(tmp_path / "machine.xml"), Order())
        assert not what or any(what in note for note in notes)
        sensor, driver = imported.sensors.names()[0], imported.inputs.names()[0]
        renamed = Recording(
            "run.csv",
            recording.t,
            {driver: recording.inputs["f"]},
            {sensor: recording.sensors["laser"]},
            (),
            "",
        )
        lacks = np.sqrt(np.mean(compare(imported, renamed).force ** 2))
        assert lacks > 20 * np.sqrt(np.mean(compare(model, recording).force ** 2))


@pytest.mark.slow
def test_friction_beside_a_contact_is_named_and_exported(tmp_path: Path, symhyb: Call) -> None:
    model, rubs = press(tmp_path), rubbing(PRESS, "guide", FRICTION)
    train, unseen = (of_press(seed, 8.0, rubs) for seed in (1, 2))
    diagnosis = sh.diagnose(model, train, holdout=unseen)
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.place) == ("friction", On("x"))
    (value,) = found.estimates
    assert value.value == pytest.approx(FRICTION, rel=0.02)
    corrected = sh.apply(model, diagnosis.found)
    verdict = sh.judge(model, corrected, on=unseen)
    assert verdict.holdout is not None
    before, after = verdict.holdout.before, verdict.holdout.after
    noise = NOISE["press"] / np.ptp(unseen.sensors["laser"])
    for score in ("window_nrmse", "free_run_nrmse"):
        assert getattr(after, score)["laser"] == pytest.approx(noise, rel=0.1)
        assert getattr(before, score)["laser"] > 3 * noise
    (tmp_path / "out").mkdir()
    sh.write_model(corrected, tmp_path / "out" / "corrected.toml")
    assert (tmp_path / "out" / "machine.xml").read_text() == PRESS
    out = str(tmp_path / "correction")
    said = symhyb("export", str(tmp_path / "out" / "corrected.toml"), "--to", "c", "-o", out)
    assert said.status == 0
    for line in ("inputs: v.x [m/s]", "outputs: dF.x [N]"):
        assert line in said.out


@pytest.mark.slow
def test_nothing_is_named_where_nothing_is_concealed(tmp_path: Path) -> None:
    diagnosis = sh.diagnose(finger(tmp_path), of_finger(1, 8.0), holdout=of_finger(2, 8.0))
    assert not diagnosis.found
    assert "Nothing is missing" in diagnosis.sentence


@pytest.mark.slow
def test_a_parameter_of_mujoco_is_fitted(tmp_path: Path, symhyb: Call) -> None:
    model = finger(tmp_path)
    number = '[mujoco.parameters]\nk = { tendon = "cord", field = "stiffness" }\n[parameters]\n'
    number += 'k = { value = 180.0, sd = 20.0, unit = "N/m" }\n'
    file = tmp_path / "softer.toml"
    file.write_text(model.text.replace("[coordinates]", f"{number}[coordinates]"))
    of_finger(1).to_frame().to_csv(tmp_path / "run.csv")
    out = tmp_path / "fitted.toml"
    assert symhyb("fit", file, tmp_path / "run.csv", "-o", out).status in (0, 1)
    assert sh.read_model(out).parameters["k"].value == pytest.approx(200.0, rel=5e-3)


@pytest.mark.slow
def test_the_command_line_knows_what_it_can_do(tmp_path: Path, symhyb: Call) -> None:
    file, record = press(tmp_path).file, str(tmp_path / "run.csv")
    of_press(1).to_frame().to_csv(record)
    assert symhyb("check", file).status == 0
    said = symhyb("compare", file, record)
    assert said.status == 0
    assert "no larger than its noise" in said.out
    (facts,) = json.loads(symhyb("compare", file, record, "--json").out)["recordings"]
    assert "first_checks" not in facts
    refused = symhyb("equations", file)
    assert refused.status == 2
    assert CLOSED in refused.err
