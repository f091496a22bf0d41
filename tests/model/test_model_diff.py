"""The difference of two models: sentences of what changed, then lines."""

from dataclasses import replace
from pathlib import Path

import pytest

from symhyb.model.diff import changes, diff
from symhyb.model.expression import parse_expression
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Element, Model, On, Parameter
from symhyb.model.write import append_elements, replace_parameters
from symhyb.units import parse_unit

MODELS = Path(__file__).parents[2] / "models"


@pytest.fixture
def duffing() -> Model:
    return read_model(MODELS / "duffing.toml")


def with_drag(model: Model) -> Model:
    own = Parameter("b", 0.42, parse_unit("N*s^2/m^2"), 0.03, owner="found_drag")
    values = (("drag", parse_expression("b")),)
    return append_elements(model, [Element("found_drag", "drag", On("x"), values, (own,))])


def test_a_correction_is_one_sentence_and_only_plus_lines(duffing: Model) -> None:
    corrected = replace(with_drag(duffing), file="corrected.toml")
    sentence = "+ element found_drag: drag on x, drag = 0.42 ± 0.03 N*s^2/m^2"
    assert changes(duffing, corrected) == (sentence,)
    lines = diff(duffing, corrected).splitlines()
    assert lines[0] == sentence
    assert lines[3] == "+++ corrected.toml"
    changed = [line for line in lines[4:] if line[:1] in "+-"]
    assert changed
    assert all(line.startswith("+") for line in changed)


def test_what_is_gone_is_said(duffing: Model) -> None:
    assert changes(with_drag(duffing), duffing)[0].startswith("- element found_drag: drag on x")


def test_values_show_old_and_new(duffing: Model) -> None:
    changed = replace_parameters(duffing, {"k": (1010.0, 12.0), "laser.delay": (0.002, 1e-4)})
    assert changes(duffing, changed) == (
        "~ parameter k: 980 ± 40 -> 1010 ± 12 N/m",
        "~ sensor laser: delay unset -> 0.002 ± 0.0001 s",
    )
    lines = [line for line in diff(duffing, changed).splitlines() if line[:2] in ("-k", "+k")]
    assert len(lines) == 2


def test_changes_of_meaning_in_every_section(duffing: Model) -> None:
    text = duffing.text
    for old, new in (
        ('title   = "Mass', 'title   = "A mass'),
        ("start = 0.0", "start = 0.5"),
        ('f = { unit = "N"', 'f = { unit = "kN"'),
        ('at   = ["x", "0"]', 'at   = ["2*x", "0"]'),
        ('stiffness = "k"', 'stiffness = "2*k"'),
        ("sd = 0.05", "sd = 0.06"),
    ):
        assert old in text
        text = text.replace(old, new)
    first, second = duffing, parse_model(text)
    assert changes(first, second) == (
        "~ model: title 'Mass on a hardening spring, driven by a shaker'"
        " -> 'A mass on a hardening spring, driven by a shaker'",
        "~ coordinate x: start 0 -> 0.5",
        "~ input f: unit N -> kN",
        "~ body mass: at (x, 0) -> (2*x, 0)",
        "~ element spring: stiffness k -> 2*k",
        "~ sensor accel: sd 0.05 -> 0.06",
    )


def test_equal_models_differ_in_nothing(duffing: Model) -> None:
    assert changes(duffing, duffing) == ()
    assert diff(duffing, duffing) == "The two models say the same."


def test_comments_alone_show_in_the_lines_only(duffing: Model) -> None:
    commented = parse_model(duffing.text + "# a remark\n")
    assert changes(duffing, commented) == ()
    assert diff(duffing, commented).splitlines()[-1] == "+# a remark"
