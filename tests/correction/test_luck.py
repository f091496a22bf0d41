"""What noise alone may do to a comparison, from the angles between two subspaces."""

import numpy as np
import pytest

from symhyb.correction.luck import _spread


def turned(angle: float) -> np.ndarray:
    """One window of three samples with a direction at an angle to the first axis."""
    return np.array([[[np.cos(angle)], [np.sin(angle)], [0.0]]])


@pytest.mark.parametrize("angle", [0.0, 0.3, np.pi / 2])
def test_the_spread_is_that_of_the_quadratic_form(angle: float) -> None:
    a, b = turned(0.0), turned(angle)
    noise = np.random.default_rng(0).normal(size=(200_000, 3))
    difference = (noise @ a[0, :, 0]) ** 2 - (noise @ b[0, :, 0]) ** 2
    assert _spread([a], [b]) == pytest.approx(float(np.std(difference)), rel=0.02, abs=1e-9)


def test_without_initial_states_there_is_no_luck() -> None:
    none = np.zeros((6, 1, 0))
    assert _spread([none], [none]) == 0.0
