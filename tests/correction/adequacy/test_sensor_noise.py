"""Noise that is correlated in time is noise: of a sensor, and in what is decided."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import symhyb as sh
from symhyb.correction.adequacy import sensor_noise
from symhyb.correction.adequacy.beyond import beyond
from symhyb.correction.adequacy.channel_noise import _showing_forces, sensor_sd
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.data.recording import Recording
from tests.pushed import NOISE, STEP, markov, pushed, pushed_model, setting_of

SAMPLES = 1500
COLOUR = 10 * NOISE, 6 * STEP  # RMS in m and correlation time in s
TOTAL = float(np.hypot(NOISE, COLOUR[0]))


def measured(recording: Recording) -> tuple[Recorded, Fitted, float]:
    """The noise of the sensor beside the model as it is, which an unknown force may help."""
    ground = setting_of(pushed_model(), recording)
    trial = fitted(ground, (), (), ground.first_noise())
    return ground, trial, float(sensor_sd(ground, trial, beyond(ground, trial))[0])


def test_coloured_noise_counts_with_all_of_its_size() -> None:
    ground, _, sd = measured(pushed(1, samples=SAMPLES, colour=COLOUR))
    assert ground.sd[0] < 0.6 * TOTAL  # a spline follows it
    assert sd == pytest.approx(TOTAL, rel=0.15)


@pytest.mark.parametrize("colour", [(0.0, 1.0), (20 * NOISE, 10.0)])
def test_white_noise_and_a_drift_are_left_as_smoothing_measures_them(
    colour: tuple[float, float],
) -> None:
    ground, _, sd = measured(pushed(2, samples=SAMPLES, colour=colour))
    assert sd == ground.sd[0]


def test_an_unmeasured_force_is_no_noise_of_the_sensor() -> None:
    force = markov(np.random.default_rng(4), SAMPLES, 0.4, 0.3)
    ground, trial, sd = measured(pushed(4, samples=SAMPLES, beside=force))
    assert beyond(ground, trial).acts
    assert sd < 1.1 * NOISE


def test_where_the_force_that_is_looked_for_does_not_act_the_sensors_alone_tell() -> None:
    ground, trial, _ = measured(pushed(1, samples=SAMPLES, colour=COLOUR))
    left = beyond(ground, replace(trial, fit=replace(trial.fit, noise=ground.first_noise())))
    quiet = replace(left, evidence=0.0)
    assert sensor_sd(ground, trial, quiet)[0] == pytest.approx(TOTAL, rel=0.15)


@pytest.mark.parametrize(("scale", "taken"), [(15.0, True), (30.0, False), (1.0, False)])
def test_noise_that_is_a_small_part_of_what_is_left_decides_nothing(
    monkeypatch: pytest.MonkeyPatch, scale: float, taken: bool
) -> None:
    """Three times the noise explains 9 of what is left, or with a factor of two 18."""
    for name in ("recorded", "followed", "beyond"):
        along = SimpleNamespace(fit=SimpleNamespace(reason=""))
        monkeypatch.setattr(sensor_noise, name, lambda *_, along=along: along)
    monkeypatch.setattr(sensor_noise, "sensor_sd", lambda *_: np.array([3.0, 1.0]))
    fit = SimpleNamespace(scale=scale)
    selected = SimpleNamespace(fit=fit)
    setting = SimpleNamespace(sd=np.ones(2), stages=[SimpleNamespace(cuts=())])
    found, along = sensor_noise.measured_again(
        SimpleNamespace(repeats=()),  # type: ignore[arg-type]
        setting,  # type: ignore[arg-type]
        selected,  # type: ignore[arg-type]
        None,
    )
    assert (found is not None) == taken
    assert (along is not None) == (scale > 1.1)


@pytest.mark.thorough
def test_what_is_missing_is_named_under_coloured_noise() -> None:
    made = pushed(7, samples=SAMPLES, damping=0.75, colour=COLOUR)
    found = sh.diagnose(pushed_model(), made)
    assert found.verdict == "missing physics"
    assert [one.element.kind for one in found.found] == ["damper"]
    assert found.noise["laser"] == pytest.approx(TOTAL, rel=0.15)


@pytest.mark.slow
def test_nothing_is_missing_under_coloured_noise() -> None:
    found = sh.diagnose(pushed_model(), pushed(8, samples=800, colour=COLOUR))
    assert found.verdict == "nothing missing"


@pytest.mark.parametrize(("imposed", "cell"), [((1,), True), ((), False)])
def test_the_colour_of_a_force_cell_may_be_a_force(imposed: tuple[int, ...], cell: bool) -> None:
    """Two sensors of a machine with two coordinates: one of the motion, one of the force on the
    second, which shows at once what acts there."""
    by_force = np.zeros((1, 5, 2, 2))
    by_force[..., 1, 1] = 1.0
    ground = SimpleNamespace(windows=SimpleNamespace(machine=SimpleNamespace(imposed=imposed)))
    tracks = [SimpleNamespace(linear=SimpleNamespace(by_force=by_force))]
    assert _showing_forces(ground, tracks).tolist() == [False, cell]  # type: ignore[arg-type]
