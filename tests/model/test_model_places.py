"""Places on expressions of coordinates: read, checked, written back, reported in words."""

import pytest
from builders import model_of, spring

from symhyb.discrepancy.results import Estimate
from symhyb.discrepancy.words.effects import action_of
from symhyb.errors import InputError
from symhyb.laws.phrases import Phrase
from symhyb.model.diff import diff
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import Model, On, place_text
from symhyb.model.vocabulary import force_unit, key_unit, stretch_unit


def shaft(on: object = "q1 - q2", **elements: dict[str, object]) -> Model:
    return model_of(
        coordinates={"q1": {"unit": "rad"}, "q2": {"unit": "deg"}, "x": {"unit": "mm"}},
        parameters={
            "J": (1.2, "kg*m^2"),
            "m": (2.0, "kg"),
            "c": (50.0, "N*m/rad"),
            "k": (9.0, "N/m"),
            "n": (3.0, "1"),
            "r": (0.2, "m"),
        },
        inputs={"u": {"unit": "N*m"}},
        bodies={
            "one": {"mass": "m", "at": ["x", "0"], "inertia": "J", "angle": "q1"},
            "two": {"mass": "m", "at": ["0", "0"], "inertia": "J", "angle": "q2"},
        },
        elements={"shaft": {"kind": "spring", "on": on, "stiffness": "c"}, **elements},
        sensors={"cell": {"measures": "force(shaft)", "unit": "N*m"}},
    )


@pytest.mark.parametrize(
    ("on", "stretch", "force"),
    [
        ("q1 - q2", "rad", "N*m"),
        ("q1 - n*q2", "rad", "N*m"),
        ("2*q1/3 + q2", "rad", "N*m"),
        ("sin(q1)", "rad", "N*m"),
        ("x - r*q1", "m", "N"),
        ("r*sin(q1)", "m", "N"),
        ("x", "m", "N"),
    ],
)
def test_units_follow_the_expression(on: str, stretch: str, force: str) -> None:
    model = shaft(more=spring("c" if force == "N*m" else "k", on=on))
    place = On(on)
    assert stretch_unit(model, place).text == stretch
    assert force_unit(model, place).text == force
    assert key_unit(model, "damper", "damping", place).text == f"{force}*s/{stretch}"


def test_a_model_is_written_as_it_was_read() -> None:
    model = shaft(belt=spring("k", on="x - r*q1"), one=spring("c", on=" (q1) "))
    places = [element.place for element in model.elements]
    assert places == [On("q1 - q2"), On("x - r*q1"), On("q1")]
    assert [place.plain for place in places if isinstance(place, On)] == [False, False, True]
    again = parse_model(render(model), "again.toml")
    assert again.elements == model.elements


@pytest.mark.parametrize(
    ("on", "sentence"),
    [
        ("q1 - q22", "'q22' is not a known name; did you mean 'q2'?"),
        ("q1 - coupling", "'coupling' is not a known name; known: q1, q2, x, J, m, c, k, n, r, u"),
        ("q1 - x", "subtracts 'q1' in rad and 'x' in mm"),
        ("q1' - q2'", "q1' is a speed, on which a place cannot depend"),
        ("u*q1", "u is an input, on which a place cannot depend"),
        ("n + 1", "'n + 1' contains no coordinate; nothing moves there"),
        ("n", "'n' is not a known coordinate; known: q1, q2, x"),
        ("abs(q1 - q2)", "'abs(q1 - q2)' has no smooth speed, which a place needs"),
        ("q1 -", "'q1 -' is not an expression"),
        ("", "the expression is empty"),
        (3, "must be text in quotes, not the number 3"),
        ("x - r*q1", "'c' is N*m/rad, needs N/m"),
    ],
)
def test_what_is_wrong_with_a_place_is_said_where_it_stands(on: object, sentence: str) -> None:
    with pytest.raises(InputError) as caught:
        shaft(on)
    reported = [str(problem) for problem in caught.value.problems]
    assert any(sentence in text for text in reported), reported


def test_all_problems_are_reported_at_once() -> None:
    with pytest.raises(InputError) as caught:
        shaft("q1 - w", other=spring("k", on="q1 + p"), rub={"kind": "damper", "on": "x - q1"})
    reported = " ".join(str(problem) for problem in caught.value.problems)
    for part in ("'w' is not", "'p' is not", "subtracts 'x' in mm", "needs 'damping'"):
        assert part in reported, reported


def test_a_place_in_words_and_in_a_difference_of_models() -> None:
    assert place_text(On("q1 - q2")) == "on q1 − q2"
    assert place_text(On("q1")) == "on q1"
    assert "on q1 − q2" in diff(shaft(), shaft("q1 + q2"))
    assert "on q1 + q2" in diff(shaft(), shaft("q1 + q2"))


@pytest.mark.parametrize(
    ("on", "words"),
    [
        ("q1 - q2", "resists the relative rotation"),
        ("q1 + q2", "resists the rotation"),
        ("q1", "resists the rotation"),
    ],
)
def test_a_difference_moves_relatively(on: str, words: str) -> None:
    damping = [Estimate("d", 1.0, 0.1, "N*m*s/rad", "damping")]
    said = Phrase("viscous damping", "", ("damping",), "motion")
    assert action_of(said, "damper", On(on), damping) == words


def test_a_constant_says_which_way() -> None:
    said = Phrase("a constant torque", "", ("constant",), "")
    push = [Estimate("c", -1.0, 0.1, "N*m", "constant")]
    assert action_of(said, "constant", On("q1 - q2"), push) == "acts towards smaller q1 − q2"
    assert action_of(said, "constant", On("q1"), push) == "acts towards negative q1"
