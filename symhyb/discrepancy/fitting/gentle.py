"""Dry friction that turns over gently: where a fit begins.

A place that sticks keeps no trace of how it came there, so that along a trajectory that sticks at
the wrong time no small change of its start improves anything. Friction that is smoothed over a
hundredth of the largest speed has none of these minima; the initial states that fit with it lie
near those that fit with the steep law (continuation: Allgower & Georg, Numerical Continuation
Methods, 1990).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.recorded.windows import Cut, rates_of
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine

SHARE = 1e-2  # of the largest rate at the place, over which friction turns over


@dataclass(frozen=True, slots=True)
class Gentle:
    """Parameters ``p`` (P,), SI, with gentle friction; those ``kept`` (columns) mean nothing beside
    it: a level that falls with a speed at which such friction has hardly turned over."""

    p: Array
    kept: frozenset[int]


def gentle(machine: Machine, cuts: Sequence[Cut], p: Array) -> Gentle | None:
    """The parameters ``p`` (P,), SI, with gentle friction; None where none is steeper. Friction at
    a point stays as it is."""
    columns = {item.path: i for i, item in enumerate(machine.model.all_parameters())}
    softer, kept = p.copy(), []
    for i, element in enumerate(machine.model.elements):
        law = KINDS[element.kind]
        column = columns.get(f"{element.name}.{law.smoothed_over}") if law.smoothed_over else None
        if column is None:
            continue
        softer[column] = max(p[column], SHARE * _fastest(machine, cuts, i))
        own = [item.name for item in element.parameters]
        if any(key.above and key.above[0] == law.smoothed_over for key in map(law.key, own) if key):
            kept += [columns[f"{element.name}.{name}"] for name in own]
    return Gentle(softer, frozenset(kept)) if np.any(softer > p) else None


def _fastest(machine: Machine, cuts: Sequence[Cut], element: int) -> float:
    """The largest rate at the place of an element along the measured motion, SI; 0 at a point."""
    rates = [rates_of(machine, item.source[1])[0][:, element] for item in cuts]
    return max(float(np.abs(np.nan_to_num(rate)).max()) for rate in rates)
