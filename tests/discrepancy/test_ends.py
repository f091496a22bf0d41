"""The ends of a smoothed motion."""

import numpy as np
import pytest

from symhyb.discrepancy.recorded.ends import END_KNOTS, between_ends, margin_of
from symhyb.discrepancy.recorded.motion import Motion


def motion(spacing_s: float, until_s: float = 10.0) -> Motion:
    t = np.linspace(0.0, until_s, 201)
    rows, sizes = np.zeros((t.size, 1)), np.zeros(1)
    return Motion(t, rows, rows, rows, sizes, sizes, sizes, sizes, spacing_s)


def test_an_end_is_three_knots_long() -> None:
    assert END_KNOTS == 3
    assert margin_of(motion(0.25)) == pytest.approx(0.75)


def test_samples_between_the_ends_are_kept() -> None:
    smooth = motion(0.25)
    inside = between_ends(smooth, smooth.t)
    kept = smooth.t[inside]
    assert (kept[0], kept[-1]) == pytest.approx((0.75, 9.25))
    assert np.count_nonzero(inside) == 171


def test_a_part_of_a_motion_has_the_ends_of_the_whole() -> None:
    smooth = motion(0.25)
    assert between_ends(smooth, smooth.t[40:160]).all()
    assert between_ends(smooth, smooth.t[:30]).tolist() == [False] * 15 + [True] * 15


def test_where_ends_are_half_of_a_motion_all_of_it_is_kept() -> None:
    short = motion(1.0)
    assert between_ends(short, short.t).all()
