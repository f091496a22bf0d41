"""Recordings of a study by a pattern of names and by a table; what is wrong is named at once."""

from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.limits import STUDY_RECORDINGS
from symhyb.study.file import read_study
from symhyb.study.sources import Source

HEAD = 'symhyb = 1\nmodel = "model.toml"\n'


def study(folder: Path, text: str, **files: str) -> Path:
    for name in ("model.toml", "runs/b.csv", "runs/a.csv", "runs/c.txt"):
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).touch()
    for name, content in files.items():
        (folder / f"{name}.csv").write_text(content, encoding="utf-8")
    (folder / "study.toml").write_text(HEAD + text, encoding="utf-8")
    return folder / "study.toml"


def problems(path: Path) -> list[str]:
    with pytest.raises(InputError) as caught:
        read_study(path)
    return [str(one).removeprefix(f"{path}:") for one in caught.value.problems]


# --- patterns -----------------------------------------------------------------------------------


def test_a_pattern_names_every_file_that_fits_sorted_by_name(tmp_path: Path) -> None:
    text = '[[train]]\nfiles = "runs/*.csv"\nspan = [0, 5]\nparameters = { m = 2 }\n'
    read = read_study(study(tmp_path, text)).train
    assert [one.file for one in read] == [tmp_path / "runs" / "a.csv", tmp_path / "runs" / "b.csv"]
    assert all(one.span == (0, 5) and one.parameters == (("m", 2.0),) for one in read)


def test_a_pattern_of_folders_and_one_of_everything(tmp_path: Path) -> None:
    read = read_study(study(tmp_path, '[[train]]\nfiles = "**/*.csv"\n')).train
    assert [one.name for one in read] == ["a.csv", "b.csv"]
    read = read_study(study(tmp_path, '[[train]]\nfiles = "r*/*"\n')).train
    assert [one.name for one in read] == ["a.csv", "b.csv", "c.txt"]


@pytest.mark.parametrize(
    ("pattern", "said"),
    [
        ("runs/*.mat", "4: train[1].files: no file fits 'runs/*.mat'"),
        ("runs/a.csv", "4: train[1].files: is no pattern of names"),
        ("../../*.csv", "4: train[1].files: '../../*.csv' leads out of the study's folder"),
        ("runs/*/../../*", "leads out of the study's folder"),
        ("/etc/*", "4: train[1].files: '/etc/*' leads out of the study's folder"),
    ],
)
def test_a_pattern_that_fits_nothing_or_leads_elsewhere(
    tmp_path: Path, pattern: str, said: str
) -> None:
    (found,) = problems(study(tmp_path, f'[[train]]\nfiles = "{pattern}"\n'))
    assert said in found


def test_a_link_that_leads_elsewhere_is_refused(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    path = study(home, '[[train]]\nfiles = "runs/*.csv"\n')
    (tmp_path / "secret.csv").touch()
    (home / "runs" / "z.csv").symlink_to(tmp_path / "secret.csv")
    (found,) = problems(path)
    assert "'runs/z.csv' lies outside of the study's folder" in found


def test_a_file_may_not_stand_twice_by_a_pattern(tmp_path: Path) -> None:
    text = '[[train]]\nfile = "runs/a.csv"\n[[train]]\nfiles = "runs/*.csv"\n'
    (found,) = problems(study(tmp_path, text))
    assert "6: train[2].files: 'a.csv' is listed already; name it once" in found
    apart = text.replace('"runs/a.csv"', '"runs/a.csv"\nspan = [0, 5]') + "span = [5, 9]\n"
    assert len(read_study(study(tmp_path, apart)).train) == 3


# --- tables -------------------------------------------------------------------------------------

TABLE = """\
file, start, end, parameters.m, groups.mount, map.laser
runs/a.csv, 0, 20, 1.5, light, qm [mm]
runs/b.csv, , , , heavy,
"""


def test_a_table_has_a_row_for_each_recording(tmp_path: Path) -> None:
    text = '[[train]]\ntable = "list.csv"\nspan = [1, 9]\nparameters = { m = 1, k = 2 }\n'
    read = read_study(study(tmp_path, text, list=TABLE)).train
    assert read == (
        Source(
            tmp_path / "runs" / "a.csv",
            span=(0.0, 20.0),
            columns=(("laser", "qm [mm]"),),
            parameters=(("m", 1.5), ("k", 2.0)),
            groups=(("mount", "light"),),
        ),
        Source(
            tmp_path / "runs" / "b.csv",
            span=(1.0, 9.0),
            parameters=(("m", 1.0), ("k", 2.0)),
            groups=(("mount", "heavy"),),
        ),
    )


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("runs/b.csv", "runs/bb.csv", "list.csv, line 3: there is no file 'runs/bb.csv'; did you"),
        ("runs/b.csv", "runs/a.csv", "'a.csv' is listed already"),
        ("runs/b.csv", "", "list.csv, line 3: names no file"),
        ("1.5", "heavy", "list.csv, line 2: parameters.m must be a number, not 'heavy'"),
        ("1.5", "inf", "must be finite"),
        ("0, 20", "20, 20", "list.csv, line 2: the start 20 s is not before the end 20 s"),
        ("groups.mount", "group.mount", "list.csv: 'group.mount' is no column here; known: file"),
        ("map.laser", "groups.mount", "list.csv: 'groups.mount' has two columns"),
        ("file,", "name,", "list.csv: a column 'file' with the recordings is missing"),
        ("heavy,", "heavy", "list.csv, line 3: has 5 cells below a header of 6"),
        (TABLE, "file\n", "'list.csv' needs a header and a row for each recording"),
    ],
)
def test_each_mistake_of_a_table_has_its_line(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    assert old in TABLE
    changed = TABLE.replace(old, new, 1)
    found = problems(study(tmp_path, '[[train]]\ntable = "list.csv"\n', list=changed))
    assert any(said in one and one.startswith("4: train[1].table: ") for one in found)


def test_of_five_hundred_recordings_the_three_that_are_missing_are_named_at_once(
    tmp_path: Path,
) -> None:
    names = [f"runs/{number:03d}.csv" for number in range(503)]
    path = study(tmp_path, '[[train]]\ntable = "list.csv"\n', list="\n".join(["file", *names]))
    for i, name in enumerate(names):
        if i not in (7, 100, 502):
            (tmp_path / name).touch()
    found = problems(path)
    assert len(found) == 3
    for one, number in zip(found, (7, 100, 502), strict=True):
        assert f"list.csv, line {number + 2}: there is no file 'runs/{number:03d}.csv'" in one


def test_more_recordings_than_the_limit_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert STUDY_RECORDINGS > 500
    monkeypatch.setattr("symhyb.study.sources.STUDY_RECORDINGS", 1)
    (found,) = problems(study(tmp_path, '[[train]]\nfiles = "runs/*.csv"\n'))
    assert "2 recordings are more than 1" in found
