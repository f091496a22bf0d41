"""What an actuator passes on of a signal, against the same written by hand on a fine grid."""

import numpy as np
import pytest
from blocks import slope

from symhyb.numeric.kernels.actuators import acted
from symhyb.numeric.kernels.buffers import Array, held_at

NUMBERS = {"dead_band": 0.2, "backlash": 0.5, "limit": 1.8, "rate_limit": 6.0, "lag": 0.05}
EACH = [{key: value} for key, value in NUMBERS.items()]
FINE = np.linspace(0.0, 5.0, 100_001)


def recorded() -> tuple[Array, Array]:
    t = np.linspace(0.0, 5.0, 251)
    return t, 2 * np.sin(3 * t) + np.sin(7.1 * t)


def by_hand(u: Array, numbers: dict[str, float]) -> Array:
    """A signal on the fine grid as it acts, step by step."""
    band, limit = numbers.get("dead_band", 0.0), numbers.get("limit", np.inf)
    rate, lag, h = numbers.get("rate_limit", np.inf), numbers.get("lag", 0.0), FINE[1]
    y = np.where(np.abs(u) > band, u - band * np.sign(u), 0.0)
    half, rests = numbers.get("backlash", 0.0) / 2, [float(y[0])]
    for one in y[1:]:
        rests.append(max(min(rests[-1], one + half), one - half))
    y = np.minimum(np.maximum(np.array(rests), -limit), limit)
    z = y.copy()
    for i in range(1, y.size):
        wanted = y[i] if not lag else z[i - 1] + h * ((y[i] + y[i - 1]) / 2 - z[i - 1]) / lag
        z[i] = min(max(wanted, z[i - 1] - rate * h), z[i - 1] + rate * h)
    return z


@pytest.mark.parametrize("numbers", [*EACH, NUMBERS], ids=lambda one: "+".join(one))
@pytest.mark.parametrize("held", [False, True])
def test_a_signal_acts_as_by_hand(numbers: dict[str, float], held: bool) -> None:
    t, u = recorded()
    raw = held_at(t, u, FINE) if held else np.interp(FINE, t, u)
    found, expected = acted(t, u, numbers, held).at(FINE), by_hand(raw, numbers)
    off = np.abs(found - expected)
    # a line between two of the added times cuts off what a lag or a rate limit bends there
    assert np.quantile(off, 0.99) < 3e-3
    assert off.max() < (0.3 if held else 1e-2)  # a jump, or its end, may lie a fine step aside


def test_a_dead_band_takes_off_and_a_limit_holds() -> None:
    t, u = np.array([0.0, 1.0, 2.0]), np.array([-3.0, 3.0, 0.5])
    assert acted(t, u, {"dead_band": 1.0}).at(t) == pytest.approx([-2.0, 2.0, 0.0])
    assert acted(t, u, {"limit": 2.0}).at(t) == pytest.approx([-2.0, 2.0, 0.5])
    # between its samples the line has its kinks where it crosses: at a third of the first second
    assert acted(t, u, {"dead_band": 1.0}).at(np.array([0.5, 2 / 3])) == pytest.approx([0.0, 0.0])
    assert acted(t, u, {"limit": 2.0}).at(np.array([1 / 6, 5 / 6])) == pytest.approx([-2.0, 2.0])


def test_a_rate_limit_catches_up_and_a_lag_decays() -> None:
    t, step = np.linspace(0.0, 1.0, 101), np.where(np.linspace(0.0, 1.0, 101) > 0.1, 1.0, 0.0)
    late = acted(t, step, {"rate_limit": 5.0}).at(np.array([0.1, 0.2, 0.3, 0.4]))
    assert late == pytest.approx([0.0, 0.5, 1.0, 1.0], abs=0.01)
    lag = acted(t, step, {"lag": 0.2}, held=True).at(np.array([0.11 + 0.2, 0.11 + 0.4]))
    assert lag == pytest.approx(1 - np.exp([-1.0, -2.0]), abs=1e-3)


def test_a_number_of_zero_does_nothing() -> None:
    t, u = recorded()
    same = acted(t, u, dict.fromkeys(NUMBERS, 0.0))
    assert np.array_equal(same.u, u)
    assert np.array_equal(same.t, t)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("numbers", [*EACH, NUMBERS], ids=lambda one: "+".join(one))
def test_slopes_by_the_numbers_are_those_of_differences(
    numbers: dict[str, float], held: bool
) -> None:
    t, u = recorded()
    at = np.linspace(0.0, 5.0, 1999)
    slopes = acted(t, u, numbers, held, asked=tuple(numbers)).by_at(at)
    for j, (key, value) in enumerate(numbers.items()):

        def moved(change: float, key: str = key, value: float = value) -> Array:
            return acted(t, u, {**numbers, key: value + change}, held).at(at)

        expected = slope(moved, 1e-6 * value)
        off = np.abs(slopes[:, j] - expected)
        # on the very corner of a held signal a difference sees either side
        assert np.quantile(off, 0.99) < 1e-6 * max(np.abs(expected).max(), 1.0), key
        assert np.abs(expected).max() > 0.1 or held


def test_the_order_matters() -> None:
    t, u = recorded()
    both = acted(t, u, {"dead_band": 0.5, "limit": 1.0})
    assert np.abs(both.u).max() == pytest.approx(1.0)  # the limit comes behind the dead band
    slow = acted(t, u, {"rate_limit": 4.0, "lag": 0.05}).at(FINE)
    assert np.abs(np.diff(slow) / FINE[1]).max() < 4.0 + 1e-6


def test_a_play_rests_after_each_turn() -> None:
    t, u = np.array([0.0, 1.0, 2.0, 3.0, 4.0]), np.array([0.0, 3.0, -3.0, -2.5, 2.0])
    made = acted(t, u, {"backlash": 2.0}, asked=("backlash",))
    assert made.at(t) == pytest.approx([0.0, 2.0, -2.0, -2.0, 1.0])
    # up from a third of the first second on; back from 2 at 3 − 2 on, a third of the next one
    assert made.at(np.array([1 / 3, 2 / 3, 4 / 3, 5 / 3])) == pytest.approx([0, 1, 2, 0])
    by = made.by_at(np.array([0.1, 0.5, 1.2, 1.5, 2.5, 3.9]))[:, 0]
    assert by == pytest.approx([0.0, -0.5, -0.5, 0.5, 0.5, -0.5])
    held = acted(t, u, {"backlash": 2.0}, held=True)
    assert held.at(np.array([0.5, 1.5, 2.5])) == pytest.approx([0.0, 2.0, -2.0])


def test_a_held_signal_steps_at_its_samples() -> None:
    t, u = recorded()
    assert acted(t, u, {"quantum": 0.3}, held=True).u == pytest.approx(0.3 * np.round(u / 0.3))


@pytest.mark.parametrize("fine", [False, True])
def test_steps_of_a_line_have_their_exact_impulse(fine: bool) -> None:
    t, u = recorded()
    if fine:
        t, u = np.linspace(0.0, 5.0, 2001), np.interp(np.linspace(0.0, 5.0, 2001), t, u)
    made = acted(t, u, {"quantum": 0.3}, fine=fine)
    stepped = 0.3 * np.round(np.interp(FINE, t, u) / 0.3)
    # from the middle of a sample on, which no mean reaches over
    area = np.cumsum(np.append(0.0, 0.5 * (stepped[1:] + stepped[:-1]) * FINE[1]))
    mine = made.at(FINE)
    off = np.cumsum(np.append(0.0, 0.5 * (mine[1:] + mine[:-1]) * FINE[1])) - area
    assert np.abs(off).max() < 0.3 * 0.02  # a step is off by as much as half of itself, a sample
    assert abs(off[-1]) < 0.1 * 0.3 * 0.02


@pytest.mark.parametrize("fine", [False, True])
def test_the_slope_by_the_size_of_steps_holds_that_they_move(fine: bool) -> None:
    t, u = recorded()
    if fine:
        t, u = np.linspace(0.0, 5.0, 2001), np.interp(np.linspace(0.0, 5.0, 2001), t, u)

    def moved(change: float) -> Array:
        return acted(t, u, {"quantum": 0.3 + change}, fine=fine).u

    expected = slope(moved, 1e-7)
    found = acted(t, u, {"quantum": 0.3}, fine=fine, asked=("quantum",)).by[:, 0]
    assert found == pytest.approx(expected, abs=1e-4 * np.abs(expected).max())
    assert np.abs(expected).max() > 6.0  # more than the seven steps of the largest value
    held = acted(t, u, {"quantum": 0.3}, held=True, fine=fine, asked=("quantum",)).by[:, 0]
    assert held == pytest.approx(found)
