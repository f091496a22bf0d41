"""Recordings of one machine with a known weight each: every step takes the weights that are known,
and the laws that are found are shared."""

import json
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

import symhyb as sh
from symhyb.cli.app import app
from symhyb.correction.calibration import calibrated
from symhyb.discrepancy.checks.first_checks import first_checks
from tests.known_weights import BARE, PENDULUM, WEIGHTS, recorded, swing

DAMPING = 0.004


@pytest.fixture(scope="module")
def bare():
    return sh.parse_model(BARE)


@pytest.fixture(scope="module")
def runs(bare):
    return [recorded(bare, *weight, c=DAMPING) for weight in WEIGHTS]


def test_the_missing_force_is_that_of_the_known_weight(bare):
    run = recorded(bare, *WEIGHTS[2])  # nothing is missing
    knowing = sh.compare(bare, run)
    ignorant = sh.compare(bare, replace(run, parameters={}))
    size = [np.sqrt(np.mean(one.force**2)) for one in (knowing, ignorant)]
    assert size[0] < 3 * np.sqrt(np.mean(knowing.band**2))
    assert size[1] > 3 * size[0]


def test_a_run_is_simulated_with_what_its_recording_knows(bare):
    run = recorded(bare, *WEIGHTS[1])
    driven = sh.simulate(bare, run)
    alone = swing(bare, *WEIGHTS[1])
    np.testing.assert_allclose(driven.y, alone.y, atol=1e-9)
    other = sh.simulate(bare, run, parameters={"l": 0.1})  # what is asked for counts
    assert np.abs(other.y - alone.y).max() > 0.1


def test_modes_are_those_of_the_known_length(bare):
    for weight, length in WEIGHTS:
        checked = first_checks(sh.build(bare), recorded(bare, weight, length))
        wanted = np.sqrt(9.81 / length) / (2 * np.pi)
        assert checked.swings[0].modes[0].frequency == pytest.approx(wanted, rel=1e-3)


def test_scores_are_those_of_the_known_weights(bare, runs):
    found = sh.parse_model(BARE.replace("value = 0.0", f"value = {DAMPING}"))
    verdict = sh.judge(bare, found, on=runs)
    after = verdict.holdout.after
    assert after.free_run_rmse["encoder"] == pytest.approx(1e-3, rel=0.1)
    assert after.window_rmse["encoder"] == pytest.approx(1e-3, rel=0.1)
    assert verdict.holdout.before.free_run_rmse["encoder"] > 0.05


def test_a_shared_parameter_is_fitted_through_all_weights(runs):
    done = calibrated(sh.parse_model(PENDULUM), runs)
    (damping,) = done.parameters
    assert damping.value == pytest.approx(DAMPING, rel=0.01)
    assert done.after < 1.2  # nothing but noise is left


def test_what_is_fitted_cannot_be_known(runs):
    model = sh.parse_model(PENDULUM)
    with pytest.raises(sh.InputError, match="is to be fitted, but recordings state known"):
        calibrated(model, runs, ["m"])
    with pytest.raises(sh.InputError, match="is to be fitted, but recordings state known"):
        sh.diagnose(model, runs, own=["l"])
    mixed = [runs[0], replace(runs[1], parameters={"m": 0.7})]
    with pytest.raises(sh.InputError, match="is not stated here, but for other recordings"):
        sh.diagnose(model, mixed)
    with pytest.raises(sh.InputError, match="there is no parameter 'n' in the model"):
        sh.compare(sh.read_model("models/oscillator.toml"), replace(runs[0], parameters={"n": 1.0}))


@pytest.mark.slow
def test_a_law_is_found_once_for_all_weights(bare, runs):
    unseen = recorded(bare, 900.0, 0.14, c=DAMPING)
    diagnosis = sh.diagnose(bare, runs, holdout=unseen)
    assert diagnosis.verdict == "missing physics"
    (found,) = diagnosis.found
    assert found.element.kind == "damper"
    assert found.damping.value == pytest.approx(DAMPING, rel=0.02)
    verdict = sh.judge(bare, sh.apply(bare, diagnosis.found), on=unseen)
    assert verdict.holdout.after.free_run_rmse["encoder"] < 1.5e-3


def test_nothing_is_missing_where_only_the_weights_differ(bare):
    runs = [recorded(bare, *weight) for weight in WEIGHTS]
    assert sh.diagnose(bare, runs).verdict == "nothing missing"


@pytest.fixture
def folder(tmp_path, bare, runs):
    (tmp_path / "model.toml").write_text(BARE, encoding="utf-8")
    rows = ["recording, m [kg], l [m]"]
    for run in runs:
        columns = np.column_stack([run.t, run.sensors["encoder"]])
        file = tmp_path / run.name
        np.savetxt(file, columns, delimiter=",", header="t,encoder", comments="")
        rows.append(f"{run.name}, {run.parameters['m']}, {run.parameters['l']}")
    (tmp_path / "known.csv").write_text("\n".join(rows), encoding="utf-8")
    return tmp_path


def called(*arguments: object):
    return CliRunner().invoke(app, [str(one) for one in arguments], catch_exceptions=True)


def test_a_table_says_on_the_command_line_what_is_known(folder, runs):
    files = [folder / run.name for run in runs]
    known = ("--known", folder / "known.csv")
    done = called("compare", folder / "model.toml", *files, *known, "--json")
    assert done.exit_code == 0
    shown = json.loads(done.stdout)["recordings"]
    modes = [one["first_checks"]["modes"][0]["modes"][0]["frequency"] for one in shown]
    wanted = [np.sqrt(9.81 / length) / (2 * np.pi) for _, length in WEIGHTS]
    np.testing.assert_allclose(modes, wanted, rtol=1e-3)
    fitted = called("fit", folder / "model.toml", *files, *known, "--free", "c", "--json")
    assert fitted.exit_code == 0
    (damping,) = json.loads(fitted.stdout)["parameters"]
    assert damping["value"] == pytest.approx(DAMPING, rel=0.01)
    driven = ("--input", files[2], "-o", folder / "run.csv")
    assert called("simulate", folder / "model.toml", *driven, *known).exit_code == 0
    rows = np.loadtxt(folder / "run.csv", delimiter=",", skiprows=1)
    alone = swing(sh.read_model(folder / "model.toml"), *WEIGHTS[2])
    np.testing.assert_allclose(rows[:, 1], alone.y[:, 0], atol=1e-6)


def test_a_recording_that_the_table_has_not_is_refused(folder, runs):
    other = folder / "other.csv"
    other.write_text((folder / runs[0].name).read_text())
    done = called("compare", folder / "model.toml", other, "--known", folder / "known.csv")
    assert isinstance(done.exception, sh.InputError)
    assert "has no row for the recording" in str(done.exception)
    looked = called("look", other, "--known", folder / "known.csv")
    assert "give the model, too" in str(looked.exception)


def test_a_study_says_for_each_recording_what_is_known(folder, runs):
    parts = ['symhyb = 1\nmodel = "model.toml"']
    for run in runs[:2]:
        known = f"{{ m = {1000 * run.parameters['m']}, l = {run.parameters['l']} }}"
        parts.append(f'[[train]]\nfile = "{run.name}"\nparameters = {known}')
    (folder / "study.toml").write_text("\n".join(parts), encoding="utf-8")
    from symhyb.study.file import read_study
    from symhyb.study.run import read_all

    model = sh.read_model(folder / "model.toml")
    read, _ = read_all(read_study(folder / "study.toml"), model)
    for one, run in zip(read, runs, strict=False):
        assert one.parameters == pytest.approx(run.parameters)
    (folder / "study.toml").write_text(
        "\n".join([*parts, f'[[holdout]]\nfile = "{runs[2].name}"']), encoding="utf-8"
    )
    with pytest.raises(sh.InputError, match="is not stated here, but for other recordings"):
        read_all(read_study(folder / "study.toml"), model)
    wrong = parts[1].replace("l = 0.1", 'l = "long"')
    (folder / "study.toml").write_text("\n".join([parts[0], wrong]), encoding="utf-8")
    with pytest.raises(sh.InputError, match="must be a number, not"):
        read_study(folder / "study.toml")
