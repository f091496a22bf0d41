"""Bent laws in place of several smooth laws of one speed, which may be the first terms of a series.

A loss that grows with the power 1.5 of the speed is drag, less damping than the model has, and a
cube, within the range that was seen. Each costs a number, and none of them is true.
"""

from collections.abc import Iterator

from symhyb.correction.search.selection import Problem, allowing, solve
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Row, Trials, first_guess
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.quantities import quantities, smooth
from symhyb.discrepancy.words.formula import LAW
from symhyb.model.types import Place

RATE = frozenset(("rate",))
STEPS = "tanh"  # in a formula that jumps


def instead_of_series(
    trials: Trials, base: Refined, problem: Problem
) -> Iterator[tuple[tuple[int, ...], list[Row]]]:
    """A structure with each bent law in place of the smooth laws of the speed at its place, and of
    the parameters that are the same as such a law, where these are several."""
    own, rows = trials.causes(base), grouped(base)
    laws = [_law(trials, cause) for cause in base.causes]
    for bent in sorted(trials.setting.bent):
        law = trials.setting.hypotheses[bent]
        gone = {i for i, one in enumerate(laws) if one is not None and _holds(one, law.place)}
        if len(gone) < 2:
            continue
        kept = [i for i in range(len(own)) if i not in gone]
        free = allowing(problem, {bent})
        if (alone := solve(free, (bent,))) is not None:
            yield (
                (*(own[i] for i in kept), bent),
                [*(rows[i] for i in kept), *first_guess(free, alone)],
            )


def _law(trials: Trials, cause: Hypothesis) -> Hypothesis | None:
    """A law at a place: the cause itself, or the one that a parameter is the same as."""
    if cause.place is not None:
        return cause
    same = (b for a, b in trials.equals if trials.known[a] == cause)
    return next((trials.known[b] for b in same if trials.known[b].place is not None), None)


def _holds(law: Hypothesis, place: Place | None) -> bool:
    """Whether a law may be a term of a series: a smooth function of the speed of a place alone,
    and no bent one, which is a sum of them by itself."""
    formula = law.kind == LAW and STEPS not in law.path
    plain = smooth(law) and not law.bent
    return law.place == place and quantities(law) == RATE and (formula or plain)
