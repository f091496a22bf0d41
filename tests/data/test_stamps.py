"""Stamps against times of logging: which is taken, and what is said of the other."""

import re

import numpy as np
import pytest

from symhyb.data.files.stamps import time_notes, times_of

SECOND = 1_000_000_000
START = 1_709_646_312 * SECOND
RANDOM = np.random.default_rng(3)


def ns(seconds):
    return START + np.round(np.asarray(seconds) * SECOND).astype(np.int64)


T = np.arange(1000) / 100
DELAY = 1e-3 + RANDOM.gamma(1.0, 1e-3, T.size)  # a bus and a queue


def test_a_stamp_is_taken_and_its_delay_is_said():
    times = times_of("imu", ns(T + DELAY), ns(T), START, 10 * SECOND)
    np.testing.assert_allclose(times.t, T, atol=1e-12)
    np.testing.assert_allclose(times.others, T + DELAY, atol=1e-9)
    assert (times.stamped, times.unused) == (True, "t_log")
    (note,) = time_notes([times])
    middle, low, high = (f"{1e3 * f(DELAY):.3g} ms" for f in (np.median, np.min, np.max))
    assert note == (
        f"t is when it was measured, as stamped: imu (logged {middle} later, {low} to {high})"
    )


def test_nanoseconds_since_1970_lose_no_digit():
    times = times_of("imu", ns(T) + 7, ns(T) + 3, START, 10 * SECOND)
    np.testing.assert_allclose(times.t[:3], [3e-9, 0.01 + 3e-9, 0.02 + 3e-9], atol=1e-15)


@pytest.mark.parametrize(
    ("stamps", "why"),
    [
        (0 * ns(T), "not set"),
        (np.where(T == 5.0, 0, ns(T)), "1 of 1000 are not set"),
        (ns(np.where(T < 5, T, T - 5)), "they jump back"),
        (ns(T % 3), "they jump back 3 times"),
        (ns(np.repeat(T[::2], 2)), "500 repeat the one before"),
        (ns(T) - START + 1, "their clock is another, 1.71e+09 s apart"),
    ],
)
def test_stamps_that_are_no_times_give_way_to_those_of_logging(stamps, why):
    times = times_of("imu", ns(T + DELAY), stamps, START, 10 * SECOND)
    np.testing.assert_allclose(times.t, T + DELAY, atol=1e-9)
    assert times.unused == "t_stamp"
    assert time_notes([times]) == (
        f"t is when it was logged, for stamps cannot be used: imu ({why})",
    )


def test_stamps_after_logging_are_clocks_of_two_computers():
    times = times_of("imu", ns(T), ns(T + 0.25), START, 10 * SECOND)
    assert "logged 250 ms before that: clocks of two computers differ" in times.said


@pytest.mark.parametrize(("drift", "verb"), [(2e-4, "grows"), (-2e-4, "shrinks")])
def test_clocks_that_run_apart_are_said(drift, verb):
    late = times_of("imu", ns(T * (1 + drift) + 0.01 + DELAY), ns(T), START, 10 * SECOND)
    found = re.search(rf"; this {verb} by (\d+) us/s, clocks run apart", late.said)
    assert found is not None
    assert abs(int(found[1]) - 200) < 20


def test_queues_alone_are_no_drift():
    for seed in range(20):
        delay = np.random.default_rng(seed).gamma(1.0, 1e-3, T.size)
        said = times_of("imu", ns(T + delay), ns(T), START, 10 * SECOND).said
        assert "apart" not in said, seed


def test_topics_without_stamps_are_told_apart():
    bare = times_of("cmd", ns(T), None, START, 10 * SECOND)
    assert bare.others is None
    assert time_notes([bare]) == ("t is when messages were logged; they have no stamps",)
    stamped = times_of("imu", ns(T + 0.5), ns(T), START, 10 * SECOND)
    assert time_notes([stamped, bare])[1] == "t is when it was logged, without stamps: cmd"
