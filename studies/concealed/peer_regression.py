"""The regressions of the peers: rows, STLSQ, and how much of ΔF they explain on unseen data."""

import warnings
from dataclasses import dataclass

import numpy as np
import pysindy as ps
from laws import Array
from peer_library import Estimate, Term, columns, known, push
from peer_motion import Recorded, estimate
from systems import System

Rows = tuple[Array, Array]  # target (rows,), columns (rows, terms): both relative to known forces
DOMAINS = 200
YARDSTICK = 21  # samples: the window of ΔF against which fits are scored, the same for all


def regression(
    peer: str, system: System, e: Estimate, wide: bool, half: int
) -> tuple[list[Term], Rows]:
    """Terms, and what is left over against their columns, coordinate by coordinate, each relative
    to the largest known force there. ``half`` is that of a weak test function, in samples."""
    p = system.values()
    M, Q = known(system, p, e)
    missing = np.einsum("ijn,jn->in", M, e.a) - Q.sum(axis=0)
    terms, forces = columns(system, p, e, wide, missing)
    if peer == "deltaf":
        scale = np.sqrt(np.mean(Q**2, axis=2)).max(axis=0)
        scale = np.where(scale > 0, scale, np.abs(missing).max(axis=1) + 1e-300)[:, None]
        return terms, ((missing / scale).ravel(), (forces / scale).reshape(len(terms), -1).T)
    inverse = np.linalg.inv(np.moveaxis(M, -1, 0))
    Q, forces = (np.einsum("nij,kjn->kin", inverse, x) for x in (Q, forces))
    scale = np.sqrt(np.mean(Q**2, axis=2)).max(axis=0)
    scale = np.where(scale > 0, scale, np.abs(e.a).max(axis=1) + 1e-300)[:, None]
    known_a = Q.sum(axis=0)
    if peer == "weak":
        return terms, _weak(e.v / scale, known_a / scale, forces / scale, e.t, half)
    left = (e.a - known_a) / scale
    return terms, (left.ravel(), (forces / scale).reshape(len(terms), -1).T)


def _weak(v: Array, known_a: Array, forces: Array, t: Array, half: int) -> Rows:
    """PySINDy's weak form: v' integrated by parts against its test functions; each coordinate
    relative to the same integrals of what is known."""
    K, n, N = forces.shape
    state = np.random.get_state()
    np.random.seed(1)  # its domains are drawn from the global generator
    width = half * float(t[1] - t[0])
    weak = ps.WeakPDELibrary(
        ps.IdentityLibrary(), spatiotemporal_grid=t, K=DOMAINS, H_xt=[width], p=4
    )
    np.random.set_state(state)
    many = np.concatenate([known_a[None], forces]).reshape(-1, N).T
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about the axes of its own arrays
        inner = np.asarray(weak.fit_transform(ps.AxesArray(many, {"ax_time": 0, "ax_coord": 1})))
    inner = inner.T.reshape(K + 1, n, DOMAINS)
    rate = np.asarray(weak.convert_u_dot_integral(v.T)).T
    size = np.sqrt(np.mean(inner[0] ** 2, axis=1, keepdims=True)) + 1e-300
    return ((rate - inner[0]) / size).ravel(), (inner[1:] / size).reshape(K, -1).T


@dataclass(frozen=True, slots=True, eq=False)
class Packed:
    """A regression as its triangle: ``triangle`` (T + 1, T + 1) of columns with RMS 1 and the
    target, whose least squares are those of all ``rows``; the ``size`` (T,) of the columns."""

    triangle: Array
    size: Array
    rows: int


def pack(target: Array, given: Array) -> Packed:
    """Pack a regression, so that every threshold costs little."""
    size = np.sqrt(np.mean(given**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    triangle = np.linalg.qr(np.column_stack([given / size, target]), mode="r")
    return Packed(triangle, size, target.size)


def sparse(packed: Packed, threshold: float) -> tuple[Array, Array]:
    """Values and standard deviations (T,) by PySINDy's STLSQ; 0 where a term is not active.

    The columns have RMS 1 and the target counts in known forces, so the threshold is the share of
    the known force below which a term is dropped. Deviations are those of least squares on the
    active columns with white errors."""
    R, y = packed.triangle[:, :-1], packed.triangle[:, -1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that nothing is left is an answer here
        fit = ps.STLSQ(threshold=threshold).fit(R, y[:, None])
    value = np.asarray(fit.coef_).ravel()
    on, spread = np.flatnonzero(value), np.zeros(value.size)
    if on.size:
        left = float(np.sum((y - R @ value) ** 2)) / max(packed.rows - on.size, 1)
        spread[on] = np.sqrt(left * np.diag(np.linalg.pinv(R[:, on].T @ R[:, on])))
    return value / packed.size, spread / packed.size


def fit_of(terms: list[Term], value: Array, train: Recorded, unseen: Recorded) -> float:
    """RMS of ΔF on the unseen recording without what is explained, over RMS of all of ΔF."""
    system, on = train.system, np.flatnonzero(value)
    e = estimate("deltaf", unseen, YARDSTICK)
    missing, scale = left_over(system, e)
    after = missing.copy()
    for i in on:
        after -= value[i] * push(system, system.values(), e, terms[i])
    return float(np.sqrt(np.mean((after / scale) ** 2) / np.mean((missing / scale) ** 2)))


def left_over(system: System, e: Estimate) -> tuple[Array, Array]:
    """ΔF (n, N) and the size (n, 1) of what is known."""
    M, Q = known(system, system.values(), e)
    scale = np.sqrt(np.mean(Q**2, axis=2)).max(axis=0)
    scale = np.where(scale > 0, scale, 1.0)[:, None]
    return np.einsum("ijn,jn->in", M, e.a) - Q.sum(axis=0), scale
