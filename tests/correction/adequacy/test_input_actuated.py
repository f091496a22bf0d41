"""Inputs behind a rate limit, a play or a converter: classes that no smooth function shows."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from actuated import actuated, behind_play, in_steps, slewing
from rigs import spring_model

from symhyb.correction.adequacy.actuators import deviating_input
from symhyb.correction.adequacy.beyond import Beyond
from symhyb.correction.adequacy.classes.input_actuated import (
    REMEMBERING,
    behind_numbers,
    input_actuated,
    stated_of,
    tried,
)
from symhyb.correction.adequacy.classes.input_curve import input_curve
from symhyb.correction.adequacy.classes.input_lag import input_lag
from symhyb.correction.adequacy.classes.worth import Around, around, worth_of
from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.structure import Generic, Likely, fitted
from symhyb.correction.naming.classes import class_found
from symhyb.model.actuators import ActuatorKey
from symhyb.model.types import Items, Parameter
from symhyb.numeric.kernels.buffers import Array
from tests.pushed import setting_of

Act = Callable[[Array, Array], Array]


def begun(acts: Act) -> Around:
    setting = setting_of(spring_model(), actuated(acts, 3, duration=8.0))
    nothing = fitted(setting, (), (), setting.first_noise())
    return around(setting, replace(nothing, evidence=evidence(setting, nothing)))


@pytest.mark.parametrize(
    ("acts", "key", "number"),
    [
        (behind_play(3.0), "backlash", 3.0),
        (in_steps(4.0), "quantum", 4.0),
        (slewing(150.0), "rate_limit", 150.0),
    ],
    ids=["backlash", "quantum", "rate_limit"],
)
def test_what_an_actuator_remembers_is_of_its_class(
    acts: Act, key: ActuatorKey, number: float
) -> None:
    here = begun(acts)
    made = {one: input_actuated(here, 0, one) for one in REMEMBERING}
    smooth = [input_curve(here, 0), input_lag(here, 0)]
    worths = {one: worth_of(here, generic) for one, generic in made.items()}
    assert max(worths, key=lambda one: worths[one]) == key
    assert worths[key] > 100 + max(worth_of(here, generic) for generic in smooth)
    assert made[key].figure == pytest.approx(number, rel=0.03)
    assert made[key].tried == tried(here.recorded, 0, key).size + 9


def test_a_model_that_states_the_number_lacks_nothing() -> None:
    """The class of a number that is stated is not offered, and others have nothing to explain."""
    recording = actuated(behind_play(3.0), 3, duration=8.0)
    model = spring_model()
    play = Parameter("backlash", 3.0, model.inputs["f"].unit, owner="f")
    inputs = (replace(model.inputs["f"], actuator=(play,)),)
    setting = setting_of(replace(model, inputs=Items(inputs)), recording)
    assert stated_of(setting, 0) == {"backlash": 3.0}
    nothing = fitted(setting, (), (), setting.first_noise())
    here = around(setting, replace(nothing, evidence=evidence(setting, nothing)))
    for key in ("rate_limit", "quantum"):
        assert worth_of(here, input_actuated(here, 0, key)) < np.log(16)


def test_the_columns_of_a_value_are_what_it_does_and_its_slope() -> None:
    here = begun(in_steps(4.0))
    values = tried(here.recorded, 0, "backlash")
    options = behind_numbers(here.recorded, 0, "backlash", {}, values)
    (wide, extra), (_, wider) = ((one.figure, one.each[0].force[:, 0]) for one in options[8:10])
    step = options[9].figure - wide
    way = np.gradient(values)[8] / np.sqrt(12)
    guess = extra[:, 0] + extra[:, 1] / way * step
    off = np.sqrt(np.mean((guess - wider[:, 0]) ** 2))
    bare = np.sqrt(np.mean((extra[:, 0] - wider[:, 0]) ** 2))
    assert off < 0.5 * bare  # over a whole step, of a quarter of the width
    assert behind_numbers(here.recorded, 0, "backlash", {}, values) is options


@pytest.mark.parametrize(
    ("key", "said"),
    [
        ("rate_limit", "The input f acts with a rate that is limited"),
        ("backlash", "The input f acts behind a play"),
        ("quantum", "The input f acts in steps of one size"),
    ],
)
def test_such_a_class_in_words_asks_for_an_actuator(key: ActuatorKey, said: str) -> None:
    generic = Generic("input", "f", (), np.ones(2), does=key)
    assert class_found(Likely(generic, 0.99)).sentence.startswith(said)
    judged = Adequacy(Beyond(np.ones(1), np.ones(1), 1.0, 99.0), (Likely(generic, 0.99),))
    assert deviating_input(judged) == "f"
