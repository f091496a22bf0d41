"""One cause for several that stand in for it, tried as one step: on the way from the several to the
one lie structures that are worse than both.
"""

from collections.abc import Iterator
from itertools import combinations

from symhyb.correction.search.evidence import NEAR_NOISE
from symhyb.correction.search.selection import solve
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Trials, first_guess

FAULTS = ("gain", "offset", "delay")
PART = 1 / 2  # of what the several take, that the one must promise
TRIED = 2  # laws in place of several at one place


def one_for_two(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """The winner with two faults of one kind replaced by the one fault of that kind which takes
    most of what they took, in the linear problem along the rest: where all forces but one input
    grow with the motion, larger readings of all sensors and a larger input are the same."""
    hypotheses, causes = trials.setting.hypotheses, trials.causes(winner)
    faults = [i for i, cause in enumerate(winner.causes) if cause.kind in FAULTS]
    for pair in combinations(faults, 2):
        kind = winner.causes[pair[0]].kind
        if winner.causes[pair[1]].kind != kind:
            continue
        kept = [i for i in range(len(causes)) if i not in pair]
        rest, rows = [causes[i] for i in kept], [grouped(winner)[i] for i in kept]
        smaller = trials.refined(rest, rows)
        if smaller.fit.reason:
            continue
        problem = trials.along(smaller)
        options = [
            subset
            for c, other in enumerate(hypotheses)
            if other.kind == kind and c not in causes and c not in trials.dropped
            if (subset := solve(problem, (c,))) is not None
        ]
        if options:
            best = min(options, key=lambda subset: subset.chi2)
            yield trials.refined((*rest, *best.causes), [*rows, *first_guess(problem, best)])


def one_law(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """The winner, where it leaves hardly more than noise, with all its causes at one place replaced
    by one law there with no more numbers: plain friction, less damping and drag stand in for
    friction that falls with speed. A parameter is where the law is that it is the twin of."""
    if not winner.fit.scale < NEAR_NOISE or not trials.listed(winner):
        return
    hypotheses, causes = trials.setting.hypotheses, trials.causes(winner)
    places = {first: hypotheses[second].place for first, second in trials.twins}
    at = [cause.place or places.get(c) for c, cause in zip(causes, winner.causes, strict=True)]
    for place in dict.fromkeys(at):
        mine = [i for i, there in enumerate(at) if there == place]
        if place is None or len(mine) < 2:
            continue
        kept = [i for i in range(len(causes)) if i not in mine]
        rest, rows = [causes[i] for i in kept], [grouped(winner)[i] for i in kept]
        smaller = trials.refined(rest, rows)
        base = None if smaller.fit.reason else solve(trials.along(smaller), ())
        if base is None:
            continue
        taken = smaller.fit.train - winner.fit.train
        most = sum(winner.causes[i].numbers for i in mine)
        options = [
            subset
            for c, cause in enumerate(hypotheses)
            if cause.place == place and 1 < cause.numbers <= most and c not in causes
            if (subset := solve(trials.along(smaller), (c,))) is not None
            and base.chi2 - subset.chi2 > PART * taken
        ]
        for subset in sorted(options, key=lambda s: s.chi2)[:TRIED]:
            values = [*rows, *first_guess(trials.along(smaller), subset)]
            yield trials.refined((*rest, *subset.causes), values, smaller.fit.starts)
