"""What laws of a pair of coordinates do along the recordings, for one SI unit of their number.

Sizes: N samples, n coordinates.
"""

import numpy as np

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws import LAWS
from symhyb.laws.maths import Motion
from symhyb.model.types import Pair
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array

PAIR_LAWS = tuple(law for law in LAWS if law.coupling is not None)


def coupled(kind: str, pair: Pair) -> Hypothesis:
    """A law of a pair as a cause."""
    return Hypothesis(kind, pair, KINDS[kind].strengths, (False,))


def pair_forces(recorded: Recorded, cause: Hypothesis) -> list[Array]:
    """The generalized force (N, n) of a law of two coordinates along every stretch, SI."""
    law, pair = KINDS[cause.kind], cause.place
    assert law.coupling is not None
    assert isinstance(pair, Pair)
    machine = recorded.windows.machine
    names = [c.name for c in machine.model.coordinates]
    places = [names.index(on.coordinate) for on in pair.each]
    found = []
    for item in recorded.items:
        course, rows = item.course(machine), item.rows[0]
        a, b = (Motion(course.q[rows, i], course.v[rows, i], (), course.t[rows]) for i in places)
        forces = np.zeros((rows.size, len(names)))
        for i, push in zip(places, law.coupling(a, b, {cause.keys[0]: 1.0}).push, strict=True):
            forces[:, i] = push
        found.append(forces)
    return found


def pair_size(recorded: Recorded, cause: Hypothesis) -> float:
    """The number of a law of a pair, SI, at which it would make the force that moves one of the two
    coordinates; 0 where it pushes neither."""
    forces = np.concatenate(pair_forces(recorded, cause))
    share = float(np.max(np.sqrt(np.mean(forces**2, axis=0)) / recorded.scale_or_inf[:, 0]))
    return 1 / share if share > 0 else 0.0
