"""The Kalman filter and smoother of a linearised machine, compiled once for all machines.

    δ(i+1) = Φ δ(i) + Γ₀ w(i) + Γ₁ w(i+1) + b(i)        δ: deviation from the trajectory, X states
    w(i+1) = α w(i) + noise                             unknown force, first-order Markov, n
    c(i+1) = ρ c(i) + noise                             coloured sensor noise, m
    e(i)   = C δ(i) + D w(i) + c(i) + white noise       e: measured less computed output, m

Filter and drives are linear, so that the residual and any number of candidate columns (each with
its own b and e) pass the same gains and come out white. Measurements are taken one after the other,
which needs no inverse and leaves out what is missing. Loops stand for slices: they compile in half
the time.
Sizes: N samples, X states, n forces, m sensors, K columns, d = X + n + c with c coloured sensors.

Sources: Anderson & Moore, Optimal Filtering, 1979 (sequential updates); Durbin & Koopman, Time
Series Analysis by State Space Methods, 2012, §4.4 (smoother) and §7.3 (score: Koopman & Shephard,
Biometrika 79, 1992; by a transition A it is Σ r x̂ᵀ − N A P, with the smoothed state x̂ and the
filtered covariance P).
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.likelihood.covariance import (
    measured,
    observe,
    predict,
    seen_through,
    start,
    transition,
)
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.jit import jitted


@jitted
def whiten(
    phi: Array,
    left: Array,
    right: Array,
    C: Array,
    D: Array,
    seen: NDArray[np.bool_],
    b: Array,
    e: Array,
    begin: Array,
    P0: Array,
    keep: Array,
    hold: Array,
    force: Array,
    white: Array,
    colour: Array,
    place: NDArray[np.int64],
) -> tuple[Array, float]:  # pragma: no cover - compiled
    """White innovations (N, m, K) of all columns, and Σ ln S.

    ``phi`` (N−1, X, X), ``left`` and ``right`` (N−1, X, n), ``C`` (N, m, X), ``D`` (N, m, n),
    ``seen`` (N, m), ``b`` (N−1, X, K), ``e`` (N, m, K), ``begin`` (X, K) the columns at the start,
    ``P0`` (X, X), ``keep`` (N−1, n) = α, ``hold`` (N−1, c) = ρ, variances ``force`` (n,),
    ``white`` (m,), ``colour`` (c,), and the ``place`` (m,) of each sensor's colour among these, −1
    where it has none; all in SI.
    """
    samples, sensors, states = C.shape
    forces, columns, sensed = left.shape[2], b.shape[2], hold.shape[1]
    P = start(P0, force, colour, sensed > 0)
    d, width = P.shape
    M, M2 = np.zeros((d, columns)), np.zeros((d, columns))
    for s in range(states):
        for c in range(columns):
            M[s, c] = begin[s, c]
    result = np.zeros((samples, sensors, columns))
    F, T = np.zeros((states, width)), np.zeros((states, width))
    share, h, k, v = np.zeros(width), np.zeros(width), np.zeros(width), np.zeros(columns)
    logs = 0.0
    for i in range(samples):
        for j in range(sensors):
            if not seen[i, j]:
                continue
            observe(h, C, D, place, i, j)
            seen_through(k, P, h)
            S = white[j]
            for s in range(d):
                S += h[s] * k[s]
            for c in range(columns):
                v[c] = e[i, j, c]
            for s in range(d):
                part = h[s]
                if part != 0.0:
                    for c in range(columns):
                        v[c] -= part * M[s, c]
            by, by_root = 1 / S, 1 / np.sqrt(S)
            for c in range(columns):
                result[i, j, c] = v[c] * by_root
            for s in range(d):
                part = k[s] * by
                for c in range(columns):
                    M[s, c] += part * v[c]
            measured(P, k, by)
            logs += np.log(S)
        if i == samples - 1:
            break
        transition(F, share, phi, left, right, keep, hold, i)
        for s in range(d):
            for c in range(columns):
                M2[s, c] = b[i, s, c] if s < states else share[s] * M[s, c]
            for t in range(states + forces if s < states else 0):
                if F[s, t] != 0.0:
                    for c in range(columns):
                        M2[s, c] += F[s, t] * M[t, c]
        M, M2 = M2, M
        predict(P, T, F, share, right, force, colour, i)
    return result, logs


@jitted
def smooth(
    phi: Array,
    left: Array,
    right: Array,
    C: Array,
    D: Array,
    seen: NDArray[np.bool_],
    b: Array,
    e: Array,
    P0: Array,
    keep: Array,
    hold: Array,
    force: Array,
    white: Array,
    colour: Array,
    place: NDArray[np.int64],
    wanted: bool,
) -> tuple[Array, Array, float, float, Array, Array, Array, Array]:  # pragma: no cover - compiled
    """Smoothed state (N, d) and the variance (N, n) of its forces, SI, Σ ln S, χ², and the score:
    ∂ ln L by the variances ``force`` (n,), ``white`` (m,) and ``colour`` (c,), and by the
    logarithms of the correlation times (2,) of force and colour. Where the state is not ``wanted``
    it is left at zero, which halves the work.

    Arguments as of :func:`whiten`, with ``b`` (N−1, X) and ``e`` (N, m) of one column.
    """
    samples, sensors, states = C.shape
    forces, sensed = left.shape[2], hold.shape[1]
    P = start(P0, force, colour, sensed > 0)
    d, width = P.shape
    M, M2 = np.zeros(d), np.zeros(d)
    kept = samples if wanted else 0
    means, covs = np.zeros((kept, d)), np.zeros((kept, d, width))
    gains, sizes = np.zeros((samples, sensors, width)), np.ones((samples, sensors))
    news = np.zeros((samples, sensors))
    # of force and colour at each sample, once it is measured: mean, and rows of the covariance
    known, rows = np.zeros((samples, d - states)), np.zeros((samples, d - states, width))
    F, T = np.zeros((states, width)), np.zeros((d, width))
    share, h, k = np.zeros(width), np.zeros(width), np.zeros(width)
    logs, chi2 = 0.0, 0.0
    for i in range(samples):
        for s in range(d if wanted else 0):
            means[i, s] = M[s]
            for t in range(width):
                covs[i, s, t] = P[s, t]
        for j in range(sensors):
            if not seen[i, j]:
                continue
            observe(h, C, D, place, i, j)
            seen_through(k, P, h)
            S, v = white[j], e[i, j]
            for s in range(d):
                S += h[s] * k[s]
                v -= h[s] * M[s]
            by = 1 / S
            for s in range(d):
                M[s] += k[s] * by * v
            measured(P, k, by)
            logs += np.log(S)
            chi2 += v * v * by
            for s in range(width):
                gains[i, j, s] = k[s]
            sizes[i, j], news[i, j] = S, v
        if i == samples - 1:
            break
        for q in range(d - states):
            known[i, q] = M[states + q]
            for s in range(width):
                rows[i, q, s] = P[states + q, s]
        transition(F, share, phi, left, right, keep, hold, i)
        for s in range(states):
            M2[s] = b[i, s]
            for t in range(states + forces):
                M2[s] += F[s, t] * M[t]
        for s in range(states, d):
            M2[s] = share[s] * M[s]
        M, M2 = M2, M
        predict(P, T, F, share, right, force, colour, i)
    mean, variance = np.zeros((samples, d)), np.zeros((samples, forces))
    by_force, by_white = np.zeros(forces), np.zeros(sensors)
    by_colour, by_times = np.zeros(sensed), np.zeros(2)
    r, r2 = np.zeros(width), np.zeros(width)
    Nn = np.zeros((d, width))
    for i in range(samples - 1, -1, -1):
        for j in range(sensors - 1, -1, -1):
            if not seen[i, j]:
                continue
            observe(h, C, D, place, i, j)
            by = 1 / sizes[i, j]
            along, across = 0.0, 0.0
            for t in range(width):
                k[t] = 0.0
            for s in range(d):
                part = gains[i, j, s] * by
                along += part * r[s]
                for t in range(width):
                    k[t] += Nn[s, t] * part
            for s in range(d):
                across += gains[i, j, s] * by * k[s]
            u = news[i, j] * by - along
            by_white[j] += 0.5 * (u * u - by - across)
            for s in range(d):
                r[s] += h[s] * u
                at, less = h[s] * (by + across) - k[s], h[s]
                for t in range(width):
                    Nn[s, t] += at * h[t] - less * k[t]
        for s in range(d if wanted else 0):
            total = means[i, s]
            for t in range(d):
                total += covs[i, s, t] * r[t]
            mean[i, s] = total
        for q in range(forces if wanted else 0):
            own = states + q
            spread = covs[i, own, own]
            for s in range(d):
                total = 0.0
                for t in range(d):
                    total += Nn[s, t] * covs[i, own, t]
                spread -= covs[i, own, s] * total
            variance[i, q] = spread
        if i == 0:
            break
        transition(F, share, phi, left, right, keep, hold, i - 1)
        for t in range(width):
            r2[t] = share[t] * r[t]
        for s in range(states):
            part = r[s]
            for t in range(width):
                r2[t] += F[s, t] * part
        for s in range(d):
            for t in range(width):
                T[s, t] = Nn[s, t] * share[t]
            for u in range(states):
                part = Nn[s, u]
                for t in range(width):
                    T[s, t] += part * F[u, t]
        for q in range(d - states):
            own = states + q
            along, across, held, drawn = r[own], Nn[own, own], 0.0, known[i - 1, q]
            for t in range(width):
                k[t] = T[own, t]
            for s in range(states if q < forces else 0):
                push = right[i - 1, s, q]
                along += push * r[s]
                total = 2 * Nn[s, own]
                for t in range(states):
                    total += Nn[s, t] * right[i - 1, t, q]
                across += push * total
                for t in range(width):
                    k[t] += push * T[s, t]
            for s in range(d):
                held += k[s] * rows[i - 1, q, s]
                drawn += r2[s] * rows[i - 1, q, s]
            left_over = along * along - across
            alpha = share[own]
            size = force[q] if q < forces else colour[q - forces]
            if q < forces:
                by_force[q] += 0.5 * left_over * (1 - alpha * alpha)
            else:
                by_colour[q - forces] += 0.5 * left_over * (1 - alpha * alpha)
            if alpha > 0.0:  # ∂α/∂ ln τ = −α ln α
                slope = along * drawn - held - alpha * size * left_over
                by_times[0 if q < forces else 1] -= slope * alpha * np.log(alpha)
        r, r2 = r2, r
        for s in range(d):
            part = share[s]
            for t in range(width):
                Nn[s, t] = part * T[s, t]
        for u in range(states):
            for s in range(states + forces):
                part = F[u, s]
                for t in range(width):
                    Nn[s, t] += part * T[u, t]
    for q in range(forces):
        s = states + q
        by_force[q] += 0.5 * (r[s] * r[s] - Nn[s, s])
    for q in range(sensed):
        s = states + forces + q
        by_colour[q] += 0.5 * (r[s] * r[s] - Nn[s, s])
    return mean, variance, logs, chi2, by_force, by_white, by_colour, by_times
