"""How much of what acts beyond a decided structure another one explains."""

from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.judgement import MOST, NEGLIGIBLE
from symhyb.numeric.kernels.buffers import Array


class Decided(NamedTuple):
    """The decided structure, its ``remainder`` (2,), dimensionless, and whether a force ``acts``
    beyond it."""

    structure: Fitted
    remainder: Array
    acts: bool

    def may_leave(self, trial: Fitted, share: float) -> Array:
        """The remainder (2,), dimensionless, that a structure with a class may leave to explain all
        but a ``share`` of what acts beyond; where nothing does, one that needs fewer causes as much
        as the decided one."""
        fewer = not {*self.structure.causes} <= {*trial.causes}
        part = 1.0 if fewer and not self.acts else share
        return np.maximum(part * self.remainder, NEGLIGIBLE**2)

    def explained_by(self, ground: Recorded, trial: Fitted, share: float) -> bool:
        """Whether a structure explains all but a ``share`` of what acts beyond the decided one."""
        return bool(np.all(remainder(ground, trial) <= self.may_leave(trial, share)))


def decided(ground: Recorded, base: Fitted, acts: bool) -> Decided:
    """A decided structure, with what it leaves."""
    return Decided(base, remainder(ground, base), acts)


def remainder(ground: Recorded, trial: Fitted) -> Array:
    """The power of the unknown force over that of what moves the coordinates, and of the colour of
    the sensors over that of what they show (2,), dimensionless: as the likelihood says, and as the
    sensors show it. The first alone does not compare forces of different memory: that of one
    without memory is spread over all frequencies, and most of it moves nothing."""
    if trial.fit.reason:
        return np.full(2, np.inf)
    noise, fit = trial.fit.noise, trial.fit
    rows = ((noise.force, noise.colour), (fit.force, fit.colour))
    return np.array([_power(ground, *row) for row in rows])


def forces_left(ground: Recorded, trial: Fitted) -> float:
    """The power of the unknown force alone over that of what moves the coordinates."""
    return _power(ground, trial.fit.noise.force, np.zeros_like(trial.fit.noise.colour))


def _power(ground: Recorded, force: Array, colour: Array) -> float:
    """The power of forces (n,) over that of what moves the coordinates, and of a colour (m,) over
    that of what the sensors show."""
    relative = force / ground.scale_or_inf[:, 0]
    return float(np.sum(relative**2) + np.sum((colour / ground.shown) ** 2))


def may_take(ground: Recorded, start: Fitted, pushes: frozenset[int] | None) -> bool:
    """Whether what ``pushes`` these coordinates alone, None for what is no force or pushes all,
    could take half of the unknown force beside a structure."""
    noise = start.fit.noise
    if pushes is None or noise.coloured:
        return True
    power = (noise.force / ground.scale_or_inf[:, 0]) ** 2
    return bool(power[list(pushes)].sum() >= MOST * power.sum())
