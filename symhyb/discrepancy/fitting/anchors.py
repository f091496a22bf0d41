"""Where the inner states of elements begin in a window: near what the measured motion left them at.

A window's places and speeds are free at its start. Inner states must not be: a slow relaxation that
may begin anywhere is a free force in every window, and would explain anything. They start within a
spread of the state that the law reaches along the measured motion up to there.
Sizes: W windows, z inner states, F free parameters.
"""

from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.known import with_known
from symhyb.numeric.runs.windows import WindowModel

SPREAD = 0.05  # of the RMS of an inner state along the recording
STEP = 1e-4  # relative, of a parameter, for slopes


@dataclass(frozen=True, slots=True)
class Anchor:
    """Inner states at the starts of windows, SI: ``z`` (W, z), one sd ``spread`` (z,), and slopes
    ``by_free`` (W, z, F)."""

    z: Array
    spread: Array
    by_free: Array


def anchored(model: WindowModel, item: Cut, p: Array, slopes: bool = False) -> Anchor:
    """The prior of inner states of the windows under parameters ``p`` (P,), SI; ``slopes`` where
    asked for."""
    starts, free = item.rows[:, 0], model.free
    asked = [i for i, column in enumerate(free) if slopes and column in _acting(model)]
    steps = np.array([STEP * (abs(p[free[i]]) or 1.0) for i in asked])
    sets = np.repeat(p[None], 1 + len(asked), axis=0)
    sets[np.arange(1, 1 + len(asked)), [free[i] for i in asked]] += steps
    along, *moved = _along(model, item, sets)
    size = np.sqrt(np.mean(along**2, axis=0))
    blur = float(np.max(item.source[1].q_sd, initial=0.0))
    by_free = np.zeros((starts.size, along.shape[1], len(free)))
    for i, step, other in zip(asked, steps, moved, strict=True):
        by_free[:, :, i] = (other - along)[starts] / step
    return Anchor(along[starts], np.sqrt((SPREAD * size) ** 2 + blur**2) + 1e-300, by_free)


def off_anchor(model: WindowModel, item: Cut, p: Array, start: Array) -> Array:
    """Squared deviations (W,) of initial states ``start`` (W, X) from their prior, in its
    deviations, dimensionless."""
    first = 2 * len(model.form.free)
    if start.shape[1] == first:
        return np.zeros(len(start))
    anchor = anchored(model, item, p)
    return np.asarray(np.sum(((start[:, first:] - anchor.z) / anchor.spread) ** 2, axis=1))


def _acting(model: WindowModel) -> set[int]:
    """The columns of p on which the rates of inner states depend."""
    inner = model.machine.inner
    return set(inner.jac_sparsity(0, 5).get_triplet()[1])


def _along(model: WindowModel, item: Cut, p: Array) -> Array:
    course = item.course(model.machine)
    motion = course.q, course.v, course.a
    p = with_known(model.machine, p, course.known)
    return inner_along(model.machine, course.t, motion, course.u, p)
