"""What noise tells of the channels: sensors that drift or freeze, inputs that were recorded with
noise, and noise that is nothing but noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter

from symhyb.correction.adequacy.beyond import beyond
from symhyb.correction.adequacy.channel_noise import faulty_sensors, noisy_inputs
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.fit import FAILED
from tests.builders import DRIVEN_MASS
from tests.plate import PLATE, plate, with_noisy_inputs
from tests.pushed import NOISE, STEP, markov, pushed, pushed_model, setting_of

SAMPLES = 1500


def coloured(recording: Recording) -> tuple[Recorded, Fitted]:
    """The model as it is with sensors alone, white and coloured."""
    setting = setting_of(pushed_model(), recording)
    return setting, fitted(setting, (), (), setting.first_noise().without_force())


def frozen(recording: Recording, samples: int, every: int) -> Recording:
    """The sensor repeats a value for some samples, again and again, beside noise of its own."""
    seen = recording.sensors["laser"].copy()
    for first in range(every, SAMPLES - samples, every):
        seen[first : first + samples] = seen[first]
    noise = NOISE * np.random.default_rng(5).standard_normal(SAMPLES)
    return replace(recording, sensors={"laser": seen + noise})


def test_a_colour_that_is_slower_than_the_motion_is_a_drift() -> None:
    setting, trial = coloured(pushed(1, samples=SAMPLES, colour=(20 * NOISE, 10.0)))
    ((found, chance, *_),) = faulty_sensors(setting, trial)
    assert (found.kind, found.where, found.does) == ("sensor", "laser", "drifts")
    assert chance > 0.99


def test_a_colour_of_bursts_is_a_sensor_that_freezes() -> None:
    setting, trial = coloured(frozen(pushed(2, samples=SAMPLES, noise=NOISE / 10), 5, 75))
    ((found, chance, *_),) = faulty_sensors(setting, trial)
    assert (found.kind, found.does) == ("sensor", "jumps")
    assert chance > 0.99


def test_a_model_that_fails_at_large_motion_accuses_no_sensor() -> None:
    """A decay with noise of the sensor in proportion to the square of its size: in bursts, but
    where the motion is large."""
    random, t = np.random.default_rng(9), STEP * np.arange(SAMPLES)
    x = np.exp(-0.3 * t) * np.cos(np.sqrt(25.0 - 0.09) * t)
    fast = lfilter([1.0], [1.0, -0.8], random.standard_normal(SAMPLES))
    noise = NOISE / 10 * random.standard_normal(SAMPLES) + NOISE * np.exp(-0.6 * t) * fast
    made = Recording("decay.csv", t, {"f": np.zeros(SAMPLES)}, {"laser": x + noise}, (), "")
    setting, trial = coloured(made)
    assert trial.fit.noise.coloured
    assert faulty_sensors(setting, trial) == ()


@pytest.mark.parametrize("memory_s", [0.04, 0.15])
def test_a_colour_that_is_fast_and_normal_is_noise(memory_s: float) -> None:
    setting, trial = coloured(pushed(3, samples=SAMPLES, colour=(5 * NOISE, memory_s)))
    assert trial.fit.noise.coloured
    assert faulty_sensors(setting, trial) == ()


def test_a_sensor_that_one_recording_lacks_is_judged_by_the_other() -> None:
    model = pushed_model(DRIVEN_MASS + 'spare = { measures = "x", unit = "m" }\n')
    made, other = pushed(2, samples=SAMPLES, noise=NOISE / 10), pushed(3, samples=600)
    seen = {**made.sensors, "spare": frozen(made, 5, 75).sensors["laser"]}
    setting = setting_of(model, replace(made, sensors=seen), other)
    trial = fitted(setting, (), (), setting.first_noise().without_force())
    ((found, *_),) = faulty_sensors(setting, trial)
    assert (found.where, found.does) == ("spare", "jumps")


def test_a_fit_without_colour_or_that_failed_accuses_no_sensor() -> None:
    setting, trial = coloured(pushed(4, samples=SAMPLES))
    assert faulty_sensors(setting, trial) == ()
    setting, trial = coloured(pushed(1, samples=SAMPLES, colour=(20 * NOISE, 10.0)))
    assert faulty_sensors(setting, replace(trial, fit=replace(trial.fit, reason=FAILED))) == ()


def test_a_force_without_memory_is_noise_of_the_input() -> None:
    """The push is recorded with noise of a fifth of its size, sample by sample."""
    made = pushed(6, samples=SAMPLES, noise=NOISE / 10)
    noise = 0.8 * np.random.default_rng(7).standard_normal(SAMPLES)
    setting = setting_of(pushed_model(), replace(made, inputs={"f": made.inputs["f"] + noise}))
    trial = fitted(setting, (), (), setting.first_noise())
    left = beyond(setting, trial)
    assert left.acts
    ((found, chance, *_),) = noisy_inputs(setting, trial, left)
    assert (found.kind, found.where, found.does) == ("input", "f", "noisy")
    assert chance > 0.99
    assert noisy_inputs(setting, trial, replace(left, memory_s=4 * STEP))  # not worth a number
    likely = replace(trial, fit=replace(trial.fit, logl=trial.fit.logl + 10))
    assert noisy_inputs(setting, likely, replace(left, memory_s=4 * STEP)) == ()


def test_a_force_with_memory_is_no_noise_of_the_input() -> None:
    planted = markov(np.random.default_rng(8), SAMPLES, 1.0, 0.2)
    setting = setting_of(pushed_model(), pushed(8, samples=SAMPLES, beside=planted))
    trial = fitted(setting, (), (), setting.first_noise())
    left = beyond(setting, trial)
    assert left.acts
    assert noisy_inputs(setting, trial, left) == ()


def pulled(*sizes: float) -> tuple[Recorded, Fitted]:
    """A plate whose pushes are recorded with noise of these sizes, N."""
    setting = setting_of(PLATE, with_noisy_inputs(plate(), sizes, 9))
    return setting, fitted(setting, (), (), setting.first_noise())


@pytest.mark.slow
def test_forces_without_memory_are_noise_of_the_inputs_that_push_there() -> None:
    setting, trial = pulled(0.8, 0.6)
    found = noisy_inputs(setting, trial, beyond(setting, trial))
    assert [one.generic.where for one in found] == ["f", "g"]
    assert {one.generic.does for one in found} == {"noisy"}
    assert min(one.probability for one in found) > 0.99
    setting, trial = pulled(0.0, 0.8)
    (second,) = noisy_inputs(setting, trial, beyond(setting, trial))
    assert second.generic.where == "g"
