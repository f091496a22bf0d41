"""Tasks that compare structures: what they leave, what the table shows, and what is refused."""

import json
from pathlib import Path

import pytest
from builders import DRIVEN_MASS
from sweeps import write_sweep

from symhyb.errors import InputError
from symhyb.fleet.rungs import weighed
from symhyb.study.file import read_study
from symhyb.tasks.expand import tasks_of
from symhyb.tasks.fitting import read_fit
from symhyb.tasks.outcome import read_outcomes
from symhyb.tasks.rows import rows_of
from symhyb.tasks.run import How, Ran, run_sweep
from symhyb.tasks.work import perform

FIT = """\
symhyb = 1
title = "a mass with friction"
model = "model.toml"
fit = ["d"]
[[train]]
files = "r*.csv"
[sweep]
each = "recording"
[[sweep.structures]]
name = "viscous"
values = { F = 0 }
[[sweep.structures]]
name = "dry"
fit = ["F"]
values = { F = 0.5 }
"""
DRY = '\n[elements.dry]\nkind = "friction"\non = "x"\ncoulomb = "F"\ntransition = "0.01 m/s"\n'


def study_in(folder: Path, text: str = FIT, **sizes: int) -> Path:
    file = write_sweep(folder, text, **sizes)
    model = DRIVEN_MASS.replace("\n[inputs]", '\nF = { value = 0, unit = "N" }\n[inputs]', 1)
    (folder / "model.toml").write_text(model + DRY, encoding="utf-8")
    return file


def at_once(tasks, directory, workers, ended, perform_) -> None:  # type: ignore[no-untyped-def]
    for task in tasks:
        perform(task, directory)
        ended(task)


def test_a_task_leaves_evidence_and_numbers_of_every_structure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("symhyb.tasks.run.run_here", at_once)
    study = read_study(study_in(tmp_path, recordings=2))
    assert run_sweep(study, tmp_path / "out", How(workers=1)) == Ran(2, 2, 0, {})
    outcomes = read_outcomes(tmp_path / "out")
    one = outcomes.tasks[0]
    assert one.fitted is not None
    assert one.fitted.names == ("d", "F")
    assert [(rung.name, rung.probability > 0.99) for rung in one.fitted.rungs] == [
        ("viscous", False),
        ("dry", True),
    ]
    assert one.found["F"].value == pytest.approx(0.8, rel=0.05)
    table = rows_of(outcomes)
    row = dict(zip(table.head, table.rows[0], strict=True))
    assert row["structure"] == "dry"
    assert row["structure dry ln evidence"] == 0.0
    assert row["structure dry probability"] == pytest.approx(1.0)
    viscous, dry = weighed(outcomes)
    assert (dry.evidence, dry.likeliest, dry.recordings) == (0.0, 2, 2)
    said = [rungs.fitted.rungs[0].evidence for rungs in outcomes.tasks if rungs.fitted]
    assert viscous.evidence == pytest.approx(sum(said))
    folder = next((tmp_path / "out" / "tasks").iterdir())
    assert len(json.loads((folder / "manifest.json").read_text())["structures"]) == 2


def test_structures_are_part_of_the_key(tmp_path: Path) -> None:
    file = study_in(tmp_path, samples=0)
    before = tasks_of(read_study(file))
    assert len(before) == 3
    file.write_text(FIT.replace("F = 0.5", "F = 0.6"), encoding="utf-8")
    assert tasks_of(read_study(file))[0].key != before[0].key


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('fit = ["d"]\n', "", "name what all of them fit"),
        ('fit = ["F"]', 'fit = ["G"]', "sweep.structures.dry: there is no parameter 'G'"),
        ('fit = ["F"]', 'fit = ["d"]', "'d' is named twice"),
        ('fit = ["F"]', "fit = 3", "must be a list of names"),
        ("{ F = 0 }", "{ G = 0 }", "sweep.structures.viscous"),
        ("{ F = 0 }", '{ F = "x" }', "must be a number"),
        ('name = "dry"', 'name = "viscous"', "'viscous' is the name of another structure"),
        ('name = "dry"\n', "", "'name' is missing"),
        ('"r*.csv"\n', '"r*.csv"\nparameters = { F = 1.0 }\n', "recordings state it as known"),
        (FIT[FIT.rindex("[[sweep") :], "", "one structure is compared with nothing"),
        (FIT[FIT.index("[[sweep") :], "structures = 1\n", "write each structure as a table"),
    ],
)
def test_what_cannot_be_compared_is_said_before_anything_runs(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    assert old in FIT
    file = study_in(tmp_path, FIT.replace(old, new), samples=0)
    with pytest.raises(InputError) as caught:
        tasks_of(read_study(file))
    assert said in "\n".join(map(str, caught.value.problems))


@pytest.mark.parametrize(
    "wrong", [{"ln_evidence": 1.0}, {"probability": 2}, {"name": None, "probability": None}]
)
def test_a_damaged_structure_is_refused(wrong: dict[str, object]) -> None:
    one = {
        "numbers": [{"name": "k", "unit": "1", "value": 1}],
        "covariance": [[4.0]],
        "noise_multiple": {"before": None, "after": 2.0},
        "samples": 5,
        "correlation_time": 1.0,
        "bounds": [],
    }
    rung = {"name": "a", "ln_evidence": 0.0, "probability": 1.0, **one}
    lost = {"name": "b", "ln_evidence": None, "probability": 0.0}
    fit = read_fit({**one, "structures": [rung, lost]})
    assert [part.fitted is None for part in fit.rungs] == [False, True]
    with pytest.raises((ValueError, TypeError)):
        read_fit({**one, "structures": [{**rung, **wrong}, lost]})
