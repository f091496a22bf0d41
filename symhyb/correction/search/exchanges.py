"""Exchanges of causes that the linear problem along a structure's simulation favours.

One Gram matrix along the simulation answers for every exchange: a cause that goes puts its effect
back into the residual, those that stay may move, and any others may come.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from symhyb.correction.search.score import choice_of, left, piece_of, samples
from symhyb.correction.search.selection import (
    Problem,
    Subset,
    best_subsets,
    many,
    solve,
    without,
)
from symhyb.correction.search.setting import effects, exchanged
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Row, Trials, first_guess
from symhyb.discrepancy.places.hypotheses import Hypothesis, families_of
from symhyb.judgement import CLOSE, MOST
from symhyb.laws.friction_dynamic import STATIC_FIRST

OUT, IN = 2, 2  # causes that go, and that come, at once; not two for two
TRIED = 8  # exchanges of one structure that are refined, the most promising


@dataclass(frozen=True, slots=True)
class Offer:
    """A structure in place of another one: the numbers of its ``causes``, and ``rows`` of values,
    by key, SI, at which their fit begins; what it takes off χ² as the linear problem has it
    (``taken``), the ``price`` of what it has more, and the ``unit`` of the score."""

    causes: tuple[int, ...]
    rows: tuple[Row, ...]
    taken: float
    price: float
    unit: float = 1.0

    @property
    def gain(self) -> float:
        """By how much the score is expected to fall."""
        return self.taken / self.unit - self.price


def exchanges(trials: Trials, base: Refined, as_predicted: bool = False) -> Iterator[Offer]:
    """The most promising exchanges of a fitted structure, best first, one for each set of laws
    whatever their shapes. They are valued in the unit of what the structure leaves, or
    ``as_predicted``: of what the best of them would leave."""
    found, unit = list(_all(trials, base)), piece_of(base)
    if as_predicted and found:
        share = max(offer.taken for offer in found) / left(base)
        unit = max(unit * (1 - share), 1.0)  # of white noise at least
    offered = sorted((replace(offer, unit=unit) for offer in found), key=lambda o: -o.gain)
    lenient = not (as_predicted or many(base.causes))
    seen: set[object] = set()
    for offer in offered:
        if offer.gain <= (-max(MOST * offer.price, CLOSE) if lenient else 0.0):
            continue
        families = families_of([trials.known[cause] for cause in offer.causes])
        if families not in seen:
            seen.add(families)
            yield offer
        if len(seen) == TRIED:
            return


def _all(trials: Trials, base: Refined) -> Iterator[Offer]:
    along = trials.along(base)
    parts = effects(trials.setting, base, along)
    still = solve(exchanged(along, parts, ()), ())
    if still is None:
        return
    own, rows = trials.causes(base), grouped(base)
    number, choice = np.log(samples(base)), choice_of(trials.count)
    few = not many(own)
    for leaving in range(min(OUT if few else 1, len(own)) + 1):
        for out in combinations(range(len(own)), leaving):
            gone = [base.causes[i] for i in out]
            stay = [i for i in range(len(own)) if i not in out]
            problem = _open(
                trials, exchanged(along, parts, out), [base.causes[i] for i in stay], gone
            )
            kept = {own[i] for i in stay}
            for sized in best_subsets(problem, IN if leaving < OUT else 1)[1:]:
                apart = [subset for subset in sized if not kept & {*subset.causes}]
                for subset in distinct(problem, apart)[:TRIED]:
                    more = subset.numbers - sum(cause.numbers for cause in gone)
                    price = more * number + (len(subset.causes) - leaving) * choice
                    taken = still.chi2 + still.held - subset.chi2 - subset.held
                    fresh = _begun(problem, subset, gone, [rows[i] for i in out])
                    yield Offer(
                        (*(own[i] for i in stay), *subset.causes),
                        (*(rows[i] for i in stay), *fresh),
                        float(taken),
                        float(price),
                    )


def _open(
    trials: Trials, problem: Problem, kept: Sequence[Hypothesis], gone: Sequence[Hypothesis]
) -> Problem:
    """The problem in which what is ``gone``, and the terms of what is ``kept``, cannot come
    again; but further branches of a ladder can."""
    held = {term for cause in kept for term in _terms(cause) if not cause.several}
    barred = {
        c
        for c, cause in enumerate(problem.hypotheses)
        if cause in gone
        or (cause.several and cause in kept)
        # the column of a parameter that is kept is its own
        or ((cause.place is not None or cause not in kept) and held.intersection(_terms(cause)))
    }
    return without(problem, barred | trials.dropped)


def _terms(cause: Hypothesis) -> set[tuple[object, str]]:
    """The terms of a cause, each with what it is a law of."""
    return {(cause.subject, term) for term in cause.terms}


def _begun(
    problem: Problem, subset: Subset, gone: Sequence[Hypothesis], rows: Sequence[Row]
) -> list[Row]:
    """First guesses of the causes of a subset; a variant begins at the plain law in whose place it
    comes."""
    found: list[Row] = list(first_guess(problem, subset))
    for i, index in enumerate(subset.causes):
        cause = problem.hypotheses[index]
        for plain, row in zip(gone, rows, strict=True):
            if cause.variant and not plain.variant and cause.extends(plain):
                terms = [row.get(term, 0.0) for term in cause.terms]
                if "static" in cause.terms:
                    terms[cause.terms.index("static")] = STATIC_FIRST * row["coulomb"]
                kept = {key: value for key, value in row.items() if key in cause.keys}
                found[i] = {**cause.values(terms), **kept}
    return found


def distinct(problem: Problem, subsets: Sequence[Subset]) -> list[Subset]:
    """The first of every set of subsets that differ in the shapes of their laws alone."""
    first: dict[frozenset[object], Subset] = {}
    for subset in subsets:
        family = frozenset(problem.hypotheses[cause].family for cause in subset.causes)
        first.setdefault(family, subset)
    return list(first.values())
