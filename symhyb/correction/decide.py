"""Which causes are believed: structures refined on trajectories, judged on held windows.

1. Linear screens at growing window lengths, and sparse regression on the weak form, name
   structures worth a trial.
2. At the longest windows the trials are refined by simulation error. From no cause upwards, a
   larger structure is taken only if it is significant on fitted *and* on held windows for coloured
   residuals, and takes a stated part of the mismatch that is then left.
3. Terms are added, swapped and dropped around the winner until nothing changes.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.screen import screen
from symhyb.correction.selection import LARGEST, Problem, Subset, best_subsets, solve
from symhyb.correction.trajectory import Refined, refine
from symhyb.discrepancy.hypotheses import Hypothesis, Library
from symhyb.discrepancy.windows import Laid
from symhyb.numeric.buffers import Array
from symhyb.numeric.windows import WindowModel

SIGNIFICANT = 10.0  # Δχ²/c − k ln N on fitted windows, Δχ²/c on held ones (10: odds of 150 to 1)
PART_LEFT = 1 / 2  # of the mismatch that is left, which a cause must take
CERTAIN = 4.6  # of the criterion: a rival closer than this (odds 10 to 1) leaves a cause in doubt
RIVAL = 10.0  # of the criterion: closer than this, a rival is told
TRIALS = 3  # refined structures of each size
PROMISE = 0.3  # of what is left, which the linear problem must promise before a trial
ROUNDS = 5
NEAR_NOISE = 1.1  # χ² per sample: nothing larger to climb to

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Stage:
    """One window length in s and the windows of all recordings at it."""

    length_s: float
    laid: tuple[Laid, ...]


@dataclass(frozen=True, slots=True)
class Setting:
    """What a decision works on: force hypotheses lowered, dull causes, windows prepared for the
    model with all dull causes free, stages from short to long, noise ``sd`` (m,) SI, and
    the smallest gain error that interpolation between samples cannot feign."""

    library: Library
    dull: tuple[Hypothesis, ...]
    windows: WindowModel
    stages: tuple[Stage, ...]
    sd: Array
    gain_floor: float

    @property
    def hypotheses(self) -> tuple[Hypothesis, ...]:
        """All causes, in the order of the reduced problems."""
        return (*self.library.hypotheses, *self.dull)


@dataclass(frozen=True, slots=True)
class Decision:
    """The structure that is believed (``winner``), every other that was refined (``trials``), and
    ``twins``: causes that no recording of this kind tells from another one."""

    winner: Refined
    nothing: Refined
    trials: tuple[Refined, ...]
    twins: tuple[tuple[Hypothesis, Hypothesis], ...]
    log: tuple[str, ...]

    def criterion(self, trial: Refined) -> float:
        """Δ of χ²/c + k ln N to the winner; positive is worse."""
        return _criterion(trial, self.winner) - _criterion(self.winner, self.winner)


def decide(setting: Setting, proposals: Sequence[Subset], say: Say) -> Decision:
    """Choose a structure. ``proposals`` are subsets from other screens, by cause index."""
    log: list[str] = []
    pool = {subset.causes for subset in proposals}
    problems = []
    for stage in setting.stages:
        say(f"screening {len(setting.hypotheses)} causes on windows of {stage.length_s:.3g} s")
        problem = _screened(setting, stage)
        twins = exact_twins(problem)
        problem = without(problem, {second for _, second in twins})
        sizes = best_subsets(problem)
        pool |= {s.causes for sized in sizes for s in _distinct(problem, sized)[:TRIALS]}
        problems.append((sizes[-1][0].chi2 / sizes[0][0].chi2, problem))
    # where the linear problem explains most, its promises are worth most
    problem = min(problems, key=lambda pair: pair[0])[1]
    subsets = [subset for causes in sorted(pool) if (subset := solve(problem, causes)) is not None]
    trials = _Trials(setting, say)
    nothing = trials.refined(())
    winner = _climb(trials, nothing, problem, subsets, log)
    for _ in range(ROUNDS):
        better = _improved(trials, winner, problem, log)
        if better is winner:
            break
        winner = better
    winner = _conventional(trials, winner, problem)
    named = tuple((setting.hypotheses[a], setting.hypotheses[b]) for a, b in twins)
    return Decision(winner, nothing, tuple(trials.done.values()), named, tuple(log))


def alike(first: Hypothesis, second: Hypothesis) -> bool:
    """Whether two causes are of kinds that convention ranks: gains of two channels of a linear
    system, offsets of two channels, a constant force and an offset."""
    kinds = {first.kind, second.kind}
    return kinds in ({"gain"}, {"offset"}, {"constant", "offset"})


class _Trials:
    """Structures refined at the longest windows, each once."""

    def __init__(self, setting: Setting, say: Say):
        self.setting, self.say = setting, say
        self.done: dict[tuple[int, ...], Refined] = {}

    def refined(
        self,
        causes: Sequence[int],
        values: Sequence[float] | Array = (),
        starts: Sequence[Array] | None = None,
    ) -> Refined:
        key = tuple(sorted(causes))
        if key not in self.done:
            chosen = [self.setting.hypotheses[cause] for cause in causes]
            self.say("trying " + _named(chosen))
            first, rest = {}, list(values)
            for i, cause in enumerate(chosen):
                first[i], rest = rest[: len(cause.terms)], rest[len(cause.terms) :]
            stage, model = self.setting.stages[-1], self.setting.windows.machine.model
            self.done[key] = refine(model, chosen, first, stage.laid, self.setting.sd, starts)
        return self.done[key]

    def causes(self, trial: Refined) -> tuple[int, ...]:
        return tuple(self.setting.hypotheses.index(cause) for cause in trial.causes)


def _conventional(trials: _Trials, winner: Refined, problem: Problem) -> Refined:
    """Where convention names one of two causes that noise cannot tell apart, the one it names."""
    for trial in trials.done.values():
        fresh = [cause for cause in trial.causes if cause not in winner.causes]
        lost = [cause for cause in winner.causes if cause not in trial.causes]
        if len(fresh) != 1 or len(lost) != 1 or not alike(fresh[0], lost[0]):
            continue
        first, second = (
            precedence(problem.hypotheses.index(cause), cause) for cause in (fresh[0], lost[0])
        )
        if first < second and abs(_criterion(trial, winner) - _criterion(winner, winner)) < CERTAIN:
            return trial
    return winner


def _climb(
    trials: _Trials, nothing: Refined, problem: Problem, pool: list[Subset], log: list[str]
) -> Refined:
    """From no cause upwards: the smallest larger structure that earns its place, and so on.

    A structure is refined only if the linear problem promises a part of what is left.
    """
    winner, left = nothing, problem.gram[-1, -1]
    for size in range(1, LARGEST + 1):
        if winner is not nothing and winner.fit.scale < NEAR_NOISE:
            break  # what is left, if anything, shows only along the winner's own simulation
        sized = sorted((s for s in pool if len(s.causes) == size), key=lambda s: s.chi2)
        promising = [s for s in _distinct(problem, sized) if s.chi2 < (1 - PROMISE) * left]
        tried = [trials.refined(s.causes, s.values) for s in promising[:TRIALS]]
        if not tried:
            continue
        closest = min(tried, key=lambda trial: trial.fit.train)
        best = min(tried, key=lambda trial: _criterion(trial, closest))
        earned, sentence = earns(best, winner)
        log.append(sentence)
        if earned:
            winner = best
            subset = solve(problem, trials.causes(best))
            left = left if subset is None else subset.chi2
    return winner


def _distinct(problem: Problem, subsets: Sequence[Subset]) -> list[Subset]:
    """The first of every set of subsets that differ in the shapes of their laws alone."""
    first: dict[frozenset[object], Subset] = {}
    for subset in subsets:
        family = frozenset(problem.hypotheses[cause].family for cause in subset.causes)
        first.setdefault(family, subset)
    return list(first.values())


def _improved(trials: _Trials, winner: Refined, problem: Problem, log: list[str]) -> Refined:
    """The winner with one cause added, swapped or dropped, if that is better; else itself."""
    for trial in _additions(trials, winner):
        earned, sentence = earns(trial, winner)
        log.append(sentence)
        if earned:
            return trial
    for trial in _swaps(trials, winner, problem):
        if _criterion(trial, winner) < _criterion(winner, winner) - SIGNIFICANT:
            log.append(f"{_named(trial.causes)} instead of {_named(winner.causes)}: fits better")
            return trial
    for simpler in _simplifications(trials, winner):
        earned, sentence = earns(winner, simpler)
        log.append(sentence)
        if not earned:
            return simpler
    for i, cause in enumerate(trials.causes(winner)):
        rest = [c for c in trials.causes(winner) if c != cause]
        kept = [v for j, row in enumerate(grouped(winner)) if j != i for v in row]
        smaller = trials.refined(rest, kept)
        earned, sentence = earns(winner, smaller)
        log.append(sentence)
        if not earned:
            return smaller
    return winner


def _additions(trials: _Trials, winner: Refined) -> Iterator[Refined]:
    """One more cause, where the linearisation along the winner's own simulation promises it."""
    problem = around(trials.setting, winner)
    taken = set(trials.causes(winner))
    base = solve(problem, ())
    if base is None:
        return
    more = [s for c in range(len(problem.hypotheses)) if c not in taken
            if (s := solve(problem, (c,))) is not None]  # fmt: skip
    for subset in sorted(more, key=lambda s: s.chi2)[:TRIALS]:
        gain = (base.chi2 - subset.chi2) / unit_of(winner)
        if gain > SIGNIFICANT and base.chi2 - subset.chi2 > PROMISE * _excess(base.chi2, winner):
            values = [*(v for row in grouped(winner) for v in row), *subset.values]
            causes = (*trials.causes(winner), *subset.causes)
            yield trials.refined(causes, values, winner.fit.starts)


def _swaps(trials: _Trials, winner: Refined, problem: Problem) -> Iterator[Refined]:
    """For each cause of the winner the best replacement at another place or of another kind."""
    causes = trials.causes(winner)
    for cause in causes:
        rest = [c for c in causes if c != cause]
        mine = problem.hypotheses[cause]
        options = [
            subset
            for c, other in enumerate(problem.hypotheses)
            if c not in causes and (other.kind, other.place) != (mine.kind, mine.place)
            if (subset := solve(problem, (*rest, c))) is not None
        ]
        if options:
            best = min(options, key=lambda s: s.chi2)
            yield trials.refined(best.causes, best.values)


def _percent(part: float) -> str:
    return "nothing" if part <= 0 else f"{100 * part:.3g} %"


def _simplifications(trials: _Trials, winner: Refined) -> Iterator[Refined]:
    """The winner with one law replaced by a simpler one of its kind (Stribeck by Coulomb)."""
    for i, cause in enumerate(winner.causes):
        for other in trials.setting.hypotheses:
            same = (other.kind, other.place, other.path) == (cause.kind, cause.place, cause.path)
            if not same or not set(other.terms) < set(cause.terms):
                continue
            rows = grouped(winner)
            rows[i] = [rows[i][cause.terms.index(term)] for term in other.terms]
            causes = [*winner.causes[:i], other, *winner.causes[i + 1 :]]
            indices = [trials.setting.hypotheses.index(c) for c in causes]
            yield trials.refined(indices, [v for row in rows for v in row], winner.fit.starts)


def _excess(chi2: float, trial: Refined) -> float:
    return max(chi2 - float(trial.fit.count[~trial.fit.held].sum()), 1e-12)


def _named(causes: Sequence[Hypothesis]) -> str:
    return " + ".join(map(str, causes)) or "the model as it is"


def earns(larger: Refined, smaller: Refined) -> tuple[bool, str]:
    """Whether the larger structure earns its extra numbers, with the sentence that says why."""
    unit = unit_of(larger)
    extra = larger.numbers - smaller.numbers
    size = max(float(larger.fit.count[~larger.fit.held].sum()), 2.0)
    fitted = (smaller.fit.train - larger.fit.train) / unit - extra * np.log(size)
    held = (smaller.fit.validation - larger.fit.validation) / unit
    validation = bool(larger.fit.held.any())
    part = part_taken(larger, smaller)
    steps = max(len(larger.causes) - len(smaller.causes), 1)
    needed = 1 - (1 - PART_LEFT) ** steps
    failed = [
        text
        for wrong, text in (
            (bool(larger.fit.reason), larger.fit.reason),
            (not fitted > SIGNIFICANT, f"not significant on fitted windows ({fitted:.3g})"),
            (validation and not held > SIGNIFICANT, f"not on held windows ({held:.3g})"),
            (not part > needed, f"takes {_percent(part)} of what is left"),
        )
        if wrong
    ]
    names, against = _named(larger.causes), _named(smaller.causes)
    judged = (
        "rejected: " + ", ".join(failed)
        if failed
        else (f"accepted: takes {_percent(part)} of what is left")
    )
    return not failed, f"{names}, against {against}: {judged}"


def part_taken(larger: Refined, smaller: Refined) -> float:
    """The share of the mismatch left by ``smaller`` that ``larger`` takes, on held windows (on the
    fitted ones where none is held); the noise floor is taken off."""
    held = smaller.fit.held if smaller.fit.held.any() else ~smaller.fit.held
    floor = float(smaller.fit.count[held].sum())
    before, after = float(smaller.fit.chi2[held].sum()), float(larger.fit.chi2[held].sum())
    if not np.isfinite(before):
        return 1.0
    left = max(before - min(floor, after), 1e-12)
    return (before - after) / left


def exact_twins(problem: Problem) -> tuple[tuple[int, int], ...]:
    """Pairs of causes whose effects are the same on these windows, the one to be named first.

    A parameter that may be estimated goes before a force, a force before a channel, an input
    before a sensor.
    """
    causes = problem.hypotheses
    order = sorted(range(len(causes)), key=lambda i: precedence(i, causes[i]))
    pairs, gone = [], set()
    for place, first in enumerate(order):
        if first in gone or len(problem.columns[first]) > 1:
            continue
        a = problem.columns[first][0]
        for second in order[place + 1 :]:
            if second in gone or len(problem.columns[second]) > 1:
                continue
            b = problem.columns[second][0]
            power = problem.gram[a, a] * problem.gram[b, b]
            if power > 0 and 1 - problem.gram[a, b] ** 2 / power < 1e-6:
                pairs.append((first, second))
                gone.add(second)
    return tuple(pairs)


def precedence(index: int, cause: Hypothesis) -> tuple[int, int]:
    """Which of two equal causes is named: a parameter that may be estimated before a force, a force
    before a channel, an input before a sensor."""
    return {"parameter": 0, "gain": 2, "offset": 3}.get(cause.kind, 1), index


def _screened(setting: Setting, stage: Stage) -> Problem:
    model = setting.windows
    p, floor = model.machine.values, setting.gain_floor
    return screen(setting.library, model, setting.dull, stage.laid, p, setting.sd, gain_floor=floor)


def around(setting: Setting, winner: Refined) -> Problem:
    """The reduced problem along the winner's simulation, its own numbers always in."""
    paths = [*(cause.path for cause in setting.dull), *winner.paths]
    unique = list(dict.fromkeys(paths))
    model = WindowModel(winner.machine, tuple(winner.machine.column(path) for path in unique))
    laid = setting.stages[-1].laid
    starts, floor = winner.fit.starts, setting.gain_floor
    return screen(setting.library, model, setting.dull, laid, winner.p, setting.sd, starts, floor)


def without(problem: Problem, dropped: set[int]) -> Problem:
    """The problem in which some causes can no longer be chosen."""
    bounds = problem.upper.copy()
    for cause in dropped:
        for column in problem.columns[cause]:
            bounds[column] = -np.inf
    return replace(problem, upper=bounds)


def unit_of(trial: Refined) -> float:
    """χ² of one independent sample: residual variance times its correlation."""
    return trial.fit.scale * trial.fit.correlation


def _criterion(trial: Refined, reference: Refined) -> float:
    size = max(float(trial.fit.count[~trial.fit.held].sum()), 2.0)
    return trial.fit.train / unit_of(reference) + trial.numbers * float(np.log(size))


def grouped(trial: Refined) -> list[list[float]]:
    """Fitted values of the terms (without refined shapes), SI, cause by cause; of a parameter its
    change."""
    rows, i = [], 0
    for cause in trial.causes:
        values = [float(v) for v in trial.fit.values[i : i + len(cause.terms)]]
        if cause.place is None:
            declared = trial.machine.values[trial.machine.column(cause.path)]
            values = [values[0] - float(declared)]
        rows.append(values)
        i += cause.numbers
    return rows
