"""How far apart the knots of a smoothed motion stand: by the Bayesian information criterion.

Schwarz, Annals of Statistics 6, 1978. Sizes: N samples, n coordinates, m sensors, B coefficients a
coordinate.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import SuperLU

from symhyb.discrepancy.recorded.splines import bands
from symhyb.numeric.kernels.buffers import Array

SPACINGS = (1.3, 1.6, 2, 3, 4, 6, 8, 11, 16, 23, 32, 45, 64, 91, 128)  # samples between two knots
WORSE_MOST = 3  # spacings in a row that are worse than the best: stop
LONG = 50_000  # samples: of longer recordings portions choose the spacing
PORTIONS = 5


@dataclass(frozen=True, slots=True)
class SplineFit:
    """Splines fitted to a recording: ``coefficients`` (n times B), the ``basis`` of values and two
    derivatives (N, B) each, ``residual`` (N, m), the ``variance`` of whitened residuals, the
    ``criterion``, the ``spacing`` of knots in s, and the factored normal equations. ``bands`` (n,)
    each, for unit noise, are those of the chosen fits, which need their ``solver`` no more."""

    coefficients: Sequence[Array]
    basis: Sequence[sparse.csr_array]
    residual: Array
    variance: float
    criterion: float
    spacing: float
    solver: SuperLU | None = None
    bands: tuple[Array, ...] = ()

    def banded(self) -> "SplineFit":
        """The fit with its bands, and without its solver."""
        if self.solver is None:
            return self
        found = bands(self.basis, self.solver, len(self.coefficients))
        return replace(self, solver=None, bands=found)

    def criterion_of(self, total: int) -> float:
        """The criterion where this is a part of a recording of ``total`` samples."""
        numbers = sum(c.size for c in self.coefficients)
        return self.criterion + numbers * float(np.log(total / len(self.residual)))


def chosen(
    fitted: Callable[[slice, float], SplineFit],
    spacings: Sequence[float],
    total: int,
    whole: bool = False,
) -> tuple[SplineFit, SplineFit]:
    """The fit with the spacing (samples) that the criterion chooses, and that with the next
    narrower one.

    ``fitted`` fits rows of a recording of ``total`` samples; of more than ``LONG``, portions
    choose, unless the ``whole`` has to. No more than three fits are held at once.
    """
    parts = [slice(None)] if whole or total <= LONG else portions(total)
    criteria: list[float] = []
    before, best = None, None  # the last fit; the best one and the one before it
    for spacing in spacings:
        fits = [fitted(rows, spacing) for rows in parts]
        criteria.append(sum(fit.criterion_of(total) for fit in fits))
        least = int(np.argmin(criteria))
        if best is None or least == len(criteria) - 1:
            best = fits[0], before or fits[0]
        before = fits[0]
        if np.isfinite(criteria[least]) and len(criteria) - least > WORSE_MOST:
            break
    if best is None:
        raise ValueError("no spacing to choose from")
    if len(parts) == 1:
        fit = best[0].banded()
        return fit, fit if best[1] is best[0] else best[1].banded()
    near = spacings[least], spacings[max(least - 1, 0)]
    return fitted(slice(None), near[0]).banded(), fitted(slice(None), near[1]).banded()


def portions(total: int) -> list[slice]:
    """``PORTIONS`` of equal length and distance, together ``LONG`` of ``total`` samples."""
    length = LONG // PORTIONS
    starts = np.linspace(0, total - length, PORTIONS).astype(int)
    return [slice(start, start + length) for start in starts.tolist()]
