"""An input that is held: the machine sees a staircase, the recording the signal behind it."""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import pushes, pushing
from symhyb.correction.adequacy.classes.worth import Around, best_of
from symhyb.correction.adequacy.structure import Generic
from symhyb.numeric.kernels.buffers import Array

LONGEST = 5  # samples that a hold lasts at most
KNOWN = 0.02  # of the staircase: how well its size is known


def held_input(start: Around, which: int) -> Generic:
    """The likeliest staircase, as it stands: it has no size of its own."""
    recorded = start.recorded
    name = recorded.windows.machine.model.inputs[which].name
    options = []
    for hold in range(1, LONGEST + 1):
        for first in range(hold):
            after, before = [], []
            for u, push in pushes(recorded, which):
                jumps = _steps(u, hold, first)
                after.append(push[:, :, None] * jumps[0][:, None, None])
                before.append(push[:, :, None] * jumps[1][:, None, None])
            made = pushing(recorded, "input", name, after, hold * recorded.step_s)
            each = tuple(replace(one, before=b) for one, b in zip(made.each, before, strict=True))
            size, mean = np.array([KNOWN]), np.array([1 / KNOWN])
            options.append(replace(made, each=each, spread=size, mean=mean, does="holds"))
    return best_of(start, options)


def _steps(values: Array, hold: int, first: int) -> tuple[Array, Array]:
    """What a staircase adds to the line through the samples, after and before each sample (N,)."""
    at = np.arange(values.size)
    stood = values[np.maximum(at - (at - first) % hold, 0)]
    return stood - values, np.append(stood[:1], stood[:-1]) - values
