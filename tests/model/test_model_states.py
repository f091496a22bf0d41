"""Declared states in a model file: what they say, where they may stand, and what is refused."""

import jsonschema
import pytest

from symhyb.errors import InputError
from symhyb.mechanics.show import show_equations
from symhyb.model.diff import changes
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.schema import model_schema
from tests.builders import DRIVEN_MASS
from tests.motors import MOTOR, motor

RATE = "(u - R*i - k*phi')/L"


def problems(text: str) -> list[str]:
    with pytest.raises(InputError) as caught:
        parse_model(text, "m.toml")
    return [str(problem).partition(": ")[2] for problem in caught.value.problems]


def changed(old: str, new: str) -> list[str]:
    assert old in MOTOR
    return problems(MOTOR.replace(old, new))


def test_a_state_says_its_rate_and_its_start() -> None:
    (state,) = parse_model(MOTOR.replace('unit = "A",', 'unit = "mA", start = 20,')).states
    assert (state.name, state.start, state.rate.text) == ("i", 20.0, RATE)
    assert state.si_start == pytest.approx(0.02)
    assert motor().states["i"].about == "current of the armature"


def test_it_is_written_as_it_was_read() -> None:
    model = parse_model(MOTOR.replace('unit = "A",', 'unit = "A", start = 0.5,'))
    again = parse_model(render(model))
    assert again.states == model.states
    assert changes(model, again) == ()


def test_what_differs_is_said() -> None:
    other = parse_model(MOTOR.replace("- R*i -", "- 2*R*i -"))
    assert changes(motor(), other) == (f"~ state i: rate {RATE} -> (u - 2*R*i - k*phi')/L",)
    without = parse_model(DRIVEN_MASS)
    added = parse_model(DRIVEN_MASS + '[states]\nz = { unit = "m", rate = "x\'" }\n')
    assert changes(without, added) == ("+ state z: unit = m, start = 0, rate = x'",)


def test_equations_show_the_rate() -> None:
    text = show_equations(motor())
    assert "rates of the states\n  i' = (-R*i - k*phi' + u)/L\n" in text
    assert "declared states\n  i  [A]  begins at 0  current of the armature\n" in text
    assert r"\dot{i} &= \frac{- R i - k \dot{\phi} + u}{L}" in show_equations(motor(), latex=True)


def test_the_schema_knows_it() -> None:
    valid = jsonschema.Draft7Validator(model_schema())
    document = {"symhyb": 1, "coordinates": {"x": {"unit": "m"}}}
    assert not list(valid.iter_errors({**document, "states": {"i": {"unit": "A", "rate": "1"}}}))
    assert list(valid.iter_errors({**document, "states": {"i": {"unit": "A"}}}))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        (f'rate = "{RATE}", ', "", "states.i: 'rate' is missing"),
        ('unit = "A", ', "", "states.i: 'unit' is missing; a plain number has the unit \"1\""),
        ("- R*i -", "- R*j -", "states.i.rate: 'j' is not a known name"),
        ("(u - R*i", "(u - i", "states.i.rate: subtracts 'u' in V and 'i' in A"),
        ("- k*phi')/L", "- k*phi')", f"states.i.rate: '{RATE[:-2]}' is V, needs A/s"),
        ("phi')/L", "phi')/L + i'", "states.i.rate: i' is the rate of a state, which nothing can"),
        ("phi')/L", "phi')/L + phi''*i", "states.i.rate: phi'' is an acceleration, on which the"),
        ('inertia = "J"', 'inertia = "J*i/i"', "bodies.rotor.inertia: i is a state, on which a "),
        ('on = "phi"\ntorque', 'on = "phi + i*i"\ntorque', "elements.motor.on: i is a state, on "),
        ("i = {", "k = {", "parameters.k: 'k' is already declared in [states]"),
        ("i = {", "pi = {", "states.pi: 'pi' is a reserved name; choose another"),
        ("i = {", "i = { imposed = true,", "states.i.imposed: 'imposed' is not a key here"),
        (f'"{RATE}"', "[1]", "states.i.rate: must be an expression in quotes, not a list of 1"),
        (f'"{RATE}"', '"distance(a, b)"', "states.i.rate: only sensors may use distance(...)"),
    ],
)
def test_what_makes_no_state_is_refused(old: str, new: str, said: str) -> None:
    found = [line.partition(": ")[2] if line[0].isdigit() else line for line in changed(old, new)]
    assert any(said in line for line in found), found


def test_a_state_that_cannot_be_read_is_one_problem() -> None:
    """Its name stays known, so that nothing else complains about it."""
    assert len(changed('unit = "A"', 'unit = "Q"')) == 1


def test_states_are_as_many_as_a_machine_has() -> None:
    many = "".join(f's{i} = {{ unit = "1", rate = "1/(1*t)" }}\n' for i in range(500))
    said = problems(MOTOR.replace("[parameters]", f"{many}[parameters]"))
    assert any("states: are 501; a machine has at most 500" in line for line in said)


def test_a_network_sees_no_state() -> None:
    learnt = (
        '[elements.rest]\nkind = "network"\non = "phi"\nweights = "w.json"\n'
        f'sha256 = "{"0" * 64}"\ninputs = ["i"]\ntrust = [[-1, 1]]\n'
    )
    said = problems(MOTOR.replace("[sensors]", f"{learnt}[sensors]"))
    assert any("i is a state, on which what a network sees cannot depend" in line for line in said)
