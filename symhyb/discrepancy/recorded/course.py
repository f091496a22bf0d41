"""The course of a recording: its smoothed motion with all that acts and remembers along it."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.signals import acting, centred, measured
from symhyb.model.expression import Reading
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.known import Known, machine_with, with_known
from symhyb.numeric.lowered.machine import Machine


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """Motion ``q``, ``v``, ``a`` (N, n), inner states ``z`` (N, z) of elements, inputs ``u`` (N, k)
    at ``t`` (N,); ``states`` (N, X) and ``drive`` (N, drive) are the same for the machine as a
    first-order system. Where a held input jumps, ``u`` is the mean of both sides, as the smoothed
    motion has it, and ``drive`` what acts from then on. ``reaction`` (N, n) is the measured force
    that drives a coordinate: 0 if it is free, NaN if it is imposed and its force is not measured.
    ``known`` are parameters that the recording knows, in place of those of a model. All SI."""

    t: Array
    q: Array
    v: Array
    a: Array
    z: Array
    u: Array
    states: Array
    drive: Array
    reaction: Array
    known: Known = field(default_factory=dict)

    def values(self, machine: Machine) -> Array:
        """The parameters (P,) of a machine in this recording, SI."""
        return with_known(machine, machine.values, self.known)

    def at(self, rows: slice | Sequence[int] | NDArray[np.int64]) -> "Course":
        """The course at some of its samples."""
        parts = {f.name: getattr(self, f.name)[rows] for f in fields(self) if f.name != "known"}
        return replace(self, **parts)


@lru_cache(maxsize=32)
def course_of(recording: Recording, machine: Machine, motion: Motion) -> Course:
    """The course of a recording for one machine, whose inner states begin at rest."""
    machine = machine_with(machine, recording.parameters)
    u, form = centred(recording, machine), state_form(machine)
    z = inner_along(machine, motion.t, (motion.q, motion.v, motion.a), u, machine.values)
    return Course(
        motion.t,
        motion.q,
        motion.v,
        motion.a,
        z,
        u,
        states=form.state(motion.q, motion.v, z),
        drive=form.driven(acting(recording, machine), motion.q, motion.v, motion.a),
        reaction=_reaction(recording, machine),
        known=recording.parameters,
    )


def _reaction(recording: Recording, machine: Machine) -> Array:
    """The forces (N, n) by which a rig imposes coordinates, from sensors that measure just that."""
    force = np.zeros((recording.t.size, machine.n))
    force[:, list(machine.imposed)] = np.nan
    names = [coordinate.name for coordinate in machine.model.coordinates]
    for sensor, column in zip(machine.model.sensors, measured(recording, machine).T, strict=True):
        match sensor.measures.tree:
            case Reading("reaction", (name,)) if name in names:
                gain = 1.0 if sensor.gain is None else sensor.gain.si
                offset = 0.0 if sensor.offset is None else sensor.offset.si
                force[:, names.index(name)] = (column - offset) / gain
    return force
