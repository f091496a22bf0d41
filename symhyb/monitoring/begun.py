"""Where a watch begins: the machine as it is, from a stretch of its recording."""

from dataclasses import dataclass

import numpy as np

from symhyb.data.recording import Recording
from symhyb.data.thin import stretch
from symhyb.errors import InputError, Problem
from symhyb.model.types import Model
from symhyb.monitoring.changes import Block, Reference, level, reference_of
from symhyb.monitoring.gauge import Gauge, block_of, gauge_of

REFERENCE_BLOCKS = 20  # that a reference has at least


@dataclass(frozen=True, slots=True, eq=False)
class Begun:
    """The machine as it is: the ``gauge`` that blocks of so many ``rows`` are reduced with, the
    ``reference``, and the probability (``least``) at which a test of one block is an alarm."""

    gauge: Gauge
    rows: int
    reference: Reference
    least: float


def begun(model: Model, piece: Recording, false_alarms: float, name: str) -> Begun:
    """A reference from a recording of the machine as it is; ``false_alarms`` a day are allowed.

    Raises:
        InputError: as :func:`~symhyb.monitoring.gauge.gauge_of`, or the recording holds too few
            blocks.
    """
    gauge = gauge_of(model, piece)
    step = float(np.median(np.diff(piece.t)))
    rows = int(np.ceil(gauge.block_s / step)) + 1
    blocks: list[Block] = []
    for first in range(0, len(piece) - rows + 1, rows):
        block = block_of(gauge, stretch(piece, slice(first, first + rows)))
        if block is not None:
            blocks.append(block)
    if len(blocks) < REFERENCE_BLOCKS:
        need = REFERENCE_BLOCKS * rows * step
        text = (
            f"a reference of {piece.duration:g} s holds {len(blocks)} whole blocks; at "
            f"least {REFERENCE_BLOCKS} are needed, which take {np.ceil(need):g} s"
        )
        raise InputError(Problem(text, file=name))
    reference = reference_of(blocks)
    return Begun(gauge, rows, reference, level(false_alarms, gauge.block_s, reference))
