"""Which causes are believed: structures refined on trajectories, judged on held windows.

1. Linear screens at growing window lengths, and sparse regression on the weak form, name
   structures worth a trial.
2. At the longest windows the trials are refined by simulation error. From no cause upwards, a
   larger structure is taken only if it is significant on fitted *and* on held windows for coloured
   residuals, and takes a stated part of the mismatch that is then left.
3. Terms are added, swapped and dropped around the winner until nothing changes.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

from symhyb.correction.beyond import (
    deeper,
    last_resort,
    lean,
    more_lines,
    twin_variants,
    variants,
)
from symhyb.correction.conventions import CERTAIN, exact_twins, exchange, precedence
from symhyb.correction.evidence import (
    HOPE,
    NEAR_NOISE,
    SIGNIFICANT,
    criterion,
    earns,
    excess,
    named,
    price,
    unit_of,
)  # fmt: skip
from symhyb.correction.losses import two_for_one
from symhyb.correction.merging import one_for_two, one_law
from symhyb.correction.selection import LARGEST, Problem, Subset, best_subsets, solve, without
from symhyb.correction.setting import Setting, along_motion
from symhyb.correction.trajectory import Refined, grouped
from symhyb.correction.trials import Say, Trials, first_guess
from symhyb.discrepancy.hypotheses import Hypothesis
from symhyb.model.types import Place

TRIALS = 3  # refined structures of each size
PROMISE = 0.3  # of what can be taken, which the linear problem must promise before a trial
VOID = 0.1  # of what the linear problem promised: less means that its promises are void
ROUNDS = 6
BASES = 2  # structures with one cause more, from which a second step is tried
PLAINER = 2  # plain laws, and pairs of them, that are tried in place of one of several numbers


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
            s for s in _distinct(problem, sized)
            if left - s.chi2 > max(PROMISE * (left - floor), HOPE * _price(trials, winner, s))
            and s.held <= held
        ]  # fmt: skip
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
    for trial in filter(trials.believed, _additions(trials, winner)):
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
    for trial in filter(trials.believed, _swaps(trials, winner, problem)):
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
    for simpler in (*_simplifications(trials, winner), *_plainer(trials, winner, problem)):
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


def _additions(trials: Trials, winner: Refined) -> Iterator[Refined]:
    """One more cause, where the linearisation along the winner's own simulation promises it; first
    without those that it makes redundant."""
    hypotheses = trials.setting.hypotheses
    skewed = {c for c, cause in enumerate(hypotheses) if "skew" in cause.terms}
    problem = without(trials.along(winner), trials.dropped - skewed)
    taken = {c for c, cause in enumerate(problem.hypotheses) if _told(cause, winner)}
    base = solve(problem, ())
    if base is None:
        return
    more = [s for c in range(len(problem.hypotheses)) if c not in taken
            if (s := solve(problem, (c,))) is not None]  # fmt: skip
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


def _ahead(trials: Trials, winner: Refined, log: list[str]) -> Refined:
    """Where more than noise is left and no single step pays: the winner with one cause more that
    fits better but takes too little by itself, and from there a variant or one more; if that earns
    its place against the winner. Else the winner."""
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
        for trial in (*variants(trials, base), *_additions(trials, base)):
            if trials.believed(trial):
                earned, sentence = earns(trial, winner, trials.count)
                log.append(sentence)
                if earned:
                    return trial
    return winner


def _told(cause: Hypothesis, winner: Refined) -> bool:
    """Whether the winner has a law of this kind at this place, with one of these terms."""
    return any(
        (mine.kind, mine.place, mine.path) == (cause.kind, cause.place, cause.path)
        and set(mine.terms) & set(cause.terms)
        for mine in winner.causes
    )


def _swaps(trials: Trials, winner: Refined, problem: Problem) -> Iterator[Refined]:
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


def _plainer(trials: Trials, winner: Refined, problem: Problem) -> Iterator[Refined]:
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


def _simplifications(trials: Trials, winner: Refined) -> Iterator[Refined]:
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
