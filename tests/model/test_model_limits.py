"""Limits of a model file: read, checked, written and compared."""

from dataclasses import replace

import pytest
from builders import DRIVEN_MASS

from symhyb.errors import InputError
from symhyb.model.diff import changes
from symhyb.model.limits import Limit
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.units import parse_unit

LIMITS = """
[limits]
x = { unit = "mm", travel = [-40, 60], speed = 800, acceleration = 2e4, about = "the stops" }
f = { unit = "N", range = [-50.0, 50.0] }
"""


def test_limits_are_read_as_they_are_stated() -> None:
    x, f = parse_model(DRIVEN_MASS + LIMITS).limits
    assert x == Limit("x", parse_unit("mm"), (-40.0, 60.0), 800.0, 2e4, "the stops")
    assert f == Limit("f", parse_unit("N"), (-50.0, 50.0))
    assert parse_model(DRIVEN_MASS).limits == ()


def test_limits_that_are_written_read_back() -> None:
    model = parse_model(DRIVEN_MASS + LIMITS)
    rate = replace(model.limits[1], between=None, rate=1e3)
    for limits in (model.limits, (model.limits[0], rate)):
        other = replace(model, limits=limits)
        assert parse_model(render(other)).limits == limits


def test_what_became_of_limits_is_said() -> None:
    model = parse_model(DRIVEN_MASS + LIMITS)
    tighter = replace(model.limits[0], rate=400.0)
    reported = changes(parse_model(DRIVEN_MASS), replace(model, limits=model.limits[1:]))
    assert reported == ("+ limits of f: between = -50 and 50 N",)
    reported = changes(model, replace(model, limits=(tighter, model.limits[1])))
    assert reported == ("~ limits of x: rate 800 -> 400 mm/s",)


@pytest.mark.parametrize(
    ("line", "place", "sentence"),
    [
        ('q = { unit = "m", speed = 1 }', "q", "'q' is neither a coordinate nor an input"),
        ("x = { speed = 1 }", "x", "'unit' is missing"),
        ('x = { unit = "N", speed = 1 }', "x.unit", "is N, but x is in m"),
        ('x = { unit = "m" }', "x", "states no limit; give travel, speed or acceleration"),
        ('f = { unit = "N" }', "f", "states no limit; give range or rate"),
        ('x = { unit = "m", travel = [2, 1] }', "x.travel", "is from 2 to 1; the first"),
        ('x = { unit = "m", travel = 2 }', "x.travel", "must be two numbers, as in [-0.05, 0.05]"),
        ('x = { unit = "m", travel = [0, inf] }', "x.travel", "must be finite"),
        ('x = { unit = "m", speed = 0 }', "x.speed", "must be positive, not 0"),
        ('x = { unit = "m", speed = 1, rate = 2 }', "x.rate", "'rate' is not a key here"),
        ('f = { unit = "N", rate = 2, acceleration = 1 }', "f.acceleration", "is not a key here"),
    ],
)
def test_a_wrong_limit_is_one_problem(line: str, place: str, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        parse_model(f"{DRIVEN_MASS}\n[limits]\n{line}\n", "car.toml")
    (problem,) = caught.value.problems
    assert problem.place == f"limits.{place}"
    assert sentence in problem.text


def test_all_wrong_limits_are_reported_at_once() -> None:
    text = f'{DRIVEN_MASS}\n[limits]\nx = {{ unit = "m", speed = -1 }}\ny = {{ unit = "m" }}\n'
    with pytest.raises(InputError) as caught:
        parse_model(text)
    assert [problem.place for problem in caught.value.problems] == ["limits.x.speed", "limits.y"]
