"""Windows with their initial states projected out, against least squares over all columns."""

import numpy as np
import pytest
from test_matching import SD, cut, rig

from symhyb.discrepancy.fitting.projection import Projected, projected

FREE = ("k", "d", "b")


@pytest.fixture(scope="module")
def part() -> Projected:
    machine, model = rig(*FREE)
    item = cut(1)
    return projected(model, item, machine.values, item.start, np.array([SD]))


def test_the_step_of_starts_and_its_gain_are_those_of_least_squares(part: Projected) -> None:
    by_start = part.basis @ (part.triangle * part.scale[:, None, :])
    move, gain = part.start_step(np.zeros(len(FREE)), 0.0)
    for w in range(len(move)):
        step, *_ = np.linalg.lstsq(by_start[w], part.residual[w], rcond=None)
        np.testing.assert_allclose(move[w], step, rtol=1e-6, atol=1e-12)
        left = part.residual[w] - by_start[w] @ step
        lower = np.sum(part.residual[w] ** 2) - np.sum(left**2)
        assert gain[w] == pytest.approx(lower, rel=1e-6)
        np.testing.assert_allclose(part.rest[w, :, -1], left, atol=1e-6 * np.abs(left).max())


def test_starts_reply_to_parameters_so_that_only_the_projected_part_stays(part: Projected) -> None:
    change = np.array([3.0, 0.1, 0.2])
    by_start = part.basis @ (part.triangle * part.scale[:, None, :])
    move, _ = part.start_step(change, 0.0)
    left = part.residual - part.by_free @ change - (by_start @ move[..., None])[..., 0]
    expected = part.rest[..., -1] - part.rest[..., :-1] @ change
    np.testing.assert_allclose(left, expected, atol=1e-5 * np.abs(expected).max())


def test_a_damped_step_of_starts_takes_the_share_it_says(part: Projected) -> None:
    whole, all_of_it = part.start_step(np.zeros(len(FREE)), 0.0)
    half, three_quarters = part.start_step(np.zeros(len(FREE)), 1.0)
    np.testing.assert_allclose(half, 0.5 * whole)
    np.testing.assert_allclose(three_quarters, 0.75 * all_of_it)


def test_some_windows_are_replaced_and_the_others_stay(part: Projected) -> None:
    machine, model = rig(*FREE)
    item = cut(1)
    rows = np.array([1])
    start = item.start.copy()
    start[rows] += 1e-3
    fresh = projected(model, item.chosen(rows), machine.values, start[rows], np.array([SD]))
    mixed = part.with_rows(rows, fresh)
    whole = projected(model, item, machine.values, start, np.array([SD]))
    np.testing.assert_allclose(mixed.rest, whole.rest, rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(mixed.rest[0], part.rest[0])


def test_columns_of_one_recording_stand_among_all_numbers(part: Projected) -> None:
    wide = part.spread_out((3, 0, 1), 5)
    np.testing.assert_array_equal(wide.by_free[:, :, 3], part.by_free[:, :, 0])
    np.testing.assert_array_equal(wide.rest[..., -1], part.rest[..., -1])
    assert not wide.rest[..., [2, 4]].any()
    change = np.array([0.1, 0.2, 7.0, 3.0, 7.0])
    same = part.start_step(change[[3, 0, 1]], 0.0)[0]
    np.testing.assert_allclose(wide.start_step(change, 0.0)[0], same)
