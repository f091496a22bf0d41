"""Two losses for one: dry friction and drag in place of viscous damping that imitates them.

What they take of a motion that swings, cycle by cycle, goes with its amplitude A as A for dry
friction, A² for viscous damping and A³ for drag. The middle one alone comes close to the two outer
ones together over a wide range of amplitudes. One of them beside it gains little, one of them in
its place fits worse: they are found only together. Nothing is added then to what was believed, it
is another answer; so the rule for one cause more, half of what is left, is not asked. Nor must
more than the noise be left: in a motion of one amplitude the damper alone comes down to it almost,
and thousands of samples tell it from the two all the same.
"""

from collections.abc import Iterator, Sequence

from symhyb.correction.search.conventions import OUTER
from symhyb.correction.search.evidence import SIGNIFICANT, criterion, unit_of
from symhyb.correction.search.selection import Problem, solve
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.search.trials import Trials, first_guess


def two_for_one(trials: Trials, winner: Refined, problem: Problem) -> Iterator[Refined]:
    """The winner with viscous damping, where it is the only loss at its place, replaced by dry
    friction and drag, if that is better by ``SIGNIFICANT`` on the fitted windows (Δ of χ²/c +
    k ln N) and on the held ones (Δχ²/c)."""
    if not trials.listed(winner):
        return
    causes = trials.causes(winner)
    for cause in causes:
        rest = [c for c in causes if c != cause]
        pairs = _pairs(trials, rest, cause)
        options = [s for pair in pairs if (s := solve(problem, (*rest, *pair))) is not None]
        if not options:
            continue
        best = min(options, key=lambda s: s.chi2)
        trial = trials.refined(best.causes, first_guess(problem, best))
        if trial.fit.reason or not trials.believed(trial):
            continue
        fitted = criterion(winner, trial) - criterion(trial, trial)
        held = (winner.fit.validation - trial.fit.validation) / unit_of(trial)
        if fitted > SIGNIFICANT and (held > SIGNIFICANT or not winner.fit.held.any()):
            yield trial


def _pairs(trials: Trials, rest: Sequence[int], cause: int) -> list[tuple[int, int]]:
    """Dry friction and drag, in every shape that is tried, where ``cause`` is a plain damper and no
    other cause of the structure (``rest``) is one of them; else none."""
    known = trials.setting.hypotheses
    mine = known[cause]
    if mine.kind != "damper" or mine.numbers > 1:
        return []
    here = [c for c, other in enumerate(known) if other.place == mine.place]
    if any(known[c].kind in OUTER for c in here if c in rest):
        return []
    plain = [c for c in here if known[c].numbers == 1 and not known[c].variant]
    return [(x, y) for x in plain for y in plain if (known[x].kind, known[y].kind) == OUTER]
