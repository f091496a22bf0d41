"""Points stand where a force needs them, and as many as it is worth."""

import numpy as np
import pytest

from symhyb.correction.adequacy.curves.courses import Form, Line, fine_points, hats
from symhyb.correction.adequacy.curves.points import POINTS_MOST, placed
from symhyb.laws.characteristic import through

RATE = Form("rate")
RANDOM = np.random.default_rng(5)
SEEN = 2.5 * np.sin(RANDOM.uniform(0, 2 * np.pi, 3000)) + 0.2 * RANDOM.normal(size=3000)


def line_of(force: np.ndarray, noise: float) -> Line:
    """The force (N,) over SEEN, each sample known to so much noise."""
    x = fine_points(SEEN)
    assert x is not None
    left = force + noise * RANDOM.standard_normal(SEEN.size)
    joined = np.column_stack([-hats(SEEN, x), left]) / noise  # left + columns · values remains
    return Line(0, RATE, x, ((joined.T @ joined, 0.0),), float(np.std(force)), 1.0)


def knee(v: np.ndarray) -> np.ndarray:
    return np.asarray(np.sign(v) * ((1 + np.abs(v) / 0.1) ** 0.35 - 1))


@pytest.mark.parametrize("noise", [0.02, 0.3])
def test_a_digressive_force_is_found_to_its_noise(noise: float) -> None:
    found = placed(line_of(knee(SEEN), noise))
    curve = through("c", found.x.tolist(), found.y.tolist())
    off = curve(SEEN) - knee(SEEN)
    assert np.sqrt(np.mean(off**2)) < 0.2 * noise + 0.01
    assert found.worth > 100


def test_less_noise_asks_for_more_points() -> None:
    fine, coarse = (placed(line_of(knee(SEEN), noise)) for noise in (0.02, 1.0))
    assert coarse.x.size < fine.x.size <= POINTS_MOST


def test_a_straight_line_needs_its_ends_alone() -> None:
    found = placed(line_of(2.0 * SEEN, 0.1))
    assert found.x.size == 2
    assert found.y == pytest.approx(2 * found.x, abs=0.05)


def test_points_stand_where_the_force_bends() -> None:
    found = placed(line_of(knee(SEEN), 0.02))
    near = np.count_nonzero(np.abs(found.x) < 0.9)
    assert near >= 0.4 * found.x.size  # of a range of ±2.9


def test_noise_alone_is_worth_nothing() -> None:
    line = line_of(np.zeros(SEEN.size), 0.1)
    found = placed(Line(0, RATE, line.x, line.products, 1.0, 1.0))
    assert found.worth < 0


def test_what_hardly_moves_has_no_line() -> None:
    assert fine_points(np.zeros(1000)) is None
    assert fine_points(np.linspace(0, 1, 10)) is None


def test_a_handful_of_samples_lies_beyond_either_end() -> None:
    x = fine_points(SEEN)
    assert x is not None
    assert np.all(np.diff(x) > 0)
    assert np.count_nonzero(x[0] > SEEN) == pytest.approx(8, abs=2)  # they are rounded
    assert np.count_nonzero(x[-1] < SEEN) == pytest.approx(8, abs=2)
