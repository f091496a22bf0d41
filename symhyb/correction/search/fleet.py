"""Several recordings at once: what each has its own value of, and one that does not fit the others.

Structure is shared, and so are the values, but for those that are named as each recording's own.
Whether a recording belongs to the others is asked of the values: the found structure is fitted to
every recording alone, and each is held against the others together, weighed by their inverse
covariances (what a fit without it would say, to first order).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtrc

from symhyb.correction.search.setting import Setting, Stage
from symhyb.correction.search.trajectory import Refined, element_name, grouped, keys_of, refine
from symhyb.data.groups import Own
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem, did_you_mean
from symhyb.judgement import CHANCE, FEWEST, OUTSTANDING, SMALL, SURE, UNEXPLAINED
from symhyb.model.types import Model
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array


def check_own(model: Model, own: Own) -> None:
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


def owning(model: Model, causes: Sequence[Hypothesis], own: Own) -> tuple[Hypothesis, ...]:
    """The causes with the keys that each recording, or each group of them, has its own value of.

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
        by = [(key, own[cause.path if cause.place is None else key]) for key in mine]
        grouped = tuple((key, grouping) for key, grouping in by if grouping)
        both = tuple(dict.fromkeys((*cause.own, *mine)))
        result.append(replace(cause, own=both, by=grouped))
    chosen = {cause.path for cause in causes}
    if not any(cause.place is None for cause in causes):
        return tuple(result)
    return (
        *(
            Hypothesis(
                "parameter",
                None,
                ("value",),
                (item.value > 0,),
                path=path,
                own=("value",),
                by=(("value", own[path]),) if own[path] else (),
            )
            for path, item in parameters.items()
            if path in own and path not in chosen
        ),
        *result,
    )


@dataclass(frozen=True, slots=True)
class Outlier:
    """A recording (its index) that does not fit the others: the number in which it differs most
    (index of the cause, key), its own value and that of the others, each with one sd, SI;
    ``distance`` is (x − y)ᵀ(C + D)⁻¹(x − y) over the shared numbers, ``chance`` how often a
    recording that belongs to the others would be as far. Where no number separates them, the
    cause is −1 and the values are χ² per sample. ``number`` is its place among those of the fit,
    ``owner`` the recording that is the first to have it, empty where all share it."""

    recording: int
    cause: int
    key: str
    value: tuple[float, float]
    others: tuple[float, float]
    distance: float
    chance: float
    number: int = -1
    owner: str = ""


@dataclass(frozen=True, slots=True)
class _Estimate:
    """Shared numbers (K,) of one recording fitted alone, their covariance (K, K), SI."""

    value: Array
    covariance: Array


def outliers(model: Model, final: Refined, stage: Stage, sd: Array) -> tuple[Outlier, ...]:
    """The recordings that do not fit the others, the worst first; less than half of them. Of two
    that differ neither is the outlier: the second is given, beside the first. ``sd`` (m,) is the
    noise of the sensors, SI."""
    keys = _shared(final)
    known = _each(model, final, stage, sd, [one.place for one in keys]) if keys else {}
    found: list[Outlier] = []
    while len(known) > 1 and len(found) < max((len(stage.cuts) - 1) // 2, 1):
        apart = [_against(i, known, keys, len(stage.cuts)) for i in known]
        worst = max((s for s in apart if s), key=lambda s: s.distance, default=None)
        if worst is None:
            break
        found.append(worst)
        del known[worst.recording]
    if found or len(stage.cuts) < FEWEST:
        return tuple(found)
    left = _unexplained(final, stage)
    return () if left is None else (left,)


class _Number(NamedTuple):
    """A number of a structure: its place among those of the fit, its cause and key, and the
    recording that is the first to have it where not all share it."""

    place: int
    cause: int
    key: str
    owner: str = ""


def _shared(final: Refined) -> list[_Number]:
    """The numbers that all recordings share."""
    numbers = [(i, cause, key) for i, cause in enumerate(final.causes) for key in keys_of(cause)]
    return [_Number(n, i, key) for n, (i, cause, key) in enumerate(numbers) if key not in cause.own]


def _numbers(final: Refined) -> list[_Number]:
    """All numbers but the phases that each recording has of its own."""
    numbers = [(i, key) for i, cause in enumerate(final.causes) for key in keys_of(cause)]
    found = {number.place: number for number in _shared(final)}
    for (recording, _), columns in zip(final.each, final.owned, strict=True):
        for n, (i, key) in zip(columns, numbers, strict=True):
            if key != "phase":
                found.setdefault(n, _Number(n, i, key, recording.name))
    return list(found.values())


def _each(
    model: Model, final: Refined, stage: Stage, sd: Array, rows: Sequence[int]
) -> dict[int, _Estimate]:
    """The shared numbers of every recording alone, where it determines them."""
    found = {}
    for i, item in enumerate(stage.cuts):
        if len(item.start) < 2:
            continue
        fit = _alone(model, final, stage, sd, i).fit
        covariance = fit.covariance[np.ix_(rows, rows)]
        if not fit.reason and np.isfinite(covariance).all():
            found[i] = _Estimate(fit.values[list(rows)], covariance)
    return found


def _against(
    which: int,
    known: Mapping[int, _Estimate],
    keys: Sequence[_Number],
    recordings: int,
) -> Outlier | None:
    """One recording against the others, if it differs beyond chance and by more than a tenth; of
    phases whole turns do not count."""
    mine, rest = known[which], _joined([other for i, other in known.items() if i != which])
    offset, spread = mine.value - rest.value, mine.covariance + rest.covariance
    turning = [one.key == "phase" for one in keys]
    offset = np.where(turning, np.remainder(offset + np.pi, 2 * np.pi) - np.pi, offset)
    rest = _Estimate(np.where(turning, mine.value - offset, rest.value), rest.covariance)
    distance = float(offset @ np.linalg.pinv(spread, hermitian=True) @ offset)
    chance = float(chdtrc(offset.size, distance))
    size = np.abs(offset) / np.sqrt(np.diag(spread))
    worth = (np.abs(offset) > SMALL * np.abs(rest.value)) & (size > OUTSTANDING)
    if chance * recordings > CHANCE or not worth.any():
        return None
    n = int(np.argmax(np.where(worth, size, 0.0)))
    own, others = (
        (float(one.value[n]), float(np.sqrt(one.covariance[n, n]))) for one in (mine, rest)
    )
    number = keys[n]
    return Outlier(
        which, number.cause, number.key, own, others, distance, chance, number.place, number.owner
    )


def _unexplained(final: Refined, stage: Stage) -> Outlier | None:
    """The recording in which the structure leaves more than in the others together, if one does
    beyond the deviation of a mean square, and beyond what the noise is known to."""
    sizes = [len(item.start) for item in stage.cuts]
    bounds = np.cumsum([0, *sizes])
    fit, worst = final.fit, None
    for i, (a, b) in enumerate(pairwise(bounds)):
        others = np.r_[0:a, b : bounds[-1]]
        mine, rest = (
            float(fit.chi2[rows].sum() / max(fit.count[rows].sum(), 1))
            for rows in (np.arange(a, b), others)
        )
        sd = [
            np.sqrt(2 * fit.correlation / max(fit.count[rows].sum(), 1)) * level
            for rows, level in ((np.arange(a, b), mine), (others, rest))
        ]
        deviation = float(np.hypot(*sd))
        if mine < UNEXPLAINED * max(rest, 1.0) or mine - rest < SURE * deviation:
            continue
        if worst is None or mine > worst.value[0]:
            distance = ((mine - rest) / deviation) ** 2
            worst = Outlier(
                i,
                -1,
                "",
                (mine, float(sd[0])),
                (rest, float(sd[1])),
                distance,
                float(chdtrc(1, distance)),
            )
    return worst


def drifting(model: Model, final: Refined, stage: Stage, sd: Array) -> Outlier | None:
    """The number that differs most between the first halves of the recordings (``others``) and the
    second (``value``), if one does beyond chance and by more than a tenth: a law that changes on
    the way is not the constant one that was fitted, whoever has it of its own. ``sd`` (m,) is the
    noise, SI."""
    keys = _numbers(final)
    if not keys or any(len(item.start) // 2 < 2 for item in stage.cuts):
        return None
    rows = [one.place for one in keys]
    known = {}
    for half in (0, 1):
        cuts = [item.chosen(_half(item, half)) for item in stage.cuts]
        start = [*grouped(final)]
        fit = refine(model, final.causes, start, cuts, sd, everything=True).fit
        covariance = fit.covariance[np.ix_(rows, rows)]
        if fit.reason or not np.isfinite(covariance).all():
            return None
        known[half] = _Estimate(fit.values[rows], covariance)
    return _against(1, known, keys, 1)


def _half(item: Cut, which: int) -> NDArray[np.int64]:
    """The windows of the first or the second half of a recording."""
    middle = len(item.start) // 2
    return np.arange(middle) if which == 0 else np.arange(middle, len(item.start))


def widened(final: Refined, odd: Outlier) -> Refined:
    """The structure with the deviation of the drifting number as wide as its two values lie apart,
    each weighed by its precision: half of that where both are known alike, and little where one
    half hardly determines it."""
    n = odd.number
    covariance = final.fit.covariance.copy()
    precise = np.array([1 / odd.value[1] ** 2, 1 / odd.others[1] ** 2])
    weight = precise / precise.sum()
    apart = float(weight.prod()) * (odd.value[0] - odd.others[0]) ** 2
    covariance[n, n] = max(covariance[n, n], apart)
    return replace(final, fit=replace(final.fit, covariance=covariance))


def without(setting: Setting, gone: Sequence[int]) -> Setting:
    """The setting without some recordings (their indices at the last stage)."""
    names = [setting.stages[-1].cuts[i].source[0] for i in gone]
    stages = [
        Stage(stage.length_s, tuple(item for item in stage.cuts if item.source[0] not in names))
        for stage in setting.stages
    ]
    return replace(setting, stages=tuple(stage for stage in stages if stage.cuts))


def parted(
    setting: Setting, selected: Refined, outlier: Outlier, rivals: Sequence[Hypothesis] = ()
) -> Setting:
    """The setting in which the number that differs is each recording's own; of ``rivals`` that may
    take its cause's place, the strength."""
    differs = selected.causes[outlier.cause]
    keys = {(cause.kind, cause.place, cause.path): keys_of(cause)[0] for cause in rivals}
    keys[differs.kind, differs.place, differs.path] = outlier.key

    def own(cause: Hypothesis) -> Hypothesis:
        key = keys.get((cause.kind, cause.place, cause.path))
        if key is None or key not in keys_of(cause) or key in cause.own:
            return cause
        return replace(cause, own=(*cause.own, key))

    library = replace(setting.library, hypotheses=tuple(map(own, setting.library.hypotheses)))
    return replace(setting, library=library, parametric=tuple(map(own, setting.parametric)))


def own_value(selected: Refined, outlier: Outlier) -> Outlier | None:
    """In what a recording differs from the other one, as a structure with own numbers has it; None
    if it has none."""
    for i, cause in enumerate(selected.causes):
        for key in keys_of(cause):
            if key in cause.own and key != "phase" and selected.owned:
                path = cause.path if cause.place is None else f"{element_name(i)}.{key}"
                which = outlier.recording
                value, others = (selected.value_of(path, j) for j in (which, 1 - which))
                return replace(outlier, cause=i, key=key, value=value, others=others)
    return None


def _alone(model: Model, final: Refined, stage: Stage, sd: Array, which: int) -> Refined:
    """The structure fitted to all windows of one recording."""
    recording = stage.cuts[which].source[0]
    start = [_first(row, recording.name) for row in grouped(final)]
    return refine(model, final.causes, start, (stage.cuts[which],), sd, everything=True)


def _first(row: Mapping[str, float], name: str) -> dict[str, float]:
    """The values of a cause to begin with in one recording, its own ones where it has them."""
    shared = {key: value for key, value in row.items() if "@" not in key}
    return {key: row.get(f"{key}@{name}", value) for key, value in shared.items()}


def _joined(each: Sequence[_Estimate]) -> _Estimate:
    """The mean of several estimates, weighed by their inverse covariances."""
    weights = [np.linalg.pinv(one.covariance, hermitian=True) for one in each]
    spread = np.linalg.pinv(np.sum(weights, axis=0), hermitian=True)
    total = np.sum([w @ one.value for w, one in zip(weights, each, strict=True)], axis=0)
    return _Estimate(spread @ total, spread)
