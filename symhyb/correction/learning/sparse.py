"""PySINDy's optimisers, over their thresholds, on a factor of the weak form."""

import warnings
from typing import Literal, get_args

import numpy as np

from symhyb.correction.learning.factor import Factor
from symhyb.correction.learning.regression import Optimizer, fitted
from symhyb.errors import InputError, Problem, did_you_mean

# of a column's share in the right-hand side
THRESHOLDS = (0.8, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002)
OptimizerName = Literal["stlsq", "sr3", "ssr"]
OPTIMIZERS: tuple[str, ...] = get_args(OptimizerName)


def thresholded(threshold: float) -> Optimizer:
    """PySINDy's STLSQ, least squares that drops coefficients below a dimensionless ``threshold``
    again and again, for :func:`symhyb.correction.learning.regression.regress`."""
    from pysindy.optimizers import STLSQ

    return STLSQ(threshold=threshold, alpha=1e-8, max_iter=30)  # type: ignore[no-any-return]


def optimizers(name: OptimizerName) -> tuple[Optimizer, ...]:
    """PySINDy's optimisers of one name over all thresholds, which are shares of the right-hand
    side: ``stlsq`` (Brunton, Proctor & Kutz, PNAS 113, 2016), ``sr3`` (Zheng et al., IEEE Access 7,
    2019; relaxed, level 0) or ``ssr``, which drops one term after the other (Boninsegna, Nüske &
    Clementi, J. Chem. Phys. 148, 2018) and needs no threshold.

    Raises:
        InputError: a name that is none of these.
    """
    from pysindy.optimizers import SR3, SSR

    if name == "stlsq":
        return tuple(thresholded(share) for share in THRESHOLDS)
    if name == "sr3":  # its threshold is the root of twice the weight
        return tuple(SR3(reg_weight_lam=x**2 / 2, max_iter=300) for x in THRESHOLDS)
    if name == "ssr":
        return (SSR(alpha=1e-8, max_iter=200),)
    raise InputError(Problem(f"there is no optimizer '{name}'{did_you_mean(name, OPTIMIZERS)}"))


def supports(factor: Factor, name: OptimizerName) -> tuple[tuple[int, ...], ...]:
    """The sets of columns that an optimiser keeps over its thresholds, none kept among them, the
    smaller ones first. The one right-hand side and the columns of ``factor`` have unit length."""
    found: set[tuple[int, ...]] = {()}
    for one in optimizers(name):
        with warnings.catch_warnings():  # a threshold that leaves no term is an answer
            warnings.simplefilter("ignore", UserWarning)
            try:
                shares = fitted(factor, one)
            except np.linalg.LinAlgError:  # columns too much alike for this threshold
                continue
        for row in getattr(one, "history_", [shares]) if name == "ssr" else [shares]:
            found.add(tuple(np.flatnonzero(np.asarray(row).ravel()).tolist()))
    return tuple(sorted(found, key=lambda kept: (len(kept), kept)))
