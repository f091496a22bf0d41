"""What only a whole recording shows: one cause more, judged over all of it at once.

Free initial states of windows take up what acts slowly. A weak damping beside a strong one changes
a decay by little within one window, and by much over all of it. Where the effect of the initial
state decays, a simulation over the whole recording adds up forces and not errors of the beginning,
and is the better judge; the held windows have to agree. On a free integrator it is not, because
there every small error adds up for ever.

They are compared by the score of the search, in the unit of what the better one leaves.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.search.preparing import SAMPLES_MOST, Prepared
from symhyb.correction.search.score import believable, choice_of, piece_of, samples, score, unit_of
from symhyb.correction.search.selection import Problem, Subset, solve, without
from symhyb.correction.search.setting import Setting, Stage, around
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.correction.verdict.choice import Choice
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.runs import cut_into_windows
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.judgement import MOST, NEAR_NOISE, SIGNIFICANT
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel
from symhyb.steps import Say

TENTH = 10  # the end and the start are tenths of a recording
TRIED_MOST = 4  # causes, each over whole recordings


@dataclass(frozen=True, slots=True)
class Completed:
    """The chosen structure with one cause more, fitted over whole recordings (``final``, at
    ``stage``), and with every rival of that cause, best first, by how much its score is worse;
    ``log`` says how they were judged."""

    final: Refined
    stage: Stage
    rivals: tuple[tuple[Refined, float], ...]
    log: tuple[str, ...]

    @property
    def added(self) -> Hypothesis:
        """The cause that is added: the last one of the structure."""
        return self.final.causes[-1]


def completed_over_all(prepared: Prepared, choice: Choice, say: Say) -> Completed | None:
    """The choice with the cause that whole recordings add to it; None where they add none, where
    hardly more than noise is left, or where whole recordings are no judge."""
    setting, selected = choice.setting, choice.decision.selected
    if not selected.causes or selected.fit.scale < NEAR_NOISE or selected.owned:
        return None
    if choice.change is not None or choice.misfits:  # what is whole is in question itself
        return None
    stage = whole_of(prepared, setting)
    if stage is None:
        return None
    say("judging over whole recordings")
    setting = replace(setting, stages=(*setting.stages, stage))
    base = _over_all(setting, selected.causes, selected, grouped(selected), ())
    if base.fit.reason or not forgets(base, stage):
        return None
    log: list[str] = []
    found = [
        trial
        for trial in _tried(choice, setting, base)
        if _stands(setting, selected, base, trial, choice.decision.count, log)
    ]
    if not found:
        return None
    unit = piece_of(min(found, key=lambda trial: trial.fit.train))
    ranked = sorted((score(trial, unit, 1), i) for i, trial in enumerate(found))
    best = found[ranked[0][1]]
    rivals = [
        (found[i], behind - ranked[0][0])
        for behind, i in ranked[1:]
        if behind - ranked[0][0] < SIGNIFICANT
    ]
    return Completed(best, stage, tuple(rivals), tuple(log))


def whole_of(prepared: Prepared, setting: Setting) -> Stage | None:
    """Every recording as one window; None where one has gaps, or is one window already, or where
    they have more samples than a search takes: one long window cannot run side by side with others.
    """
    if sum(item.source[0].t.size for item in setting.stages[-1].cuts) > SAMPLES_MOST:
        return None
    cuts: list[Cut] = []
    for item in setting.stages[-1].cuts:
        run = next(run for run in prepared.runs if run.recording is item.source[0])
        t = run.recording.t
        one = cut_into_windows(run, prepared.machine, (t.size - 1) * float(np.median(np.diff(t))))
        if one is None or len(item.start) < 2:
            return None
        cuts.append(item.noise.put_right(one) if item.noise is not None else one)
    return Stage(max(float(np.ptp(item.block.t)) for item in cuts), tuple(cuts))


def forgets(trial: Refined, stage: Stage) -> bool:
    """Whether an error of the state at the start of a recording is down to half at its end, in all
    that the sensors show."""
    free = tuple(trial.machine.column(path) for path in trial.paths)
    model = WindowModel(trial.machine, free)
    half = len(model.form.free)
    if half == 0:  # all motion is given: there is no beginning to forget
        return False
    for item, start in zip(stage.cuts, trial.fit.starts, strict=True):
        suited = item.suited(trial.machine)
        spread = suited.states.reshape(-1, suited.states.shape[2]).std(axis=0)[: 2 * half]
        p = trial.of(item.source[0])
        with np.errstate(over="ignore", invalid="ignore"):
            reply = model.differentiate(suited.block, start, p).from_states()
            size = np.sum((reply[0, :, :, : 2 * half] * spread) ** 2, axis=2)  # (L, m)
        first, *_, last = np.array_split(size, TENTH)
        seen = first.mean(axis=0) > 0
        left = last.mean(axis=0)[seen]
        if not np.all(left <= MOST**2 * first.mean(axis=0)[seen]):
            return False
    return True


def _tried(choice: Choice, setting: Setting, base: Refined) -> list[Refined]:
    """The structure with each cause of one number that the linear problem over whole recordings
    favours, refined; the admissible ones."""
    gone = {setting.hypotheses.index(second) for _, second in choice.decision.equals}
    gone |= {i for i, cause in enumerate(setting.hypotheses) if cause.variant}
    problem = without(around(setting, base), gone)
    tried = []
    for subset in _promised(problem, base, choice.decision.count):
        cause = problem.hypotheses[subset.causes[0]]
        rows = [*grouped(base), cause.values(list(subset.values))]
        trial = _over_all(setting, (*base.causes, cause), base, rows, base.fit.starts)
        if believable(trial):
            tried.append(trial)
    return tried


def _promised(problem: Problem, base: Refined, count: int) -> list[Subset]:
    """Causes of one number, the most promising of each family, by what they would take."""
    empty = solve(problem, ())
    if empty is None:
        return []
    known = {(c.kind, c.place, c.path, term) for c in base.causes for term in c.terms}
    price = np.log(samples(base)) + choice_of(count)
    best: dict[object, Subset] = {}
    for i, cause in enumerate(problem.hypotheses):
        terms = {(cause.kind, cause.place, cause.path, term) for term in cause.terms}
        if cause.numbers > 1 or terms & known or (subset := solve(problem, (i,))) is None:
            continue
        worth = empty.chi2 - subset.chi2 > MOST * price * piece_of(base)
        if worth and (cause.family not in best or subset.chi2 < best[cause.family].chi2):
            best[cause.family] = subset
    return sorted(best.values(), key=lambda subset: subset.chi2)[:TRIED_MOST]


def _stands(
    setting: Setting,
    selected: Refined,
    base: Refined,
    trial: Refined,
    count: int,
    log: list[str],
) -> bool:
    """Whether the added cause passes the selection over whole recordings, and the held ones of the
    longest windows, at which ``selected`` was fitted, agree."""
    unit = piece_of(trial)
    gain = score(base, unit, count) - score(trial, unit, count)
    log.append(f"{trial.name} over whole recordings, against {base.name}: better by {gain:.3g}")
    if not gain > 0 or not selected.fit.held.any():
        return gain > 0
    model, cuts = setting.windows.machine.model, setting.stages[-2].cuts
    larger = refine(model, trial.causes, grouped(trial), cuts, setting.sd, selected.fit.starts)
    held = (selected.fit.validation - larger.fit.validation) / unit_of(larger)
    agreed = not larger.fit.reason and held > SIGNIFICANT
    said = "agree" if agreed else "do not agree"
    log.append(f"{trial.name}: held windows {said} ({held:.3g})")
    return agreed


def _over_all(
    setting: Setting,
    causes: Sequence[Hypothesis],
    before: Refined,
    rows: Sequence[dict[str, float]],
    starts: Sequence[Array],
) -> Refined:
    """Causes fitted over whole recordings, from values ``rows``, SI."""
    return refine(
        setting.windows.machine.model,
        causes,
        rows,
        setting.stages[-1].cuts,
        setting.sd,
        starts or None,
        everything=True,
        careful=True,
    )
