"""Actuators of inputs in a model file: read, refused, compared, written."""

import pytest
from builders import DRIVEN_MASS

from symhyb.errors import InputError
from symhyb.model.diff import diff
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import Model
from symhyb.model.write import replace_parameters, text_of

SAID = (
    'gain = 1.1, backlash = 0.3, quantum = { value = 50, unit = "mN" }, '
    'lag = { value = 20, sd = 4, unit = "ms" }, limit = 2.5, rate_limit = 40, '
    'dead_band = { value = 100, unit = "mN" }'
)


def model(said: str = SAID) -> Model:
    return parse_model(DRIVEN_MASS.replace('f = { unit = "N"', f'f = {{ unit = "N", {said}'))


def test_numbers_are_parameters_in_the_order_in_which_they_act() -> None:
    f = model().inputs["f"]
    keys = ["quantum", "dead_band", "backlash", "limit", "rate_limit", "lag"]
    assert [number.name for number in f.actuator] == keys
    assert [number.si for number in f.actuator] == pytest.approx([0.05, 0.1, 0.3, 2.5, 40.0, 0.02])
    assert [number.unit.text for number in f.actuator] == ["mN", "mN", "N", "N", "N/s", "ms"]
    assert f.actuator[-1].si_sd == pytest.approx(0.004)
    paths = [one.path for one in model().all_parameters() if one.owner == "f"]
    assert paths == ["f.gain", *(f"f.{key}" for key in keys)]


@pytest.mark.parametrize(
    ("said", "wrong"),
    [
        ("limit = 0", "inputs.f.limit: must be positive"),
        ("limit = { value = -1.0 }", "inputs.f.limit: must be positive"),
        ("rate_limit = 0.0", "inputs.f.rate_limit: must be positive"),
        ("lag = -0.1", "inputs.f.lag: must not be negative"),
        ("backlash = -0.1", "inputs.f.backlash: must not be negative"),
        ("quantum = -0.1", "inputs.f.quantum: must not be negative"),
        ('backlash = { value = 1.0, unit = "m" }', "is in m, needs N"),
        ("dead_band = -0.1", "inputs.f.dead_band: must not be negative"),
        ('rate_limit = { value = 1.0, unit = "N" }', "is in N, needs N/s"),
        ('lag = { value = 1.0, unit = "N" }', "is in N, needs s"),
        ("deadband = 0.1", "dead_band"),
    ],
)
def test_what_no_actuator_does_is_refused(said: str, wrong: str) -> None:
    with pytest.raises(InputError, match=wrong):
        model(said)


def test_a_sensor_has_no_actuator() -> None:
    text = DRIVEN_MASS.replace('measures = "x"', 'measures = "x", lag = 0.1')
    with pytest.raises(InputError, match=r"sensors.*lag"):
        parse_model(text)


def test_a_model_that_is_rendered_says_the_same() -> None:
    assert parse_model(render(model())).inputs == model().inputs


def test_a_correction_writes_the_number_and_what_it_was() -> None:
    bare = model("gain = 1.0")
    found = replace_parameters(bare, {"f.limit": (2.1, 0.1), "f.lag": (0.02, 0.001)})
    text = text_of(found)
    assert "limit = { value = 2.1, sd = 0.1 }" in text  # what never limited had no value
    assert "lag = { value = 0.02, was = 0.0, sd = 0.001 }" in text
    assert [one.si for one in found.inputs["f"].actuator] == pytest.approx([2.1, 0.02])
    said = diff(bare, found)
    assert "limit unset -> 2.1 ± 0.1 N" in str(said)
    again = replace_parameters(model(), {"f.lag": (21.0, 0.5)})
    assert "lag = { value = 21.0, sd = 0.5, unit" in text_of(again).replace("was = 20, ", "")
