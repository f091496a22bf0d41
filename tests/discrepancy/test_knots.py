"""Which spacing of knots is chosen, and by which part of a recording."""

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from symhyb.discrepancy.recorded.knots import LONG, PORTIONS, SplineFit, chosen, portions
from symhyb.discrepancy.recorded.splines import spline_basis

SPACINGS = (2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0)


class Fitter:
    """Fits whose criterion a sample is least at ``best``; remembers what was asked for."""

    def __init__(self, total: int, best: float) -> None:
        self.total, self.best = total, best
        self.asked: list[tuple[int, float]] = []

    def __call__(self, rows: slice, spacing: float) -> SplineFit:
        size = len(range(*rows.indices(self.total)))
        self.asked.append((size, spacing))
        worth = size * abs(np.log(spacing / self.best))
        return SplineFit((), (), np.zeros((size, 1)), 1.0, float(worth), spacing)


@pytest.mark.parametrize(("best", "narrower"), [(16.0, 8.0), (2.0, 2.0), (128.0, 64.0)])
def test_the_best_and_the_next_narrower(best: float, narrower: float) -> None:
    fits = chosen(Fitter(1000, best), SPACINGS, 1000)
    assert [fit.spacing for fit in fits] == [best, narrower]


def test_what_gets_worse_and_worse_is_not_tried() -> None:
    fitter = Fitter(1000, 2.0)
    chosen(fitter, SPACINGS, 1000)
    assert [spacing for _, spacing in fitter.asked] == [2.0, 4.0, 8.0, 16.0]


def test_portions_of_a_long_recording_choose_and_the_whole_is_fitted() -> None:
    total = 20 * LONG
    fitter = Fitter(total, 8.0)
    fits = chosen(fitter, SPACINGS, total)
    assert [fit.spacing for fit in fits] == [8.0, 4.0]
    assert [len(fit.residual) for fit in fits] == [total, total]
    sizes = [size for size, _ in fitter.asked]
    assert sizes.count(total) == 2
    assert set(sizes) == {total, LONG // PORTIONS}
    assert len(chosen(Fitter(total, 8.0), SPACINGS, total, whole=True)[0].residual) == total


def test_portions_lie_from_end_to_end() -> None:
    rows = portions(3 * LONG)
    assert rows[0].start == 0
    assert rows[-1].stop == 3 * LONG
    assert sum(one.stop - one.start for one in rows) == LONG


def test_a_part_pays_for_its_numbers_as_the_whole_does() -> None:
    fit = SplineFit((np.zeros(30),), (), np.zeros((100, 1)), 1.0, 5.0, 1.0)
    assert fit.criterion_of(100) == 5.0
    assert fit.criterion_of(1000) == pytest.approx(5 + 30 * np.log(10))


def test_bands_of_a_fit_are_those_of_its_normal_equations() -> None:
    """sd of a value at row k, for unit noise: the root of b_k (BᵀB)⁻¹ b_kᵀ."""
    basis = spline_basis(np.linspace(0, 1, 60), 0.1)
    normal = (basis[0].T @ basis[0]).tocsc()
    size = basis[0].shape[1]
    fit = SplineFit((np.zeros(size),), basis, np.zeros((60, 1)), 1.0, 5.0, 0.1, splu(normal))
    done = fit.banded()
    assert done.solver is None
    assert done.banded() is done
    rows = np.unique(np.linspace(18, 42, 15).astype(int))
    for band, b in zip(done.bands, basis, strict=True):
        spread = b.toarray()[rows] @ np.linalg.inv(normal.toarray()) @ b.toarray()[rows].T
        assert band == pytest.approx([np.sqrt(np.median(np.diag(spread)))], rel=1e-9)
