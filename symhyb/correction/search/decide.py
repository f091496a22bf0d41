"""Which causes are believed: structures refined on trajectories, judged on held windows.

1. Linear screens at growing window lengths, and sparse regression on the weak form, name
   structures worth a trial.
2. At the longest windows the trials are refined by simulation error. From no cause upwards, a
   larger structure is taken only if it is significant on fitted *and* on held windows for coloured
   residuals, and takes a stated part of the mismatch that is then left.
3. Terms are added, swapped and dropped around the winner until nothing changes.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain

from symhyb.correction.search.beyond import (
    bends,
    deeper,
    last_resort,
    lean,
    more_lines,
    twin_variants,
    variants,
)
from symhyb.correction.search.conventions import CERTAIN, exact_twins, exchange, precedence
from symhyb.correction.search.evidence import (
    HOPE,
    NEAR_NOISE,
    PART_LEFT,
    SIGNIFICANT,
    criterion,
    earns,
    excess,
    named,
    price,
)
from symhyb.correction.search.losses import two_for_one
from symhyb.correction.search.merging import one_for_two, one_law
from symhyb.correction.search.moves import (
    PROMISE,
    TRIALS,
    additions,
    plainer,
    simplifications,
    swaps,
)
from symhyb.correction.search.selection import (
    LARGEST,
    Problem,
    Subset,
    best_subsets,
    reach,
    solve,
    without,
)
from symhyb.correction.search.setting import Setting, along_motion
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Say, Trials, first_guess
from symhyb.discrepancy.places.hypotheses import Hypothesis

VOID = 0.1  # of what the linear problem promised: less means that its promises are void
ROUNDS = 6
BASES = 2  # structures with one cause more, from which a second step is tried


@dataclass(frozen=True, slots=True)
class Decision:
    """The structure that is believed (``winner``), every other that was refined (``trials``), and
    ``twins``: causes that no recording of this kind tells from another one. ``luck`` is by how much
    the χ²/c of a trial may differ from the winner's by noise alone, one deviation."""

    winner: Refined
    nothing: Refined
    trials: tuple[Refined, ...]
    twins: tuple[tuple[Hypothesis, Hypothesis], ...]
    log: tuple[str, ...]
    luck: tuple[tuple[Refined, float], ...] = ()

    def criterion(self, trial: Refined) -> float:
        """Δ of χ²/c + k ln N to the winner; positive is worse."""
        return criterion(trial, self.winner) - criterion(self.winner, self.winner)

    def evidence(self, trial: Refined) -> float:
        """The criterion less two deviations of luck: what can be counted on."""
        luck = next((spread for known, spread in self.luck if known is trial), 0.0)
        return self.criterion(trial) - 2 * luck


def decide(setting: Setting, proposals: Sequence[Subset], say: Say) -> Decision:
    """Choose a structure. ``proposals`` are subsets from other screens, by cause index."""
    log: list[str] = []
    variants = {i for i, cause in enumerate(setting.hypotheses) if cause.variant}
    pool = {subset.causes for subset in proposals if not variants & {*subset.causes}}
    problems = []
    for stage in setting.stages:
        say(f"screening {len(setting.hypotheses)} causes on windows of {stage.length_s:.3g} s")
        problem = along_motion(setting, stage)
        twins = exact_twins(problem)
        problem = without(problem, {second for _, second in twins} | variants)
        sizes = best_subsets(problem)
        pool |= {s.causes for sized in sizes for s in _distinct(problem, sized)[:TRIALS]}
        problems.append((sizes[-1][0].chi2 / max(sizes[0][0].chi2, 1e-300), problem))
    # where the linear problem explains most, its promises are worth most
    problem = min(problems, key=lambda pair: pair[0])[1]
    subsets = [subset for causes in sorted(pool) if (subset := solve(problem, causes)) is not None]
    trials = Trials(setting, variants, say, twins)
    nothing = trials.refined(())
    winner = _climb(trials, nothing, problem, subsets, log)
    past = [winner]
    for _ in range(ROUNDS):
        better = _improved(trials, winner, problem, log)
        if better is winner:
            better = _passed_by(trials, winner, log)
        if better is winner:
            better = _ahead(trials, winner, log)
        if any(better is one for one in past):
            break
        winner = better
        past.append(winner)
    winner = last_resort(trials, winner, nothing, log)
    winner = _conventional(trials, winner, problem)
    named = tuple((setting.hypotheses[a], setting.hypotheses[b]) for a, b in twins)
    return Decision(winner, nothing, tuple(trials.done.values()), named, tuple(log))


def _conventional(trials: Trials, winner: Refined, problem: Problem) -> Refined:
    """Where convention names one of two causes that noise cannot tell apart, the one it names."""
    for trial in trials.done.values():
        change = exchange(trial.causes, winner.causes)
        if change.pair is None or not change.conventional:
            continue
        first, second = (
            precedence(problem.hypotheses.index(cause), cause) for cause in change.pair
        )
        if first < second and abs(criterion(trial, winner) - criterion(winner, winner)) < CERTAIN:
            return trial
    return winner


def _climb(
    trials: Trials, nothing: Refined, problem: Problem, pool: list[Subset], log: list[str]
) -> Refined:
    """From no cause upwards: the smallest larger structure that earns its place, and so on.

    A structure is refined only if the linear problem promises a part of what the best of all takes,
    on held windows as well.
    """
    winner, left, held = nothing, problem.gram[-1, -1], problem.held[-1, -1]
    floor = min((subset.chi2 for subset in pool), default=0.0)
    for size in range(1, LARGEST + 1):
        if winner is not nothing and winner.fit.scale < NEAR_NOISE:
            break  # what is left, if anything, shows only along the winner's own simulation
        sized = sorted((s for s in pool if len(s.causes) == size), key=lambda s: s.chi2)
        promising = [
            s
            for s in _distinct(problem, sized)
            if left - s.chi2 > max(PROMISE * (left - floor), HOPE * _price(trials, winner, s))
            and s.held <= held
        ]
        tried = [trials.refined(s.causes, first_guess(problem, s)) for s in promising[:TRIALS]]
        kept = [winner.fit.train - trial.fit.train for trial in tried]
        if tried and max(kept) < VOID * (left - promising[0].chi2):
            break  # along simulations the linear problem does not hold here
        tried = [trial for trial in tried if trials.believed(trial)]
        if not tried:
            continue
        best = _plainest(tried)
        earned, sentence = earns(best, winner, trials.count)
        fitter = criterion(best, best) < criterion(winner, best) - SIGNIFICANT
        if not earned and best.numbers <= winner.numbers and fitter:
            earned, sentence = True, f"{named(best.causes)}: fits better with as few numbers"
        log.append(sentence)
        if earned:
            winner = best
            subset = solve(problem, trials.causes(best))
            left, held = (left, held) if subset is None else (subset.chi2, subset.held)
    return winner


def _price(trials: Trials, winner: Refined, subset: Subset) -> float:
    """What Δχ² a subset must reach against the winner to be taken, if its residuals are white."""
    numbers, causes = subset.numbers - winner.numbers, len(subset.causes) - len(winner.causes)
    return SIGNIFICANT + price(winner, numbers, causes, trials.count)


def _plainest(tried: Sequence[Refined]) -> Refined:
    """The best of structures with as many causes each: one with more numbers must earn them."""
    closest = min(tried, key=lambda trial: trial.fit.train)
    best: Refined | None = None
    for trial in sorted(tried, key=lambda trial: (trial.numbers, criterion(trial, closest))):
        if best is None or (
            criterion(trial, closest) < criterion(best, closest)
            and (trial.numbers == best.numbers or earns(trial, best)[0])
        ):
            best = trial
    assert best is not None
    return best


def _distinct(problem: Problem, subsets: Sequence[Subset]) -> list[Subset]:
    """The first of every set of subsets that differ in the shapes of their laws alone."""
    first: dict[frozenset[object], Subset] = {}
    for subset in subsets:
        family = frozenset(problem.hypotheses[cause].family for cause in subset.causes)
        first.setdefault(family, subset)
    return list(first.values())


def _improved(trials: Trials, winner: Refined, problem: Problem, log: list[str]) -> Refined:
    """The winner with one cause added, swapped or dropped, if that is better; else itself."""
    more = list(filter(trials.believed, deeper(trials, winner)))
    for trial in more:  # where one law with a number more says it all, no second law is tried
        earned, sentence = earns(trial, winner)
        if earned and trial.fit.scale < NEAR_NOISE:
            log.append(sentence)
            return trial
    for trial in filter(trials.believed, additions(trials, winner)):
        earned, sentence = earns(trial, winner, trials.count)
        log.append(sentence)
        if earned:
            return trial
    plain = (*variants(trials, winner), *twin_variants(trials, winner))
    for trial in (*filter(trials.believed, plain), *more):
        earned, sentence = earns(trial, winner)
        log.append(sentence)
        if earned:
            return trial
    for trial in filter(trials.believed, more_lines(trials, winner)):
        earned, sentence = earns(trial, winner, trials.count)
        log.append(sentence)
        if earned:
            return trial
    for trial in filter(trials.believed, swaps(trials, winner, problem)):
        better = criterion(trial, winner) < criterion(winner, winner) - SIGNIFICANT
        if better and (trial.numbers <= winner.numbers or earns(trial, winner)[0]):
            log.append(f"{named(trial.causes)} instead of {named(winner.causes)}: fits better")
            return trial
    for trial in filter(trials.believed, (*one_for_two(trials, winner), *one_law(trials, winner))):
        if not earns(winner, trial)[0]:
            log.append(
                f"{named(trial.causes)} instead of {named(winner.causes)}: says it with less"
            )
            return trial
    for trial in two_for_one(trials, winner, problem):
        log.append(f"{named(trial.causes)} instead of {named(winner.causes)}: fits better")
        return trial
    for simpler in (*simplifications(trials, winner), *plainer(trials, winner, problem)):
        worse = criterion(simpler, winner) > criterion(winner, winner) + SIGNIFICANT
        if worse and simpler.numbers >= winner.numbers and winner.fit.scale < NEAR_NOISE:
            continue  # two laws that say less with as many numbers
        earned, sentence = earns(winner, simpler)
        log.append(sentence)
        if not earned:
            return simpler
    for i, cause in enumerate(trials.causes(winner)):
        rest = [c for c in trials.causes(winner) if c != cause]
        kept = [row for j, row in enumerate(grouped(winner)) if j != i]
        smaller = trials.refined(rest, kept)
        earned, sentence = earns(winner, smaller)
        log.append(sentence)
        if not earned:
            return smaller
        for single in filter(trials.believed, deeper(trials, smaller, winner.causes[i].place)):
            earned, sentence = earns(winner, single)
            log.append(sentence)
            if not earned:
                return single
    return winner


def _passed_by(trials: Trials, winner: Refined, log: list[str]) -> Refined:
    """The structure that fits best of those tried on the way which are no larger than the winner,
    without what does not stand out in it, if it is better (with as many numbers significantly so):
    the steps led past it. Else the winner."""

    def better(trial: Refined) -> bool:
        least = SIGNIFICANT if trial.numbers == winner.numbers else 0.0
        return criterion(trial, winner) < criterion(winner, winner) - least

    others = [
        trial
        for trial in trials.done.values()
        if trial.numbers <= winner.numbers
        and len(trial.causes) <= len(winner.causes)
        and better(trial)
    ]
    for other in sorted(others, key=lambda trial: criterion(trial, winner))[:BASES]:
        for trial in (other, *lean(trials, other)):
            if better(trial) and trials.believed(trial):
                log.append(f"{named(trial.causes)} instead of {named(winner.causes)}: fits better")
                return trial
    return winner


def _ahead(trials: Trials, winner: Refined, log: list[str]) -> Refined:
    """Where more than noise is left and no single step pays: the winner with one cause more that
    fits better but takes too little by itself, and from there a variant or one more, where the
    linear problem lets both together take enough; if that earns its place against the winner. Else
    the winner."""
    if winner.fit.scale < NEAR_NOISE:
        return winner
    better = criterion(winner, winner) - SIGNIFICANT
    bases = [
        trial
        for trial in trials.done.values()
        if len(trial.causes) == len(winner.causes) + 1
        and {*winner.causes} < {*trial.causes}
        and criterion(trial, winner) < better
        and trials.believed(trial)
    ]
    for base in sorted(bases, key=lambda trial: criterion(trial, winner))[:BASES]:
        bent, more = _hopeful(trials, winner, base)
        added = additions(trials, base) if more else iter(())
        for trial in chain(variants(trials, base, bent), added):
            if trials.believed(trial):
                earned, sentence = earns(trial, winner, trials.count)
                log.append(sentence)
                if earned:
                    return trial
    return winner


def _hopeful(trials: Trials, winner: Refined, base: Refined) -> tuple[set[int], bool]:
    """The variants of causes of ``base`` that could take enough together with what it has more than
    the winner, and whether one cause more could."""
    hypotheses, own = trials.setting.hypotheses, trials.causes(base)
    (extra,) = (c for c in own if c not in trials.causes(winner))
    if extra >= len(hypotheses):
        return set(), False
    problem, left = trials.along(winner), excess(winner.fit.train, winner)
    share = {c: reach(problem, extra, c) / left for c in range(len(hypotheses)) if c not in own}
    bent = {c for c in share if any(bends(hypotheses[c], mine) for mine in base.causes)}
    hopeful = {c for c in bent if share[c] > PART_LEFT}
    return hopeful, any(share[c] > 1 - (1 - PART_LEFT) ** 2 for c in share if c not in bent)
