"""One scenario with many sets of parameters, on several cores.

Processes, not threads: building an integrator touches the reference counts of CasADi's shared
expressions, which are not made for two threads, and an integrator must not be called by two.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

PARTS = 4  # for each worker: small enough that none waits long for the last


def simulate_many(
    machine: Machine, scenario: Scenario, parameter_sets: Array, workers: int = 1
) -> tuple[Trajectory, ...]:
    """Simulate ``scenario`` with each of the ``parameter_sets`` (S, P), SI, one run a set in their
    order; a run that fails says so in its ``reason`` and leaves the others alone.

    The numbers do not depend on ``workers``. The processes stay for the next call; starting them
    takes a second or more, so few or short runs are faster with one worker, in this process.

    Raises:
        ValueError: parameter sets of another shape, fewer than one worker, or a scenario that
            :func:`symhyb.numeric.runs.integrate.simulate` refuses.
    """
    sets = np.asarray(parameter_sets, dtype=float)
    if sets.ndim != 2 or sets.shape[1] != machine.values.size:
        raise ValueError(
            f"the parameter sets have the shape {sets.shape}; one row a set with "
            f"{machine.values.size} values each is needed, in the order of all_parameters()"
        )
    if workers < 1:
        raise ValueError(f"{workers} workers; at least one is needed")
    if workers == 1 or len(sets) < 2:
        return _runs(machine, scenario, sets)
    from joblib import Parallel, delayed

    parts = np.array_split(sets, min(len(sets), PARTS * workers))
    done: Sequence[tuple[Trajectory, ...]] = Parallel(n_jobs=workers)(
        delayed(_runs)(machine, scenario, part) for part in parts
    )
    return tuple(run for part in done for run in part)


def _runs(machine: Machine, scenario: Scenario, sets: Array) -> tuple[Trajectory, ...]:
    return tuple(simulate(machine, scenario, p) for p in sets)
