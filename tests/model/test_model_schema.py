"""The schema of model files: current, true to the reader, hard on mistakes."""

import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.schema import FILE, main, model_schema
from symhyb.model.schema_parts import written
from symhyb.model.tables import Table

ROOT = Path(__file__).parents[2]
SCHEMA = model_schema()
VALID = jsonschema.Draft7Validator(SCHEMA)
MODELS = sorted(
    file
    for folder in ("models", "studies")
    for file in (ROOT / folder).rglob("*.toml")
    if "\n[coordinates" in file.read_text(encoding="utf-8") and "/out/" not in file.as_posix()
)

GOOD = """
symhyb = 1
title = "a mass on a spring"
[coordinates]
x = { unit = "m", start = 0.1 }
[parameters]
m = { value = 1.2, unit = "kg" }
k = { value = 980.0, unit = "N/m", sd = 40.0 }
l = { value = 1, unit = "m" }
F = { value = 2.0, unit = "N" }
v = { value = 0.1, unit = "m/s" }
[inputs]
f = { unit = "N", gain = { value = 1.0, sd = 0.1 } }
[points]
wall = ["0", "0"]
tip = ["x + l", "0"]
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.rub]
kind = "friction"
between = ["wall", "tip"]
length = "l"
coulomb = "F"
static = "1.5*F"
stribeck = "v"
[elements.shaker]
kind = "force"
at = "tip"
force = ["f", "0"]
[elements.strut]
kind = "curve"
on = "x"
over = "rate"
units = ["m/s", "N"]
points = [[-1, -5], [1, 3]]
[elements.bush]
kind = "map"
on = "x"
units = ["mm", "m/s", "N"]
x = [-1, 1]
y = [-2, 2]
values = [[-9, 5], [-6, 8]]
[maps.other]
units = ["mm", "m/s", "N"]
y = [0, 2]
x = [0, 1]
values = [[0, 1], [2, 3]]
[sensors]
laser = { measures = "x", unit = "m", sd = 2e-5 }
[limits]
x = { unit = "m", travel = [-0.1, 0.1], speed = 2 }
"""

MISTAKES = [
    ("symhyb = 1", "symhyb = 2"),
    ("symhyb = 1", ""),
    ('title = "a', 'titel = "a'),
    ('title = "a mass on a spring"', "title = 5"),
    ('x = { unit = "m", start = 0.1 }', ""),
    ('x = { unit = "m", start = 0.1 }', "x = { start = 0.1 }"),
    ("start = 0.1", 'start = "0.1"'),
    ("start = 0.1", "begin = 0.1"),
    ("start = 0.1", 'imposed = "yes"'),
    ("x = {", "1x = {"),
    ("sd = 40.0", "sd = -40.0"),
    ("value = 1.2, ", ""),
    ("gain = { value = 1.0, sd = 0.1 }", "gain = 0"),
    ("gain = { value = 1.0, sd = 0.1 }", "gain = { sd = 0.1 }"),
    ("gain = { value = 1.0, sd = 0.1 }", 'between = "steps"'),
    ('wall = ["0", "0"]', 'wall = ["0"]'),
    ('wall = ["0", "0"]', 'wall = "0"'),
    ('mass = "m"\n', ""),
    ('at = ["x", "0"]\n', ""),
    ('at = ["x", "0"]\n', 'at = ["x", "0"]\nangle = "x"\n'),
    ('at = ["x", "0"]\n', 'at = ["x", "0"]\ninertia = "m"\n'),
    ('kind = "spring"', 'kind = "sprong"'),
    ('kind = "spring"\n', ""),
    ('on = "x"\nstiffness', "stiffness"),
    ('on = "x"\nstiffness', 'on = "x"\nbetween = ["wall", "tip"]\nstiffness'),
    ('on = "x"\nstiffness', 'at = "tip"\nstiffness'),
    ('stiffness = "k"', 'stifness = "k"'),
    ('stiffness = "k"', ""),
    ('stiffness = "k"', 'stiffness = "k"\nlength = "l"'),
    ('stiffness = "k"', "stiffness = true"),
    ('stribeck = "v"', ""),
    ('stribeck = "v"', "stribeck = 0"),
    ('["wall", "tip"]', '["wall"]'),
    ('force = ["f", "0"]', 'force = "f"'),
    ('force = ["f", "0"]', 'force = ["f", "0"]\ntension = "f"'),
    ("x = [-1, 1]\n", ""),
    ("x = [-1, 1]", "x = [1]"),
    ("values = [[-9, 5], [-6, 8]]", "values = [[-9, 5], [-6]]"),
    ("values = [[-9, 5], [-6, 8]]", 'file = "other.csv"'),
    ("values = [[-9, 5], [-6, 8]]", 'map = "bush"'),
    ("y = [0, 2]", 'file = "other.csv"'),
    ("y = [0, 2]", 'y = "other"'),
    ('["mm", "m/s", "N"]\nx', '["m/s", "N"]\nx'),
    ('over = "rate"', ""),
    ('over = "rate"', 'over = "speed"'),
    ("points = [[-1, -5], [1, 3]]", ""),
    ("points = [[-1, -5], [1, 3]]", "points = [[-1, -5]]"),
    ("points = [[-1, -5], [1, 3]]", 'points = [[-1, -5], [1, 3]]\ninterpolation = "cubic"'),
    ('measures = "x", ', ""),
    ("travel = [-0.1, 0.1]", "travel = [-0.1]"),
    ("speed = 2", "speed = -2"),
    ("speed = 2", "rate = 2"),
    ('x = { unit = "m", travel = [-0.1, 0.1], speed = 2 }', 'x = { unit = "m" }'),
]


def test_the_schema_that_is_shipped_is_current() -> None:
    assert FILE.read_text(encoding="utf-8") == written(SCHEMA)


def test_the_schema_is_one() -> None:
    jsonschema.Draft7Validator.check_schema(SCHEMA)


def test_there_are_models_to_hold_against_it() -> None:
    assert len(MODELS) > 50


def test_it_is_written_where_one_wants_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["", str(tmp_path / "model.schema.json")])
    main()
    assert (tmp_path / "model.schema.json").read_bytes() == FILE.read_bytes()


@pytest.mark.parametrize("file", MODELS, ids=lambda file: file.relative_to(ROOT).as_posix())
def test_every_model_that_is_shipped_is_valid(file: Path) -> None:
    VALID.validate(tomllib.loads(file.read_text(encoding="utf-8")))


def test_a_good_file_is_valid_and_read() -> None:
    VALID.validate(tomllib.loads(GOOD))
    assert parse_model(GOOD).elements


@pytest.mark.parametrize(
    ("right", "wrong", "said"),
    [
        ('stiffness = "k"', 'stifness = "k"', "'stifness' was unexpected"),
        ('over = "rate"', "", "'over' is a required property"),
        ('kind = "spring"', 'kind = "sprong"', "'sprong' is not one of"),
        ("speed = 2", "speed = -2", "-2 is less than or equal"),
    ],
)
def test_the_sentence_is_on_the_key_that_is_wrong(right: str, wrong: str, said: str) -> None:
    faults = VALID.iter_errors(tomllib.loads(GOOD.replace(right, wrong, 1)))
    told = [inner.message for fault in faults for inner in (fault, *(fault.context or ()))]
    assert any(said in one for one in told)


@pytest.mark.parametrize(("right", "wrong"), MISTAKES)
def test_a_mistake_is_refused_by_the_schema_as_by_the_reader(right: str, wrong: str) -> None:
    assert GOOD.count(right) >= 1
    text = GOOD.replace(right, wrong, 1)
    assert not VALID.is_valid(tomllib.loads(text))
    with pytest.raises(InputError):
        parse_model(text)


def forms(schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A schema and its alternatives, references followed."""
    if "$ref" in schema:
        schema = SCHEMA["definitions"][schema["$ref"].rpartition("/")[2]]
    yield schema
    for one in (*schema.get("oneOf", ()), *schema.get("anyOf", ())):
        yield from forms(one)


def at(path: tuple[str, ...]) -> list[dict[str, Any]]:
    """The schemas of what stands at a path of a model file."""
    found = [SCHEMA]
    for part in path:
        inner = [form for one in found for form in forms(one)]
        found = [one["properties"][part] for one in inner if part in one.get("properties", {})]
        named = [form["patternProperties"] for form in inner if "patternProperties" in form]
        found += [entry for one in named for entry in one.values()]
    return [form for one in found for form in forms(one)]


@pytest.mark.parametrize("file", MODELS[::5], ids=lambda file: file.relative_to(ROOT).as_posix())
def test_the_schema_has_the_keys_that_the_reader_takes(
    file: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: dict[tuple[str, ...], tuple[dict[str, Any], set[str]]] = {}
    plain = Table.checked

    def noted(self: Table, keys: tuple[str, ...]) -> Table:
        asked[self.path] = dict(self.entries), set(keys)
        return plain(self, keys)

    monkeypatch.setattr(Table, "checked", noted)
    parse_model(file.read_text(encoding="utf-8"), str(file))
    assert asked
    for path, (entries, keys) in asked.items():
        kind = entries.get("kind")
        known = [form["properties"] for form in at(path) if "properties" in form]
        known = [own for own in known if own.get("kind", {}).get("const", kind) == kind]
        # a place that a kind cannot have is refused by its own sentence, and so are axes
        free = {"on", "between", "at", "pair", "axes"} if path[:1] == ("elements",) else set()
        assert free | keys in [free | own.keys() for own in known], path
