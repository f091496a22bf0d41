"""Coordinates whose place nothing depends on, such as the charge of a circuit without a capacitor.

    ∂ΔF/∂q_j = 0  and  ∂y/∂q_j = 0        q_j is cyclic (Goldstein, Classical Mechanics, §2.6)

Where a sensor shows the rate of one, its motion is known up to a constant that acts nowhere: no
equation of a model that may lack something has to determine its place.
Sizes: N samples, n coordinates, m sensors.
"""

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine

STATES = 7
SHIFT = 1.0  # rad, m or C: any shift tells, for what is not there changes by nothing at all


def cyclic(machine: Machine, u: Array, t: Array) -> frozenset[int]:
    """The coordinates on whose places neither forces nor sensors depend, at random states under
    the inputs ``u`` (N, k), SI, at ``t`` (N,), s; none of a machine with constraints."""
    if machine.constraints:
        return frozenset()
    rows = np.linspace(0, t.size - 1, STATES).astype(int)
    rng = np.random.default_rng(0)
    q = np.array(machine.model.start()[0]) + rng.normal(size=(STATES, machine.n))
    v, a = rng.normal(size=(2, STATES, machine.n))
    z = rng.normal(size=(STATES, machine.inner_states))

    def seen(places: Array) -> tuple[Array, Array]:
        arguments = (places, v, a, z, u[rows], t[rows], machine.values)
        (force,) = along(machine.discrepancy, arguments, (6,), STATES)
        (shown,) = along(machine.outputs, arguments, (6,), STATES)
        return force, shown

    base, found = seen(q), []
    for j in range(machine.n):
        moved = q.copy()
        moved[:, j] += SHIFT
        if all(map(np.array_equal, seen(moved), base)):
            found.append(j)
    return frozenset(found)


def rates_shown(slopes: Array) -> NDArray[np.bool_]:
    """Whether the sensors of slopes by the rates (N, m, n), SI, show by themselves the rate of each
    coordinate (n,), at a sample in the middle."""
    one = slopes[len(slopes) // 2]
    scaled = one / np.maximum(np.linalg.norm(one, axis=1, keepdims=True), 1e-300)
    resolved = np.diag(np.linalg.pinv(scaled, rcond=1e-6) @ scaled)
    return np.asarray(resolved > 1 - 1e-6)
