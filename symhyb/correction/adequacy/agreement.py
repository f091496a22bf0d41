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
from scipy.special import ndtr, ndtri

from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.correction.search.trajectory import Refined, firsts_of, keys_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import MOST, OUTSTANDING


class Disputed(NamedTuple):
    """A cause whose strength depends on what else the structure holds: value and one deviation as
    ``claimed`` and as found by ``another`` estimator, SI; ``beside`` is the class that it had,
    ``recording`` one whose own strength it is, or its group's; empty where all share it."""

    cause: Hypothesis
    claimed: tuple[float, float]
    another: tuple[float, float]
    beside: Generic | None
    recording: str = ""


Strengths = dict[str, tuple[float, float]]
"""The strength of a cause and one deviation, SI, by the first recording that has it."""


def disputed(final: Refined, trials: Sequence[Fitted]) -> tuple[Disputed, ...]:
    """The causes of a structure that one of the trials gives another strength: off by more than the
    deviations allow, and by more than half of what is claimed, each with the first such trial; of
    strengths that not all recordings share any one, and by more than half of a typical one, too. A
    class that is a change of the same number says nothing of it; one that can hold a part of a law
    (a force of stretch and rate) speaks against the law where it takes that, not where it asks for
    more of it."""
    claimed, found = dict(_strengths(final)), dict[Hypothesis, Disputed]()
    for trial in trials:
        for cause, others in _strengths(trial):
            if cause not in claimed or cause in found or _same(trial, cause):
                continue
            mine, usual = claimed[cause], _usual(final, cause)
            sizes = [value - usual for value, _ in mine.values()]
            typical = float(np.sqrt(np.mean(np.square(sizes)))) if len(sizes) > 1 else 0.0
            least = -ndtri(ndtr(-OUTSTANDING) / len(mine))  # as the furthest of so many by chance
            for name in (one for one in mine if one in others):
                (own, own_sd), (value, sd) = mine[name], others[name]
                off, size = value - own, own - usual
                if may_hold(trial) and off * size > 0:
                    continue
                part = abs(off) > MOST * max(abs(size), typical)
                if part and abs(off) > least * np.hypot(sd, own_sd):
                    one = Disputed(cause, (own, own_sd), (value, sd), trial.extra, name)
                    found.setdefault(cause, one)
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


def _strengths(trial: Refined | Fitted) -> Iterator[tuple[Hypothesis, Strengths]]:
    """Each cause with its first number and one deviation; where not all recordings share it, that
    of each that is the first to have its own; of a curve the RMS of its values."""
    spread = np.sqrt(np.abs(np.diag(trial.fit.covariance)))
    for cause, first in zip(trial.causes, firsts_of(trial.causes), strict=True):
        if cause.points:
            own = slice(first, first + len(cause.unknown))
            values = np.asarray(trial.fit.values[own])
            covariance = trial.fit.covariance[own, own]
            size = float(np.sqrt(np.mean(values**2))) or 1e-300
            along = values / (size * values.size)
            variance = float(along @ covariance @ along)
            yield cause, {"": (size, float(np.sqrt(max(variance, 0.0))))}
            continue
        known = {first: ""}
        if keys_of(cause)[0] in cause.own and trial.owned:
            known = {}
            for (recording, _), columns in zip(trial.each, trial.owned, strict=True):
                known.setdefault(columns[first], recording.name)
        yield (
            cause,
            {name: (float(trial.fit.values[i]), float(spread[i])) for i, name in known.items()},
        )
