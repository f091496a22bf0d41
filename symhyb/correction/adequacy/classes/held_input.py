"""An input that is held: the machine sees a staircase, the recording the signal behind it."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.classes.columns import made_of, pushes
from symhyb.correction.adequacy.classes.erring_input import erring
from symhyb.correction.adequacy.classes.worth import Around, best_of, joined
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Generic
from symhyb.numeric.kernels.buffers import Array

LONGEST = 5  # samples that a hold lasts at most
KNOWN = 0.02  # of the staircase: how well its size is known


def held_input(start: Around, inputs: Sequence[int]) -> Generic:
    """The likeliest staircase, as it stands: it has no size of its own. Several inputs may be held
    together, by one clock."""
    holds = [(hold, first) for hold in range(1, LONGEST + 1) for first in range(hold)]
    options = [
        joined([_staircase(start.recorded, which, hold, first) for which in inputs])
        for hold, first in holds
    ]
    names = [start.recorded.windows.machine.model.inputs[which].name for which in inputs]
    return replace(best_of(start, options), other=" and ".join(names[1:]))


def _staircase(recorded: Recorded, which: int, hold: int, first: int) -> Generic:
    """What an input held for so many samples from the ``first`` on adds to its record."""
    channel = recorded.windows.machine.model.inputs[which]
    after, before = [], []
    for u, _ in pushes(recorded, which):
        jumps = _steps(u, hold, first, channel.between == "smooth")
        after.append(jumps[0][:, None])
        before.append(jumps[1][:, None])
    each = erring(recorded, which, after, before)
    made = made_of(recorded, "input", channel.name, each, hold * recorded.step_s)
    size, mean = np.array([KNOWN]), np.array([1 / KNOWN])
    return replace(made, spread=size, mean=mean, does="holds")


def _steps(values: Array, hold: int, first: int, bent: bool) -> tuple[Array, Array]:
    """What a staircase adds to the line through the samples, after and before each sample (N,); to
    a ``bent`` curve through them, whose mean between two samples lies h²u''/12 off the line."""
    at = np.arange(values.size)
    stood = values[np.maximum(at - (at - first) % hold, 0)]
    if bent:
        curved = np.pad(np.diff(values, 2), 1, mode="edge") / 12
        stood = stood + 0.5 * (curved + np.append(curved[1:], curved[-1:]))
    return stood - values, np.append(stood[:1], stood[:-1]) - values
