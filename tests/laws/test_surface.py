"""Maps as functions of two variables against SciPy: values, what is beyond, slopes, few pieces."""

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from symhyb.laws.surface import Surface, bilinear, hats

RNG = np.random.default_rng(7)
X = np.array([-0.04, -0.01, 0.0, 0.02, 0.05])
Y = np.array([-1.0, -0.2, 0.3, 2.0])
Z = RNG.normal(size=(X.size, Y.size))
AT = (RNG.uniform(-0.08, 0.09, 500), RNG.uniform(-2.0, 3.0, 500))


def surface(extrapolation: str = "line") -> Surface:
    return bilinear("m", X.tolist(), Y.tolist(), Z.tolist(), extrapolation)  # type: ignore[arg-type]


def test_between_and_beyond_its_points_it_is_that_of_scipy() -> None:
    known = RegularGridInterpolator((X, Y), Z, "linear", bounds_error=False, fill_value=None)
    assert surface()(*AT) == pytest.approx(known(np.stack(AT, axis=-1)), rel=1e-9, abs=1e-11)


def test_where_it_holds_it_has_the_value_at_the_edge() -> None:
    known = RegularGridInterpolator((X, Y), Z, "linear")
    inside = np.clip(AT[0], X[0], X[-1]), np.clip(AT[1], Y[0], Y[-1])
    made = surface("hold")(*AT)
    assert made == pytest.approx(known(np.stack(inside, axis=-1)), rel=1e-9, abs=1e-11)


@pytest.mark.parametrize("extrapolation", ["line", "hold"])
def test_at_its_points_it_has_their_values(extrapolation: str) -> None:
    made = surface(extrapolation)(X[:, None], Y[None, :])
    assert made.shape == Z.shape
    assert made == pytest.approx(Z, rel=1e-12, abs=1e-14)


@pytest.mark.parametrize("extrapolation", ["line", "hold"])
def test_slopes_are_differences(extrapolation: str) -> None:
    whole, (x, y), h = surface(extrapolation), AT, 1e-8
    by_x = (whole(x + h, y) - whole(x - h, y)) / (2 * h)
    by_y = (whole(x, y + h) - whole(x, y - h)) / (2 * h)
    assert whole.slope("x")(x, y) == pytest.approx(by_x, rel=1e-5, abs=1e-5)
    assert whole.slope("y")(x, y) == pytest.approx(by_y, rel=1e-5, abs=1e-5)
    both = whole.slope("y").slope("x")
    assert both == whole.slope("x").slope("y")
    assert both.slope_by == "xy"
    crossed = (whole.slope("x")(x, y + h) - whole.slope("x")(x, y - h)) / (2 * h)
    assert both(x, y) == pytest.approx(crossed, rel=1e-4, abs=1e-4)


@pytest.mark.parametrize("extrapolation", ["line", "hold"])
def test_a_hat_has_no_more_pieces_than_it_needs(extrapolation: str) -> None:
    made = hats("h", X.tolist(), extrapolation)  # type: ignore[arg-type]
    assert max(len(hat.pieces) for hat in made) <= 4
    assert sum(hat(AT[0]) for hat in made) == pytest.approx(np.ones(500))
    assert np.array([hat(X) for hat in made]) == pytest.approx(np.eye(X.size))


def test_two_by_two_places_are_one_plane_or_saddle_everywhere() -> None:
    made = bilinear("m", [0.0, 2.0], [0.0, 1.0], [[1.0, 3.0], [5.0, 4.0]])
    x, y = AT
    assert made(x, y) == pytest.approx(1 + 2 * x + 2 * y - 1.5 * x * y)


def test_what_is_no_number_stays_none() -> None:
    assert np.isnan(surface()(np.nan, 0.1))
    assert np.isnan(surface("hold")(0.01, np.nan))
