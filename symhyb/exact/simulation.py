"""A run as a person asks for it: smooth, or exact with located events."""

import numpy as np

from symhyb.errors import InputError, Problem
from symhyb.numeric.kernels.buffers import Array, on_lines
from symhyb.numeric.lowered.lengths import at_unit_length
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs import integrate
from symhyb.numeric.runs.cvodes import culprits, cvodes_options, jumps_of
from symhyb.numeric.runs.integrate import Trajectory, begun
from symhyb.numeric.runs.sampled import samples_of
from symhyb.numeric.runs.scenario import Scenario


def simulate(
    machine: Machine, scenario: Scenario, p: Array | None = None, exact: bool = False
) -> Trajectory:
    """Integrate M q'' = k_e − k_c over ``scenario.t`` with parameters ``p`` (P,) in SI, default
    the model's, as :func:`symhyb.numeric.runs.integrate.simulate`. Inputs must cover the output
    times.

    ``exact``: dry friction holds instead of creeping, stops touch, and what the file writes as a
    jump switches at its time; every transition is located and listed in ``events``
    (:mod:`symhyb.exact.events`).

    Raises:
        InputError: an exact run of a machine with constraints.
        ValueError: an input that stops before the simulation does, or times that do not increase.
    """
    if not exact:
        return integrate.simulate(machine, scenario, p)
    values, model = machine.values if p is None else np.asarray(p, dtype=float), machine.model
    form, scenario, drive, start, reason = begun(machine, scenario, values)
    if reason or form.size == 0:  # nothing moves
        return integrate.simulate(machine, scenario, values)
    if machine.constraints:
        text = "an exact run knows no constraints; leave out 'exact'"
        raise InputError(Problem(text, "constraints", model.file))
    from symhyb.exact.driven import Drive  # SciPy's integrators, which other runs do not need
    from symhyb.exact.events import is_stiff, locate_events
    from symhyb.exact.switched import switched

    opened = switched(form)
    longest = float(cvodes_options(scenario.t_u, drive, 0, "bdf", 1.0)["max_step_size"]) or np.inf
    jumps = jumps_of(scenario.t_u, drive, scenario.t)
    samples = samples_of(form, scenario.t, values)
    held = Drive(scenario.t_u, drive)
    stiff = is_stiff(opened, scenario.t, start, held, values)
    run = locate_events(opened, scenario.t, start, held, values, jumps, stiff, longest, samples)
    f = len(form.free)
    motion = form.motion(run.x, on_lines(scenario.t_u, drive, scenario.t))
    q, v = at_unit_length(model, *motion)
    reason = run.reason + (culprits(model) if run.reason else "")
    method = "radau" if stiff else "dop853"
    z = run.x[:, 2 * f :]
    return Trajectory(
        scenario.t, q, v, run.a, run.y, z, reason, method, events=run.events, model=model
    )
