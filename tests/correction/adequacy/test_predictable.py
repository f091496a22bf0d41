"""What a structure leaves is noise, or follows from its own past."""

import numpy as np
import pytest

import symhyb as sh
from symhyb.correction.adequacy.predictable import _follows_from_its_past, leaves_noise
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely, fitted
from symhyb.correction.naming.classes import class_found
from symhyb.model.types import On
from tests.pushed import STEP, markov, pushed, pushed_model, setting_of


def series(seed: int, count: int, correlation: float) -> np.ndarray:
    return markov(np.random.default_rng(seed), count, 1.0, -STEP / np.log(correlation))


@pytest.mark.parametrize("count", [30, 200, 3000])
def test_white_noise_follows_from_nothing(count: int) -> None:
    """Of 200 draws a thousandth is a false alarm by the test alone."""
    random = np.random.default_rng(count)
    alarms = [_follows_from_its_past(random.standard_normal(count)) for _ in range(200)]
    assert sum(alarms) <= 2


@pytest.mark.parametrize(
    ("correlation", "count", "said"),
    [
        (0.5, 3000, True),
        (0.5, 200, True),
        (0.1, 3000, False),  # certain, and a hundredth of the power
        (0.3, 30, False),  # may be by chance
    ],
)
def test_a_correlation_counts_that_is_certain_and_large(
    correlation: float, count: int, said: bool
) -> None:
    assert _follows_from_its_past(series(1, count, correlation)) == said


def test_samples_that_are_missing_are_no_samples() -> None:
    values = series(2, 3000, 0.5)
    values[::3] = np.nan
    assert _follows_from_its_past(values)
    assert not _follows_from_its_past(np.full(500, np.nan))
    assert not _follows_from_its_past(np.zeros(500))


def sensors_alone(recording: sh.Recording) -> tuple[Recorded, Fitted]:
    """The model as it is, beside white noise of the sensor alone."""
    ground = setting_of(pushed_model(), recording)
    quiet = ground.first_noise().without_force().without_colour()
    return ground, fitted(ground, (), (), quiet)


def test_what_the_right_model_leaves_is_noise_and_what_one_leaves_that_lacks_a_force_is_not() -> (
    None
):
    force = markov(np.random.default_rng(4), 1000, 0.4, 0.3)
    assert leaves_noise(*sensors_alone(pushed(3, samples=1000)))
    assert not leaves_noise(*sensors_alone(pushed(3, samples=1000, beside=force)))


def test_the_best_of_what_was_tried_has_no_probability_where_it_leaves_no_noise() -> None:
    mode = Generic("hidden mode", On("x"), (), np.zeros(0), figure=37.0)
    known = class_found(Likely(mode, 1.0))
    best = class_found(Likely(mode, 1.0, white=False))
    assert "(probability 100 %)" in known.sentence
    assert "probability" not in best.sentence
    assert "it may be none of them" in best.sentence
    assert (known.leaves_noise, best.leaves_noise) == (True, False)
