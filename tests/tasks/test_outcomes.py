"""Tables of the tasks of a study, and what two of them say differently."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import sweeps
from fakes import NOTHING, friction, verdict
from sweeps import write_sweep

from symhyb.errors import InputError
from symhyb.report.contract import to_json
from symhyb.study.file import read_study
from symhyb.tasks.differences import differences_of
from symhyb.tasks.expand import tasks_of
from symhyb.tasks.folder import Ended, held, leave_ended, prepare, whole, write_index
from symhyb.tasks.outcome import Number, read_outcomes
from symhyb.tasks.rows import csv_text, rows_of, write_parquet
from symhyb.tasks.work import leave_failed


@pytest.fixture
def left(tmp_path: Path) -> Path:
    """A folder with friction, nothing, a failure, and three tasks that were not run."""
    study = read_study(write_sweep(tmp_path, samples=0))
    tasks, out = tasks_of(study), tmp_path / "out"
    with held(out):
        write_index(out, study.title, tasks)
        prepare(out)
        for task, one in zip(tasks, (friction(), NOTHING), strict=False):
            with whole(out, task.key) as folder:
                content = to_json(one, verdict())
                content["classes"] = [
                    {
                        "kind": "hysteresis",
                        "place": {"on": "q"},
                        "probability": 0.7,
                        "figure": None,
                        "sentence": "",
                    }
                ]
                (folder / "diagnosis.json").write_text(json.dumps(content))
                leave_ended(folder, Ended(seconds=1.5))
        leave_failed(out, tasks[2].key, "input", "r1.csv: has no column 'laser'")
    return out


def test_a_row_holds_what_came_out_of_its_task(left: Path) -> None:
    rows = rows_of(read_outcomes(left))
    table = [dict(zip(rows.head, row, strict=True)) for row in rows.rows]
    first = table[0]
    assert (first["recordings"], first["noise"], first["state"]) == ("r0.csv", "0.0", "finished")
    assert (first["verdict"], first["found"]) == ("missing physics", "q.coulomb")
    assert (first["q.coulomb [N]"], first["q.coulomb sd [N]"]) == (0.4905, 0.006)
    assert first["class q.hysteresis"] == 0.7
    assert (first["holdout.before.window_rmse.position"], first["window_s"]) == (0.05, 0.5)
    assert (table[1]["verdict"], table[1]["q.coulomb [N]"]) == ("nothing missing", None)
    assert (table[2]["state"], table[2]["failure"]) == ("failed", "r1.csv: has no column 'laser'")
    assert [one["state"] for one in table[3:]] == ["not run"] * 3
    assert "seconds" not in rows.head
    timed = rows_of(read_outcomes(left), times=True)
    assert [row[timed.head.index("seconds")] for row in timed.rows[:2]] == [1.5, 1.5]


def test_csv_and_parquet_hold_the_same(left: Path, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    rows = rows_of(read_outcomes(left))
    (tmp_path / "t.csv").write_text(csv_text(rows))
    write_parquet(rows, tmp_path / "t.parquet")
    first, second = pd.read_csv(tmp_path / "t.csv"), pd.read_parquet(tmp_path / "t.parquet")
    assert list(first.columns) == list(second.columns) == list(rows.head)
    for name in rows.head:
        if first[name].dtype == float and name != "noise":
            assert np.array_equal(first[name], second[name].astype(float), equal_nan=True)
    assert list(second["verdict"])[:2] == ["missing physics", "nothing missing"]
    write_parquet(rows, tmp_path / "again.parquet")
    assert (tmp_path / "again.parquet").read_bytes() == (tmp_path / "t.parquet").read_bytes()


def test_units_that_differ_are_columns_of_their_own(left: Path) -> None:
    outcomes = read_outcomes(left)
    found = outcomes.tasks[1].found
    object.__setattr__(outcomes.tasks[1], "found", {**found, "q.coulomb": Number(1, None, "kN")})
    rows = rows_of(outcomes)
    cells = [dict(zip(rows.head, row, strict=True)) for row in rows.rows[:2]]
    assert [one["q.coulomb [N]"] for one in cells] == [0.4905, None]
    assert [one["q.coulomb [kN]"] for one in cells] == [None, 1]


def test_a_folder_without_tasks_and_damaged_files_are_sentences(left: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="holds no tasks of a study"):
        read_outcomes(tmp_path)
    file = next((left / "tasks").glob("*/diagnosis.json"))
    for content in ("{", "[]", '{"verdict": 1}', '{"verdict": "", "found": [1]}'):
        file.write_text(content)
        with pytest.raises(InputError, match="is no diagnosis"):
            read_outcomes(left)
    for content in ("{}", "[]", '{"title": "", "tasks": [{"name": 1}]}', "x"):
        (left / "study.json").write_text(content)
        with pytest.raises(InputError, match=r"is no list of tasks|is no JSON"):
            read_outcomes(left)
    entry = '{"name": "a", "settings": {}, "key": "../../etc"}'
    (left / "study.json").write_text(f'{{"title": "", "tasks": [{entry}]}}')
    with pytest.raises(InputError, match="is no key"):
        read_outcomes(left)


def test_what_two_studies_say_differently(left: Path, tmp_path: Path) -> None:
    first = read_outcomes(left)
    assert differences_of(first, first).same
    second = read_outcomes(left)
    one, two, three, four, five, six = second.tasks
    object.__setattr__(one, "found", {"q.coulomb": Number(0.4985, 0.008, "N")})
    object.__setattr__(two, "verdict", "undecided")
    object.__setattr__(two, "found", {"q.drag": Number(1, 0.1, "")})
    object.__setattr__(three, "failure", "another reason")
    object.__setattr__(second, "tasks", (one, two, three, four, five))
    found = differences_of(first, second)
    assert (found.common, found.only_first, found.only_second) == (5, (six.entry.name,), ())
    moved, named, failed = found.tasks
    assert moved.task == one.entry.name
    (value,) = moved.moved
    assert (value.name, value.first.value, value.second.value) == ("q.coulomb", 0.4905, 0.4985)
    assert value.deviations == pytest.approx(0.8)  # 0.008 over the root of 0.006² + 0.008²
    assert (named.verdicts, named.only_second) == (("nothing missing", "undecided"), ("q.drag",))
    assert failed.states == ("failed: r1.csv: has no column 'laser'", "failed: another reason")
    assert not found.same


def test_the_order_in_which_tasks_end_leaves_no_trace(tmp_path: Path) -> None:
    tables = []
    for name, order in (("a", 1), ("b", -1)):
        study = read_study(write_sweep(tmp_path / name, samples=0))
        tasks, out = tasks_of(study), tmp_path / name / "out"
        with held(out):
            write_index(out, study.title, tasks)
            prepare(out)
            for task in tasks[::order]:
                sweeps.quick(task, out)
        tables.append(csv_text(rows_of(read_outcomes(out))))
    assert tables[0] == tables[1]
