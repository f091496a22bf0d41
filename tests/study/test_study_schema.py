"""The schema of study files: current, kind to every study that ships, hard on mistakes."""

import tomllib
from pathlib import Path

import jsonschema
import pytest

from symhyb.errors import InputError
from symhyb.model.schema_parts import written
from symhyb.study.file import SECTIONS, read_study
from symhyb.study.schema import FILE, main, study_schema

ROOT = Path(__file__).parents[2]
SCHEMA = study_schema()
VALID = jsonschema.Draft7Validator(SCHEMA)
STUDIES = sorted((ROOT / "studies").rglob("study.toml"))

GOOD = """
symhyb = 1
title = "a study"
model = "model.toml"
own = ["drag"]
[map]
force = "gtau*vir"
[[train]]
file = "train.csv"
span = [0.0, 20.0]
[score]
window_s = 0.25
[finish]
values = true
"""

MISTAKES = [
    ("symhyb = 1", "symhyb = 3"),
    ("symhyb = 1", ""),
    ('model = "model.toml"', ""),
    ('model = "model.toml"', "model = 3"),
    ('title = "a study"', 'titel = "a study"'),
    ('own = ["drag"]', 'own = "drag"'),
    ('force = "gtau*vir"', "force = 1"),
    ('own = ["drag"]', 'fit = "drag"'),
    ("[[train]]", "[[holdout]]"),
    ("[[train]]", "[train]"),
    ('file = "train.csv"', ""),
    ('file = "train.csv"', 'file = "train.csv"\ndata = "emps/DATA_EMPS.mat"'),
    ('file = "train.csv"', 'fill = "train.csv"'),
    ("span = [0.0, 20.0]", "span = [0.0]"),
    ("window_s = 0.25", "window_s = 0"),
    ("window_s = 0.25", "window = 0.25"),
    ("values = true", "values = 1"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("model.toml", "train.csv"):
        (tmp_path / name).write_text("", encoding="utf-8")
    return tmp_path


def test_the_schema_that_is_shipped_is_current() -> None:
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    assert FILE.read_text(encoding="utf-8") == written(SCHEMA)


def test_its_sections_are_those_of_the_reader() -> None:
    assert set(SCHEMA["properties"]) == set(SECTIONS)


def test_it_is_written_where_one_wants_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["", str(tmp_path / "study.schema.json")])
    main()
    assert (tmp_path / "study.schema.json").read_bytes() == FILE.read_bytes()


@pytest.mark.parametrize("file", STUDIES, ids=lambda file: file.relative_to(ROOT).as_posix())
def test_every_study_that_is_shipped_is_valid(file: Path) -> None:
    VALID.validate(tomllib.loads(file.read_text(encoding="utf-8")))


def test_a_good_file_is_valid_and_read(folder: Path) -> None:
    VALID.validate(tomllib.loads(GOOD))
    (folder / "study.toml").write_text(GOOD, encoding="utf-8")
    assert read_study(folder / "study.toml").train


@pytest.mark.parametrize(("right", "wrong"), MISTAKES)
def test_a_mistake_is_refused_by_the_schema_as_by_the_reader(
    right: str, wrong: str, folder: Path
) -> None:
    assert right in GOOD
    text = GOOD.replace(right, wrong, 1)
    assert not VALID.is_valid(tomllib.loads(text))
    (folder / "study.toml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError):
        read_study(folder / "study.toml")
