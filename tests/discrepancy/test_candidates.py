"""Laws scaled by what the recordings move through: lines found, clearances inside the travel."""

import numpy as np
import pytest
from builders import cart_pole

from symhyb.discrepancy.places.candidates import force_hypotheses, joined, lacking
from symhyb.laws.gap import CLEARANCE_SHARES
from symhyb.laws.harmonic import time_peaks
from symhyb.laws.lines import PEAKS
from symhyb.laws.reach import Reach
from symhyb.laws.ripple import place_peaks
from symhyb.model.types import On

T = np.arange(2000) / 200
NOISE = np.random.default_rng(1).normal(size=T.size)


def reach(force: np.ndarray, stretch: np.ndarray | None = None) -> Reach:
    s = 0.3 * np.sin(2 * T) + 0.2 * np.sin(3.1 * T) if stretch is None else stretch
    return Reach(s, np.gradient(s, T), force, T)


def test_lines_of_a_force_in_time_are_found_and_ordered() -> None:
    force = np.sin(2 * np.pi * 7.3 * T + 1) + 0.5 * np.cos(2 * np.pi * 21.4 * T) + 0.3 * NOISE
    first, second = time_peaks(T, force)
    assert first == pytest.approx(7.3, abs=0.03)
    assert second == pytest.approx(21.4, abs=0.05)


def test_noise_alone_seldom_shows_a_line() -> None:
    noises = [np.random.default_rng(seed).normal(size=T.size) for seed in range(40)]
    assert sum(bool(time_peaks(T, noise)) for noise in noises) <= 20
    assert all(time_peaks(T, 0.5 * n + np.sin(2 * np.pi * 7.3 * T)) for n in noises)
    many = sum(np.sin(2 * np.pi * f * T) for f in (3.0, 11.0, 19.0, 31.0))
    assert len(time_peaks(T, many)) == PEAKS


def test_a_line_is_looked_for_up_to_a_gap_in_time() -> None:
    t = np.concatenate([T[:1200], T[1200:] + 3.7])
    force = np.sin(2 * np.pi * 7.3 * t)
    assert time_peaks(t, force)[0] == pytest.approx(7.3, abs=0.05)
    assert time_peaks(T[:40], force[:40]) == ()


def test_lines_of_a_force_along_the_travel_are_found() -> None:
    s = reach(NOISE).stretch
    force = np.sin(2 * np.pi * s / 0.043 + 0.5) + 0.2 * NOISE
    assert place_peaks(s, force)[0] == pytest.approx(0.043, rel=0.02)
    assert place_peaks(np.zeros(500), NOISE[:500]) == ()


def kinds(force: np.ndarray, kind: str) -> list[dict[str, float]]:
    tried = force_hypotheses(cart_pole(), {On("x"): reach(force)})
    return [dict(h.shape) for h in tried if h.kind == kind]


def test_periodic_laws_are_tried_where_lines_stand_out_of_simple_laws() -> None:
    """A large spring and friction in the lacking force do not hide a small line."""
    r = reach(NOISE)
    smooth = 40 * r.stretch + 3 * np.sign(r.rate)
    in_time = kinds(smooth + 0.2 * np.sin(2 * np.pi * 17 * T), "harmonic")
    assert any(shape["frequency"] == pytest.approx(17, abs=0.05) for shape in in_time)
    in_place = kinds(smooth + 0.2 * np.sin(2 * np.pi * r.stretch / 0.043), "ripple")
    assert any(shape["period"] == pytest.approx(0.043, rel=0.02) for shape in in_place)


def test_clearances_lie_inside_the_travel() -> None:
    r = reach(NOISE)
    found = [shape["clearance"] for shape in kinds(NOISE, "gap")]
    assert len(found) == 3 * len(CLEARANCE_SHARES)
    assert 0 < min(found) < max(found) < np.abs(r.stretch).max()
    one_sided = Reach(r.stretch + 1.0, r.rate, r.force, T)
    tried = force_hypotheses(cart_pole(), {On("x"): one_sided})
    assert {h.options for h in tried if h.kind == "gap"} == {(("side", "upper"),)}


def test_size_and_speed_of_a_reach() -> None:
    r = reach(NOISE)
    assert r.amplitude == pytest.approx(np.ptp(r.stretch) / 2)
    assert r.speed == pytest.approx(np.quantile(np.abs(r.rate), 0.99))
    empty = Reach(*(np.empty(0),) * 4)
    assert (empty.speed, empty.amplitude) == (0.0, 0.0)
    both = joined([r, r])
    assert both.t.size == 2 * T.size
    assert both.force[T.size :].tolist() == r.force.tolist()


def test_what_lacks_at_a_place_is_its_part_of_the_generalized_force() -> None:
    """ΔF = d·f at every sample gives back f; what is across the place does not count."""
    rng = np.random.default_rng(2)
    directions = rng.normal(size=(50, 2, 3))
    f = rng.normal(size=50)
    d = directions[:, :, 1]
    across = np.stack([-d[:, 1], d[:, 0]], axis=1)
    assert lacking(d * f[:, None] + across, directions, 1) == pytest.approx(f)
