"""A number times a factor of the time, wherever a model uses it."""

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.model.curves import Curve
from symhyb.model.read import parse_model
from symhyb.model.types import Parameter
from symhyb.model.varied import shown_with_factor, with_factor, written_with_factor
from symhyb.numeric.lowered.machine import build
from symhyb.units import ONE, parse_unit
from tests.builders import DRIVEN_MASS

COURSE = Curve("k_course", ((1.0, 1.0), (2.0, 1.5)), (parse_unit("s"), ONE), "linear", "hold")
FACTOR = "curve(k_course, t)"


def text_of(text: str, path: str = "k") -> str:
    return written_with_factor(parse_model(text, "m.toml"), path, FACTOR, curves=[COURSE]).text


def test_only_the_lines_that_use_the_number_change() -> None:
    lines = text_of(DRIVEN_MASS).splitlines()
    old = DRIVEN_MASS.splitlines()
    changed = [(a, b) for a, b in zip(old, lines, strict=False) if a != b]
    assert changed == [('stiffness = "k"', 'stiffness = "(k*curve(k_course, t))"')]
    assert lines[len(old) + 1] == "[curves.k_course]"


def test_the_force_is_that_of_the_number_times_the_factor() -> None:
    model = written_with_factor(parse_model(DRIVEN_MASS), "k", FACTOR, curves=[COURSE])
    machine = build(model)
    for t, factor in [(0.0, 1.0), (1.5, 1.25), (9.0, 1.5)]:
        given = np.array([0.2]), np.zeros(1), np.zeros(0), np.zeros(1), t, machine.values
        forces = machine.elements(*given)
        assert np.asarray(forces).ravel()[0] == pytest.approx(-25.0 * factor * 0.2)


def test_an_element_that_has_a_parameter_of_that_name_keeps_it() -> None:
    own = (
        '[elements.more]\nkind = "spring"\non = "x"\nstiffness = "k"\n'
        '[elements.more.parameters]\nk = { value = 1.0, unit = "N/m" }\n'
    )
    model = with_factor(parse_model(DRIVEN_MASS + own), "k", FACTOR, curves=[COURSE])
    assert model.elements["spring"].value("stiffness").text == f"(k*{FACTOR})"
    assert model.elements["more"].value("stiffness").text == "k"
    inner = with_factor(parse_model(DRIVEN_MASS + own), "more.k", FACTOR, curves=[COURSE])
    assert inner.elements["spring"].value("stiffness").text == "k"
    assert inner.elements["more"].value("stiffness").text == f"(k*{FACTOR})"


def test_an_input_acts_times_the_factor_and_is_measured_without() -> None:
    sensed = DRIVEN_MASS + 'cell = { measures = "f", unit = "N" }\n'
    model = written_with_factor(parse_model(sensed), "f", FACTOR, curves=[COURSE])
    assert model.elements["push"].value("force").text == f"(f*{FACTOR})"
    assert model.sensors["cell"].measures.text == "f"


def test_a_rate_and_a_longer_name_are_other_names() -> None:
    text = DRIVEN_MASS.replace("[inputs]", 'kk = { value = 1.0, unit = "N*s/m" }\n[inputs]')
    text = text.replace('damping = "d"', 'damping = "d + kk"')
    assert 'damping = "d + kk"' in text_of(text)


def test_a_word_that_looks_like_the_number_stays_a_word() -> None:
    text = DRIVEN_MASS.replace(
        "[sensors]", '[points]\nk = ["x", "0"]\n[bodies.small]\nmass = "m"\nat = "k"\n[sensors]'
    )
    model = written_with_factor(parse_model(text), "k", FACTOR, curves=[COURSE])
    assert model.elements["spring"].value("stiffness").text == f"(k*{FACTOR})"
    assert model.bodies["small"].at == model.points["k"].at


def test_more_parameters_stand_at_the_end() -> None:
    more = Parameter("k_level", 1.25, ONE, about="as found")
    model = written_with_factor(parse_model(DRIVEN_MASS), "k", "k_level", [more])
    assert model.parameters["k_level"] == more
    assert model.text.startswith(DRIVEN_MASS.replace('"k"', '"(k*k_level)"'))


def test_a_sensor_shows_times_a_factor() -> None:
    more = Parameter("c", 1.1, ONE)
    model = shown_with_factor(parse_model(DRIVEN_MASS), "laser", "c", [more])
    assert model.sensors["laser"].measures.text == "(x)*c"
    assert model.parameters["c"] == more


def test_a_mass_of_a_body_may_change_with_time_that_of_an_element_not() -> None:
    model = written_with_factor(parse_model(DRIVEN_MASS), "m", FACTOR, curves=[COURSE])
    assert model.bodies[0].mass.text == f"(m*{FACTOR})"
    more = '[elements.more]\nkind = "added_mass"\non = "x"\nmass = "m"\n'
    with pytest.raises(InputError, match="an added mass cannot depend on the time"):
        written_with_factor(parse_model(DRIVEN_MASS + more), "m", FACTOR, curves=[COURSE])


def test_the_rate_of_a_state_has_it_too() -> None:
    states = '[states]\nz = { unit = "N", rate = "(k*x - z)/(1 s)" }\n'
    model = written_with_factor(parse_model(DRIVEN_MASS + states), "k", FACTOR, curves=[COURSE])
    assert model.states[0].rate.text == f"((k*{FACTOR})*x - z)/(1 s)"
    driven = written_with_factor(
        parse_model(DRIVEN_MASS + states.replace("k*x", "f")), "f", FACTOR, curves=[COURSE]
    )
    assert driven.states[0].rate.text == f"((f*{FACTOR}) - z)/(1 s)"


def test_units_and_curves_of_that_name_stay() -> None:
    more = """[parameters.m_2]
value = 1.0
unit = "N/m"
[curves.k]
units = ["m", "1"]
points = [[0, 1], [1, 2]]
[elements.more]
kind = "law"
on = "x"
force = "-m_2*curve(k, x)*2 m - k*x*curve(k, 1 m)"
"""
    model = with_factor(parse_model(DRIVEN_MASS + more), "k", FACTOR, curves=[COURSE])
    assert model.elements["more"].value("force").text == (
        f"-m_2*curve(k, x)*2 m - (k*{FACTOR})*x*curve(k, 1 m)"
    )
    mass = with_factor(parse_model(DRIVEN_MASS + more), "m", "2", curves=[])
    assert mass.elements["more"].value("force").text == "-m_2*curve(k, x)*2 m - k*x*curve(k, 1 m)"
