"""Faults of recordings: each is said first and put right; no ordinary physics looks like one."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.checks.suspicion import repaired, suspect
from symhyb.discrepancy.places.hypotheses import with_channels
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.results import RecordingFault
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from tests.liars import chain_model, chain_recording, pendulum_model, pendulum_recording
from tests.rigs import spring_model, spring_recording

DEGREES = 180 / np.pi


def reported(model: Model, run: Recording) -> tuple[RecordingFault, ...]:
    machine = build(with_channels(model))
    return suspect(machine, [Run(run, motion_of(run, machine), np.empty(0))]).faults


def shown(run: Recording, **factors: float) -> Recording:
    """The recording with channels multiplied."""
    sensors, inputs = dict(run.sensors), dict(run.inputs)
    for name, factor in factors.items():
        side = sensors if name in sensors else inputs
        side[name] = factor * side[name]
    return replace(run, sensors=sensors, inputs=inputs)


@pytest.mark.parametrize(
    ("factor", "word"), [(DEGREES, "deg"), (1 / (2 * np.pi), "turn"), (1000.0, "mrad")]
)
def test_an_angle_in_another_unit_is_reported_and_not_physics(factor: float, word: str) -> None:
    (fault,) = reported(pendulum_model(), shown(pendulum_recording(1), encoder=factor))
    assert fault.claimed
    assert (fault.kind, fault.channels, fault.word) == ("unit", ("encoder",), word)
    assert fault.factor == pytest.approx(factor)


@pytest.mark.parametrize("noise", [0.001, 0.05])
def test_degrees_are_reported_beside_friction_and_under_noise(noise: float) -> None:
    run = pendulum_recording(5, {"coulomb": 0.2}, noise=noise)
    (fault,) = reported(pendulum_model(), shown(run, encoder=DEGREES))
    assert fault.claimed
    assert (fault.channels, fault.word) == (("encoder",), "deg")


def test_where_an_input_and_a_sensor_cannot_be_reported_apart_the_input_is_named() -> None:
    run = spring_recording(1, {}, duration=8.0)
    (metres,) = reported(spring_model(), shown(run, laser=1000.0))
    assert (metres.kind, metres.channels, metres.word) == ("unit", ("f",), "kN")
    assert [rival.channels for rival in metres.rivals] == [("laser",)]
    (sign,) = reported(spring_model(), shown(run, laser=-1.0))
    assert (sign.kind, sign.channels) == ("sign", ("f",))
    assert "laser is recorded with the opposite sign" in sign.sentence


@pytest.mark.parametrize(
    ("factors", "kind", "word"),
    [
        ({"gyro": -1.0}, "sign", ""),
        ({"gyro": 30 / np.pi}, "unit", "rpm"),
        ({"encoder": DEGREES}, "unit", "deg"),
        ({"encoder": DEGREES, "gyro": DEGREES}, "unit", "deg"),
    ],
    ids=["gyro sign", "gyro rpm", "encoder deg", "both deg"],
)
def test_two_sensors_of_one_motion_tell_which_of_them_lies(
    factors: Mapping[str, float], kind: str, word: str
) -> None:
    run = shown(pendulum_recording(2, gyro=True), **factors)
    (fault,) = reported(pendulum_model(gyro=True), run)
    assert fault.claimed
    assert (fault.kind, set(fault.channels), fault.word) == (kind, set(factors), word)


def test_exchanged_columns_are_reported_and_put_right() -> None:
    run = chain_recording(3)
    crossed = replace(run, sensors={"near": run.sensors["far"], "far": run.sensors["near"]})
    (fault,) = reported(chain_model(), crossed)
    assert fault.claimed
    assert (fault.kind, set(fault.channels)) == ("swap", {"near", "far"})
    (right,) = repaired([crossed], [fault])
    np.testing.assert_array_equal(right.sensors["near"], run.sensors["near"])


def test_a_sign_of_one_place_among_two_is_reported() -> None:
    (fault,) = reported(chain_model(), shown(chain_recording(3), far=-1.0))
    assert (fault.claimed, fault.kind, fault.channels) == (True, "sign", ("far",))


def test_a_time_column_in_milliseconds_is_reported_and_put_right() -> None:
    run = spring_recording(1, {}, duration=8.0)
    late = replace(run, t=1000 * run.t)
    (fault,) = reported(spring_model(), late)
    assert (fault.claimed, fault.kind, fault.word) == (True, "time", "ms")
    np.testing.assert_allclose(repaired([late], [fault])[0].t, run.t)


@pytest.mark.parametrize(
    ("model", "run"),
    [
        (pendulum_model(), pendulum_recording(11, noise=0.05)),
        (pendulum_model(), pendulum_recording(11, {"coulomb": 0.8})),
        (pendulum_model(), pendulum_recording(12, {"stiffness": 10.0})),
        (pendulum_model(gravity=1e-3), pendulum_recording(12)),
        (pendulum_model(gyro=True), pendulum_recording(13, {"coulomb": 0.6}, gyro=True)),
        (chain_model(), chain_recording(11, {"coulomb": 5.0})),
        (chain_model(stiffness=1.0), chain_recording(12)),
        (spring_model(), spring_recording(11, {"coulomb": 5.0}, duration=8.0)),
        (spring_model(stiffness=10.0), spring_recording(12, {}, duration=8.0)),
    ],
    ids=[
        "noise",
        "friction",
        "spring",
        "no gravity",
        "friction seen twice",
        "chain friction",
        "chain spring",
        "oscillator friction",
        "oscillator spring",
    ],
)
def test_large_missing_forces_are_no_lies(model: Model, run: Recording) -> None:
    assert reported(model, run) == ()


@pytest.mark.slow
def test_a_wrong_unit_is_said_first_and_the_diagnosis_goes_on() -> None:
    run = shown(pendulum_recording(5, {"coulomb": 0.2}), encoder=DEGREES)
    diagnosis = sh.diagnose(pendulum_model(), run)
    assert diagnosis.sentence.startswith("The measurement is wrong: encoder is recorded in degrees")
    assert diagnosis.verdict == "missing physics"
    assert [found.element.kind for found in diagnosis.found] == ["friction"]
    assert diagnosis.found[0].estimates[0].value == pytest.approx(0.2, rel=0.05)
    (fault,) = [one for one in diagnosis.measurement if one.channel == "encoder"]
    assert fault.kind == "gain"
    assert fault.value == pytest.approx(DEGREES, rel=0.01)
    corrected = sh.apply(
        pendulum_model(), diagnosis.found, diagnosis.parameters, diagnosis.measurement
    )
    (sensor,) = corrected.sensors
    assert sensor.gain is not None
    assert sensor.gain.value == pytest.approx(DEGREES, rel=0.01)


@pytest.mark.parametrize("kind", ["sign", "time"])
def test_a_lie_alone_is_a_fault_of_the_measurement(kind: str) -> None:
    run = spring_recording(1, {}, duration=8.0)
    run = shown(run, f=-1.0) if kind == "sign" else replace(run, t=1000 * run.t)
    diagnosis = sh.diagnose(spring_model(), run)
    assert diagnosis.verdict == "measurement"
    assert diagnosis.found == ()
    assert [(m.channel, m.kind, m.value) for m in diagnosis.measurement] == (
        [("f", "gain", -1.0)] if kind == "sign" else []
    )
    assert {"sign": "opposite sign", "time": "in ms, not in s"}[kind] in diagnosis.sentence
