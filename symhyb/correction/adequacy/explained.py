"""How much of what acts beyond a decided structure another one explains."""

from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.judgement import NEGLIGIBLE


class Decided(NamedTuple):
    """The decided structure, its ``remainder``, and whether a force ``acts`` beyond it."""

    structure: Fitted
    remainder: float
    acts: bool

    def may_leave(self, trial: Fitted, share: float) -> float:
        """The remainder that a structure with a class may leave to explain all but a ``share`` of
        what acts beyond; where nothing does, one that needs fewer causes as much as the decided
        one."""
        fewer = not {*self.structure.causes} <= {*trial.causes}
        part = 1.0 if fewer and not self.acts else share
        return max(part * self.remainder, NEGLIGIBLE**2)


def remainder(ground: Recorded, trial: Fitted) -> float:
    """The power of the unknown force over that of what moves the coordinates, and of the colour of
    the sensors over that of what they show."""
    if trial.fit.reason:
        return np.inf
    return forces_left(ground, trial) + float(np.sum((trial.fit.noise.colour / ground.shown) ** 2))


def forces_left(ground: Recorded, trial: Fitted) -> float:
    """The power of the unknown force alone over that of what moves the coordinates."""
    return float(np.sum((trial.fit.noise.force / ground.scale_or_inf[:, 0]) ** 2))
