"""What errors of an input do: at once, and through the declared states that it drives.

u + c ──▶ forces                     at once: c times what one unit of u pushes with
  └─────▶ i' = …, i ──▶ forces       through a state: what its change along the measured motion
                    └─▶ sensors      adds to the forces, and to what sensors show of it
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import CHANGE, pushes
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.discrepancy.likelihood.track import Extra
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.machine import Machine


def erring(
    recorded: Recorded,
    which: int,
    errors: Sequence[Array],
    before: Sequence[Array] | None = None,
) -> tuple[Extra, ...]:
    """The forces and parts of the outputs that errors (N, K) of an input make in every stretch, SI;
    errors that jump are otherwise just ``before`` each sample, and states follow their mean."""
    model, found = recorded.windows.machine.model, []
    parts = zip(recorded.items, pushes(recorded, which), errors, before or errors, strict=True)
    for item, (_, push), after, ahead in parts:
        output = np.zeros((len(after), len(model.sensors), after.shape[1]))
        forces = [push[:, :, None] * error[:, None] for error in (after, ahead)]
        if model.states:
            mean = 0.5 * (after + ahead)
            more = [_through_states(recorded, item, which, column) for column in mean.T]
            pushed, output = (np.stack(part, axis=2) for part in zip(*more, strict=True))
            forces = [force + pushed for force in forces]
        found.append(Extra(forces[0], output, None if before is None else forces[1]))
    return tuple(found)


def spared_by(recorded: Recorded, which: int, at_once: bool = False) -> list[int]:
    """The coordinates on which an input does not act, or not ``at_once``."""
    pushed = [push for _, push in pushes(recorded, which)]
    if recorded.windows.machine.model.states and not at_once:
        unit = [np.ones((len(push), 1)) for push in pushed]
        pushed = [extra.force[:, :, 0] for extra in erring(recorded, which, unit)]
    size = sum(np.abs(push).sum(axis=0) for push in pushed)
    return [int(i) for i in np.flatnonzero(size == 0) if recorded.scale[i] > 0]


def pushed_by(recorded: Recorded, which: int) -> frozenset[int]:
    """The coordinates on which an input acts."""
    every = range(len(recorded.windows.machine.model.coordinates))
    return frozenset(every) - {*spared_by(recorded, which)}


def _through_states(recorded: Recorded, item: Cut, which: int, error: Array) -> tuple[Array, Array]:
    """The force (N, n) and what the sensors show (N, m), SI, of an ``error`` (N,) of an input that
    goes through states, to first order; inputs at once stay."""
    machine, (recording, motion) = recorded.windows.machine, item.source
    course = course_of(recording, machine, motion).at(item.rows[0])
    largest, p = float(np.abs(error).max()), course.values(machine)
    if largest == 0:
        shape = (error.size, len(machine.model.sensors))
        return np.zeros_like(course.q), np.zeros(shape)
    gain = machine.model.inputs[which].gain
    change = CHANGE * (float(np.std(course.u[:, which])) or 1.0) / largest
    u = course.u.copy()
    u[:, which] += change * error / (1.0 if gain is None else gain.si)
    before, after = (_remembering(machine, course, drive, p) for drive in (course.u, u))
    forces = discrepancy(machine, before, machine.values) - discrepancy(
        machine, after, machine.values
    )
    return forces / change, (_shown(machine, after, p) - _shown(machine, before, p)) / change


def _remembering(machine: Machine, course: Course, u: Array, p: Array) -> Course:
    """The course with the states that inputs ``u`` (N, k) drive, SI."""
    z = inner_along(machine, course.t, (course.q, course.v, course.a), u, p)
    return replace(course, z=z)


def _shown(machine: Machine, course: Course, p: Array) -> Array:
    c = course
    (y,) = along(machine.outputs, (c.q, c.v, c.a, c.z, c.u, c.t, p), (6,), c.t.size)
    return np.asarray(y.reshape(c.t.size, -1))
