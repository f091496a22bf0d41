"""How large the states of a run become, which absolute tolerances count in.

Sizes: N outputs, X states.
"""

from collections.abc import Callable, Sequence

import numpy as np

from symhyb.numeric.kernels.buffers import Array

ROUGH = 1e-4  # relative tolerance of the run that finds the sizes
OUTPUTS = 200
EARLY = 0.1  # of a run: shows how large the motion is, unless something rests there
LEAST = 1e-12  # SI: a state that moves less is not seen
GROWN = 1e6  # sizes: a state so large has grown without bound


def unit_sizes(start: Array) -> Array:
    """Sizes of the states (X,), SI, before anything is known but the ``start`` (X,)."""
    return np.maximum(np.abs(start), 1e-3)


def seen(size: Array, other: Array) -> Array:
    """The ``size`` (X,) of states that moved, the ``other`` of those that stood still, SI."""
    return np.where(size > LEAST, size, other)


def rough_sizes(
    t: Array,
    start: Array,
    run: Callable[[Array, Array], tuple[Array, bool]],
    parts: Sequence[float] = (EARLY, 1.0),
) -> Array:
    """Largest size of each state (X,), SI, in a rough run from ``start`` (X,) over the first of the
    ``parts`` of the times ``t`` (N,), s, or the next where a state still rests then; 1 where it
    stands still. A size that is too small costs steps, and no accuracy.

    ``run`` gets outputs and sizes to begin with, and returns sizes and whether it came to its end.
    """
    unit, size = unit_sizes(start), np.zeros(start.size)
    for part in parts:
        rows = np.unique(np.linspace(0, part * (t.size - 1), OUTPUTS).astype(int))
        if rows.size < 2:
            continue
        size, whole = run(t[rows], unit)
        if not whole:  # what grows without bound would hide all that it began with
            size = np.minimum(size, GROWN * unit)
        if not whole or np.all(size > LEAST):
            break
    return seen(size, np.ones(start.size))
