"""Known values of parameters in each recording: what is taken, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.data.known import known_in, known_note, require_known
from symhyb.data.recording import Recording
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from tests.known_weights import PENDULUM


@pytest.fixture(scope="module")
def pendulum():
    return parse_model(PENDULUM)


def run(name: str, parameters: dict[str, float]) -> Recording:
    t = np.linspace(0, 1, 50)
    return Recording(name, t, {}, {"encoder": np.sin(t)}, parameters=parameters)


def refused(*arguments, **named) -> list[str]:
    with pytest.raises(InputError) as caught:
        require_known(*arguments, **named)
    return [str(problem) for problem in caught.value.problems]


def test_values_are_turned_into_si(pendulum):
    assert known_in(pendulum, {"m": 750, "l": 0.15}, "a.csv") == {"m": 0.75, "l": 0.15}
    assert known_in(pendulum, None, "a.csv") == {}


def test_everything_that_is_wrong_with_values_is_said_at_once(pendulum):
    wrong = {"mm": 1.0, "m": "heavy", "l": float("nan"), "c": 0.01, "g": True}
    with pytest.raises(InputError) as caught:
        known_in(pendulum, wrong, "a.csv")
    said = [str(problem) for problem in caught.value.problems]
    assert len(said) == 5
    assert said[0].startswith("a.csv: parameters.mm: there is no parameter 'mm' in the model")
    assert "must be a number in g, not 'heavy'" in said[1]
    assert "must be finite, not nan" in said[2]
    assert "states an sd in the model, so that it is estimated, and a known value" in said[3]
    assert "must be a number in m/s^2, not True" in said[4]


def test_a_note_says_the_values_in_the_units_of_the_model(pendulum):
    said = known_note(pendulum, {"m": 0.75, "l": 0.15})
    assert said == "known here: m = 750 g, l = 0.15 m"


def test_recordings_that_all_know_the_same_parameters_are_taken(pendulum):
    require_known(pendulum, [run("a", {"m": 0.5}), run("b", {"m": 0.7})], fitted=("l",))
    require_known(pendulum, [run("a", {}), run("b", {})])


def test_a_value_that_one_recording_lacks_is_named_with_the_recording(pendulum):
    runs = [run("a", {"m": 0.5, "l": 0.1}), run("b", {"m": 0.7}), run("c", {"l": 0.1})]
    said = refused(pendulum, runs)
    assert [line.split(":")[:2] for line in said] == [
        ["c", " parameters.m"],
        ["b", " parameters.l"],
    ]
    assert all("state it for all of them" in line for line in said)


def test_what_is_fitted_is_not_known(pendulum):
    runs = [run("a", {"m": 0.5, "c": 0.1, "k": 1.0})]
    said = refused(pendulum, runs, fitted=("m",))
    assert len(said) == 3
    assert "is to be fitted, but recordings state known values of it" in said[0]
    assert "states an sd" in said[1]
    assert "there is no parameter 'k'" in said[2]


def test_parts_of_a_recording_keep_what_is_known(pendulum):
    whole = replace(run("a", {"m": 0.5}))
    before, after = whole.split(0.5)
    assert before.parameters == after.parameters == whole.crop(end=0.8).parameters == {"m": 0.5}


def test_a_recording_is_read_with_what_is_known_of_it(pendulum):
    t = np.linspace(0, 1, 50)
    frame = {"t": t, "encoder": np.sin(t)}
    read = Recording.from_frame(frame, pendulum, parameters={"m": 750})
    assert read.parameters == {"m": 0.75}
    assert "known here: m = 750 g" in read.notes
    with pytest.raises(InputError, match="there is no parameter 'n'"):
        Recording.from_frame(frame, pendulum, parameters={"n": 1})
