"""What noise tells of the channels: a colour that is no noise of a sensor, a force that is noise of
an input.

Coloured noise of a sensor explains what no force does, and so could hide a sensor that drifts or
freezes. Noise is stationary, faster than the motion and, its colour taken off, about normal.
An unknown force that does not know its last sample comes from how an input was recorded.
"""

from collections.abc import Iterator

import numpy as np
from scipy.stats import kurtosis

from symhyb.correction.adequacy.beyond import NEGLIGIBLE, Beyond
from symhyb.correction.adequacy.classes.crossing_input import spared_by
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import NOISE_FLOOR, Fitted, Generic, Likely, tracks_of
from symhyb.discrepancy.likelihood.horizon import maximised
from symhyb.discrepancy.likelihood.track import white_problem
from symhyb.numeric.kernels.buffers import Array

CERTAIN = 4.6  # of ln of the odds (100 to 1) that a sensor has a colour at all
FAST = 3.0  # samples: no force of a machine forgets as fast
BURSTS = 10.0  # excess kurtosis of innovations: 0 of normal noise, 3 of double exponential


def faulty_sensors(recorded: Recorded, trial: Fitted) -> tuple[Likely, ...]:
    """The sensors whose colour is no noise, each with the probability of the colour."""
    noise = trial.fit.noise
    if trial.fit.reason or not noise.coloured:
        return ()
    found = list(_faults(recorded, trial))
    if not found:
        return ()
    tracks = tracks_of(recorded, trial)
    steady, without = maximised(tracks, noise.without_colour(), NOISE_FLOOR * recorded.sd)
    price = 0.5 * np.log(max(trial.fit.count, 2)) * (noise.numbers - steady.numbers)
    gain = trial.fit.logl - without - price
    if gain < CERTAIN:
        return ()
    return tuple(Likely(generic, float(1 / (1 + np.exp(-gain)))) for generic in found)


def noisy_input(recorded: Recorded, left: Beyond) -> tuple[Likely, ...]:
    """The input of which the unknown force may be the noise: it has no memory, and acts nowhere
    else than this input does."""
    if not left.acts or left.memory_s > FAST * recorded.step_s:
        return ()
    acting = set(np.flatnonzero(left.share > NEGLIGIBLE))
    for j, one in enumerate(recorded.windows.machine.model.inputs):
        if not acting & set(spared_by(recorded, j)):
            generic = Generic("input", one.name, (), np.zeros(0), does="noisy")
            return (Likely(generic, left.probability),)
    return ()


def _faults(recorded: Recorded, trial: Fitted) -> Iterator[Generic]:
    noise = trial.fit.noise
    bursts = kurtosis(_innovations(recorded, trial), axis=0, nan_policy="omit")
    for j in np.flatnonzero(noise.colour):
        name = recorded.windows.machine.model.sensors[j].name
        if noise.colour_s > recorded.period_s:
            yield Generic("sensor", name, (), np.zeros(0), does="drifts")
        elif bursts[j] > BURSTS:
            yield Generic("sensor", name, (), np.zeros(0), does="jumps")


def _innovations(recorded: Recorded, trial: Fitted) -> Array:
    """The white residuals (N, m), NaN where nothing was measured."""
    parts = []
    for one in tracks_of(recorded, trial):
        white = white_problem(one, trial.fit.noise)[0].reshape(one.residual.shape)
        parts.append(np.where(one.seen, white, np.nan))
    return np.concatenate(parts)
