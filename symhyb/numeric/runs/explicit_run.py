"""When a whole run is integrated by the explicit method, and to what accuracy.

An explicit method is the quickest unless the equations are so stiff that its steps must be far
shorter than the motion asks for. Where that is to be feared, it is tried with as many steps as cost
less than a run of CVODES does; if they do not suffice, or the run ends early for any other reason,
CVODES does the run and says why it fails if it does.
Sizes: N outputs, X states, K samples of the drive, P parameters.
"""

from dataclasses import dataclass

import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.explicit import GROWTH, Field, Steps, Tolerances, bends

STAGES = 12  # evaluations of a step
WORK_STIFF = 400_000_000  # instructions of a vain attempt: 0.1 s compiled, 1 s as interpreted; a
# tenth of that failed where CVODES then took 6 times as long (six-joint arm, 10 s), and 200 times
# under six inputs recorded at 200 Hz
WORK = 2_000_000_000  # where nothing points to stiffness
STEPS_NODE = 3  # allowed besides for every bend of the drive
ROUGH, ROUGH_OUTPUTS, EARLY = 1e-4, 200, 0.1  # the run that finds the scales, and its first part
SCALE_LEAST = 1e-12  # SI: a state that moves less is not seen
SCALE_OFF = 10.0  # a scale this many times too large asks for another run
GROWN = 1e6  # scales


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


def explicit_states(
    field: Field,
    course: Course,
    scales: Array | None,
    tolerances: tuple[float, float],
    stiff: bool,
) -> Array | None:
    """States (N, X) of a run, SI, NaN from where it left its bound; None if it took more steps than
    worth it, or did not reach its end for another reason.

    ``scales`` (X,) are sizes of the states, SI, found by a rough run if None; ``tolerances`` are
    relative, and absolute in these scales.
    """
    if course.t.size < 2 or not np.isfinite(course.start).all():
        return None
    nodes = bends(course.t_u, course.drive)
    work = (WORK_STIFF if stiff else WORK) // (STAGES * max(len(field.code.steps), 1))
    steps = work + STEPS_NODE * nodes[0].size
    found = scales
    if found is None:
        found = _rough_scales(field, course, nodes, tolerances, steps)
        if found is None:
            return None
    run = _run(field, course, nodes, found, tolerances, steps)
    if run.reason == GROWTH and course.bound is not None:
        return run.x
    if run.reason:
        return None
    if scales is None:
        size = np.where(run.reach > SCALE_LEAST, run.reach, found)
        if np.any(found > SCALE_OFF * size):
            run = _run(field, course, nodes, size, tolerances, steps)
    return None if run.reason else run.x


def _run(
    field: Field,
    course: Course,
    nodes: tuple[Array, Array],
    scales: Array,
    tolerances: tuple[float, float],
    steps: int,
) -> Steps:
    relative, absolute = tolerances
    bound = GROWN * scales if course.bound is None else course.bound
    limits = Tolerances(relative, absolute * scales, bound, steps)
    return field.integrate(course.t, course.start, course.p, nodes, limits, longest=course.longest)


def _rough_scales(
    field: Field,
    course: Course,
    nodes: tuple[Array, Array],
    tolerances: tuple[float, float],
    steps: int,
) -> Array | None:
    """Largest size of each state (X,) in a rough run over the first part, or over all where a
    state still rests then; 1 where it stands still. None if the run fails."""
    unit = np.maximum(np.abs(course.start), 1e-3)
    absolute = tolerances[1] * ROUGH / tolerances[0] * unit
    limits = Tolerances(ROUGH, absolute, np.full(unit.size, np.inf), steps)
    size = np.zeros(unit.size)
    for part in (EARLY, 1.0):
        last = part * (course.t.size - 1)
        rows = np.unique(np.linspace(0, last, ROUGH_OUTPUTS).astype(int))
        if rows.size < 2:
            continue
        run = field.integrate(course.t[rows], course.start, course.p, nodes, limits)
        if run.reason:
            return None
        size = run.reach
        if np.all(size > SCALE_LEAST):
            break
    return np.asarray(np.where(size > SCALE_LEAST, size, 1.0))
