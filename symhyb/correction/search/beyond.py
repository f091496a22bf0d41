"""Structures beyond the first list: variants of a law, further lines, products as the last resort.

Each is tried only where what was found leaves more than noise.
"""

from collections.abc import Collection, Iterator

from symhyb.correction.search.evidence import (
    HOPE,
    NEAR_NOISE,
    SIGNIFICANT,
    believable,
    criterion,
    earns,
    price,
    unit_of,
    weak,
)
from symhyb.correction.search.kin import variants_of
from symhyb.correction.search.last_resort import beside, candidates, instead
from symhyb.correction.search.overtones import overtones
from symhyb.correction.search.selection import reach, solve
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Trials, first_guess
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.friction_dynamic import STATIC_FIRST
from symhyb.model.types import Place


def deeper(trials: Trials, winner: Refined, place: Place | None = None) -> Iterator[Refined]:
    """The winner with one law (at ``place``, where one is given) replaced by a variant with a key
    more, where something is left; the variant that fits best first."""
    if winner.fit.scale < NEAR_NOISE:
        return
    tried = []
    for i, cause in enumerate(winner.causes):
        if place is not None and cause.place != place:
            continue
        for other, row in variants_of(trials.setting, cause, grouped(winner)[i]):
            rows = [*grouped(winner)[:i], row, *grouped(winner)[i + 1 :]]
            causes = [*winner.causes[:i], other, *winner.causes[i + 1 :]]
            indices = [trials.index(c) for c in causes]
            trial = trials.refined(indices, rows, winner.fit.starts)
            tried += [trial, *lean(trials, trial, other)]
    yield from sorted(tried, key=lambda trial: trial.fit.train)


def variants(
    trials: Trials, winner: Refined, only: Collection[int] | None = None
) -> Iterator[Refined]:
    """The winner with one plain law replaced by a variant (one of ``only``), first without what
    stood in for the key more; where hardly more than noise is left, only if the linear
    problem along the winner's simulation lets it reach something."""
    for i, cause in enumerate(winner.causes):
        for c, other in enumerate(trials.setting.hypotheses):
            if not bends(other, cause) or (only is not None and c not in only):
                continue
            if not _worth_it(trials, winner, c, other.numbers - cause.numbers):
                continue
            rows = grouped(winner)
            plain = [rows[i].get(term, 0.0) for term in other.terms]
            if "static" in other.terms:
                plain[other.terms.index("static")] = STATIC_FIRST * rows[i]["coulomb"]
            kept = {key: value for key, value in rows[i].items() if key in other.keys}
            rows[i] = {**other.values(plain), **kept}
            causes = [*winner.causes[:i], other, *winner.causes[i + 1 :]]
            trial = trials.refined([trials.index(c) for c in causes], rows, winner.fit.starts)
            yield from lean(trials, trial, other)
            yield trial


def twin_variants(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """The winner with a parameter replaced by a variant of the law that it is the twin of (a
    damping that may be estimated, by a damper that differs by direction); first without those that
    stood in for what the variant has more. Tried as those of laws are."""
    hypotheses, twins = trials.setting.hypotheses, trials.twins
    for i, cause in enumerate(trials.causes(winner)):
        if winner.causes[i].place is not None:
            continue
        laws = [hypotheses[law] for named, law in twins if named == cause]
        offered = [
            c
            for c, other in enumerate(hypotheses)
            if any(bends(other, law) for law in laws)
            and _worth_it(trials, winner, c, other.numbers - 1)
        ]
        if not offered:
            continue
        causes = [c for c in trials.causes(winner) if c != cause]
        rows = [row for j, row in enumerate(grouped(winner)) if j != i]
        smaller = trials.refined(causes, rows, winner.fit.starts)
        problem = trials.along(smaller)
        for c in offered:
            subset = solve(problem, (c,))
            if subset is None or smaller.fit.reason:
                continue
            values = [*rows, *first_guess(problem, subset)]
            trial = trials.refined((*causes, c), values, smaller.fit.starts)
            yield from lean(trials, trial, hypotheses[c])
            yield trial


def _worth_it(trials: Trials, winner: Refined, cause: int, more: int) -> bool:
    """Whether a variant with so many numbers ``more`` may be worth a trial: where hardly more than
    noise is left, only if the linear problem along the winner's simulation lets it reach that."""
    if not winner.fit.scale < NEAR_NOISE:
        return True
    needed = SIGNIFICANT + price(winner, more, 0, 1)
    return reach(trials.along(winner), cause) / unit_of(winner) > HOPE * needed


def bends(other: Hypothesis, plain: Hypothesis) -> bool:
    """Whether a cause is a variant of a plain law."""
    return other.variant and not plain.variant and other.extends(plain)


def more_lines(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """The winner with one or two lines more, where it has one: also where hardly more than noise
    is left, for what is fast looks like noise to the smoothing that measures it."""
    for lines, rows in overtones(trials.setting, winner):
        indices = (*trials.causes(winner), *map(trials.index, lines))
        yield trials.refined(indices, [*grouped(winner), *rows], winner.fit.starts)


def lean(trials: Trials, trial: Refined, kept: Hypothesis | None = None) -> Iterator[Refined]:
    """The structure without the causes that do not stand out: they stood in for a key of the
    law that is ``kept``, or were surrogates of it."""
    gone = {i for i in weak(trial) if trial.causes[i] != kept}
    if gone and not trial.fit.reason:
        rows = [row for i, row in enumerate(grouped(trial)) if i not in gone]
        causes = [cause for i, cause in enumerate(trials.causes(trial)) if i not in gone]
        yield trials.refined(causes, rows, trial.fit.starts)


def last_resort(trials: Trials, winner: Refined, nothing: Refined, log: list[str]) -> Refined:
    """Where the laws that have a name leave more than noise: the winner with one product more, or
    a product alone, if that explains the recordings down to their noise; else the winner."""
    if winner.fit.scale < NEAR_NOISE:
        return winner
    book = candidates(trials.setting)
    tried: list[Refined] = []
    for base, offered in (
        (winner, beside(trials.setting, book, winner)),
        (nothing, instead(trials.setting, book, nothing)),
    ):
        for cause, row in offered:
            indices = (*trials.causes(base), trials.index(cause))
            starts = base.fit.starts if base is winner else None
            trial = trials.refined(indices, [*grouped(base), row], starts)
            tried += [trial, *lean(trials, trial, cause)]
    fitting = [trial for trial in filter(believable, tried) if trial.fit.scale < NEAR_NOISE]
    for trial in sorted(fitting, key=lambda trial: criterion(trial, fitting[0])):
        earned, sentence = earns(trial, winner, trials.count + len(book.hypotheses))
        log.append(sentence)
        if earned:
            return _spared(trials, trial, log)
    return winner


def _spared(trials: Trials, winner: Refined, log: list[str]) -> Refined:
    """The winner without the causes that do not earn their place in it."""
    for i, cause in enumerate(trials.causes(winner)):
        rest = [c for c in trials.causes(winner) if c != cause]
        rows = [row for j, row in enumerate(grouped(winner)) if j != i]
        smaller = trials.refined(rest, rows, winner.fit.starts)
        earned, sentence = earns(winner, smaller)
        log.append(sentence)
        if not earned:
            return _spared(trials, smaller, log)
    return winner
