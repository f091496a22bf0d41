"""Sparse regression on a band-limited modulated weak form, with PySINDy's optimisers.

The equations of motion are multiplied by windowed complex exponentials and integrated by parts,

    ∫ φ (p' − ∂T/∂q − k_e) dt = −∫ φ' p dt − ∫ φ (∂T/∂q + k_e) dt = Σ θ_j ∫ φ F_j dt,

so no second derivative of noisy data is formed and both sides pass the same band (modulating
functions: Shinbrot 1957; weak SINDy: Messenger & Bortz, MMS 19, 2021). A plain bump longer than the
oscillation filters it out; the modulation keeps the band. The result is a proposal, not a decision.
Sizes: R rows, C columns, n coordinates.
"""

import warnings
from collections.abc import Iterator, Sequence
from typing import Literal, get_args

import numpy as np

from symhyb.correction.learning.regression import BLOCK, Optimizer, fitted
from symhyb.correction.search.selection import Subset
from symhyb.discrepancy.places.hypotheses import Library
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.factor import Factor, factor_of
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine

SMOOTHNESS = 4  # of the window (1 − τ²)^4
HARMONICS_MOST = 12
THRESHOLDS = (0.5, 0.2, 0.1, 0.05, 0.02)  # of a column's share in the right-hand side
FINE_THRESHOLDS = (0.8, *THRESHOLDS, 0.01, 0.005, 0.002)  # where terms alone are wanted
OptimizerName = Literal["stlsq", "sr3", "ssr"]
OPTIMIZERS: tuple[str, ...] = get_args(OptimizerName)
TERMS_MOST = 5


def propose(
    machine: Machine, library: Library, cuts: Sequence[Cut], band_hz: float
) -> tuple[Subset, ...]:
    """Subsets of the force hypotheses with their coefficients (SI), from STLSQ over thresholds.

    ``cuts`` are windows with smoothed motion, ``band_hz`` the highest modulation. Rows of every
    coordinate are scaled to equal weight, columns to unit length. The rows are never stored
    together: they are reduced to a factor, block by block. No proposals with constraints.
    """
    if machine.constraints:  # the weak form holds their reactions, which nothing here knows
        return ()
    names = [f"{h} {term}" for h in library.hypotheses for term in h.terms]

    def rows() -> Iterator[Array]:
        for item in cuts:
            yield from weak_rows(machine, library, item, band_hz)

    try:
        factor = factor_of(rows, (*names, "what the model lacks"))
    except InputError:  # a row that is not finite: no proposal, no answer lost
        return ()
    length, size = np.linalg.norm(factor.columns, axis=0), np.linalg.norm(factor.right, axis=0)
    seen = length > 1e-9 * length.max(initial=0.0)
    if size[0] == 0 or not seen.any():
        return ()
    unit = factor.chosen(seen).scaled(length[seen], size)
    found: dict[tuple[int, ...], Subset] = {}
    for threshold in THRESHOLDS:
        optimizer = thresholded(threshold)
        with warnings.catch_warnings():  # a threshold that leaves no term is an answer
            warnings.simplefilter("ignore", UserWarning)
            try:
                shares = fitted(unit, optimizer)[0]
            except np.linalg.LinAlgError:  # columns too much alike: no proposal, no answer lost
                continue
        values = np.zeros(length.size)
        values[seen] = shares * size / length[seen]
        subset = _subset(library, values, factor)
        if subset is not None:
            found.setdefault(subset.causes, subset)
    return tuple(found.values())


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
        return tuple(thresholded(share) for share in FINE_THRESHOLDS)
    if name == "sr3":  # its threshold is the root of twice the weight
        return tuple(SR3(reg_weight_lam=x**2 / 2, max_iter=300) for x in FINE_THRESHOLDS)
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


def weak_rows(machine: Machine, library: Library, item: Cut, band_hz: float) -> Iterator[Array]:
    """The weak form over windows, some windows at a time: rows (R, C + 1), the candidates per SI
    unit of each coefficient and, last, the right-hand side, dimensionless: all over the RMS of the
    right-hand side by coordinate."""
    c, where, free = item.course(machine), item.rows, list(machine.free)
    given = c.q, c.v, c.z, c.u, c.t, machine.values
    momentum, rest = along(machine.weak, given, (5,), c.t.size)
    forces = library.forces(item.course(library.machine))
    test, slope = modulated(item.block.t, band_hz)
    right = -(slope @ momentum[where] + test @ rest[where])[..., free]
    scale = np.sqrt(np.mean(right**2, axis=(0, 1)))
    scale = np.where(scale > 0, scale, 1.0)[:, None]
    windows, harmonics, columns = len(where), test.shape[1], forces.shape[2]
    most = max(BLOCK // (harmonics * max(len(free) * columns, 1)), 1)
    for first in range(0, windows, most):
        some = slice(first, first + most)
        acting = forces[where[some]][:, :, free]
        rows = test[some] @ acting.reshape(*acting.shape[:2], -1)
        rows = rows.reshape(*rows.shape[:2], len(free), columns)
        joined = np.concatenate([rows, right[some][..., None]], axis=3) / scale
        yield joined.reshape(-1, columns + 1)


def modulated(t: Array, band_hz: float) -> tuple[Array, Array]:
    """Test functions (W, K, L) times quadrature weights, s, and their derivatives, dimensionless,
    for windows at times ``t`` (W, L), s: a smooth window times cosines and sines of its harmonics
    up to the band."""
    span = t[:, -1:] - t[:, :1]
    tau = 2 * (t - t[:, :1]) / span - 1
    window = (1 - tau**2) ** SMOOTHNESS
    fall = -2 * tau * SMOOTHNESS * (1 - tau**2) ** (SMOOTHNESS - 1) * 2 / span
    weight = np.gradient(t, axis=1)
    tests, slopes = [window * weight], [fall * weight]
    harmonics = min(int(band_hz * float(np.median(span))), HARMONICS_MOST)
    for k in range(1, harmonics + 1):
        omega = 2 * np.pi * k / span
        phase = omega * (t - t[:, :1])
        for wave, rise in ((np.cos(phase), -np.sin(phase)), (np.sin(phase), np.cos(phase))):
            tests.append(window * wave * weight)
            slopes.append((fall * wave + window * omega * rise) * weight)
    return np.stack(tests, axis=1), np.stack(slopes, axis=1)


def _subset(library: Library, values: Array, factor: Factor) -> Subset | None:
    causes = []
    for i, (hypothesis, columns) in enumerate(
        zip(library.hypotheses, library.columns, strict=True)
    ):
        own = values[list(columns)]
        if not np.any(own):
            continue
        if any(sign and value < 0 for sign, value in zip(hypothesis.positive, own, strict=True)):
            return None
        causes.append(i)
    terms = [
        (library.hypotheses[i].kind, library.hypotheses[i].place, term)
        for i in causes
        for term in library.hypotheses[i].terms
    ]
    if not causes or len(causes) > TERMS_MOST or len(set(terms)) < len(terms):
        return None
    chosen = [c for i in causes for c in library.columns[i]]
    left = float(np.sum((factor.right[:, 0] - factor.columns @ values) ** 2))
    numbers = sum(library.hypotheses[i].numbers for i in causes)
    return Subset(tuple(causes), values[chosen], left, left, numbers)
