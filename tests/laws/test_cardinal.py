"""A curve as a sum of what each of its values multiplies."""

import numpy as np
import pytest

from symhyb.laws.cardinal import cardinal_values, cardinals, parts_of
from symhyb.laws.characteristic import through
from symhyb.laws.curve import LAW, value_name
from symhyb.laws.maths import NUMPY, Motion

RANDOM = np.random.default_rng(3)
RISING = (np.sort(RANDOM.normal(size=7)), np.sort(RANDOM.normal(size=7)))
SWINGING = (np.sort(RANDOM.normal(size=6)), RANDOM.normal(size=6))
TWO = (np.array([0.0, 2.0]), np.array([1.0, -3.0]))
POINTS = pytest.mark.parametrize("points", [RISING, SWINGING, TWO])


def parts_over(points: tuple[np.ndarray, np.ndarray], grid: np.ndarray) -> np.ndarray:
    x, y = points
    return np.array([part(grid) for part in cardinals("c", x.tolist(), y.tolist())])


def around(points: tuple[np.ndarray, np.ndarray]) -> np.ndarray:
    x, _ = points
    return np.linspace(x[0] - 1.0, x[-1] + 1.0, 401)


@POINTS
def test_their_sum_is_the_monotone_curve(points: tuple[np.ndarray, np.ndarray]) -> None:
    x, y = points
    grid = around(points)
    whole = through("c", x.tolist(), y.tolist())(grid)
    assert y @ parts_over(points, grid) == pytest.approx(whole, abs=1e-9)


@POINTS
def test_each_is_the_derivative_by_its_value(points: tuple[np.ndarray, np.ndarray]) -> None:
    x, y = points
    grid, step = around(points), 1e-6
    slopes = []
    for unit in np.eye(x.size):
        above, below = (
            through("c", x.tolist(), (y + sign * unit).tolist())(grid) for sign in (step, -step)
        )
        slopes.append((above - below) / (2 * step))
    assert parts_over(points, grid) == pytest.approx(np.array(slopes), rel=1e-4, abs=1e-4)


def test_many_curves_at_once_are_each_by_itself() -> None:
    x = np.sort(RANDOM.normal(size=(40, 6)), axis=1)
    y = RANDOM.normal(size=(40, 6)).round(1)  # some neighbours are as high
    grid = np.linspace(x.min() - 1.0, x.max() + 1.0, 203)
    found = cardinal_values(x, y, grid)
    for own, values, made in zip(x, y, np.swapaxes(found, 1, 2), strict=True):
        assert made == pytest.approx(parts_over((own, values), grid), rel=1e-9, abs=1e-9)
    assert cardinal_values(x[:, :2], y[:, :2], grid).sum(axis=-1) == pytest.approx(1.0)


@POINTS
def test_a_shift_of_all_values_shifts_the_curve(points: tuple[np.ndarray, np.ndarray]) -> None:
    assert parts_over(points, around(points)).sum(axis=0) == pytest.approx(1.0)


def test_each_is_made_of_few_pieces() -> None:
    x = np.linspace(-1, 1, 30)
    assert all(len(part.breaks) <= 5 for part in cardinals("c", x.tolist(), (x**3).tolist()))


@pytest.mark.parametrize("over", ["stretch", "rate"])
def test_the_law_with_unknown_values_is_that_of_the_curve(over: str) -> None:
    x, y = RISING
    s = np.linspace(x[0] - 1.0, x[-1] + 1.0, 101)
    at, options = Motion(s, s, (), 0.0), {"over": over}
    values = {value_name(i): value for i, value in enumerate(y)}
    assert LAW.action is not None
    points = zip(x.tolist(), y.tolist(), strict=True)
    parts = parts_of("c", [(value_name(i), point) for i, point in enumerate(points)])
    does = LAW.action(NUMPY, at, {**values, "parts": parts}, options)
    known = LAW.action(NUMPY, at, {"curve": through("c", x.tolist(), y.tolist())}, options)
    assert does.force == pytest.approx(known.force, abs=1e-9)
    assert does.stored == pytest.approx(known.stored, abs=1e-9)
