"""Spikes are found from the signal alone; what a motion can do is no spike."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb.data.faults import spikes

Array = NDArray[np.float64]
AT = 5.001  # s, between two samples


def noisy_sine(t: Array) -> Array:
    return 0.1 * np.sin(2 * np.pi * t) + 1e-3 * np.random.default_rng(0).standard_normal(t.size)


@pytest.mark.parametrize("gap", [2, 3, 4, 5, 9])
def test_two_spikes_close_together_are_both_found(gap: int) -> None:
    values = noisy_sine(np.arange(2000) * 0.005)
    values[1004] += 0.7
    values[1004 + gap] -= 0.3
    assert list(np.flatnonzero(spikes(values))) == [1004, 1004 + gap]


def test_spikes_beside_missing_samples_raise_nothing() -> None:
    values = noisy_sine(np.arange(2000) * 0.005)
    values[[1004, 1006]] += 0.7
    values[1008:1020] = np.nan
    assert not spikes(values).any()


@pytest.mark.parametrize("size", [0.1, 0.5, 5.0])
@pytest.mark.parametrize(
    "motion",
    [
        lambda s: s > 0,
        lambda s: np.maximum(s, 0) / 0.005,
        lambda s: (s > 0) & (s < 0.01),  # two samples
        lambda s: (s > 0) & (s < 0.015),
        lambda s: np.where(s > 0, np.exp(-s / 0.02) * np.sin(2 * np.pi * 60 * s), 0.0),
    ],
    ids=["step", "kink", "two samples", "three samples", "ringing"],
)
def test_what_a_motion_can_do_is_no_spike(motion: Callable[[Array], Array], size: float) -> None:
    t = np.arange(2000) * 0.005
    with np.errstate(under="ignore", over="ignore"):
        moved = size * np.asarray(motion(t - AT), dtype=float)
    assert not spikes(noisy_sine(t) + moved).any()
