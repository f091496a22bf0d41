"""Sensors that are refreshed by a clock of their own are found, and their samples put right."""

from dataclasses import dataclass

import numpy as np
import pytest
from numpy.typing import NDArray

from symhyb import Recording, parse_model
from symhyb.data.cleaning import cleaned
from symhyb.data.refresh import refresh

Array = NDArray[np.float64]
STEP = 0.01  # s
NOISE = 4e-4  # rad

MODEL = """symhyb = 1
gravity = ["0", "-g"]
[coordinates]
q = { unit = "rad" }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 1.0, unit = "kg" }
l = { value = 0.2, unit = "m" }
[bodies.weight]
mass = "m"
at = ["l*sin(q)", "-l*cos(q)"]
[sensors]
encoder = { measures = "q", unit = "rad" }
"""


def swing(t: Array) -> Array:
    """Angles (N,) in rad of a swing that decays."""
    return np.asarray(1.5 * np.exp(-0.5 * t) * np.cos(6.0 * t))


def left_of(y: Array, t: Array) -> float:
    """What the swing, by a clock that may be late and a little slow, leaves of values (N,): RMS,
    rad."""
    late = t - 0.004
    speed = np.gradient(swing(late), t)
    clock = np.column_stack((speed, speed * t))
    off = y - swing(late)
    return float(np.sqrt(np.mean((off - clock @ np.linalg.lstsq(clock, off)[0]) ** 2)))


@dataclass(frozen=True, slots=True)
class Read:
    """Samples that are read: times (N,) in s, their true ages (N,) in s, values (N,) in rad."""

    t: Array
    ages: Array
    y: Array


def read(period: float, seed: int, phases: tuple[float, ...] = (0.3,), again: int = 0) -> Read:
    """Read a sensor that is refreshed every ``period``; its phase changes after each part of the
    recording, and of ``again`` samples the value is one period older."""
    rng = np.random.default_rng(seed)
    t = np.arange(300) * STEP + 2e-4 * rng.standard_normal(300)
    parts = np.repeat(phases, -(-t.size // len(phases)))[: t.size]
    ages = np.mod(t - parts * period, period)
    ages[rng.choice(np.arange(5, 200), again, replace=False)] += period
    return Read(t, ages, swing(t - ages) + NOISE * rng.standard_normal(t.size))


@pytest.mark.parametrize("period", [0.0047, 0.008, 0.0123])
def test_the_period_and_the_ages_are_those_of_the_clock(period: float) -> None:
    one = read(period, 0)
    found = refresh([(one.t, one.y)])
    assert found is not None
    assert found.period == pytest.approx(period, rel=3e-3)
    (aged,) = found.each
    assert aged is not None
    fast = np.abs(np.gradient(swing(one.t), one.t)) > 2
    off = np.mod(aged.ages - one.ages + period / 2, period) - period / 2
    assert np.std(off[fast]) < 0.07 * period
    assert aged.after < 2 * NOISE**2 < 0.1 * aged.before


def test_phases_that_change_and_values_read_once_more_are_followed() -> None:
    one = read(0.008, 1, (0.2, 0.7), again=6)
    found = refresh([(one.t, one.y)])
    assert found is not None
    (aged,) = found.each
    assert aged is not None
    assert aged.after < 3 * NOISE**2
    fast = np.abs(np.gradient(swing(one.t), one.t)) > 2
    stale = fast & (one.ages > 0.008)
    assert stale.any()
    assert np.median(aged.ages[stale]) > 0.008


def test_samples_are_moved_to_half_a_period_before_their_stamps() -> None:
    model = parse_model(MODEL)
    runs = [read(0.008, seed) for seed in range(2)]
    recordings = [
        Recording.from_frame({"t": one.t, "encoder": one.y}, model, name=f"run-{i}.csv")
        for i, one in enumerate(runs)
    ]
    put = cleaned(recordings, model)
    for one, before, after in zip(runs, recordings, put, strict=True):
        seen = np.isfinite(after.sensors["encoder"])
        assert seen.mean() > 0.95
        errors = [left_of(r.sensors["encoder"][seen], one.t[seen]) for r in (before, after)]
        assert errors[1] < 2 * NOISE < 0.2 * errors[0]
        (note,) = [text for text in after.notes if "clock" in text]
        assert "encoder is refreshed every 8 ms by a clock of its own" in note


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("noise", ["white", "jitter", "steps", "coloured", "ripple"])
def test_other_noise_is_no_clock(noise: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.arange(300) * STEP
    y = {
        "white": lambda: swing(t) + 5e-3 * rng.standard_normal(t.size),
        "jitter": lambda: swing(t + 2e-3 * rng.standard_normal(t.size)),
        "steps": lambda: np.round(swing(t) / 0.02) * 0.02,
        "coloured": lambda: swing(t) + 1e-3 * np.cumsum(rng.standard_normal(t.size)),
        "ripple": lambda: swing(t) + 5e-3 * np.sin(2 * np.pi * 26 * t + seed),
    }[noise]()
    assert refresh([(t, y)]) is None


def test_a_recording_in_which_nothing_moves_has_no_ages_beside_one_that_shows_the_clock() -> None:
    one = read(0.008, 0)
    found = refresh([(one.t, np.full(one.t.size, 0.2)), (one.t, one.y)])
    assert found is not None
    assert found.each[0] is None
    assert found.each[1] is not None


def test_a_sensor_without_motion_or_with_few_samples_has_no_clock() -> None:
    t = np.arange(300) * STEP
    assert refresh([(t, np.zeros(300))]) is None
    assert refresh([(t[:30], swing(t[:30]))]) is None
    assert refresh([(t, np.full(300, np.nan))]) is None
