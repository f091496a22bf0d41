"""What is in a channel: noise, rest and frequencies of signals that are known."""

import numpy as np
import pytest

from symhyb.data.look import noise_of, peaks_of, rests, signal_of, spectrum_of

T = np.arange(0, 20, 0.002)
NOISE = np.random.default_rng(0).standard_normal(T.size)


def test_noise_on_a_smooth_motion_is_measured() -> None:
    assert noise_of(3 * np.sin(2 * np.pi * 2 * T) + 0.05 * NOISE) == pytest.approx(0.05, rel=0.05)


def test_jumps_are_no_noise() -> None:
    steps = np.floor(T / 2.0) + 0.01 * NOISE
    assert noise_of(steps) == pytest.approx(0.01, rel=0.05)


def test_the_power_of_a_spectrum_is_the_variance() -> None:
    wave = 2 * np.sin(2 * np.pi * 12.5 * T)
    frequency, power = spectrum_of(T, wave, 0.002)
    assert power.sum() == pytest.approx(2.0, rel=0.02)
    assert frequency[np.argmax(power)] == pytest.approx(12.5, abs=0.3)


def test_frequencies_that_stand_out_come_strongest_first() -> None:
    two = 2 * np.sin(2 * np.pi * 7 * T) + np.sin(2 * np.pi * 30 * T) + 0.1 * NOISE
    first, second = peaks_of(T, two, 0.002)
    assert (first.frequency, second.frequency) == pytest.approx((7.0, 30.0), abs=0.3)
    assert (first.share, second.share) == pytest.approx((0.8, 0.2), abs=0.03)


def test_white_noise_has_no_frequency() -> None:
    assert peaks_of(T, NOISE, 0.002) == ()


def test_a_rest_is_found_and_a_turning_point_is_none() -> None:
    moving = np.sin(2 * np.pi * T)
    noise = 0.001 * NOISE
    assert list(rests(T, moving + noise, 0.001)) == []
    stopped = np.where((T > 8) & (T < 12), 0.0, moving) + noise
    ((start, end),) = rests(T, stopped, 0.001)
    assert start == pytest.approx(8.0, abs=0.2)
    assert end == pytest.approx(12.0, abs=0.2)


def test_a_slow_channel_and_missing_samples() -> None:
    slow = np.where(np.arange(T.size) % 10 == 0, np.sin(T), np.nan)
    one = signal_of("slow", "m", T, slow)
    assert (one.missing, one.rate) == (0, pytest.approx(50.0))
    holes = np.sin(T)
    holes[100:103] = np.nan
    assert signal_of("holes", "m", T, holes).missing == 3


def test_a_constant_channel_shows_nothing_else() -> None:
    one = signal_of("dead", "V", T, np.full(T.size, 4.0))
    assert (one.low, one.high, one.grain, one.rest, one.peaks) == (4.0, 4.0, None, (), ())
