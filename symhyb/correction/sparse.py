"""Sparse regression on a band-limited modulated weak form, with PySINDy's optimisers.

The equations of motion are multiplied by windowed complex exponentials and integrated by parts,

    ∫ φ (p' − ∂T/∂q − k_e) dt = −∫ φ' p dt − ∫ φ (∂T/∂q + k_e) dt = Σ θ_j ∫ φ F_j dt,

so no second derivative of noisy data is formed and both sides pass the same band (modulating
functions: Shinbrot 1957; weak SINDy: Messenger & Bortz, MMS 19, 2021). A plain bump longer than the
oscillation filters it out; the modulation keeps the band. The result is a proposal, not a decision.
Sizes: R rows, C columns, n coordinates.
"""

import warnings
from collections.abc import Sequence

import numpy as np

from symhyb.correction.selection import Subset
from symhyb.discrepancy.hypotheses import Library
from symhyb.discrepancy.windows import Laid
from symhyb.numeric.buffers import Array
from symhyb.numeric.machine import Machine
from symhyb.numeric.vector import along

SMOOTHNESS = 4  # of the window (1 − τ²)^4
HARMONICS_MOST = 12
THRESHOLDS = (0.5, 0.2, 0.1, 0.05, 0.02)  # of a column's share in the right-hand side
TERMS_MOST = 5


def propose(
    machine: Machine, library: Library, laid: Sequence[Laid], band_hz: float
) -> tuple[Subset, ...]:
    """Subsets of the force hypotheses with their coefficients (SI), from STLSQ over thresholds.

    ``laid`` are windows with smoothed motion, ``band_hz`` the highest modulation. Rows of every
    coordinate are scaled to equal weight, columns to unit length. No proposals with constraints.
    """
    if machine.constraints:  # the weak form holds their reactions, which nothing here knows
        return ()
    from pysindy.optimizers import STLSQ

    blocks = [weak_rows(machine, library, item, band_hz) for item in laid]
    rows, right = np.concatenate([b[0] for b in blocks]), np.concatenate([b[1] for b in blocks])
    length, size = np.linalg.norm(rows, axis=0), float(np.linalg.norm(right))
    if size == 0:
        return ()
    seen = length > 1e-9 * length.max(initial=0.0)
    # the triangular factor holds all that least squares asks of the rows
    joined = np.column_stack([rows[:, seen] / length[seen], right / size])
    factor = np.asarray(np.linalg.qr(joined, mode="r"))
    found: dict[tuple[int, ...], Subset] = {}
    for threshold in THRESHOLDS:
        optimizer = STLSQ(threshold=threshold, alpha=1e-8, max_iter=30)
        with warnings.catch_warnings():  # a threshold that leaves no term is an answer
            warnings.simplefilter("ignore", UserWarning)
            try:
                optimizer.fit(factor[:, :-1], factor[:, -1:])
            except np.linalg.LinAlgError:  # columns too much alike: no proposal, no answer lost
                continue
        values = np.zeros(length.size)
        values[seen] = np.asarray(optimizer.coef_)[0] * size / length[seen]
        subset = _subset(library, values, rows, right)
        if subset is not None:
            found.setdefault(subset.causes, subset)
    return tuple(found.values())


def weak_rows(
    machine: Machine, library: Library, item: Laid, band_hz: float
) -> tuple[Array, Array]:
    """The weak form over windows: rows (R, C), per SI unit of each coefficient, and right-hand side
    (R,), dimensionless: both over its RMS by coordinate."""
    c, where, free = item.course(machine), item.rows, list(machine.free)
    given = c.q, c.v, c.z, c.u, c.t, machine.values
    momentum, rest = along(machine.weak, given, (5,), c.t.size)
    forces = library.forces(item.course(library.machine))[where]
    test, slope = _modulated(item.block.t, band_hz)
    right = -np.einsum("wkl,wln->wkn", slope, momentum[where])
    right -= np.einsum("wkl,wln->wkn", test, rest[where])
    rows = np.einsum("wkl,wlnc->wknc", test, forces)
    right, rows = right[..., free], rows[:, :, free]
    scale = np.sqrt(np.mean(right**2, axis=(0, 1)))
    scale = np.where(scale > 0, scale, 1.0)
    return (rows / scale[:, None]).reshape(-1, rows.shape[3]), (right / scale).reshape(-1)


def _modulated(t: Array, band_hz: float) -> tuple[Array, Array]:
    """Test functions (W, K, L) times quadrature weights, and their derivatives: a smooth window
    times cosines and sines of its harmonics up to the band."""
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


def _subset(library: Library, values: Array, rows: Array, right: Array) -> Subset | None:
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
    left = float(np.sum((right - rows @ values) ** 2))
    numbers = sum(library.hypotheses[i].numbers for i in causes)
    return Subset(tuple(causes), values[chosen], left, left, numbers)
