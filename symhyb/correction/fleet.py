"""Several recordings at once: what each has its own value of, and one that does not fit the others.

Structure is shared, and so are the values, but for those that are named as each recording's own.
Whether a recording belongs to the others is asked of the values: the found structure is fitted to
every recording alone, and each is held against the others together, weighed by their inverse
covariances (what a fit without it would say, to first order).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2 as chi_square

from symhyb.correction.setting import Stage
from symhyb.correction.trajectory import Refined, grouped, keys_of, refine
from symhyb.discrepancy.hypotheses import Hypothesis
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.buffers import Array

ODDS = 1e-3  # of naming any recording of a fleet in which all agree
SIZE = 0.1  # of the others' value: a smaller difference is not worth a name
WINDOWS_LEAST = 2  # of a recording that is fitted alone


def check_own(model: Model, own: Sequence[str]) -> None:
    """See that each name is a parameter of the model or a key of a law.

    Raises:
        InputError: names that are neither.
    """
    parameters = {item.path for item in model.parameters}
    parameters |= {p.path for element in model.elements for p in element.parameters}
    keys = {key.name for kind in KINDS.values() for key in kind.keys}
    known = sorted(parameters | keys)
    wrong = [name for name in own if name not in known]
    if wrong:
        raise InputError(
            Problem(
                f"own: '{name}' is neither a parameter of the model nor a key of a law"
                f"{did_you_mean(name, known)}"
            )
            for name in wrong
        )


def owning(
    model: Model, causes: Sequence[Hypothesis], own: Sequence[str]
) -> tuple[Hypothesis, ...]:
    """The causes with the keys that each recording has its own value of.

    A name of the model means its parameter, which then competes whether it states an sd or not.
    """
    parameters = {item.path: item for item in model.parameters}
    parameters |= {p.path: p for element in model.elements for p in element.parameters}
    result = []
    for cause in causes:
        if cause.place is None:
            mine: tuple[str, ...] = ("value",) if cause.path in own else ()
        else:
            mine = tuple(key for key in cause.keys if key in own and key not in parameters)
        result.append(replace(cause, own=tuple(dict.fromkeys((*cause.own, *mine)))))
    told = {cause.path for cause in causes}
    if not any(cause.place is None for cause in causes):
        return tuple(result)
    return (
        *(
            Hypothesis(
                "parameter", None, ("value",), (item.value > 0,), path=path, own=("value",)
            )
            for path, item in parameters.items()
            if path in own and path not in told
        ),
        *result,
    )


@dataclass(frozen=True, slots=True)
class Stranger:
    """A recording (its index) that does not fit the others: the number in which it differs most
    (index of the cause, key), its own value and that of the others, each with one sd, SI;
    ``chance`` is how often a recording that belongs would differ as much."""

    recording: int
    cause: int
    key: str
    value: tuple[float, float]
    others: tuple[float, float]
    chance: float


def stranger(model: Model, final: Refined, stage: Stage, sd: Array) -> Stranger | None:
    """The recording that differs most from the others in shared numbers, if any does beyond
    chance and by more than a tenth.

    Of two recordings, neither is the stranger; then the second is given, beside the first.
    """
    apart = [i for i, item in enumerate(stage.laid) if len(item.start) >= WINDOWS_LEAST]
    if len(apart) < 2 or not final.causes:
        return None
    shared = [(i, key) for i, cause in enumerate(final.causes) for key in keys_of(cause)]
    rows = [n for n, (i, key) in enumerate(shared) if key not in final.causes[i].own]
    fits = {i: _alone(model, final, stage, sd, i) for i in apart}
    known = {
        i: (trial.fit.values[rows], trial.fit.covariance[np.ix_(rows, rows)])
        for i, trial in fits.items()
        if not trial.fit.reason and np.isfinite(trial.fit.covariance).all()
    }
    if len(known) < 2 or not rows:
        return None
    found: Stranger | None = None
    for i, (value, covariance) in known.items():
        rest, spread = _joined([pair for j, pair in known.items() if j != i])
        offset = value - rest
        distance = float(offset @ np.linalg.pinv(covariance + spread, hermitian=True) @ offset)
        chance = float(chi_square.sf(distance, len(rows)))
        size = np.abs(offset) / np.sqrt(np.diag(covariance + spread))
        worth = np.abs(offset) > SIZE * np.abs(rest)
        if chance * len(known) > ODDS or not worth.any():
            continue
        n = int(np.argmax(np.where(worth, size, 0.0)))
        told = Stranger(
            i, *shared[rows[n]],
            (float(value[n]), float(np.sqrt(covariance[n, n]))),
            (float(rest[n]), float(np.sqrt(spread[n, n]))), chance,
        )  # fmt: skip
        if found is None or chance < found.chance or _further(told, found):
            found = told
    return found


def _further(one: Stranger, other: Stranger) -> bool:
    """Of two whose chance is nought in floating point, the one that is further off."""
    if one.chance > other.chance:
        return False
    first, second = (abs(s.value[0] - s.others[0]) / abs(s.others[0] or 1.0) for s in (one, other))
    return first > second


def _alone(model: Model, final: Refined, stage: Stage, sd: Array, which: int) -> Refined:
    """The structure fitted to all windows of one recording."""
    recording = stage.laid[which].source[0]
    start = [_first(row, recording.name) for row in grouped(final)]
    return refine(model, final.causes, start, (stage.laid[which],), sd, everything=True)


def _first(row: Mapping[str, float], name: str) -> dict[str, float]:
    """The values of a cause to begin with in one recording, its own ones where it has them."""
    shared = {key: value for key, value in row.items() if "@" not in key}
    return {key: row.get(f"{key}@{name}", value) for key, value in shared.items()}


def _joined(pairs: Sequence[tuple[Array, Array]]) -> tuple[Array, Array]:
    """The mean of several estimates, weighed by their inverse covariances, and its covariance."""
    weights = [np.linalg.pinv(covariance, hermitian=True) for _, covariance in pairs]
    spread = np.linalg.pinv(np.sum(weights, axis=0), hermitian=True)
    total = np.sum([w @ value for w, (value, _) in zip(weights, pairs, strict=True)], axis=0)
    return spread @ total, spread
