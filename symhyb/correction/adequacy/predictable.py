"""Whether what a structure leaves of the sensors is noise, or follows from its own past.

Probabilities compare structures that were tried, and one of them is always the best. Innovations
are white where the likelihood knows how everything acts that acts; where they are not, none of the
structures may be right (Ljung & Box, Biometrika 65, 1978; Ljung, System Identification, 2nd ed.,
sec. 16.6).
"""

from collections.abc import Sequence

import numpy as np

from symhyb.correction.adequacy.channel_noise import innovations
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely, tracks_of
from symhyb.discrepancy.fitting.whiteness import LAGS_MOST
from symhyb.judgement import CHANCE, NOTABLE
from symhyb.numeric.kernels.buffers import Array

LAG_LEAST = 20  # samples a lag: of fewer the statistic of white noise has heavier tails than χ²


def with_whiteness(
    recorded: Recorded, classes: Sequence[Likely], trials: Sequence[Fitted]
) -> list[Likely]:
    """The classes, with whether the likeliest structure that has each leaves noise."""
    fits = [likeliest_with(one.generic, trials) for one in classes]
    pairs = zip(classes, fits, strict=True)
    return [one._replace(white=leaves_noise(recorded, fit)) for one, fit in pairs]


def likeliest_with(generic: Generic, trials: Sequence[Fitted]) -> Fitted:
    """The likeliest of the structures that have a class."""
    having = [trial for trial in trials if trial.extra and trial.extra.key == generic.key]
    return max(having, key=lambda trial: trial.evidence)


def leaves_noise(recorded: Recorded, trial: Fitted) -> bool:
    """Whether the innovations of every sensor are white beside a structure: no significant part of
    their power is predicted by their own past, or none that is worth a word."""
    white = innovations(trial.fit.noise, tracks_of(recorded, trial))
    return not any(_follows_from_its_past(column) for column in white.T)


def _follows_from_its_past(values: Array) -> bool:
    """Whether white residuals (N,), dimensionless, NaN where nothing was measured, are correlated
    by more than chance, and by more than is worth a word of their power."""
    from scipy.special import gammaincc

    seen = np.isfinite(values)
    count = int(seen.sum())
    most = min(LAGS_MOST, count // LAG_LEAST)
    centred = np.where(seen, values - (values[seen].mean() if count else 0.0), 0.0)
    if most < 1 or not np.any(centred):
        return False
    by_lag = np.array([centred[lag:] @ centred[:-lag] for lag in range(1, most + 1)])
    squares = (by_lag / (centred @ centred)) ** 2
    statistic = count * (count + 2) * float(np.sum(squares / (count - np.arange(1, most + 1))))
    by_chance = float(gammaincc(most / 2, statistic / 2))
    return by_chance < CHANCE and (statistic - most) / count > NOTABLE
