"""Readings of instruments: units, and where they may not stand."""

from dataclasses import replace

import pytest

from symhyb.errors import InputError
from symhyb.model.expression import Reading, parse_expression
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.sensing import reading_unit

RIG = """\
symhyb = 1
[coordinates]
x = { unit = "mm", imposed = true }
phi = { unit = "rad", imposed = true }
y = { unit = "m" }
[parameters]
m = { value = 2, unit = "kg" }
k = { value = 3, unit = "N/m" }
force = { value = 3, unit = "N" }
d = { value = 0.1, unit = "N*s^2/m^2" }
[inputs]
f = { unit = "N" }
[points]
wall = ["0", "0"]
tip = { body = "arm", at = ["1e3*x", "0"] }
volts = ["force", "0"]
[bodies.arm]
joint = "wall"
angle = "phi"
mass = "m"
[bodies.block]
mass = "m"
at = ["y", "0"]
[elements.rail]
kind = "friction"
on = "x"
coulomb = "force"
[elements.spring]
kind = "spring"
between = ["wall", "tip"]
stiffness = "k"
[elements.wind]
kind = "drag"
at = "tip"
drag = "d"
[sensors]
cell = { measures = "reaction(x) + force(rail)", unit = "kN" }
"""

GOOD = {
    "position_x(tip)": "mm",
    "position_y(tip)": "m",
    "distance(wall, tip) - k/k*x": "mm",
    "direction(wall, tip)": "rad",
    "sin(direction(wall, tip))": "1",
    "orientation(arm)": "deg",
    "gyroscope(arm)": "deg/s",
    "accelerometer_x(tip, arm)": "m/s^2",
    "accelerometer_y(wall, block)": "mm/s^2",
    "force(spring)": "N",
    "force*force(rail)/force": "mN",
    "reaction(x)": "N",
    "reaction(phi) + orientation(arm)*force*distance(wall, tip)": "N*m",
}


@pytest.mark.parametrize(("text", "unit"), GOOD.items(), ids=GOOD)
def test_what_instruments_show_has_a_unit(text: str, unit: str) -> None:
    line = f'probe = {{ measures = "{text}", unit = "{unit}" }}\n'
    model = parse_model(RIG + line)
    assert model.sensors[-1].measures == parse_expression(text)
    bare = replace(model, text="")
    assert replace(parse_model(render(bare)), text="") == bare
    with pytest.raises(InputError, match="needs A"):
        parse_model(RIG + line.replace(f'unit = "{unit}"', 'unit = "A"'))


def test_units_of_readings() -> None:
    model = parse_model(RIG)
    assert reading_unit(model, Reading("reaction", ("phi",))).text == "N*m"
    assert reading_unit(model, Reading("force", ("rail",))).text == "N"
    assert reading_unit(model, Reading("gyroscope", ("arm",))).text == "rad/s"
    for lost in (Reading("force", ("none",)), Reading("reaction", ("none",))):
        with pytest.raises(LookupError, match="none"):
            reading_unit(model, lost)


MEASURES = {
    "point unknown": ("distance(wall, tp)", "'tp' is not a known point; did you mean 'tip'"),
    "point of force": ("distance(wall, volts)", "the point 'volts' is in N; forces and"),
    "point itself": ("distance(tip, tip)", "distance(tip, tip) goes from the point 'tip' to"),
    "body unknown": ("gyroscope(arn)", "'arn' is not a known body; did you mean 'arm'"),
    "body that does not turn": ("gyroscope(block)", "the body 'block' does not turn"),
    "body no point": ("accelerometer_x(arm, arm)", "'arm' is not a known point"),
    "element unknown": ("force(rial)", "'rial' is not a known element; did you mean 'rail'"),
    "element at a point": ("force(wind)", "the force of 'wind' at a point is a vector"),
    "coordinate unknown": ("reaction(z)", "'z' is not a known coordinate; known: x, phi, y"),
    "coordinate free": ("reaction(y)", "the coordinate 'y' is free; only an imposed motion has a"),
    "names": ("distance(wall)", "'distance' takes 2 names, not 1; write distance(<point>,"),
    "sum": ("x + force(rail)", "adds 'x' in mm and 'force(rail)' in N"),
    "name": ("force(rail)*xx", "'xx' is not a known name"),
}


@pytest.mark.parametrize(("text", "sentence"), MEASURES.values(), ids=MEASURES)
def test_a_wrong_reading_is_one_problem(text: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_model(RIG + f'probe = {{ measures = "{text}", unit = "N" }}\n', "file")
    (problem,) = caught.value.problems
    assert str(problem).startswith("file:")
    assert "sensors.probe.measures: " in str(problem)
    assert sentence in str(problem)


ELSEWHERE = {
    "point": ('wall = ["0", "0"]', 'wall = ["distance(wall, tip)", "0"]', "a position"),
    "mass": ('mass = "m"', 'mass = "force(rail)"', "a mass or inertia"),
    "force": ('coulomb = "force"', 'coulomb = "force(rail)"', "a coefficient"),
    "law": (
        "[elements.rail]",
        '[elements.servo]\nkind = "law"\non = "y"\nforce = "-reaction(x)"\n[elements.rail]',
        "a force",
    ),
    "energy": (
        "[sensors]",
        '[energy]\npotential = "k*distance(wall, tip)**2"\n[sensors]',
        "a potential energy",
    ),
}


@pytest.mark.parametrize(("old", "new", "words"), ELSEWHERE.values(), ids=ELSEWHERE)
def test_only_sensors_use_readings(old: str, new: str, words: str) -> None:
    assert old in RIG
    with pytest.raises(InputError) as caught:
        parse_model(RIG.replace(old, new, 1))
    (problem,) = caught.value.problems
    assert "only sensors may use " in str(problem)
    assert f"(...), not {words}" in str(problem)


def test_an_element_that_cannot_be_read_stays_known_to_sensors() -> None:
    text = RIG.replace('kind = "friction"', 'kind = "fricton"')
    with pytest.raises(InputError) as caught:
        parse_model(text)
    (problem,) = caught.value.problems
    assert "did you mean 'friction'" in str(problem)


def test_the_name_of_an_imposed_coordinate_is_its_recording() -> None:
    assert parse_model(RIG + 'x = { measures = "x", unit = "mm" }\n').sensors[-1].name == "x"
    with pytest.raises(InputError) as caught:
        parse_model(RIG + 'x = { measures = "2*x", unit = "mm" }\n')
    (problem,) = caught.value.problems
    assert "sensors.x.measures: has the name of an imposed coordinate" in str(problem)
    assert "must measure 'x' itself, not '2*x'" in str(problem)
    assert parse_model(RIG + 'y = { measures = "2*y", unit = "mm" }\n').sensors[-1].name == "y"
