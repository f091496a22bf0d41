"""Posterior probabilities of fitted structures, and the classes that they make."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.structure import Fitted, Generic, Likely
from symhyb.judgement import CERTAIN, PROBABLE
from symhyb.numeric.kernels.buffers import Array


def weights(trials: Sequence[Fitted]) -> Array:
    """Posterior probabilities (T,), dimensionless."""
    scores = np.array([trial.evidence for trial in trials])
    weight = np.exp(np.maximum(scores - scores.max(), -700.0))
    return np.asarray(weight / weight.sum())


def ranked(trials: Sequence[Fitted], enough: Collection[object]) -> tuple[Likely, ...]:
    """The classes with their probabilities, the likeliest first; ``enough`` are those that explain
    all. What a sensor does may be what its input does: where the two cannot be distinguished, the
    input is named for both, but of a lag both are."""
    found: dict[object, Likely] = {}
    for trial, weight in zip(trials, weights(trials), strict=True):
        if trial.extra is not None:
            key = trial.extra.key
            known = found.get(key, Likely(trial.extra, 0.0, key in enough))
            found[key] = known._replace(probability=known.probability + float(weight))
    order = sorted(found.values(), key=lambda one: -one.probability)
    for i, one in enumerate(order[1:], 1):
        first = order[0]
        late = _lag_of_either(first.generic, one.generic)
        if late or (first.generic.kind == "sensor" and one.generic.kind in ("input", "lag")):
            if one.probability > first.probability * np.exp(-CERTAIN):
                both = one._replace(probability=one.probability + first.probability)
                both = both._replace(generic=late or one.generic)
                order = [both, *order[1:i], *order[i + 1 :]]
            break
    rounded = (one._replace(probability=min(one.probability, 1.0)) for one in order)
    return tuple(one for one in rounded if one.probability > 1 - PROBABLE)


def is_lag(generic: Generic) -> bool:
    """Whether a class is that of an input or of a sensor that lags."""
    return generic.kind == "lag" or generic.does == "lags"


def _lag_of_either(first: Generic, second: Generic) -> Generic | None:
    """The lag of an input or of a sensor, where one of the two classes is that and the other
    this."""
    for one, other in ((first, second), (second, first)):
        if one.kind == "lag" and other.does == "lags":
            return replace(one, sensors=(str(other.where),))
    return None
