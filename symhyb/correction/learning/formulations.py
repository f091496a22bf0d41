"""The two formulations of a learned correction, from the same recording and with the same learners.

    force    ΔF  = M a + k_c − k_e             what acts besides k_e
    rates    Δx' = x' − f(t, x, u),   x = (q, v),   Δx' = (q' − v, a − M⁻¹(k_e − k_c))

Δv' = M⁻¹ ΔF without constraints, so both say the same of exact data. They differ in what is
learned: with a mass matrix that depends on q, a law of forces is no simple law of rates; and no
host can add rates to its forces. Δq' is zero where q and v were estimated together; it is not where
speed was measured on its own.
Sizes: N samples, n coordinates of which f are free, k inputs, R rows (force: f, rates: 2f), T
terms.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.correction.learning.corrected import (
    Formulation,
    Law,
    Networks,
    Terms,
    features,
    value_of,
)
from symhyb.correction.learning.network import MEMBERS, WIDTH, members_of
from symhyb.correction.learning.refining import joined
from symhyb.correction.learning.regression import Candidates, regress
from symhyb.correction.learning.sparse import thresholded
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.errors import InputError, Problem
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.machine import Machine

UNSEEN = 1e-9  # of the largest column: a term that is no larger is not seen


def measured_course(
    machine: Machine, t: Array, motion: tuple[Array, Array, Array], u: Array
) -> Course:
    """The course of a motion q, v, a (N, n) under inputs (N, k) at times ``t`` (N,), all SI, just
    as it is given. :func:`symhyb.discrepancy.recorded.course.course_of` has the smoothed one of a
    recording."""
    form, (q, v, a) = state_form(machine), motion
    z = inner_along(machine, t, motion, u, machine.values)
    free = np.zeros_like(q)
    return Course(t, q, v, a, z, u, form.state(q, v, z), form.driven(u, q, v, a), free)


def lacking(
    machine: Machine, course: Course, formulation: Formulation, rate: Array | None = None
) -> Array:
    """What the model lacks along a course (N, R), SI: ΔF, or Δx' = (Δq', Δv'). ``rate`` (N, n) is
    q' where it was measured beside v, else it is v."""
    free = list(machine.free)
    if formulation == "force":
        return discrepancy(machine, course, machine.values)[:, free]
    form, still = state_form(machine), np.zeros(machine.n)
    given = course.states, course.drive, course.t, course.values(machine), still
    (rates,) = along(form.rates(), given, (3, 4), course.t.size)
    slip = (course.v if rate is None else rate)[:, free] - course.v[:, free]
    return np.concatenate([slip, course.a[:, free] - rates[:, : len(free)]], axis=1)


def values_along(machine: Machine, course: Course, law: Law) -> Array:
    """A law along a course (N, R), SI."""
    given = course.q, course.v, course.u, course.t, course.values(machine)
    (values,) = along(value_of(machine, law), given, (4,), course.t.size)
    return values


def sparse_law(
    machine: Machine, course: Course, wanted: Array, texts: Sequence[str], threshold: float = 0.05
) -> Terms:
    """Sparse terms for ``wanted`` (N, R), SI, by PySINDy's STLSQ on columns of unit length; a term
    goes whose share of the row is below the ``threshold``. ``texts`` are expressions (T).

    Raises:
        InputError: an expression with names the model has not, terms that depend on each other.
    """
    given = course.q, course.v, course.u, course.t, course.values(machine)
    (columns,) = along(features(machine, texts), given, (4,), course.t.size)
    length, size = np.linalg.norm(columns, axis=0), np.linalg.norm(wanted, axis=0)
    seen = np.flatnonzero(length > UNSEEN * length.max(initial=0.0)).tolist()
    coefficients = np.zeros((wanted.shape[1], len(texts)))
    for row in np.flatnonzero(size):
        table = np.column_stack([columns[:, seen] / length[seen], wanted[:, row] / size[row]])
        found = Candidates(
            lambda part, table=table: table[part],  # type: ignore[misc]
            len(table),
            (*(texts[i] for i in seen), "what is lacking"),
        )
        shares = regress(found, thresholded(threshold))[0]
        coefficients[row, seen] = shares * size[row] / length[seen]
    return Terms(tuple(texts), coefficients)


def network_law(
    machine: Machine,
    course: Course,
    wanted: Array,
    inputs: Sequence[str],
    *,
    width: int = WIDTH,
    members: int = MEMBERS,
    seed: int = 0,
) -> Networks:
    """A network a row for ``wanted`` (N, R), SI, trained as :func:`symhyb.train_network` does
    (standardised, stopped early on blocks of time, the mean of ``members``), but not refined by
    simulation error. It fades outside of what the course shows of its ``inputs``, expressions.

    Raises:
        InputError: an expression with names the model has not, or one that never changes.
    """
    given = course.q, course.v, course.u, course.t, course.values(machine)
    (seen,) = along(features(machine, inputs), given, (4,), course.t.size)
    low, high = seen.min(axis=0), seen.max(axis=0)
    if not (low < high).all():
        still = ", ".join(t for t, a, b in zip(inputs, low, high, strict=True) if not a < b)
        raise InputError(Problem(f"{still} never changes here: a network cannot learn from it"))
    rows = [
        joined(members_of(seen, column, width, members, seed)) if column.any() else None
        for column in wanted.T
    ]
    trust = tuple(zip(low.tolist(), high.tolist(), strict=True))
    return Networks(tuple(inputs), tuple(rows), trust)
