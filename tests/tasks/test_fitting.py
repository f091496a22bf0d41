"""Tasks that fit: what a study says of them, what is left, and what is refused."""

import json
from pathlib import Path

import numpy as np
import pytest
from sweeps import write_sweep

from symhyb.errors import InputError
from symhyb.study.file import read_study
from symhyb.study.run import run_study
from symhyb.tasks.expand import tasks_of
from symhyb.tasks.fitting import read_fit
from symhyb.tasks.outcome import FITTED, read_outcomes
from symhyb.tasks.rows import rows_of
from symhyb.tasks.run import How, Ran, run_sweep
from symhyb.tasks.work import perform

FIT = """\
symhyb = 1
title = "a mass with friction"
model = "model.toml"
fit = ["m", "d"]
[[train]]
files = "r*.csv"
groups = { drive = "a" }
[sweep]
each = "recording"
"""


def at_once(tasks, directory, workers, ended, perform_) -> None:  # type: ignore[no-untyped-def]
    for task in tasks:
        perform(task, directory)
        ended(task)


def test_every_task_leaves_its_values_with_their_covariance(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("symhyb.tasks.run.run_here", at_once)
    study = read_study(write_sweep(tmp_path, FIT, recordings=2))
    assert run_sweep(study, tmp_path / "out", How(workers=1)) == Ran(2, 2, 0, {})
    outcomes = read_outcomes(tmp_path / "out")
    for one in outcomes.tasks:
        fit = one.fitted
        assert fit is not None
        assert (one.verdict, fit.names) == (FITTED, ("m", "d"))
        assert (np.linalg.eigvalsh(fit.covariance) > 0).all()
        assert fit.after < fit.before
        assert fit.samples > 100
        assert one.found["m"].sd == pytest.approx(fit.sd[0])
        assert one.entry.recordings[0].groups == (("drive", "a"),)
    table = rows_of(outcomes)
    assert f"m [{outcomes.tasks[0].found['m'].unit}]" in table.head
    folder = next((tmp_path / "out" / "tasks").iterdir())
    assert sorted(one.name for one in folder.iterdir()) == [
        "fit.json",
        "fitted.toml",
        "manifest.json",
        "task.json",
    ]
    said = json.loads((folder / "manifest.json").read_text())
    assert said["fit"] == ["m", "d"]
    assert str(tmp_path) not in json.dumps(said)
    assert run_sweep(study, tmp_path / "out", How(workers=1, resume=True)) == Ran(2, 2, 2, {})


def test_what_is_fitted_is_part_of_the_key(tmp_path: Path) -> None:
    file = write_sweep(tmp_path, FIT, samples=0)
    before = tasks_of(read_study(file))[0].key
    file.write_text(FIT.replace('"m", "d"', '"d"'), encoding="utf-8")
    assert tasks_of(read_study(file))[0].key != before
    file.write_text(FIT.replace('fit = ["m", "d"]\n', ""), encoding="utf-8")
    assert len(tasks_of(read_study(file))) == 3


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('["m", "d"]', '["m", "dd"]', "did you mean 'd'"),
        ('["m", "d"]', '["m", "m"]', "'m' is named twice"),
        ('["m", "d"]', '"m"', "must be a list of names"),
        ('["m", "d"]', "[1]", "must be a list of names"),
        ('[sweep]\neach = "recording"\n', "", "symhyb fit fits one model once"),
        ('fit = ["m", "d"]', 'fit = ["m"]\nown = ["m"]', "says how to diagnose"),
        ('fit = ["m", "d"]', 'fit = ["m"]\nbudget = "1min"', "'budget' says how to diagnose"),
        ('each = "recording"', '[[sweep.options]]\nname = "a"\nown = ["m"]', "sweep.options.a"),
        ("groups = {", "parameters = { m = 1.0 }\ngroups = {", "recordings state it as known"),
    ],
)
def test_what_cannot_be_fitted_is_said_before_anything_runs(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    assert old in FIT
    file = write_sweep(tmp_path, FIT.replace(old, new), samples=0)
    with pytest.raises(InputError, match=said):
        tasks_of(read_study(file))


def test_a_study_that_fits_is_no_single_diagnosis(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="states many"):
        run_study(write_sweep(tmp_path, FIT, samples=0), tmp_path / "out")


def test_numbers_that_are_not_determined_have_infinite_deviations() -> None:
    fit = read_fit(
        {
            "numbers": [{"name": name, "unit": "1", "value": 1} for name in ("k", "d")],
            "covariance": [[4.0, 1.0], [1.0, None]],
            "noise_multiple": {"before": None, "after": 2.0},
            "samples": 5,
            "correlation_time": 1.0,
            "bounds": ["d"],
        }
    )
    assert fit.sd.tolist() == [2.0, np.inf]
    assert fit.covariance[0, 1] == 0.0
    assert (fit.before, fit.after) == (np.inf, 4.0)


def test_deviations_whose_fourth_power_is_no_number_are_read() -> None:
    """Of a run that leaves every bound the slopes are as large as 10⁸⁵."""
    tiny, part = 1e-170, 0.9e-170
    fit = read_fit(
        {
            "numbers": [{"name": name, "unit": "1", "value": 1} for name in ("k", "d")],
            "covariance": [[tiny, part], [part, tiny]],
            "noise_multiple": {"before": 2.0, "after": 2.0},
            "samples": 5,
            "correlation_time": 1.0,
            "bounds": [],
        }
    )
    assert fit.sd.tolist() == pytest.approx([1e-85, 1e-85], rel=1e-12)
