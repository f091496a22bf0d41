"""Parameters whose values are known in one recording, in place of those of the model file.

A mass that is changed between two runs is no unknown: each run has its own known value of it, while
what is fitted is shared. Sizes: P parameters.
"""

from collections.abc import Mapping
from dataclasses import replace

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine

Known = Mapping[str, float]
"""Values by the path of a parameter of the model, SI."""


def with_known(machine: Machine, p: Array, known: Known) -> Array:
    """Parameters ``p`` (P,), or sets of them (C, P), SI, with what is known in place of it; ``p``
    itself if nothing is."""
    if not known:
        return p
    full = p.copy()
    full[..., [machine.column(path) for path in known]] = list(known.values())
    return full


def machine_with(machine: Machine, known: Known) -> Machine:
    """The machine with the values that are known; itself if nothing is."""
    if not known:
        return machine
    return replace(machine, values=with_known(machine, machine.values, known))
