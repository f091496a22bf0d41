"""A number of the model that changes with time."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import CHANGE, pushing, slow, waves
from symhyb.correction.adequacy.classes.worth import Around, worths_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.numeric.kernels.buffers import Array

PULSES = 200  # frequencies that are tried at most


def slopes_of(recorded: Recorded, path: str) -> list[Array]:
    """The generalized force (N, n) of one unit more of a number along every stretch, SI."""
    machine = recorded.windows.machine
    column = machine.column(path)
    change = CHANGE * (abs(machine.values[column]) or 1.0)
    slopes = []
    for item in recorded.items:
        recording, motion = item.source
        moved = machine.values.copy()
        moved[column] += change
        course = course_of(recording, machine, motion)
        force = discrepancy(machine, course, moved) - discrepancy(machine, course, machine.values)
        slopes.append(-force[item.rows[0]] / change)
    return slopes


def changing(start: Around, path: str) -> Generic:
    """A number that changes slowly, or at one frequency."""
    recorded = start.recorded
    machine = recorded.windows.machine
    size = abs(machine.values[machine.column(path)])
    slopes = [size * slope for slope in slopes_of(recorded, path)]
    lasts = max(float(np.ptp(item.block.t[0])) for item in recorded.items)
    most = 2 / recorded.period_s
    lines = np.linspace(0.5 / lasts, most, min(int(2 * lasts * most) + 1, PULSES))
    pairs = [
        slope[:, :, None] * waves(item.block.t[0], lines)[:, None]
        for slope, item in zip(slopes, recorded.items, strict=True)
    ]
    columns = pushing(recorded, "time-varying", path, pairs)
    gains = worths_of(start, columns, [range(2 * i, 2 * i + 2) for i in range(lines.size)])
    line = lines[int(np.argmax(gains))]
    forces = []
    for slope, item in zip(slopes, recorded.items, strict=True):
        t = item.block.t[0]
        both = np.concatenate(
            [slow(t), waves(t, line + np.array([-0.5, 0.0, 0.5]) / lasts)], axis=1
        )
        forces.append(slope[:, :, None] * both[:, None])
    found = pushing(recorded, "time-varying", path, forces, float(line))
    return replace(found, tried=lines.size)
