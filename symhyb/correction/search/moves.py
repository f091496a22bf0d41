"""Single steps from one structure to another: a cause more, another one, a simpler one."""

from collections.abc import Iterator
from itertools import combinations

from symhyb.correction.search.beyond import lean
from symhyb.correction.search.evidence import HOPE, SIGNIFICANT, excess, price, unit_of
from symhyb.correction.search.selection import Problem, solve, without
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Trials, first_guess
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import Place

TRIALS = 3  # refined structures of each size
PROMISE = 0.3  # of what can be taken, which the linear problem must promise before a trial
PLAINER = 2  # plain laws, and pairs of them, that are tried in place of one of several numbers


def additions(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """One more cause, where the linearisation along the winner's own simulation promises it; first
    without those that it makes redundant."""
    hypotheses = trials.setting.hypotheses
    skewed = {c for c, cause in enumerate(hypotheses) if "skew" in cause.terms}
    problem = without(trials.along(winner), trials.dropped - skewed)
    taken = {c for c, cause in enumerate(problem.hypotheses) if _told(cause, winner)}
    base = solve(problem, ())
    if base is None:
        return
    more = [
        s
        for c in range(len(problem.hypotheses))
        if c not in taken
        if (s := solve(problem, (c,))) is not None
    ]
    for subset in sorted(more, key=lambda s: s.chi2)[:TRIALS]:
        gain = (base.chi2 - subset.chi2) / unit_of(winner)
        needed = SIGNIFICANT + price(winner, subset.numbers, 1, trials.count)
        part = (base.chi2 - subset.chi2) / excess(base.chi2, winner)
        if gain > HOPE * needed and part > PROMISE:
            values = [*grouped(winner), *first_guess(problem, subset)]
            causes = (*trials.causes(winner), *subset.causes)
            trial = trials.refined(causes, values, winner.fit.starts)
            yield from lean(trials, trial, trial.causes[-1])
            yield trial


def _told(cause: Hypothesis, winner: Refined) -> bool:
    """Whether the winner has a law of this subject with one of these terms."""
    return any(
        mine.subject == cause.subject and set(mine.terms) & set(cause.terms)
        for mine in winner.causes
    )


def swaps(trials: Trials, winner: Refined, problem: Problem) -> Iterator[Refined]:
    """For each cause of the winner the best replacement at another place or of another kind."""
    if not trials.listed(winner):
        return
    causes = trials.causes(winner)
    for cause in causes:
        rest = [c for c in causes if c != cause]
        mine = problem.hypotheses[cause]
        own = mine.kind, mine.place, mine.path
        options = [
            subset
            for c, other in enumerate(problem.hypotheses)
            if c not in causes and (other.kind, other.place, other.path) != own
            if (subset := solve(problem, (*rest, c))) is not None
        ]
        if options:
            best = min(options, key=lambda s: s.chi2)
            yield trials.refined(best.causes, first_guess(problem, best))


def plainer(trials: Trials, winner: Refined, problem: Problem) -> Iterator[Refined]:
    """The winner with a law of several numbers replaced by the one or two plain laws at its place
    that come closest: a stop behind a clearance by a spring that hardens."""
    if not trials.listed(winner):
        return
    causes = trials.causes(winner)
    for cause in causes:
        mine = problem.hypotheses[cause]
        if mine.place is None or mine.numbers < 2 or mine.variant:
            continue
        rest = [c for c in causes if c != cause]
        plain = [c for c in _plain_at(trials, mine.place) if c not in causes]
        for many in (1, 2):
            options = [
                subset
                for more in combinations(plain, many)
                if (subset := solve(problem, (*rest, *more))) is not None
            ]
            for subset in sorted(options, key=lambda s: s.chi2)[:PLAINER]:
                trial = trials.refined(subset.causes, first_guess(problem, subset))
                if not trial.fit.reason:
                    yield trial


def _plain_at(trials: Trials, place: Place) -> list[int]:
    """The laws with one number at a place; where a parameter of the model is the twin of one (a
    stiffness that may be estimated, of a spring), convention names the parameter, so it stands for
    that law."""
    hypotheses = trials.setting.hypotheses
    named = {second: first for first, second in trials.twins}
    plain = [c for c, h in enumerate(hypotheses) if h.place == place and h.numbers == 1]
    return list(dict.fromkeys(named.get(c, c) for c in plain))


def simplifications(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """The winner with one law replaced by a simpler one of its kind (Stribeck by Coulomb)."""
    for i, cause in enumerate(winner.causes):
        for other in trials.setting.hypotheses:
            same = (other.kind, other.place, other.path) == (cause.kind, cause.place, cause.path)
            if not same or not set(other.terms) < set(cause.terms):
                continue
            rows = grouped(winner)
            rows[i] = {key: rows[i][key] for key in other.keys}
            causes = [*winner.causes[:i], other, *winner.causes[i + 1 :]]
            indices = [trials.index(c) for c in causes]
            yield trials.refined(indices, rows, winner.fit.starts)
