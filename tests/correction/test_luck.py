"""What noise alone may do to a comparison, from the angles between two subspaces."""

import numpy as np
import pytest

from symhyb.correction.search.luck import _spread, _View

ROWS = (np.arange(3),)


def turned(angle: float) -> _View:
    """One window of three samples with a direction at an angle to the first axis."""
    return _View(np.array([[[np.cos(angle)], [np.sin(angle)], [0.0]]]), ROWS)


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2])
def test_the_spread_is_that_of_the_quadratic_form(angle: float) -> None:
    a, b = turned(0.0), turned(angle)
    noise = np.random.default_rng(0).normal(size=(200_000, 3))
    difference = (noise @ a.bases[0, :, 0]) ** 2 - (noise @ b.bases[0, :, 0]) ** 2
    assert _spread([a], [b]) == pytest.approx(float(np.std(difference)), rel=0.02, abs=1e-9)


def test_without_initial_states_there_is_no_luck() -> None:
    none = _View(np.zeros((6, 1, 0)), ROWS)
    assert _spread([none], [none]) == 0.0


def test_samples_taken_later_are_others() -> None:
    """A sensor that is two samples late: two samples of noise go and two others come."""
    bases, rows = np.zeros((1, 1, 0)), np.arange(40)
    noise = np.random.default_rng(0).normal(size=(100_000, 42))
    difference = np.sum(noise[:, :40] ** 2, axis=1) - np.sum(noise[:, 2:] ** 2, axis=1)
    spread = _spread([_View(bases, (rows, rows))], [_View(bases, (rows + 2, rows))])
    assert spread == pytest.approx(float(np.std(difference)), rel=0.02)
