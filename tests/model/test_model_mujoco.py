"""A file of MuJoCo in place of bodies: read, checked, written, compared, and what cannot stand
beside it."""

from dataclasses import replace
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.model.closed import CLOSED
from symhyb.model.diff import changes
from symhyb.model.mujoco import Drive, Mujoco, Number
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.model.write import write_model
from symhyb.numeric.lowered.machine import build

HEAD = """symhyb = 1
[coordinates]
x = { unit = "m" }
turn = { unit = "rad" }
[parameters]
m = { value = 3.0, unit = "kg", sd = 0.1 }
d = { value = 3.0, unit = "N*m*s/rad" }
[inputs]
f = { unit = "N" }
g = { unit = "N" }
h = { unit = "N*m" }
[sensors]
laser = { measures = "x", unit = "m" }
"""
TABLE = """[mujoco]
file = "parts/arm.xml"
[mujoco.coordinates]
x = "slide"
[mujoco.inputs]
f = "motor"
g = { site = "tip", along = [0, 0.6, 1] }
h = { joint = "turn" }
[mujoco.parameters]
m = { body = "hand", field = "mass" }
d = { joint = "turn", field = "damping" }
"""


def said(text: str) -> str:
    with pytest.raises(InputError) as caught:
        parse_model(text)
    return str(caught.value)


def test_it_is_read_with_joints_in_the_order_of_the_coordinates() -> None:
    found = parse_model(HEAD + TABLE).mujoco
    assert found == Mujoco(
        "parts/arm.xml",
        (("x", "slide"), ("turn", "turn")),  # the joint of its own name
        (
            Drive("f", "actuator", "motor"),
            Drive("g", "site", "tip", (0.0, 0.6, 1.0)),
            Drive("h", "joint", "turn"),
        ),
        (Number("m", "body", "hand", "mass"), Number("d", "joint", "turn", "damping")),
    )
    assert found.path("models/arm.toml") == Path("models/parts/arm.xml")


def test_what_is_written_reads_back() -> None:
    model = parse_model(HEAD + TABLE)
    assert parse_model(render(model)).mujoco == model.mujoco
    bare = replace(model.mujoco, inputs=(), parameters=())
    assert parse_model(render(replace(model, mujoco=bare))).mujoco == bare


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"parts/arm.xml"', '"../arm.xml"', "must be a file beside the model file or below it"),
        ('"parts/arm.xml"', '"/etc/arm.xml"', "must be a file beside the model file or below it"),
        ('file = "parts/arm.xml"', "", "mujoco: 'file' is missing"),
        ('x = "slide"', 'x = "turn"', "the joint 'turn' is named twice"),
        ('x = "slide"', "x = 3", "must be text in quotes, not the number 3"),
        ("f = ", "k = ", "'k' is not declared in [inputs]"),
        ('"motor"', "[1]", "must be a table, not a list of 1"),
        ('joint = "turn" }', 'joints = "turn" }', "not a key here; did you mean 'joint'?"),
        ('h = { joint = "turn" }', "h = {}", "names nothing; name one of actuator, joint"),
        ('{ joint = "turn" }', '{ joint = "a", site = "b" }', "names joint and site; name one"),
        (", along = [0, 0.6, 1]", "", "'along' is missing: a direction"),
        ("[0, 0.6, 1]", "[0, 1]", "must be a direction in the axes of the world, a list of three"),
        ("[0, 0.6, 1]", "[0, 0, 0]", "has no direction"),
        ('"turn" }', '"turn", along = [0, 0, 1] }', "is for a site; leave it out"),
        ('"mass"', '"damping"', "must be one of mass for a body, not 'damping'"),
        ('"damping"', '"dampin"', "not 'dampin'; did you mean 'damping'?"),
        (', field = "mass"', "", "'field' is missing"),
        ('d = { joint = "turn", field', 'd = { body = "hand", field', "not 'damping'"),
    ],
)
def test_what_is_wrong_is_said(old: str, new: str, expected: str) -> None:
    assert TABLE.count(old) == 1
    assert expected in said(HEAD + TABLE.replace(old, new))


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('x = { unit = "m" }', 'x = { unit = "V" }', "is V; a joint is an angle or a length"),
        ('m = { value = 3.0, unit = "kg"', 'm = { value = 3.0, unit = "N"', "is N, needs kg"),
        ('"N*m*s/rad"', '"N*s/m"', "damping of a joint"),
        ('g = { unit = "N" }', 'g = { unit = "N*m" }', "inputs.g.unit: is N*m, needs"),
        ('h = { unit = "N*m" }', 'h = { unit = "N" }', "inputs.h.unit: is N, needs"),
    ],
)
def test_units_are_those_of_what_is_set(old: str, new: str, expected: str) -> None:
    assert HEAD.count(old) == 1
    assert expected in said(HEAD.replace(old, new) + TABLE)


@pytest.mark.parametrize(
    ("section", "text"),
    [
        ("bodies", '[bodies.b]\nmass = 1\nat = ["x", "0"]\n'),
        ("energy", '[energy]\npotential = "m*x**2/2"\n'),
        ("constraints", '[constraints.c]\nkind = "gear"\non = ["x", "turn"]\nratio = 2\n'),
    ],
)
def test_nothing_says_again_what_mujoco_has(section: str, text: str) -> None:
    assert f"{section}: MuJoCo has the machine" in said(HEAD + TABLE + text)


def test_no_coordinate_is_imposed_and_no_fmu_stands_beside() -> None:
    text = HEAD.replace('x = { unit = "m" }', 'x = { unit = "m", imposed = true }') + TABLE
    assert "coordinates.x.imposed: an imposed coordinate is not possible" in said(text)
    assert "mujoco: stands beside [fmu]" in said(HEAD + TABLE + '[fmu]\nfile = "a.fmu"\n')


def test_what_became_of_it_is_said() -> None:
    model = parse_model(HEAD + TABLE)
    other = replace(model, mujoco=replace(model.mujoco, file="b.xml"))
    assert any("'parts/arm.xml' -> 'b.xml'" in line for line in changes(model, other))


def test_the_file_goes_with_the_model_file_and_no_other_is_overwritten(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    (first / "parts").mkdir(parents=True)
    (first / "arm.toml").write_text(HEAD + TABLE)
    (first / "parts/arm.xml").write_text("<mujoco/>")
    model = read_model(first / "arm.toml")
    (second / "parts").mkdir(parents=True)
    write_model(model, second / "arm.toml")
    assert (second / "parts/arm.xml").read_text() == "<mujoco/>"
    (second / "parts/arm.xml").write_text("<mujoco></mujoco>")
    with pytest.raises(InputError, match="is another file of MuJoCo"):
        write_model(model, second / "arm.toml")


def test_what_needs_equations_says_that_there_are_none() -> None:
    with pytest.raises(InputError) as caught:
        build(parse_model(HEAD + TABLE))
    (problem,) = caught.value.problems
    assert (problem.text, problem.place) == (CLOSED, "mujoco")
