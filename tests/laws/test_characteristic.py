"""Curves through points against SciPy, between the points and beyond them."""

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator, PPoly

from symhyb.laws.characteristic import Array, Characteristic, through


def points(seed: int, count: int, rising: bool = False) -> tuple[Array, Array]:
    rng = np.random.default_rng(seed)
    y = rng.normal(size=count)
    return np.sort(rng.normal(size=count)), np.sort(y) if rising else y


CASES = [(1, 2, False), (2, 3, False), (3, 4, True), (4, 5, False), (5, 20, True), (6, 100, False)]


@pytest.mark.parametrize(("seed", "count", "rising"), CASES)
def test_monotone_cubics_are_those_of_scipy(seed: int, count: int, rising: bool) -> None:
    x, y = points(seed, count, rising)
    curve, scipy = through("c", x, y), PchipInterpolator(x, y)
    at = np.linspace(x[0], x[-1], 2000)[:-1]
    steepest = np.abs(scipy.derivative()(at)).max()
    assert curve(at) == pytest.approx(scipy(at), abs=1e-13)
    assert curve.slope()(at) == pytest.approx(scipy.derivative()(at), abs=1e-13 * steepest)
    area, whole = curve.area(), scipy.antiderivative()
    assert area(at) - area(at[0]) == pytest.approx(whole(at) - whole(at[0]), abs=1e-13)


def test_slopes_stay_finite_where_points_lie_level() -> None:
    """0/0 in the harmonic mean of two secants: a flat stretch, and a turn after it."""
    x, y = [0.0, 1.0, 2.0, 3.0, 5.0], [1.0, 1.0, 1.0, 4.0, 2.0]
    at = np.linspace(0, 5, 501)[:-1]
    assert through("c", x, y)(at) == pytest.approx(PchipInterpolator(x, y)(at), abs=1e-14)


@pytest.mark.parametrize("seed", range(5))
def test_a_monotone_curve_overshoots_no_point(seed: int) -> None:
    x, y = points(seed, 12, rising=True)
    at = np.linspace(x[0], x[-1], 5000)
    assert np.all(np.diff(through("c", x, y)(at)) >= -1e-14)


def test_straight_lines_are_those_of_numpy() -> None:
    x, y = points(7, 9)
    curve, at = through("c", x, y, "linear"), np.linspace(x[0], x[-1], 1001)
    assert curve(at) == pytest.approx(np.interp(at, x, y), abs=1e-14)
    assert curve.slope()(x[:-1]) == pytest.approx(np.diff(y) / np.diff(x))


@pytest.mark.parametrize("interpolation", ["monotone", "linear"])
def test_beyond_the_points_it_goes_on_as_it_says(interpolation: str) -> None:
    x, y = points(8, 9, rising=True)
    outside = np.array([x[0] - 3.0, x[0] - 0.1, x[-1] + 0.1, x[-1] + 3.0])
    held = through("c", x, y, interpolation, "hold")  # type: ignore[arg-type]
    assert held(outside) == pytest.approx([y[0], y[0], y[-1], y[-1]])
    assert np.all(held.slope()(outside) == 0)
    line = through("c", x, y, interpolation, "line")  # type: ignore[arg-type]
    ends = line.slope()(np.array([x[0], np.nextafter(x[-1], -10)]))
    expected = [
        y[0] - 3 * ends[0],
        y[0] - 0.1 * ends[0],
        y[-1] + 0.1 * ends[1],
        y[-1] + 3 * ends[1],
    ]
    assert line(outside) == pytest.approx(expected)
    assert line.slope()(outside) == pytest.approx([ends[0], ends[0], ends[1], ends[1]])


@pytest.mark.parametrize("extrapolation", ["line", "hold"])
def test_the_area_is_the_integral_from_zero(extrapolation: str) -> None:
    """Also beyond the points, and where 0 itself is beyond them."""
    x, y = points(9, 6)
    for shift in (0.0, 10.0, -10.0):
        curve = through("c", x + shift, y, "monotone", extrapolation)  # type: ignore[arg-type]
        area = curve.area()
        assert area(0.0) == pytest.approx(0.0, abs=1e-12)
        for end in (shift - 4.0, shift, shift + 4.0):
            fine = np.linspace(0.0, end, 200_001)
            assert area(end) == pytest.approx(np.trapezoid(curve(fine), fine), rel=1e-7, abs=1e-7)


def test_slope_and_area_undo_each_other() -> None:
    x, y = points(10, 8)
    curve, at = through("c", x, y), np.linspace(-4, 4, 999)
    assert curve.area().slope()(at) == pytest.approx(curve(at), abs=1e-12)


def test_a_break_belongs_to_the_piece_behind_it() -> None:
    step = Characteristic("step", (0.0,), ((0.0, 1.0), (0.0, 2.0)))
    assert list(step(np.array([-1e-300, 0.0, 1e-300]))) == [1.0, 2.0, 2.0]


def test_no_number_has_no_value() -> None:
    assert np.isnan(through("c", [0.0, 1.0], [0.0, 1.0])(float("nan")))


def test_it_is_the_same_as_any_piecewise_polynomial() -> None:
    x, y = points(11, 6)
    curve = through("c", x, y)
    inner = np.array(curve.pieces)[1:-1, :0:-1].T  # highest power first, as SciPy has it
    at = np.linspace(x[0], x[-1], 333)[:-1]
    assert curve(at) == pytest.approx(PPoly(inner, x)(at), abs=1e-14)
