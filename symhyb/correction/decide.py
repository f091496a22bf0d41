"""Which causes are believed: structures refined on trajectories, judged on held windows.

1. Linear screens at growing window lengths, and sparse regression on the weak form, name
   structures worth a trial.
2. At the longest windows the trials are refined by simulation error. From no cause upwards, a
   larger structure is taken only if it is significant on fitted *and* on held windows for coloured
   residuals, and takes a stated part of the mismatch that is then left.
3. Terms are added, swapped and dropped around the winner until nothing changes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.correction.screen import screen
from symhyb.correction.selection import Problem, Subset, best_subsets, solve
from symhyb.correction.trajectory import Refined, refine
from symhyb.discrepancy.hypotheses import Hypothesis, Library
from symhyb.discrepancy.windows import Laid
from symhyb.numeric.buffers import Array
from symhyb.numeric.windows import WindowModel

SIGNIFICANT = 10.0  # Δχ²/c − k ln N on fitted windows, Δχ²/c on held ones (10: odds of 150 to 1)
PART_LEFT = 1 / 3  # of the mismatch that is left, which a cause must take
RIVAL = 10.0  # of the criterion: closer than this, a rival is told
TRIALS = 3  # refined structures of each size

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Stage:
    """One window length in s and the windows of all recordings at it."""

    length_s: float
    laid: tuple[Laid, ...]


@dataclass(frozen=True, slots=True)
class Setting:
    """What a decision works on: force hypotheses lowered, dull causes, windows prepared for the
    model with all dull causes free, stages from short to long, noise ``sd`` (m,), SI."""

    library: Library
    dull: tuple[Hypothesis, ...]
    windows: WindowModel
    stages: tuple[Stage, ...]
    sd: Array

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
    pool: dict[tuple[int, ...], Subset] = {subset.causes: subset for subset in proposals}
    twins: tuple[tuple[int, int], ...] = ()
    for stage in setting.stages:
        say(f"screening {len(setting.hypotheses)} causes on windows of {stage.length_s:.3g} s")
        problem = _screened(setting, stage)
        twins = exact_twins(problem)
        for sized in best_subsets(_without(problem, {second for _, second in twins})):
            for subset in sized[:TRIALS]:
                pool[subset.causes] = subset
    trials = _Trials(setting, say)
    nothing = trials.refined(())
    winner = _climb(trials, nothing, list(pool.values()), log)
    for _ in range(4):
        better = _improve(trials, winner, twins, log)
        if better is winner:
            break
        winner = better
    named = tuple((setting.hypotheses[a], setting.hypotheses[b]) for a, b in twins)
    return Decision(winner, nothing, tuple(trials.done.values()), named, tuple(log))


class _Trials:
    """Structures refined at the longest windows, each once."""

    def __init__(self, setting: Setting, say: Say):
        self.setting, self.say = setting, say
        self.done: dict[tuple[int, ...], Refined] = {}

    def refined(self, causes: tuple[int, ...], values: Sequence[float] = ()) -> Refined:
        causes = tuple(causes)
        key = tuple(sorted(causes))
        if key not in self.done:
            chosen = [self.setting.hypotheses[cause] for cause in causes]
            self.say("trying " + (" + ".join(map(str, chosen)) or "the model as it is"))
            start, rest = {}, list(values)
            for i, cause in enumerate(chosen):
                start[i] = [rest.pop(0) for _ in cause.terms]
            stage = self.setting.stages[-1]
            model = self.setting.windows.machine.model
            self.done[key] = refine(model, chosen, start, stage.laid, self.setting.sd)
        return self.done[key]

    def causes(self, trial: Refined) -> tuple[int, ...]:
        return tuple(self.setting.hypotheses.index(cause) for cause in trial.causes)


def _climb(trials: _Trials, nothing: Refined, pool: list[Subset], log: list[str]) -> Refined:
    """From no cause upwards: the smallest larger structure that earns its place, and so on."""
    winner = nothing
    for size in range(1, max((len(s.causes) for s in pool), default=0) + 1):
        sized = sorted((s for s in pool if len(s.causes) == size), key=lambda s: s.chi2)
        best: Refined | None = None
        for subset in sized[: 2 * TRIALS]:
            trial = trials.refined(subset.causes, subset.values)
            if best is None or _criterion(trial, trial) < _criterion(best, trial):
                best = trial
        if best is None:
            continue
        earned, sentence = earns(best, winner)
        log.append(sentence)
        if earned:
            winner = best
        elif size > len(winner.causes) + 2:
            break
    return winner


def _improve(
    trials: _Trials, winner: Refined, twins: Sequence[tuple[int, int]], log: list[str]
) -> Refined:
    """Add, swap or drop one cause around the winner, linearised along its own simulation."""
    problem = _around(trials, winner)
    dropped = {second for _, second in twins}
    held = set(trials.causes(winner))
    best = winner
    base = solve(problem, ())
    if base is None:
        return winner
    added = [s for c in range(len(problem.hypotheses)) if c not in held | dropped
             if (s := solve(problem, (c,))) is not None]  # fmt: skip
    for subset in sorted(added, key=lambda s: s.chi2)[:TRIALS]:
        gain = (base.chi2 - subset.chi2) / _unit(winner)
        if gain < SIGNIFICANT:
            continue
        values = [*_terms(winner), *subset.values]
        trial = trials.refined((*trials.causes(winner), *subset.causes), values)
        earned, sentence = earns(trial, best)
        log.append(sentence)
        if earned:
            best = trial
    if best is not winner:
        return best
    for i, cause in enumerate(trials.causes(winner)):
        rest = tuple(c for c in trials.causes(winner) if c != cause)
        kept = [v for j, vs in enumerate(_grouped(winner)) if j != i for v in vs]
        smaller = trials.refined(rest, kept)
        earned, sentence = earns(winner, smaller)
        log.append(sentence)
        if not earned:
            return smaller
    return best


def earns(larger: Refined, smaller: Refined) -> tuple[bool, str]:
    """Whether the larger structure earns its extra numbers, with the sentence that says why."""
    unit = _unit(larger)
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
            (not part > needed, f"takes only {100 * part:.2g} % of what is left"),
        )
        if wrong
    ]
    names = " + ".join(map(str, larger.causes)) or "the model as it is"
    against = " + ".join(map(str, smaller.causes)) or "the model as it is"
    judged = "rejected: " + ", ".join(failed) if failed else (
        f"accepted: takes {100 * part:.3g} % of what {against} leaves"
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
    order = sorted(range(len(problem.hypotheses)), key=lambda i: _precedence(problem, i))
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


def _precedence(problem: Problem, index: int) -> tuple[int, int]:
    kind = problem.hypotheses[index].kind
    return {"parameter": 0, "gain": 2, "offset": 3}.get(kind, 1), index


def _screened(setting: Setting, stage: Stage) -> Problem:
    model = setting.windows
    return screen(
        setting.library, model, setting.dull, stage.laid, model.machine.values, setting.sd
    ).problem


def _around(trials: _Trials, winner: Refined) -> Problem:
    """The reduced problem along the winner's simulation, its own numbers always in."""
    setting = trials.setting
    paths = [*(cause.path for cause in setting.dull), *winner.paths]
    unique = list(dict.fromkeys(paths))
    model = WindowModel(winner.machine, tuple(winner.machine.column(path) for path in unique))
    laid = setting.stages[-1].laid
    return screen(
        setting.library, model, setting.dull, laid, winner.p, setting.sd, winner.fit.starts
    ).problem


def _without(problem: Problem, dropped: set[int]) -> Problem:
    """The problem in which some causes can no longer be chosen."""
    bounds = problem.upper.copy()
    for cause in dropped:
        for column in problem.columns[cause]:
            bounds[column] = -np.inf
    return Problem(
        problem.gram, problem.held, problem.hypotheses, problem.columns, problem.always,
        problem.prior, problem.lower, bounds,
    )  # fmt: skip


def _unit(trial: Refined) -> float:
    """χ² of one independent sample: residual variance times its correlation."""
    return trial.fit.scale * trial.fit.correlation


def _criterion(trial: Refined, reference: Refined) -> float:
    size = max(float(trial.fit.count[~trial.fit.held].sum()), 2.0)
    return trial.fit.train / _unit(reference) + trial.numbers * float(np.log(size))


def _grouped(trial: Refined) -> list[list[float]]:
    """Fitted values of the terms (without refined shapes), cause by cause; changes for parameters."""
    rows, i = [], 0
    for cause in trial.causes:
        values = [float(v) for v in trial.fit.values[i : i + len(cause.terms)]]
        if cause.place is None:
            declared = trial.machine.values[trial.machine.column(cause.path)]
            values = [values[0] - float(declared)]
        rows.append(values)
        i += cause.numbers
    return rows


def _terms(trial: Refined) -> list[float]:
    return [value for row in _grouped(trial) for value in row]
