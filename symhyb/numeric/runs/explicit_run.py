"""A whole run by the explicit method: to what accuracy, how far, and when it is to change methods.

An explicit method is the quickest unless the equations are so stiff that its steps must be far
shorter than the motion asks for. That shows on the way: many steps in a row lie at the border of
stability. Where much is at stake, the implicit method then tries a part of what is left; if it
needs less than the explicit one there, it goes on from the state reached. Work is counted in steps
and instructions, not by the clock, so that a run always goes the same way.
Sizes: N outputs, X states, K samples of the drive, P parameters.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.explicit import INSTRUCTIONS_MOST, Field, Steps, Tolerances, bends
from symhyb.numeric.runs.sizes import GROWN, ROUGH, rough_sizes, seen, unit_sizes

STEPS_MOST = 5_000_000  # tried in a run, a tenth of them at first: 3 s for 100 instructions
STEPS_BEND = 20  # more for each bend of the drive, where a step ends anyway
# ns for an explicit step, for each instruction of its rates, and for one that is never compiled
STEP, STEP_EACH, STEP_EACH_LISTED = 400.0, 4.4, 84.0
IMPLICIT, IMPLICIT_EACH = 3000.0, 23.0  # the same for one of BDF: evaluations and slopes by CasADi
AT_STAKE, AT_STAKE_EACH = 2e7, 3e4  # ns: of less no change is tried; CVODES begins in a third of it
TRIED = 0.2  # of what is left, which both have to do to be compared
SHORTER = 4.0  # so many times shorter steps than where BDF was found slower ask for another try
SIZE_OFF = 10.0  # a size this many times too large asks for another run

Nodes = tuple[Array, Array]
# whether BDF gets from a time and a state (X,), SI, to another time in so many steps, with sizes of
# the states (X,), SI
Try = Callable[[float, Array, float, Array, int], bool]


@dataclass(frozen=True, slots=True)
class Course:
    """What to integrate, SI: outputs ``t`` (N,), ``start`` (X,), parameters ``p`` (P,), and the
    drive (K, drive) at times ``t_u`` (K,), straight between them; no step is longer than
    ``longest`` s, and the run ends where a state is beyond its ``bound`` (X,)."""

    t: Array
    start: Array
    p: Array
    t_u: Array
    drive: Array
    longest: float = np.inf
    bound: Array | None = None


def explicit_run(
    field: Field,
    course: Course,
    scales: Array | None,
    tolerances: tuple[float, float],
    gets: Try | None,
) -> tuple[Steps, Array]:
    """A run as far as the explicit method is the one for it, and the sizes of the states (X,), SI.

    ``scales`` (X,) are these sizes, found by a rough run if None; ``tolerances`` are relative, and
    absolute in these scales; ``gets`` tries BDF. None: it has proved quicker, and whatever is stiff
    is left to it.
    """
    nodes = bends(course.t_u, course.drive)
    found = _rough(field, course, nodes, tolerances) if scales is None else scales
    run = _run(field, course, nodes, found, tolerances, gets)
    size = seen(run.reach, found)
    if scales is None and not run.reason and np.any(found > SIZE_OFF * size):
        run, found = _run(field, course, nodes, size, tolerances, gets), size
    return run, found


def _run(
    field: Field,
    course: Course,
    nodes: Nodes,
    scales: Array,
    tolerances: tuple[float, float],
    gets: Try | None,
) -> Steps:
    relative, absolute = tolerances
    bound = course.bound
    if bound is None:  # a state that hardly moved at first may well grow by more than that
        bound = GROWN * np.maximum(scales, unit_sizes(course.start))
    limits = Tolerances(relative, absolute * scales, bound, _most(nodes))
    end, size = float(course.t[-1]), len(field.code.steps)

    def weigh(t: float, h: float, x: Array) -> float:
        left = (end - t) / h  # steps at the border of stability are alike
        part = TRIED * left * _cost(field) / (IMPLICIT + IMPLICIT_EACH * size)
        if gets is None or left > STEPS_MOST:
            return 0.0
        return 0.0 if gets(t, x, t + TRIED * (end - t), scales, int(part)) else h / SHORTER

    return field.integrate(
        course.t,
        course.start,
        course.p,
        nodes,
        limits,
        longest=course.longest,
        suspect=np.inf if gets is None else _suspect(field, course),
        weigh=weigh,
    )


def _most(nodes: Nodes) -> int:
    """How many steps a run may try."""
    return STEPS_MOST + STEPS_BEND * int(nodes[0].size)


def _cost(field: Field) -> float:
    """Of an explicit step, ns."""
    size = len(field.code.steps)
    return STEP + size * (STEP_EACH if size <= INSTRUCTIONS_MOST else STEP_EACH_LISTED)


def _suspect(field: Field, course: Course) -> float:
    """The length in s of steps with which a whole run would cost what is worth a change."""
    at_stake = AT_STAKE + AT_STAKE_EACH * len(field.code.steps)
    return float(course.t[-1] - course.t[0]) * _cost(field) / at_stake


def _rough(field: Field, course: Course, nodes: Nodes, tolerances: tuple[float, float]) -> Array:
    """The sizes of the states (X,), SI, in a rough run; as far as it comes, where it is stiff."""
    suspect = _suspect(field, course)

    def run(t: Array, unit: Array) -> tuple[Array, bool]:
        absolute = tolerances[1] * ROUGH / tolerances[0] * unit
        limits = Tolerances(ROUGH, absolute, np.full(unit.size, np.inf), _most(nodes))
        found = field.integrate(t, course.start, course.p, nodes, limits, suspect=suspect)
        return np.where(np.isfinite(found.reach), found.reach, 0.0), not found.reason

    return rough_sizes(course.t, course.start, run)
