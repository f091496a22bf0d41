"""An FMU in place of bodies: read, checked, written, compared, and what cannot stand beside it."""

from dataclasses import replace
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.mechanics.show import show_equations
from symhyb.model.closed import CLOSED, require_open
from symhyb.model.diff import changes
from symhyb.model.fmu import Fmu, FmuPlace
from symhyb.model.local import Local
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.model.write import write_model
from symhyb.numeric.lowered.machine import build

HEAD = """symhyb = 1
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
[parameters]
k = { value = 3.0, unit = "N/m", sd = 0.1 }
[inputs]
f = { unit = "N" }
[sensors]
laser = { measures = "x", unit = "m" }
"""
FMU = """[fmu]
file = "parts/arm.fmu"
[fmu.coordinates]
y = { position = "y", rate = "vy", force = "fy" }
x = { position = "x", rate = "vx", force = "fx" }
[fmu.inputs]
f = "drive"
[fmu.parameters]
k = "spring.k"
"""


def said(text: str) -> str:
    with pytest.raises(InputError) as caught:
        parse_model(text)
    return str(caught.value)


def test_an_fmu_is_read_with_its_places_in_the_order_of_the_coordinates() -> None:
    fmu = parse_model(HEAD + FMU).fmu
    places = FmuPlace("x", "x", "vx", "fx"), FmuPlace("y", "y", "vy", "fy")
    assert fmu == Fmu("parts/arm.fmu", places, (("f", "drive"),), (("k", "spring.k"),))
    assert fmu.path("models/arm.toml") == Path("models/parts/arm.fmu")


def test_what_is_written_reads_back() -> None:
    model = parse_model(HEAD + FMU)
    assert parse_model(render(model)).fmu == model.fmu
    assert parse_model(render(replace(model, fmu=replace(model.fmu, inputs=())))).fmu.inputs == ()


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ('"parts/arm.fmu"', '"../arm.fmu"', "must be a file beside the model file or below it"),
        ('file = "parts/arm.fmu"', "", "fmu: 'file' is missing"),
        ('force = "fx"', 'forces = "fx"', "'forces' is not a key here; did you mean 'force'?"),
        ('"fy"', '"fx"', "the variable 'fx' of the FMU is named twice"),
        ("f = ", "g = ", "'g' is not declared in [inputs]"),
        ("k = ", "c = ", "'c' is not declared in [parameters]"),
        ("y = { position", "z = { position", "'y' is missing: its position, rate and force"),
        (', force = "fx"', "", "x: needs either 'force', an input that acts along"),
        ('force = "fx"', 'force = "fx", mass = "1 kg"', "x: needs either 'force'"),
        ('force = "fx"', 'mass = "1 kg"', "some coordinates name a 'force' and others a 'mass'"),
        ('force = "fx"', 'mass = "k"', "x.mass: is no number above 0 with its unit"),
        ('force = "fx"', 'mass = "0 kg"', "x.mass: is no number above 0 with its unit"),
        ('"spring.k"', "3", "must be text in quotes, not the number 3"),
    ],
)
def test_what_is_wrong_is_said(old: str, new: str, expected: str) -> None:
    assert FMU.count(old) == 1
    assert expected in said(HEAD + FMU.replace(old, new))


MASSES = FMU.replace('force = "fy"', 'mass = "250 g"').replace('force = "fx"', 'mass = "3 kg"')


def test_masses_stand_in_for_forces() -> None:
    model = parse_model(HEAD + MASSES)
    assert model.fmu is not None
    assert [place.force for place in model.fmu.places] == ["", ""]
    assert [place.mass and place.mass.value for place in model.fmu.places] == [3.0, 0.25]
    assert parse_model(render(model)).fmu == model.fmu


def test_a_mass_has_the_unit_that_a_force_moves() -> None:
    text = HEAD + MASSES.replace("3 kg", "3 kg*m^2")
    assert "fmu.coordinates.x.mass: is kg*m^2, needs kg on a coordinate in m" in said(text)
    turned = HEAD.replace('x = { unit = "m" }', 'x = { unit = "rad" }').replace("laser", "# laser")
    assert "x.mass: is kg, needs" in said(turned + MASSES)


@pytest.mark.parametrize(
    ("section", "text"),
    [
        ("bodies", '[bodies.b]\nmass = 1\nat = ["x", "0"]\n'),
        ("energy", '[energy]\npotential = "k*x**2/2"\n'),
        ("constraints", '[constraints.c]\nkind = "gear"\non = ["x", "y"]\nratio = 2\n'),
    ],
)
def test_nothing_says_again_what_the_fmu_is(section: str, text: str) -> None:
    assert f"{section}: the FMU is the machine" in said(HEAD + FMU + text)


def test_no_coordinate_of_an_fmu_is_imposed() -> None:
    text = (HEAD + FMU).replace('y = { unit = "m" }', 'y = { unit = "m", imposed = true }')
    assert "coordinates.y.imposed: an imposed coordinate is not possible" in said(text)


def test_what_became_of_an_fmu_is_said() -> None:
    model = parse_model(HEAD + FMU)
    other = replace(model, fmu=replace(model.fmu, file="b.fmu"))
    assert any("'parts/arm.fmu' -> 'b.fmu'" in line for line in changes(model, other))


def test_the_fmu_goes_with_the_model_file_and_no_other_is_overwritten(tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    (first / "parts").mkdir(parents=True)
    (second / "parts").mkdir(parents=True)
    (first / "arm.toml").write_text(HEAD + FMU)
    (first / "parts/arm.fmu").write_bytes(b"one")
    model = read_model(first / "arm.toml")
    write_model(model, second / "arm.toml")
    write_model(model, second / "again.toml")
    write_model(model, first / "again.toml")
    assert (second / "parts/arm.fmu").read_bytes() == b"one"
    (second / "parts/arm.fmu").write_bytes(b"two")
    with pytest.raises(InputError, match="is another FMU; write the model into another folder"):
        write_model(model, second / "arm.toml")


def test_what_needs_equations_says_that_an_fmu_has_none() -> None:
    model = parse_model(HEAD + FMU)
    for needs in (require_open, build, show_equations):
        with pytest.raises(InputError) as caught:
            needs(model)
        assert caught.value.problems[0].text == CLOSED
    require_open(replace(model, local=Local(())))
