"""Windows cut on a recording, their initial states removed, and correlated residuals counted."""

import numpy as np
import pytest
from builders import cart_pole, oscillator, push, recording
from numpy.typing import NDArray

from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.windows import (
    SAMPLES_LEAST,
    Cut,
    Reduced,
    correlation_time,
    lay,
    merge,
    reduce,
    reversals,
    summed,
)
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import Block

Array = NDArray[np.float64]
T = np.arange(400) / 100
MACHINE = build(oscillator({"motor": push("f")}, inputs={"f": {"unit": "N"}}))


def resting(t: Array, n: int = 1) -> Motion:
    """A motion that tells its samples apart: q = t, q' = 10 t."""
    still = np.zeros((t.size, n))
    q = np.repeat(t[:, None], n, axis=1)
    small = np.full(n, 1e-3)
    return Motion(t, q, 10 * q, still, small, small, small, np.full(1, 1e-3), 0.1)


def cut(length_s: float, t: Array = T, place: Array | None = None, **more: object) -> Cut | None:
    place = np.sin(t) if place is None else place
    run = recording(t, {"f": np.cos(t)}, place=place)
    return lay(run, MACHINE, resting(t), length_s, **more)  # type: ignore[arg-type]


def test_windows_share_their_ends_and_cover_the_recording() -> None:
    windows = cut(0.5)
    assert windows is not None
    block = windows.block
    assert block.t.shape == (7, 51)
    assert block.t[:, 0] == pytest.approx(0.5 * np.arange(7))
    assert block.t[1:, 0] == pytest.approx(block.t[:-1, -1])
    assert block.d[..., 0] == pytest.approx(np.cos(block.t))
    assert block.y[..., 0] == pytest.approx(np.sin(block.t))
    assert block.substeps.tolist() == np.ones((7, 50), int).tolist()
    assert windows.start == pytest.approx(np.column_stack([block.t[:, 0], 10 * block.t[:, 0]]))
    assert windows.states[..., 1] == pytest.approx(10 * block.t)


def test_every_third_window_validates() -> None:
    windows = cut(0.5)
    assert windows is not None
    assert windows.held.tolist() == [False, False, True, False, False, True, False]


def test_substeps_go_with_their_intervals() -> None:
    parts = np.arange(1, 400)
    windows = cut(0.5, substeps=parts)
    assert windows is not None
    assert windows.block.substeps[2].tolist() == list(range(101, 151))


def test_a_window_has_enough_samples_and_fits_the_recording() -> None:
    short = cut(0.01)
    assert short is not None
    assert short.block.t.shape[1] == SAMPLES_LEAST
    whole = cut(3.99)
    assert whole is not None
    assert whole.block.t.shape == (1, 400)
    assert cut(4.2) is None


def test_a_part_of_a_stretch_begins_where_it_begins() -> None:
    whole = cut(3.99)
    assert whole is not None
    part = whole.between(100, 250)
    assert np.array_equal(part.block.t, whole.block.t[:, 100:250])
    assert np.array_equal(part.block.y, whole.block.y[:, 100:250])
    assert part.block.substeps.shape == (1, 149)
    assert np.array_equal(part.start, whole.states[:, 100])
    assert part.rows[0, 0] == 100
    until = whole.between(0, 250)
    assert np.array_equal(until.start, whole.start)


def test_windows_across_a_gap_in_time_are_left_out() -> None:
    t = np.concatenate([T[:120], T[120:] + 3.0])
    windows = cut(0.5, t=t)
    assert windows is not None
    spans = np.ptp(windows.block.t, axis=1)
    assert spans.max() < 0.75
    assert len(spans) == 6


def test_windows_that_miss_too_many_samples_are_left_out() -> None:
    place = np.sin(T)
    place[150:190] = np.nan  # 40 of the 51 samples of the fourth window
    place[::5] = np.nan
    windows = cut(0.5, place=place)
    assert windows is not None
    assert windows.block.t[:, 0] == pytest.approx(0.5 * np.array([0, 1, 2, 4, 5, 6]))
    assert windows.held.tolist() == [False, False, True, False, False, True]


@pytest.mark.parametrize("lost", [0.3, 0.6])
def test_windows_are_kept_where_samples_are_missing_everywhere(lost: float) -> None:
    place = np.where(np.random.default_rng(1).random(T.size) < lost, np.nan, np.sin(T))
    windows = cut(1.0, place=place)
    assert windows is not None
    assert len(windows.start) == 3


def test_windows_with_hardly_a_sample_are_left_out() -> None:
    assert cut(0.5, place=np.where(np.arange(T.size) % 10 == 0, np.sin(T), np.nan)) is None


def test_a_sensor_that_was_not_recorded_does_not_count_as_missing() -> None:
    machine = build(cart_pole())
    run = recording(T, {"pull": np.cos(T)}, cart=np.sin(T), pole=np.cos(T))
    windows = lay(run, machine, resting(T, 2), 0.5)
    assert windows is not None
    assert windows.block.y.shape == (7, 51, 3)
    assert np.isnan(windows.block.y[..., 2]).all()


def test_reversals_reach_three_intervals_to_either_side() -> None:
    rates = np.concatenate([np.full(20, 1.0), np.full(20, -1.0)])[:, None]
    assert np.flatnonzero(reversals(rates)).tolist() == list(range(16, 23))


def test_rest_counts_as_reversal() -> None:
    rates = np.full((40, 2), 1.0)
    rates[10:15, 1] = 0.01
    near = np.flatnonzero(reversals(rates))
    assert near.tolist() == list(range(6, 18))


def test_a_steady_motion_has_no_reversal() -> None:
    assert not reversals(np.full((40, 1), 2.0)).any()


# --- initial states removed -----------------------------------------------------------------


def parts(seed: int) -> tuple[Array, Array, Array, Array]:
    """Residual (3, 20, 2), by start (…, 4), columns (…, 5) and sd (2,)."""
    rng = np.random.default_rng(seed)
    residual, start = rng.normal(size=(3, 20, 2)), rng.normal(size=(3, 20, 2, 4))
    return residual, start, rng.normal(size=(3, 20, 2, 5)), np.array([0.5, 3.0])


def cut_of(residual: Array, held: NDArray[np.bool_]) -> Cut:
    """Windows of which nothing but these arrays and the ``held`` ones matters."""
    windows, length, _ = residual.shape
    t = np.tile(np.arange(length) / 100.0, (windows, 1))
    block = Block(t, t[..., None], residual, np.ones((windows, length - 1), int))
    still = np.zeros((windows, length, 2))
    rows = np.arange(windows * length).reshape(windows, length)
    run = recording(T, {"f": np.cos(T)}, place=np.sin(T))
    return Cut(block, still[:, 0], still, held, rows, (run, resting(T)))


def reduced_of(
    residual: Array, start: Array, columns: Array, sd: Array, held: NDArray[np.bool_]
) -> Reduced:
    return reduce(cut_of(residual, held), residual, start, columns, sd)


def test_the_regression_that_is_left_is_that_of_least_squares_with_the_states() -> None:
    residual, start, columns, sd = parts(1)
    residual[1, 3:7, 0] = np.nan
    reduced = reduced_of(residual, start, columns, sd, np.array([False, False, True]))
    gram = reduced.grams.sum(axis=0)
    found = np.linalg.solve(gram[:5, :5], gram[:5, 5])
    rows, target = [], []
    for w in range(3):
        seen = np.isfinite(residual[w])
        weight = np.broadcast_to(1 / sd, seen.shape)[seen]
        own = np.zeros((seen.sum(), 12))
        own[:, 4 * w : 4 * w + 4] = start[w][seen]
        rows.append(np.hstack([columns[w][seen], own]) * weight[:, None])
        target.append(residual[w][seen] * weight)
    expected, cost, *_ = np.linalg.lstsq(np.vstack(rows), np.concatenate(target), rcond=None)
    assert found == pytest.approx(expected[:5])
    assert gram[5, 5] - found @ gram[:5, 5] == pytest.approx(cost[0])
    assert reduced.count.tolist() == [36, 32, 36]


def test_sums_over_windows_are_those_of_their_grams() -> None:
    residual, start, columns, sd = parts(4)
    residual[2, 5:9, 1] = np.nan
    held = np.array([False, True, False])
    reduced = reduced_of(residual, start, columns, sd, held)
    fitted, kept = summed(cut_of(residual, held), residual, start, columns, sd)
    np.testing.assert_allclose(fitted, reduced.grams[~held].sum(axis=0), atol=1e-12)
    np.testing.assert_allclose(kept, reduced.grams[1], atol=1e-12)
    every, none = summed(cut_of(residual, ~held & held), residual, start, columns, sd)
    np.testing.assert_allclose(every, reduced.grams.sum(axis=0), atol=1e-12)
    assert not none.any()


def test_a_residual_made_of_initial_states_vanishes() -> None:
    _, start, columns, sd = parts(2)
    residual = start @ np.array([1.0, -2.0, 0.5, 3.0])
    reduced = reduced_of(residual, start, columns, sd, np.zeros(3, bool))
    assert reduced.grams[:, 5, 5] == pytest.approx(np.zeros(3), abs=1e-20)


def test_a_state_that_no_sensor_sees_costs_no_sample() -> None:
    residual, start, columns, sd = parts(3)
    start[..., 2] = 0.0
    start[..., 3] = 2 * start[..., 0]
    reduced = reduced_of(residual, start, columns, sd, np.zeros(3, bool))
    assert reduced.count.tolist() == [38, 38, 38]
    assert np.isfinite(reduced.grams).all()


def test_recordings_are_joined_in_order() -> None:
    pieces = []
    for seed, held in ((4, False), (5, True)):
        residual, start, columns, sd = parts(seed)
        pieces.append(reduced_of(residual, start, columns, sd, np.full(3, held)))
    grams, count, held_flags = merge(pieces)
    assert grams[3:].tolist() == pieces[1].grams.tolist()
    assert count.tolist() == [36] * 6
    assert held_flags.tolist() == [False] * 3 + [True] * 3


# --- correlation ----------------------------------------------------------------------------


def coloured(phi: float, m: int, seed: int) -> Array:
    """Windows (60, 400·m) of an AR(1) process in the last of m sensors, white in the others."""
    rng = np.random.default_rng(seed)
    noise = rng.normal(size=(60, 400, m))
    series = noise[..., -1]
    for i in range(1, 400):
        series[:, i] = phi * series[:, i - 1] + np.sqrt(1 - phi**2) * series[:, i]
    return noise.reshape(60, -1)


@pytest.mark.parametrize("phi", [0.5, 0.8, 0.9])
@pytest.mark.parametrize("m", [1, 2])
def test_correlation_of_an_autoregressive_residual(phi: float, m: int) -> None:
    """c = (1 + φ)/(1 − φ), the largest of the sensors; the tail below ρ = 0.05 is left out."""
    expected = (1 + phi) / (1 - phi)
    found = correlation_time([coloured(phi, m, 1), coloured(phi, m, 2)], m)
    assert 0.85 * expected < found < 1.1 * expected


def test_a_white_residual_has_correlation_one() -> None:
    assert correlation_time([np.random.default_rng(3).normal(size=(60, 400))], 1) == 1.0


def test_an_alternating_residual_does_not_go_below_one() -> None:
    assert correlation_time([np.tile([1.0, -1.0], (5, 50))], 1) == 1.0


def test_a_residual_of_zero_has_correlation_one() -> None:
    assert correlation_time([np.zeros((5, 50))], 1) == 1.0
