"""Clock jitter: noise that grows with the rate of what a sensor shows, told in seconds."""

from dataclasses import replace

import numpy as np
import pytest

import symhyb as sh
from symhyb.correction.adequacy.clock_jitter import growing, jittering
from symhyb.correction.adequacy.structure import fitted
from symhyb.data.recording import Recording
from tests.pushed import NOISE, pushed, pushed_model, setting_of

SAMPLES = 1000
JITTER_S = 4e-3  # a fifth of a sample


def jittered(seed: int, time_s: float = JITTER_S) -> Recording:
    """The place as it was at times that are not those of the file."""
    exact = pushed(seed, samples=SAMPLES, noise=0.0)
    random = np.random.default_rng([seed, 1])
    place = exact.sensors["laser"]
    rate = np.gradient(place, exact.t)
    seen = place + rate * time_s * random.standard_normal(place.size)
    return replace(exact, sensors={"laser": seen + NOISE * random.standard_normal(place.size)})


def growing_with_size(seed: int) -> Recording:
    """Noise in proportion to what is shown, as of a sensor whose gain flickers."""
    exact = pushed(seed, samples=SAMPLES, noise=0.0)
    random = np.random.default_rng([seed, 2])
    place = exact.sensors["laser"]
    seen = place * (1 + 0.05 * random.standard_normal(place.size))
    return replace(exact, sensors={"laser": seen + NOISE * random.standard_normal(place.size)})


@pytest.mark.parametrize("true", [0.0, 1.0, 3.0])
def test_growth_is_measured(true: float) -> None:
    random = np.random.default_rng(3)
    signal = np.sin(np.arange(4000) / 7)
    white = np.sqrt(1 + (true * signal) ** 2) * random.standard_normal(signal.size)
    growth, gain = growing(white, signal)
    if true:
        assert growth == pytest.approx(true, rel=0.12)
        assert gain > 20
    else:
        assert gain < 3


def test_a_signal_that_stands_still_tells_nothing() -> None:
    assert growing(np.ones(10), np.zeros(10)) == (0.0, 0.0)


def test_jitter_is_found_and_steady_noise_is_none() -> None:
    for recording, expected in ((jittered(4), JITTER_S), (pushed(4, samples=SAMPLES), None)):
        ground = setting_of(pushed_model(), recording)
        found = jittering(ground, fitted(ground, (), (), ground.first_noise()))
        assert [one.sensor for one in found] == ([] if expected is None else ["laser"])
        for one in found:
            assert one.time_s == pytest.approx(expected, rel=0.2)


def test_noise_in_proportion_to_what_is_shown_is_no_jitter() -> None:
    ground = setting_of(pushed_model(), growing_with_size(5))
    assert jittering(ground, fitted(ground, (), (), ground.first_noise())) == ()


def test_a_diagnosis_says_it_and_finds_no_physics() -> None:
    diagnosis = sh.diagnose(pushed_model(), jittered(6))
    assert not diagnosis.found
    (said,) = (note for note in diagnosis.notes if "time stamps" in note)
    assert "laser" in said
    assert not any("time stamps" in n for n in sh.diagnose(pushed_model(), pushed(6)).notes)
