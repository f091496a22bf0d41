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

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.jit import jitted


@jitted
def transition(
    A: Array,
    g: Array,
    phi: Array,
    left: Array,
    right: Array,
    keep: Array,
    hold: Array,
    i: int,
) -> None:  # pragma: no cover - compiled
    """Write the transition (d, d) of the i-th step and how the force's noise enters (d, n), SI."""
    _, states, forces = left.shape
    for s in range(states):
        for t in range(states):
            A[s, t] = phi[i, s, t]
        for t in range(forces):
            A[s, states + t] = left[i, s, t] + keep[i, t] * right[i, s, t]
            g[s, t] = right[i, s, t]
    for t in range(forces):
        A[states + t, states + t] = keep[i, t]
        g[states + t, t] = 1.0
    first = states + forces
    for t in range(A.shape[0] - first):
        A[first + t, first + t] = hold[i, t]


@jitted
def start(P0: Array, force: Array, colour: Array, coloured: bool) -> Array:  # pragma: no cover
    """The covariance (d, d) at the first sample, SI."""
    states, forces, sensors = P0.shape[0], force.size, colour.size if coloured else 0
    P = np.zeros((states + forces + sensors, states + forces + sensors))
    for s in range(states):
        for t in range(states):
            P[s, t] = P0[s, t]
    for t in range(forces):
        P[states + t, states + t] = force[t]
    for t in range(sensors):
        P[states + forces + t, states + forces + t] = colour[t]
    return P


@jitted
def observe(
    h: Array, C: Array, D: Array, place: NDArray[np.int64], i: int, j: int
) -> None:  # pragma: no cover - compiled
    """Write how the j-th sensor sees the i-th state (d,), SI."""
    states, forces = C.shape[2], D.shape[2]
    for s in range(states):
        h[s] = C[i, j, s]
    for s in range(forces):
        h[states + s] = D[i, j, s]
    for s in range(states + forces, h.size):
        h[s] = 0.0
    if place[j] >= 0:
        h[states + forces + place[j]] = 1.0


@jitted
def seen_through(k: Array, P: Array, h: Array) -> None:  # pragma: no cover - compiled
    """Write P·h (d,), SI: how the state with covariance P (d, d) varies with what a sensor sees of
    it, h, most of which is zero."""
    for s in range(h.size):
        k[s] = 0.0
    for t in range(h.size):
        if h[t] != 0.0:
            for s in range(h.size):
                k[s] += P[t, s] * h[t]


@jitted
def predict(
    P: Array,
    T: Array,
    A: Array,
    g: Array,
    force: Array,
    colour: Array,
    keep: Array,
    hold: Array,
    i: int,
) -> None:  # pragma: no cover - compiled
    """Move the covariance (d, d), SI, on by the i-th step, in place. Force and colour are each
    their own share of what they were: only the states mix."""
    d, forces = P.shape[0], g.shape[1]
    first = d - hold.shape[1]
    states = first - forces
    for s in range(d):
        for t in range(d):
            T[s, t] = A[s, s] * P[s, t]
        for u in range(first if s < states else 0):
            if u != s:
                for t in range(d):
                    T[s, t] += A[s, u] * P[u, t]
    for s in range(d):
        for t in range(s, d):
            if t >= states:
                total = T[s, t] * A[t, t]
            else:
                total = 0.0
                for u in range(first):
                    total += T[s, u] * A[t, u]
            for u in range(forces):
                total += g[s, u] * force[u] * (1 - keep[i, u] * keep[i, u]) * g[t, u]
            if s == t and s >= first:
                total += colour[s - first] * (1 - hold[i, s - first] ** 2)
            P[s, t] = total
            P[t, s] = total


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
    d = P.shape[0]
    M, M2 = np.zeros((d, columns)), np.zeros((d, columns))
    for s in range(states):
        for c in range(columns):
            M[s, c] = begin[s, c]
    result = np.zeros((samples, sensors, columns))
    A, g, T = np.zeros((d, d)), np.zeros((d, forces)), np.zeros((d, d))
    h, k, v = np.zeros(d), np.zeros(d), np.zeros(columns)
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
            root = np.sqrt(S)
            for c in range(columns):
                v[c] = e[i, j, c]
            for s in range(d):
                if h[s] != 0.0:
                    for c in range(columns):
                        v[c] -= h[s] * M[s, c]
            for c in range(columns):
                result[i, j, c] = v[c] / root
            for s in range(d):
                share = k[s] / S
                for c in range(columns):
                    M[s, c] += share * v[c]
                for t in range(d):
                    P[s, t] -= share * k[t]
            logs += np.log(S)
        if i == samples - 1:
            break
        transition(A, g, phi, left, right, keep, hold, i)
        for s in range(d):
            for c in range(columns):
                M2[s, c] = b[i, s, c] if s < states else 0.0
            for t in range(d):
                if A[s, t] != 0.0:
                    for c in range(columns):
                        M2[s, c] += A[s, t] * M[t, c]
        M, M2 = M2, M
        predict(P, T, A, g, force, colour, keep, hold, i)
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
    """Smoothed state (N, d) with its variance (N, d), SI, Σ ln S, χ², and the score: ∂ ln L by the
    variances ``force`` (n,), ``white`` (m,) and ``colour`` (c,), and by the logarithms of the
    correlation times (2,) of force and colour. Where the state is not ``wanted`` it is left at
    zero, which halves the work.

    Arguments as of :func:`whiten`, with ``b`` (N−1, X) and ``e`` (N, m) of one column.
    """
    samples, sensors, states = C.shape
    forces, sensed = left.shape[2], hold.shape[1]
    P = start(P0, force, colour, sensed > 0)
    d = P.shape[0]
    M, M2 = np.zeros(d), np.zeros(d)
    kept = samples if wanted else 0
    means, covs = np.zeros((kept, d)), np.zeros((kept, d, d))
    gains, sizes = np.zeros((samples, sensors, d)), np.ones((samples, sensors))
    news = np.zeros((samples, sensors))
    # of force and colour at each sample, once it is measured: what is known of them, and how the
    # next state varies with them
    known, leads = np.zeros((samples, d - states)), np.zeros((samples, d - states, d))
    A, g, T = np.zeros((d, d)), np.zeros((d, forces)), np.zeros((d, d))
    h, k = np.zeros(d), np.zeros(d)
    logs, chi2 = 0.0, 0.0
    for i in range(samples):
        for s in range(d if wanted else 0):
            means[i, s] = M[s]
            for t in range(d):
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
            for s in range(d):
                gains[i, j, s] = k[s]
                share = k[s] / S
                M[s] += share * v
                for t in range(d):
                    P[s, t] -= share * k[t]
            sizes[i, j], news[i, j] = S, v
            logs += np.log(S)
            chi2 += v * v / S
        if i == samples - 1:
            break
        transition(A, g, phi, left, right, keep, hold, i)
        for s in range(d):
            M2[s] = b[i, s] if s < states else 0.0
            for t in range(d):
                M2[s] += A[s, t] * M[t]
        predict(P, T, A, g, force, colour, keep, hold, i)
        for q in range(d - states):
            known[i, q] = M[states + q]
            for s in range(d):
                leads[i, q, s] = T[s, states + q]
        M, M2 = M2, M
    mean, variance = np.zeros((samples, d)), np.zeros((samples, d))
    by_force, by_white = np.zeros(forces), np.zeros(sensors)
    by_colour, by_times = np.zeros(sensed), np.zeros(2)
    r, r2 = np.zeros(d), np.zeros(d)
    Nn = np.zeros((d, d))
    for i in range(samples - 1, -1, -1):
        for j in range(sensors - 1, -1, -1):
            if not seen[i, j]:
                continue
            observe(h, C, D, place, i, j)
            S = sizes[i, j]
            along, across = 0.0, 0.0
            for s in range(d):
                along += gains[i, j, s] * r[s]
                total = 0.0
                for t in range(d):
                    total += Nn[s, t] * gains[i, j, t]
                k[s] = total / S
                across += gains[i, j, s] * total / (S * S)
            u = (news[i, j] - along) / S
            by_white[j] += 0.5 * (u * u - 1 / S - across)
            for s in range(d):
                if h[s] != 0.0:
                    r[s] += h[s] * u
                    for t in range(d):
                        Nn[s, t] += h[s] * (h[t] * (1 / S + across) - k[t])
                        Nn[t, s] -= k[t] * h[s]
        for s in range(d if wanted else 0):
            total, spread = means[i, s], covs[i, s, s]
            for t in range(d):
                total += covs[i, s, t] * r[t]
                part = 0.0
                for q in range(d):
                    part += Nn[t, q] * covs[i, q, s]
                spread -= covs[i, s, t] * part
            mean[i, s], variance[i, s] = total, spread
        if i == 0:
            break
        transition(A, g, phi, left, right, keep, hold, i - 1)
        for q in range(d - states):
            own, drawn = states + q, known[i - 1, q]
            along, across, held = 0.0, 0.0, 0.0
            for s in range(d):
                h[s], k[s] = g[s, q] if q < forces else 0.0, 0.0
            if q >= forces:
                h[own] = 1.0
            for t in range(d):
                if h[t] != 0.0:
                    along += h[t] * r[t]
                    for s in range(d):
                        k[s] += Nn[s, t] * h[t]
            for s in range(d):
                across += h[s] * k[s]
                held += k[s] * leads[i - 1, q, s]
                drawn += r[s] * leads[i - 1, q, s]
            left_over = along * along - across
            if q < forces:
                alpha, size = keep[i - 1, q], force[q]
                by_force[q] += 0.5 * left_over * (1 - alpha * alpha)
            else:
                alpha, size = hold[i - 1, q - forces], colour[q - forces]
                by_colour[q - forces] += 0.5 * left_over * (1 - alpha * alpha)
            if alpha > 0.0:  # ∂α/∂ ln τ = −α ln α
                slope = along * drawn - held - alpha * size * left_over
                by_times[0 if q < forces else 1] -= slope * alpha * np.log(alpha)
        for s in range(d):
            r2[s] = 0.0
            for t in range(d):
                r2[s] += A[t, s] * r[t]
        r, r2 = r2, r
        for s in range(d):
            for t in range(d):
                T[s, t] = 0.0 if t < states else Nn[s, t] * A[t, t]
            for q in range(states):
                for t in range(states + forces):
                    T[s, t] += Nn[s, q] * A[q, t]
        for s in range(d):
            for t in range(d):
                Nn[s, t] = 0.0 if s < states else A[s, s] * T[s, t]
            for q in range(states if s < states + forces else 0):
                for t in range(d):
                    Nn[s, t] += A[q, s] * T[q, t]
    for q in range(forces):
        s = states + q
        by_force[q] += 0.5 * (r[s] * r[s] - Nn[s, s])
    for q in range(sensed):
        s = states + forces + q
        by_colour[q] += 0.5 * (r[s] * r[s] - Nn[s, s])
    return mean, variance, logs, chi2, by_force, by_white, by_colour, by_times
