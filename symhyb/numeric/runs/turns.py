"""A run that changes methods on the way, by what it meets.

    explicit ---- stiff, and BDF quicker in a part of the rest ----> BDF over a piece, then explicit
             ---- stopped for another reason ----> BDF to the end, to get past it or to say why

States that were computed stay. Behind each piece the explicit method takes up again, and gives back
after fifteen stiff steps.
Sizes: N outputs, X states, K samples of the drive, D entries of it, P parameters.
"""

from dataclasses import replace

import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import StateForm
from symhyb.numeric.runs.cvodes import ABSOLUTE_TOLERANCE, RELATIVE_TOLERANCE
from symhyb.numeric.runs.explicit import GROWTH, STIFF, Field, longest_step
from symhyb.numeric.runs.explicit_run import Course, explicit_run
from symhyb.numeric.runs.implicit_run import implicit_sizes, implicit_states
from symhyb.numeric.runs.scenario import Scenario, within
from symhyb.numeric.runs.sizes import seen

STEPS_STIFF = 10_000  # of BDF for one output, where the explicit method is far slower
FIRST_PIECE = 1 / 7  # of what is left when a run is found stiff: three pieces by BDF to the end


def in_turns(
    form: StateForm, rates: Field, scenario: Scenario, drive: Array, start: Array, p: Array
) -> tuple[Array, str, str, str]:
    """States (N, X), SI, by the explicit method, and by BDF over pieces that double where a run is
    stiff; why they end early, the method at the end, and a sentence if it changed."""

    def gets(t: float, x: Array, until: float, scales: Array, most: int) -> bool:
        part = replace(scenario, t=np.array([t, until]), bound=None)
        return not implicit_states(form, part, drive, x, p, scales, "bdf", most=most)[1]

    whole, end = np.full((scenario.t.size, form.size), np.nan), float(scenario.t[-1])
    longest, tolerances = longest_step(form), (RELATIVE_TOLERANCE, ABSOLUTE_TOLERANCE)
    whole[0] = start
    rest, scales, changed, piece = scenario, scenario.scales, "", 0.0
    while True:
        course = Course(rest.t, start, p, rest.t_u, drive, longest, rest.bound)
        run, sizes = explicit_run(rates, course, scales, tolerances, None if changed else gets)
        whole[-rest.t.size + 1 :] = run.x[1:]
        if not run.reason or (run.reason == GROWTH and scenario.bound is not None):
            again = f"; explicit again from {rest.t[0]:.6g} s" if changed else ""
            return *within(scenario.bound, scenario.t, whole), "explicit", changed + again
        left, stiff = rest.t > run.t, run.reason == STIFF
        why = "is stiff from there on" if stiff else f"ended ({run.reason})"
        changed = changed or f"explicit up to {run.t:.6g} s, where it {why}; BDF from there"
        piece = 2 * piece or FIRST_PIECE * (end - run.t)
        rest = replace(rest, t=np.concatenate([[run.t], rest.t[left]]))
        if scales is None:
            rough = implicit_sizes(form, rest, drive, run.last, p, "bdf") if stiff else sizes
            scales = np.maximum(rough, seen(run.reach, np.zeros(form.size)))
        stop = int(np.searchsorted(rest.t, run.t + piece)) + 1 if stiff else rest.t.size
        part = replace(rest, t=rest.t[: max(stop, 2)])
        most = STEPS_STIFF if stiff else 0
        x, reason = implicit_states(
            form, part, drive, run.last, p, scales, "bdf", most=most, doubtful=not stiff
        )
        first = scenario.t.size - rest.t.size + 1
        whole[first : first + len(x) - 1] = x[1:]
        if reason or part.t.size == rest.t.size:
            return whole, reason, "bdf", changed
        rest, start = replace(rest, t=rest.t[part.t.size - 1 :]), x[-1]
