"""Constraints in the model file: what is read, what is refused, and what is written again."""

from dataclasses import replace
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.model.diff import changes
from symhyb.model.read import parse_model, read_model
from symhyb.model.render import render
from symhyb.model.types import Model

MODELS = Path(__file__).parents[2] / "models"
RIG = """\
symhyb = 1
[coordinates]
x   = { unit = "m", start = 0.5 }
phi = { unit = "rad" }
psi = { unit = "deg" }
[parameters]
m = { value = 1.0, unit = "kg" }
J = { value = 0.1, unit = "kg*m^2" }
l = { value = 0.4, unit = "m" }
[points]
o = ["0", "0"]
e = ["l", "0"]
p = ["x", "0"]
q = ["l*cos(phi)", "l*sin(phi)"]
[bodies.cart]
mass = "m"
at = "p"
[bodies.arm]
mass = "m"
at = "q"
inertia = "J"
angle = "phi"
[energy]
kinetic = "J*psi'**2/2"
[constraints.rod]
kind = "distance"
between = ["p", "q"]
length = "2*l"
about = "a light rod"
[constraints.rail]
kind = "slider"
point = "q"
along = ["o", "e"]
[constraints.teeth]
kind = "gear"
on = ["phi", "psi"]
ratio = "1/3"
offset = "0.1"
[constraints.wheel]
kind = "rolling"
on = ["x", "phi"]
radius = "l/2"
[constraints.hinge]
kind = "pin"
points = ["p", "q"]
[constraints.law]
kind = "equation"
zero = "x**2 - l**2*(1 + sin(phi)**2)"
"""
FAULTS = {
    "kind": (
        'kind = "gear"',
        'kind = "gaer"',
        "constraints.teeth.kind: 'gaer' is not a known kind of constraint; did you mean 'gear'?",
    ),
    "no kind": ('kind = "gear"\n', "", "constraints.teeth: 'kind' is missing"),
    "key": ('ratio = "1/3"', 'ration = "1/3"', "'ration' is not a key here; did you mean 'ratio'?"),
    "no length": ('length = "2*l"\n', "", "'length' is missing: a distance needs it"),
    "point": (
        'between = ["p", "q"]',
        'between = ["p", "oo"]',
        "constraints.rod.between: 'oo' is not a known point; did you mean 'o'?",
    ),
    "itself": ('between = ["p", "q"]', 'between = ["p", "p"]', "names 'p' twice"),
    "one point": (
        'points = ["p", "q"]',
        'points = ["p"]',
        "must be a list of two points, not a list of 1",
    ),
    "no points": ('points = ["p", "q"]\n', "", "'points' is missing: a list of two points"),
    "slider point": ('point = "q"', "point = 3", "constraints.rail.point: must be text in quotes"),
    "coordinate": (
        'on = ["phi", "psi"]',
        'on = ["phi", "pis"]',
        "'pis' is not a known coordinate; did you mean 'psi'?",
    ),
    "rolls an angle": ('on = ["x", "phi"]', 'on = ["psi", "phi"]', "what rolls goes a length"),
    "unit of a length": ('length = "2*l"', 'length = "2*m"', "'2*m' is kg, needs m"),
    "unit of a ratio": ('ratio = "1/3"', 'ratio = "l"', "constraints.teeth.ratio: 'l' is m, needs"),
    "unit of a radius": ('radius = "l/2"', 'radius = "2"', "'2' is 1, needs m"),
    "unit of an equation": ("x**2 -", "x -", "subtracts 'x' in m and"),
    "length 0": ('length = "2*l"', "length = 0", "two points in one place are a pin"),
    "ratio 0": ('ratio = "1/3"', "ratio = 0", "is 0; then 'psi' moves nothing"),
    "speed": ('zero = "x**2', "zero = \"x'*x", "x' is a speed, on which a constraint"),
    "kink": ('zero = "x**2', 'zero = "abs(x)*x', "has no smooth speed"),
    "nothing moves": (
        'zero = "x**2 - l**2*(1 + sin(phi)**2)"',
        'zero = "l"',
        "contains no coordinate; it holds nothing",
    ),
}


def test_every_kind_is_read() -> None:
    found = {item.name: item for item in read().constraints}
    assert [(item.kind, item.names) for item in found.values()] == [
        ("distance", ("p", "q")),
        ("slider", ("q", "o", "e")),
        ("gear", ("phi", "psi")),
        ("rolling", ("x", "phi")),
        ("pin", ("p", "q")),
        ("equation", ()),
    ]
    assert [key for key, _ in found["teeth"].values] == ["ratio", "offset"]
    assert found["rod"].about == "a light rod"


@pytest.mark.parametrize(("old", "new", "sentence"), FAULTS.values(), ids=FAULTS)
def test_one_fault_is_one_problem(old: str, new: str, sentence: str) -> None:
    text = RIG.replace(old, new)
    with pytest.raises(InputError) as caught:
        parse_model(text, "file")
    (problem,) = caught.value.problems
    assert sentence in str(problem)
    assert problem.line > 0


def test_a_written_model_reads_back_the_same() -> None:
    model = read()
    assert replace(parse_model(render(model)), text=model.text) == model


@pytest.mark.parametrize("name", ["slider_crank", "four_bar"])
def test_what_a_start_leaves_open_stays_open_when_written(name: str) -> None:
    model = read_model(MODELS / f"{name}.toml")
    again = parse_model(render(model))
    assert [c.stated for c in again.coordinates] == [c.stated for c in model.coordinates]


def test_a_difference_is_reported() -> None:
    reported = changes(read(), parse_model(RIG.replace('ratio = "1/3"', 'ratio = "1/4"')))
    assert reported == ("~ constraint teeth: ratio 1/3 -> 1/4",)


def read() -> Model:
    return parse_model(RIG)


@pytest.mark.parametrize(
    ("measures", "unit", "sentence"),
    [
        ("reaction(rod)", "N", ""),
        ("reaction(teeth)", "N*m", ""),
        ("reaction(wheel)", "N", ""),
        ("reaction(law)", "J/m^2", ""),
        ("reaction(rod)", "m", "'reaction(rod)' is N, needs m"),
        ("reaction(hinge)", "N", "the reaction of the pin 'hinge' is a vector"),
        ("reaction(rdo)", "N", "did you mean 'rod'"),
    ],
)
def test_a_sensor_may_show_what_a_constraint_bears(measures: str, unit: str, sentence: str) -> None:
    text = f'{RIG}[sensors]\ncell = {{ measures = "{measures}", unit = "{unit}" }}\n'
    if not sentence:
        assert parse_model(text).sensors
        return
    with pytest.raises(InputError) as caught:
        parse_model(text)
    assert sentence in str(caught.value)


def test_an_expression_that_is_zero_needs_no_kind() -> None:
    text = RIG.replace('kind = "equation"\n', "")
    assert parse_model(text).constraints[-1].kind == "equation"
