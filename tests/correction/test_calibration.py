"""Parameters alone, fitted by simulation error: values come back, and bounds and priors count."""

from dataclasses import replace

import numpy as np
import pytest
from rigs import DAMPING, MASS, STIFFNESS, spring_model, spring_recording

from symhyb.correction.calibration import Calibrated, calibrated, chosen
from symhyb.errors import InputError
from symhyb.model.types import Model


@pytest.fixture(scope="module")
def fitted() -> Calibrated:
    """Stiffness a quarter too large, and a damping that is said to be known exactly."""
    model = spring_model(stiffness=1.25 * STIFFNESS)
    return calibrated(model, spring_recording(3, {}, duration=8.0), ["k", "d", "m"])


def test_wrong_values_come_back_within_their_deviations(fitted: Calibrated) -> None:
    for item, truth in zip(fitted.parameters, (STIFFNESS, DAMPING, MASS), strict=True):
        assert abs(item.value - truth) < 4 * item.sd
        assert item.sd < 0.05 * truth
    assert [item.name for item in fitted.parameters] == ["k", "d", "m"]
    assert fitted.before > 20
    assert fitted.after == pytest.approx(1.0, abs=0.2)


def test_the_model_file_keeps_the_old_values(fitted: Calibrated) -> None:
    stiffness = {item.name: item for item in fitted.model.parameters}["k"]
    assert stiffness.was == 1.25 * STIFFNESS
    assert stiffness.value == pytest.approx(fitted.parameters[0].value, rel=1e-9)
    assert stiffness.sd == pytest.approx(fitted.parameters[0].sd, rel=1e-4)


def test_parameters_that_trade_off_are_told(fitted: Calibrated) -> None:
    """Of a resonance stiffness and mass are told by their ratio first."""
    (first, second, size), *_ = fitted.together(0.5)
    assert {first, second} == {"k", "m"}
    assert size > 0.5
    assert np.diag(fitted.correlation) == pytest.approx(1.0)
    assert fitted.together(1.1) == []


def test_a_stated_deviation_is_evidence_and_that_of_an_earlier_fit_is_none() -> None:
    recording = spring_recording(3, {}, duration=4.0)
    sure = spring_model(stiffness=1.02 * STIFFNESS, sd=1e-3)
    held = calibrated(sure, recording)
    assert held.parameters[0].value == pytest.approx(1.02 * STIFFNESS, rel=1e-4)
    before = replace(sure.parameters[1], was=150.0)
    again = replace(sure, parameters=(sure.parameters[0], before, sure.parameters[2]))
    free = calibrated(again, recording)
    assert free.prior == (None,)
    assert free.parameters[0].value == pytest.approx(STIFFNESS, rel=5e-3)


def test_a_value_ends_at_what_physics_allows() -> None:
    """The recording's damping is less than none: the damper of the model ends at 0."""
    recording = spring_recording(3, {}, duration=4.0)
    text = spring_model().text.replace('damping = "d"', 'damping = "d"\nasymmetry = 0')
    more = text + '[elements.more]\nkind = "damper"\non = "x"\ndamping = "e"\n'
    more = more.replace("[inputs]", 'e = { value = 0.3, unit = "N*s/m" }\n[inputs]')
    more = more.replace("value = 0.8", "value = 1.5")
    done = calibrated(parsed(more), recording, ["e"])
    assert done.bounds == ("e",)
    assert done.parameters[0].value == pytest.approx(0.0, abs=1e-5)


def parsed(text: str) -> Model:
    from symhyb.model.read import parse_model

    return parse_model(text)


def test_a_gain_is_fitted_where_it_is_asked_for() -> None:
    done = calibrated(
        spring_model(), spring_recording(3, {}, gain=1.1, duration=4.0), ["laser.gain"]
    )
    assert abs(done.parameters[0].value - 1.1) < 4 * done.parameters[0].sd
    sensor = done.model.sensors[0]
    assert sensor.gain is not None
    assert sensor.gain.was == 1.0


@pytest.mark.parametrize(
    ("free", "said"),
    [
        (["kk"], "did you mean 'k'"),
        (["k", "k"], "named twice"),
        ([], "no parameter states an sd"),
    ],
)
def test_what_cannot_be_fitted_is_said(free: list[str], said: str) -> None:
    with pytest.raises(InputError, match=said):
        chosen(spring_model(), free)


def test_a_machine_that_stands_still_tells_no_parameter() -> None:
    run = spring_recording(1, {}, duration=4.0)
    still = replace(run, sensors={"laser": 0 * run.t})
    with pytest.raises(InputError, match="no sensor changes"):
        calibrated(spring_model(), still, ["k"])
