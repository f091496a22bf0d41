"""The structures that a search begins with: the subsets with the largest screening gain.

Where these do not explain the recordings, laws are compared at their best, with the numbers that
nobody knows exactly: a resistance that is off by 4 % carries long windows away from the recording
whatever else acts, so that the right law seems to explain nothing. And the best subset of
each window length is tried: a law that jumps is linear along short windows alone.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.search.exchanges import distinct
from symhyb.correction.search.score import choice_of, samples
from symhyb.correction.search.selection import Problem, Subset, best_subsets, solve
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.search.trials import Row, Trials, first_guess
from symhyb.judgement import MOST

BEGUN = 4  # structures of each size
LARGEST = 3  # causes of one of them
LAWS_MOST = 2  # beside all parameters that state an sd


def begun(
    trials: Trials, nothing: Refined, problem: Problem, pool: set[tuple[int, ...]]
) -> list[Subset]:
    """The subsets of the pool that the linear problem ranks first, a few of each size, the small
    ones first."""
    empty = solve(problem, ())
    found = [s for causes in sorted(pool) if (s := solve(problem, causes)) is not None]
    if empty is None or not found:
        return []
    unit = _unit(min(found, key=lambda subset: subset.left), nothing)
    gains = {s.causes: _gain(trials, nothing, empty, s, unit, 1.0) for s in found}
    able = [s for s in found if _gain(trials, nothing, empty, s, unit, MOST) > 0]
    ranked = sorted(able, key=lambda s: -gains[s.causes])
    each = [[s for s in ranked if len(s.causes) == many] for many in range(1, LARGEST + 1)]
    return [s for sized in each for s in distinct(problem, sized)[:BEGUN]]


def begun_along(
    trials: Trials, nothing: Refined, problems: Sequence[Problem]
) -> Iterator[tuple[tuple[int, ...], list[Row]]]:
    """Structures with all parameters that state an ``sd``, with their first guesses: no law beside
    them, and the one and the two that each of the linear ``problems`` favours most, if they pay for
    themselves; the small ones first."""
    numbers = _stated(problems[0])
    if not numbers:
        return
    yield numbers, [{"value": 0.0} for _ in numbers]
    free = [_however_small(problem, numbers) for problem in problems]
    seen: set[frozenset[object]] = set()
    for many in range(1, LAWS_MOST + 1):
        for problem in free:
            subset = _promised(trials, nothing, problem, numbers, many)
            if subset is None:
                continue
            family = frozenset(trials.known[cause].family for cause in subset.causes)
            whole = solve(problem, (*subset.causes, *numbers)) if family not in seen else None
            if whole is not None:
                seen.add(family)
                yield whole.causes, first_guess(problem, whole)


def _promised(
    trials: Trials, nothing: Refined, problem: Problem, numbers: Sequence[int], many: int
) -> Subset | None:
    """The subset of so many causes beside these parameters that leaves least, if its screening gain
    is large enough."""
    sizes = best_subsets(_with_parameters(problem, numbers), many)
    more = [one for one in sizes[many] if _apart(one, numbers)] if len(sizes) > many else []
    if not more:
        return None
    (empty, *_), (best, *_) = sizes[0], more
    promised = _gain(trials, nothing, empty, best, _unit(best, nothing), MOST) > 0
    return best if promised else None


def _apart(subset: Subset, numbers: Sequence[int]) -> bool:
    """Whether none of these parameters is chosen once more."""
    return not {*subset.causes} & {*numbers}


def _unit(best: Subset, nothing: Refined) -> float:
    """χ² per sample that the ``best`` subset leaves, of noise at least."""
    return max(best.left / samples(nothing), 1.0)


def _gain(
    trials: Trials, nothing: Refined, empty: Subset, subset: Subset, unit: float, paid: float
) -> float:
    """By how much the score is expected to fall with a subset of which a part of the price, 0 to 1,
    is ``paid``."""
    choices = len(subset.causes) * choice_of(trials.count)
    price = subset.numbers * np.log(samples(nothing)) + choices
    return float((empty.left - subset.left) / unit - paid * price)


def _stated(problem: Problem) -> tuple[int, ...]:
    """The causes that are parameters which state an sd, and may be chosen."""
    return tuple(
        i
        for i, cause in enumerate(problem.hypotheses)
        if cause.kind == "parameter"
        and all(problem.prior[c] > 0 and problem.upper[c] > 0 for c in problem.columns[i])
    )


def _however_small(problem: Problem, numbers: Sequence[int]) -> Problem:
    """The problem in which these parameters may change as little as they like."""
    least = problem.least.copy()
    least[[column for i in numbers for column in problem.columns[i]]] = 0.0
    return replace(problem, least=least)


def _with_parameters(problem: Problem, numbers: Sequence[int]) -> Problem:
    """The problem with these parameters in every subset."""
    columns = [column for i in numbers for column in problem.columns[i]]
    return replace(problem, always=(*problem.always, *columns))
