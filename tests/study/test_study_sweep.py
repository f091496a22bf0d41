"""The sweep of a study file: what is read of it, and what the reader and the schema refuse."""

import tomllib
from pathlib import Path

import jsonschema
import pytest

from symhyb.errors import InputError
from symhyb.study.file import Study, read_study
from symhyb.study.schema import study_schema
from symhyb.study.sweep import Noise, Structure, Subsets, Sweep

VALID = jsonschema.Draft7Validator(study_schema())

GOOD = """\
symhyb = 1
values = { k = 3 }
noise = { level = 0.5, seed = 4 }
[[train]]
file = "a.csv"
[sweep]
models = ["soft.toml", "stiff.toml"]
[sweep.values]
m = [0.5, 0.6]
[sweep.subsets]
size = 1
count = 1
seed = 3
[sweep.noise]
levels = [0.0, 0.01]
seeds = [1, 2]
[[sweep.options]]
name = "own drag"
own = ["drag"]
finish = { values = true }
score = { window_s = 0.5 }
[[sweep.options]]
name = "plain"
"""
STRUCTURES = """\
symhyb = 1
model = "soft.toml"
fit = ["k"]
[[train]]
file = "a.csv"
[sweep]
each = "recording"
[[sweep.structures]]
name = "without"
values = { F = 0 }
[[sweep.structures]]
name = "dry"
fit = ["F"]
"""


def read(folder: Path, text: str) -> Study:
    for name in ("soft.toml", "stiff.toml", "a.csv"):
        (folder / name).touch()
    (folder / "study.toml").write_text(text, encoding="utf-8")
    return read_study(folder / "study.toml")


def test_a_sweep_reads_as_it_is_written(tmp_path: Path) -> None:
    VALID.validate(tomllib.loads(GOOD))
    study = read(tmp_path, GOOD)
    own = {"own": {"drag": ""}, "window_s": 0.5, "force_band_hz": None}
    assert (study.values, study.noise) == ((("k", 3.0),), Noise(0.5, 4))
    assert study.sweep == Sweep(
        models=(tmp_path / "soft.toml", tmp_path / "stiff.toml"),
        values=(("m", (0.5, 0.6)),),
        subsets=Subsets(1, 1, 3),
        noise=(Noise(0.0), Noise(0.01, 1), Noise(0.01, 2)),
        options=(
            ("own drag", {**own, "last_values": True, "remainder": None, "network": None}),
            ("plain", {}),
        ),
    )


def test_structures_read_as_they_are_written(tmp_path: Path) -> None:
    VALID.validate(tomllib.loads(STRUCTURES))
    study = read(tmp_path, STRUCTURES)
    assert study.sweep is not None
    without, dry = Structure("without", (), (("F", 0.0),)), Structure("dry", ("F",))
    assert study.sweep.structures == (without, dry)


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ('name = "dry"', ""),
        ('fit = ["F"]', "fit = []"),
        ('fit = ["F"]', 'fit = "F"'),
        ('fit = ["F"]', "fits = 1"),
        ("F = 0", 'F = "0"'),
        ('[[sweep.structures]]\nname = "dry"\nfit = ["F"]\n', ""),
    ],
)
def test_a_wrong_structure_is_refused_by_both(right: str, wrong: str, tmp_path: Path) -> None:
    assert right in STRUCTURES
    text = STRUCTURES.replace(right, wrong, 1)
    assert not VALID.is_valid(tomllib.loads(text))
    with pytest.raises(InputError):
        read(tmp_path, text)


MISTAKES = [
    ('models = ["soft.toml", "stiff.toml"]', 'models = "soft.toml"'),
    ('models = ["soft.toml", "stiff.toml"]', "models = []"),
    ('models = ["soft.toml", "stiff.toml"]', ""),
    ("m = [0.5, 0.6]", "m = 0.5"),
    ("m = [0.5, 0.6]", "m = [0.5, 0.5]"),
    ("m = [0.5, 0.6]", 'm = ["x"]'),
    ("size = 1", "size = 0"),
    ("size = 1", ""),
    ("count = 1", "count = 1.5"),
    ("seed = 3", "seed = -1"),
    ("levels = [0.0, 0.01]", "levels = [-1]"),
    ("levels = [0.0, 0.01]", ""),
    ("seeds = [1, 2]", 'seeds = ["a"]'),
    ("seeds = [1, 2]", "seeds = [-1]"),
    ("seeds = [1, 2]", "seed = 1"),
    ('name = "plain"', ""),
    ('own = ["drag"]', "own = 1"),
    ("window_s = 0.5", "window_s = 0"),
    ("level = 0.5, ", ""),
    ("level = 0.5", "level = -1"),
    ("k = 3", 'k = "3"'),
]


@pytest.mark.parametrize(("right", "wrong"), MISTAKES)
def test_a_mistake_is_refused_by_the_schema_as_by_the_reader(
    right: str, wrong: str, tmp_path: Path
) -> None:
    assert right in GOOD
    text = GOOD.replace(right, wrong, 1)
    assert not VALID.is_valid(tomllib.loads(text))
    with pytest.raises(InputError) as caught:
        read(tmp_path, text)
    assert "Traceback" not in str(caught.value)


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ("symhyb = 1", 'symhyb = 1\nmodel = "soft.toml"', "model: the sweep states models"),
        ("[sweep]", '[sweep]\neach = "recording"', "state each or subsets, not both"),
        ('name = "plain"', 'name = "own drag"', "'own drag' is the name of another set already"),
        ('"soft.toml", ', '"sof.toml", ', "there is no file 'sof.toml'; did you mean 'soft.toml'?"),
        ("[sweep.values]", "[sweep.value]", "'value' is not a key here; did you mean 'values'?"),
    ],
)
def test_what_the_reader_alone_sees(tmp_path: Path, right: str, wrong: str, said: str) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, GOOD.replace(right, wrong, 1))
    assert said in str(caught.value)


def test_a_sweep_that_varies_nothing_is_refused(tmp_path: Path) -> None:
    text = 'symhyb = 1\nmodel = "soft.toml"\n[[train]]\nfile = "a.csv"\n[sweep]\n'
    with pytest.raises(InputError, match="varies nothing"):
        read(tmp_path, text)
    assert not VALID.is_valid(tomllib.loads(text))
