"""Linearised steps of windows: joined from sample to sample, and what they do to the outputs.

The matrices are small and many, which is where a call of a library for each costs more than its
numbers; numba compiles the loops once for all machines.
Sizes: S integration steps, M intervals between samples, W windows, L samples a window, X states,
F free parameters, n test forces, m sensors, C columns.
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.jit import jitted


@jitted
def joined(
    slopes: Array, own: int, first: NDArray[np.int64], parts: NDArray[np.int64]
) -> tuple[Array, Array, Array, Array]:  # pragma: no cover - compiled
    """Slopes from sample to sample: transition (M, X, X), by a test force before (M, X, n) and
    after (M, X, n), which runs straight between two samples and is constant within a step, and by
    ``own`` free parameters (M, X, F).

    ``slopes`` (S, X + F + n, X) are those of single steps by states, parameters and test forces,
    column by column; ``first`` (M,) is the first step of each interval and ``parts`` (M,) how many
    there are. SI.
    """
    states = slopes.shape[2]
    kicks = slopes.shape[1] - states - own
    width = states + own + 2 * kicks
    whole = np.empty((first.size, states, states))
    by_free = np.empty((first.size, states, own))
    left = np.empty((first.size, states, kicks))
    right = np.empty((first.size, states, kicks))
    now, after = np.zeros((states, width)), np.zeros((states, width))
    for i in range(first.size):
        for part in range(parts[i]):
            s, where = first[i] + part, (part + 0.5) / parts[i]
            for r in range(states):
                for c in range(width):
                    total = 0.0
                    if part:
                        for q in range(states):
                            total += slopes[s, q, r] * now[q, c]
                    elif c < states:
                        total = slopes[s, c, r]
                    if states <= c < states + own:
                        total += slopes[s, c, r]
                    elif states + own <= c < states + own + kicks:
                        total += (1 - where) * slopes[s, c, r]
                    elif c >= states + own + kicks:
                        total += where * slopes[s, c - kicks, r]
                    after[r, c] = total
            now, after = after, now
        for r in range(states):
            for c in range(states):
                whole[i, r, c] = now[r, c]
            for c in range(own):
                by_free[i, r, c] = now[r, states + c]
            for c in range(kicks):
                left[i, r, c] = now[r, states + own + c]
                right[i, r, c] = now[r, states + own + kicks + c]
    return whole, left, right, by_free


@jitted
def responses(
    transition: Array, by_state: Array, begin: Array, added: Array
) -> Array:  # pragma: no cover - compiled
    """What the sensors see (W, L, m, C) of deviations of the state that begin at ``begin`` (W, X,
    C) and follow ``transition`` (W, L − 1, X, X), by ``by_state`` (W, L, m, X). Each step adds
    ``added`` (W, L − 1, X, K) to the last K of the columns. SI."""
    windows, length, sensors, states = by_state.shape
    columns = begin.shape[2]
    alone = columns - added.shape[3]
    seen = np.empty((windows, length, sensors, columns))
    now, after = np.empty((states, columns)), np.empty((states, columns))
    for w in range(windows):
        for r in range(states):
            for c in range(columns):
                now[r, c] = begin[w, r, c]
        for i in range(length):
            for j in range(sensors):
                for c in range(columns):
                    seen[w, i, j, c] = 0.0
                for q in range(states):
                    for c in range(columns):
                        seen[w, i, j, c] += by_state[w, i, j, q] * now[q, c]
            if i == length - 1:
                break
            for r in range(states):
                for c in range(columns):
                    after[r, c] = added[w, i, r, c - alone] if c >= alone else 0.0
                for q in range(states):
                    for c in range(columns):
                        after[r, c] += transition[w, i, r, q] * now[q, c]
            now, after = after, now
    return seen
