"""Recorded inputs as the actuators of a machine pass them on.

Sizes: K times, k inputs, P parameters.
"""

from collections.abc import Sequence

from symhyb.model.types import Input
from symhyb.numeric.kernels.actuators import MOVING, Acted, acted
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine


def shaping_paths(machine: Machine, free: Sequence[int]) -> tuple[str, ...]:
    """Which of the ``free`` columns of p are numbers of actuators, by path."""
    known = {number.path for item in machine.model.inputs for number in item.actuator}
    paths = [item.path for item in machine.model.all_parameters()]
    return tuple(paths[i] for i in free if paths[i] in known)


def moves(item: Input) -> bool:
    """Whether an actuator makes a held input one that moves between its samples."""
    return any(number.name in MOVING for number in item.actuator)


def acting_inputs(
    machine: Machine, p: Array, t: Array, u: Array, fine: bool, asked: Sequence[str] = ()
) -> dict[int, Acted]:
    """The inputs that have actuators, by their number, as these pass them on under ``p`` (P,), SI;
    from ``u`` (K, k) at times ``t`` (K,), s, which are ``fine`` enough for what moves. Slopes by
    those of the numbers ``asked`` for, by path, that are of the same input."""
    found = {}
    for i, item in enumerate(machine.model.inputs):
        if item.actuator:
            numbers = {one.name: float(p[machine.column(one.path)]) for one in item.actuator}
            own = [one.name for one in item.actuator if one.path in asked]
            found[i] = acted(t, u[:, i], numbers, item.between == "held", fine, own)
    return found
