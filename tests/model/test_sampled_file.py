"""Sampled states in a model file: what they say, how they are written, and what is refused."""

import jsonschema
import pytest

from symhyb.errors import InputError
from symhyb.mechanics.show import show_equations
from symhyb.model.diff import changes
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.schema import model_schema
from tests.builders import DRIVEN_MASS

STATE = 'u = { unit = "N", every = "10 ms", first = 0.002, next = "-k*x - d*x\'", start = 1 }'


def text(state: str = STATE) -> str:
    return f"{DRIVEN_MASS}[states]\n{state}\n"


def test_it_says_when_it_is_sampled_and_what_it_becomes() -> None:
    (state,) = parse_model(text()).states
    assert (state.every, state.first, state.start) == (0.01, 0.002, 1.0)
    assert state.next is not None
    assert state.next.text == "-k*x - d*x'"
    assert parse_model(text(STATE.replace('"10 ms"', "0.01"))).states[0].every == 0.01


def test_it_is_written_as_it_was_read_and_differences_are_said() -> None:
    model = parse_model(text())
    again = parse_model(render(model))
    assert again.states == model.states
    assert changes(model, again) == ()
    other = parse_model(text(STATE.replace("10 ms", "20 ms")))
    assert changes(model, other) == ("~ state u: every 0.01 -> 0.02",)


def test_equations_show_it() -> None:
    shown = show_equations(parse_model(text()))
    assert "sampled, and held in between\n  every 0.01 s  u becomes -d*x' - k*x\n" in shown
    assert "u' =" not in shown
    latex = show_equations(parse_model(text()), latex=True)
    assert r"u &\leftarrow - d \dot{x} - k x && \text{every 0.01 s}" in latex


def test_the_schema_knows_it() -> None:
    valid = jsonschema.Draft7Validator(model_schema())
    document = {"symhyb": 1, "coordinates": {"x": {"unit": "m"}}}
    good = {"unit": "N", "every": "10 ms", "next": "1"}
    assert not list(valid.iter_errors({**document, "states": {"u": good}}))
    for key in ("every", "next"):
        bad = {name: value for name, value in good.items() if name != key}
        assert list(valid.iter_errors({**document, "states": {"u": bad}}))
    assert list(valid.iter_errors({**document, "states": {"u": {**good, "rate": "0"}}}))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('every = "10 ms", ', "", "states.u: 'every' is missing: the time from sample to sample"),
        (', next = "-k*x - d*x\'"', "", "states.u: 'next' is missing"),
        ("first", 'rate = "0", first', "states.u.rate: a state that is sampled is held between"),
        ('"10 ms"', "0", "states.u.every: must be positive, not 0 s"),
        ('"10 ms"', '"-10 ms"', "states.u.every: must be positive, not -0.01 s"),
        ('"10 ms"', '"10 mm"', 'states.u.every: must be a time, a number in s or as in "10 ms"'),
        ('"10 ms"', '"t"', "states.u.every: must be a time"),
        ("0.002", '"k"', "states.u.first: must be a time"),
        ("- d*x'", "- d*x", "states.u.next: subtracts"),
        ("-k*x - d*x'", "-d*x", "states.u.next: '-d*x' is N*s, needs N"),
        ("d*x'", "m*x''", "states.u.next: x'' is an acceleration, on which the next value of a"),
    ],
)
def test_what_is_refused(old: str, new: str, said: str) -> None:
    assert old in STATE
    with pytest.raises(InputError) as caught:
        parse_model(text(STATE.replace(old, new)))
    assert any(said in str(problem) for problem in caught.value.problems), caught.value
