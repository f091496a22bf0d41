"""Whether recordings contradict a structure that is the likelier one of all of them together.

What all recordings share is likelier in each. If a structure is right, another one is likelier by a
factor c in a recording with a probability of no more than 1/c, whatever the recording holds. So one
in which the other is likelier by 100 to 1 contradicts the structure. The evidence of all together
does not show that: where none of two structures is right, it is the sum of what some recordings say
for one and others for the other, in proportion to how far they are from either.

Source: Royall, Statistical Evidence, 1997, §1.4 (the bound of 1/c).
"""

import numpy as np

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.judgement import CERTAIN, SMALL
from symhyb.numeric.kernels.buffers import Array


def contradicted(ground: Recorded, trial: Fitted, base: Fitted) -> bool:
    """Whether the recordings that contradict a structure, each by 100 to 1 against the ``base``,
    take back more than a tenth of what the others say for it. A single recording cannot."""
    gains = gains_of(ground, trial, base)
    if gains.size == 1 or not np.isfinite(gains).all():
        return False
    against = -gains[gains < -CERTAIN].sum()
    return bool(against > SMALL * gains[gains > 0].sum())


def gains_of(ground: Recorded, trial: Fitted, base: Fitted) -> Array:
    """By how much ln L of each recording (R,), dimensionless, is larger with one structure than
    with another."""
    gains = np.zeros(1 + max(ground.recording))
    for which, more, less in zip(ground.recording, trial.fit.logls, base.fit.logls, strict=True):
        gains[which] += more - less
    return gains
