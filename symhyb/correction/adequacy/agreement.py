"""Whether a claimed strength is the same by another estimator: a specification test.

Of a cause that acts, every consistent estimator finds the same strength: trajectories of short
windows, innovations with an unknown force, and these with a generic class of what acts beyond. A
cause that only stands in for something else is another number as soon as that has a place of its
own: a load behind a play is an added mass of 0.35 kg, and of 1.8 kg beside a hidden mode.

Source: Hausman, Econometrica 46, 1978.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.correction.search.trajectory import Refined, firsts_of, keys_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import MOST, OUTSTANDING


class Disputed(NamedTuple):
    """A cause whose strength depends on what else the structure holds: value and one deviation as
    ``claimed`` and as found by ``another`` estimator, SI; ``beside`` is the class that it had."""

    cause: Hypothesis
    claimed: tuple[float, float]
    another: tuple[float, float]
    beside: Generic | None


def disputed(final: Refined, trials: Sequence[Fitted]) -> tuple[Disputed, ...]:
    """The causes of a structure that one of the trials gives another strength: off by more than the
    deviations allow, and by more than half of what is claimed, each with the first such trial. A
    class that is a change of the same number says nothing of it; one that can hold a part of a law
    (a force of stretch and rate) speaks against the law where it takes that, not where it asks for
    more of it."""
    claimed, found = dict(_strengths(final)), {}
    for trial in trials:
        for cause, (value, sd) in _strengths(trial):
            if cause not in claimed or cause in found or _same(trial, cause):
                continue
            own, own_sd = claimed[cause]
            off, size = value - own, own - _usual(final, cause)
            if may_hold(trial) and off * size > 0:
                continue
            if abs(off) > OUTSTANDING * np.hypot(sd, own_sd) and abs(off) > MOST * abs(size):
                found[cause] = Disputed(cause, (own, own_sd), (value, sd), trial.extra)
    return tuple(found.values())


def _same(trial: Fitted, cause: Hypothesis) -> bool:
    """Whether the class of a trial is the cause itself, but for its course in time."""
    return trial.extra is not None and trial.extra.where == cause.path


def may_hold(trial: Fitted) -> bool:
    """Whether the class of a trial may hold a part of a law."""
    return trial.extra is not None and trial.extra.kind == "law"


def _usual(final: Refined, cause: Hypothesis) -> float:
    """The strength, SI, at which there is no such cause: 0 of a law, else what the file states."""
    return 0.0 if cause.place else float(final.machine.values[final.machine.column(cause.path)])


def _strengths(trial: Refined | Fitted) -> Iterator[tuple[Hypothesis, tuple[float, float]]]:
    """Each cause whose strength all recordings share, with its first number and one deviation; of a
    curve the RMS of its values."""
    spread = np.sqrt(np.abs(np.diag(trial.fit.covariance)))
    for cause, first in zip(trial.causes, firsts_of(trial.causes), strict=True):
        if cause.points:
            own = slice(first, first + len(cause.unknown))
            values = np.asarray(trial.fit.values[own])
            covariance = trial.fit.covariance[own, own]
            size = float(np.sqrt(np.mean(values**2))) or 1e-300
            along = values / (size * values.size)
            variance = float(along @ covariance @ along)
            yield cause, (size, float(np.sqrt(max(variance, 0.0))))
        elif keys_of(cause)[0] not in cause.own:
            yield cause, (float(trial.fit.values[first]), float(spread[first]))
