"""Where the inner states of elements begin in a window: near what the measured motion left them at.

A window's places and speeds are free at its start. Inner states must not be: a slow relaxation that
may begin anywhere is a free force in every window, and would explain anything. They start within a
spread of the state that the law reaches along the measured motion up to there.

Declared states likewise. What they begin a recording with is not known: where they settle, the
spread also holds what a start beside that by their RMS would leave of itself, and where a sensor
shows them, it is their RMS. What integrates and is not seen may begin anywhere in every window: a
constant force behind it cannot be distinguished from where it begins, and must not be named.
Sizes: W windows, z declared and inner states, S declared ones, F free parameters.
"""

from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.recorded.watching import shown_states
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.model.vocabulary import memories
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.inner import inner_along, settled
from symhyb.numeric.lowered.known import with_known
from symhyb.numeric.runs.windows import WindowModel

SPREAD = 0.05  # of the RMS of an inner state along the recording
UNSEEN = 100.0  # of the RMS of a declared state: where it may begin if nothing says where
STEP = 1e-4  # relative, of a parameter, for slopes


@dataclass(frozen=True, slots=True)
class Anchor:
    """Inner states at the starts of windows, SI: ``z`` and one sd ``spread`` (W, z), and slopes
    ``by_free`` (W, z, F)."""

    z: Array
    spread: Array
    by_free: Array


@np.errstate(over="ignore", invalid="ignore")
def anchored(model: WindowModel, item: Cut, p: Array, slopes: bool = False) -> Anchor:
    """The prior of inner states of the windows under parameters ``p`` (P,), SI; ``slopes`` where
    asked for. What runs away under trial parameters is infinite or NaN, and costs as much."""
    starts, free = item.rows[:, 0], model.free
    asked = [i for i, column in enumerate(free) if slopes and column in _acting(model)]
    steps = np.array([STEP * (abs(p[free[i]]) or 1.0) for i in asked])
    sets = np.repeat(p[None], 1 + len(asked), axis=0)
    sets[np.arange(1, 1 + len(asked)), [free[i] for i in asked]] += steps
    along, *moved = _along(model, item, sets)
    size = np.sqrt(np.mean(along**2, axis=0))
    motion = item.source[1]
    blurs = [float(np.max(sd, initial=0.0)) for sd in (motion.q_sd, motion.v_sd)]
    declared = len(model.machine.model.states)
    own = [blurs[-state.time] for _, state in memories(model.machine.model)]
    blur = np.array([*(declared * [0.0]), *own])
    by_free = np.zeros((starts.size, along.shape[1], len(free)))
    for i, step, other in zip(asked, steps, moved, strict=True):
        by_free[:, :, i] = (other - along)[starts] / step
    spread = np.repeat(np.sqrt((SPREAD * size) ** 2 + blur**2)[None] + 1e-300, starts.size, axis=0)
    if declared:
        spread[:, :declared] = _of_declared(model, item, p, along, size)[starts]
    return Anchor(along[starts], spread, by_free)


def _of_declared(model: WindowModel, item: Cut, p: Array, along: Array, size: Array) -> Array:
    """One sd (N, S), SI, of declared states along a recording; ``along`` (N, z) are the states and
    ``size`` (z,) their RMS."""
    begins = begin_spread(model, item, p, size)
    count = begins.size
    off = np.zeros((count, along.shape[1]))
    off[:, :count] = np.diag(begins)
    moved = _along(model, item, np.repeat(p[None], count, axis=0), off)
    kept = np.sqrt(np.sum((moved - along)[:, :, :count] ** 2, axis=0))
    wide = np.sqrt((SPREAD * size[:count]) ** 2 + kept**2)
    shown = shown_states(model.machine.model, item.block.y)
    return np.asarray(np.where(shown, np.maximum(wide, size[:count]), wide) + 1e-300)


def begin_spread(model: WindowModel, item: Cut, p: Array, size: Array) -> Array:
    """One sd (S,), SI, of declared states where a recording begins: their RMS, of ``size`` (z,), if
    they settle or a sensor shows them; of what integrates unseen as good as anything."""
    machine, course = model.machine, item.course(model.machine)
    here = course.q[0], course.v[0], course.u[0], float(course.t[0])
    settles = settled(machine, *here, with_known(machine, p, course.known))[1]
    shown = shown_states(machine.model, item.block.y)
    known, declared = settles[: shown.size] | shown, size[: shown.size]
    return np.where(known, declared, UNSEEN * declared)


def off_anchor(model: WindowModel, start: Array, prior: Anchor) -> Array:
    """Squared deviations (W,) of initial states ``start`` (W, X), SI, from their prior, in its
    deviations, dimensionless."""
    first = 2 * len(model.form.free)
    return np.asarray(np.sum(((start[:, first:] - prior.z) / prior.spread) ** 2, axis=1))


def _acting(model: WindowModel) -> set[int]:
    """The columns of p on which the rates of inner states depend."""
    inner = model.machine.inner
    return set(inner.jac_sparsity(0, 5).get_triplet()[1])


def _along(model: WindowModel, item: Cut, p: Array, off: Array | float = 0.0) -> Array:
    course = item.course(model.machine)
    motion = course.q, course.v, course.a
    p = with_known(model.machine, p, course.known)
    return inner_along(model.machine, course.t, motion, course.u, p, off)
