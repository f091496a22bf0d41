"""When, at which frequencies and beyond which amplitude a force acts."""

import numpy as np
import pytest

import symhyb as sh
from symhyb.discrepancy.places.occurrence import band_of, beyond_of, spectrum
from symhyb.discrepancy.results import Change
from symhyb.discrepancy.words.occurrence_words import occurrence_sentence, place_words
from symhyb.model.types import On
from tests.rigs import spring_model

T = np.arange(0, 40, 0.01)
NOISE = np.random.default_rng(3).standard_normal(T.size)


def test_the_band_is_where_the_force_acts_and_not_where_the_noise_is() -> None:
    acting = np.sin(2 * np.pi * 3.2 * T) + np.sin(2 * np.pi * 4.8 * T)
    lines, power = spectrum(T, acting + 3 * NOISE, acting)
    band = band_of(lines, power)
    assert band == pytest.approx((3.2, 4.8), abs=0.06)
    assert spectrum(T**1.2, acting, acting)[0].size == 0  # uneven samples have no spectrum here


def test_a_stop_acts_only_beyond_its_clearance_and_smooth_laws_from_the_start() -> None:
    s = np.sin(T) * (1 + 0.3 * np.sin(0.31 * T))
    noise = 0.02 * NOISE
    stop = -5 * np.sign(s) * np.maximum(np.abs(s) - 0.7, 0) + noise
    assert beyond_of(s, stop) == pytest.approx(0.7, abs=0.1)
    assert beyond_of(s, -5 * s + noise) is None
    assert beyond_of(s, -5 * s**3 + noise) is None
    assert beyond_of(s, -np.sign(np.gradient(s)) + noise) is None
    assert beyond_of(s, noise) is None
    far = 0.7 + 0.27 * np.sin(T)  # never near zero
    assert beyond_of(far, -5 * far + noise) is None


@pytest.mark.parametrize(
    ("name", "coordinate", "words"),
    [
        ("double_pendulum", "beta", "on beta (joint of lower to upper)"),
        ("double_pendulum", "alpha", "on alpha (joint of upper to the ground)"),
        ("cartpole", "x", None),
    ],
)
def test_a_joint_or_body_is_named(name: str, coordinate: str, words: str | None) -> None:
    model = sh.read_model(f"models/{name}.toml")
    said = place_words(model, On(model.coordinates[0].name if words is None else coordinate))
    assert said == words if words else said.startswith("on ")


def test_the_sentence_says_begin_amplitude_and_band() -> None:
    change = Change("run.csv", 40.21, 0.2, "begins")
    said = occurrence_sentence(spring_model(), On("x"), change, (3.0, 5.0), 0.1, 0.08)
    assert said == (
        "On x (motion of mass), the mismatch begins at t = 40.21 s of run.csv (to 0.2 s), "
        "acts only beyond 80 mm and acts mostly between 3 and 5 Hz."
    )
    assert occurrence_sentence(spring_model(), On("x"), None, None, 0.1, None) == ""
