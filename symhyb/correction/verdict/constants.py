"""Numbers that the model file holds: whether one of them, wrong, would say as much as what was
found.

A parameter without an ``sd`` is taken for certain and is no cause. But a mass that was never
weighed shows as several laws at once; one number in place of them is then worth a sentence.
"""

from collections.abc import Sequence
from dataclasses import replace

from symhyb.correction.naming.findings import reestimated
from symhyb.correction.search.score import piece_of, score
from symhyb.correction.search.screen import screen
from symhyb.correction.search.selection import solve
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.correction.verdict.choice import Choice
from symhyb.correction.verdict.refusal import withdrawn
from symhyb.discrepancy.places.hypotheses import Hypothesis, wrong_parameter
from symhyb.discrepancy.results import Alternative, Diagnosis, Estimate
from symhyb.discrepancy.words.wording import parameter_phrase
from symhyb.judgement import CLOSE, MOST, NEAR_NOISE, SIGNIFICANT, SLIP_MOST
from symhyb.numeric.runs.windows import WindowModel

TRIED = 2
CURE = "If it may be wrong, state its sd in the file, and it competes"


def with_constant(answer: Diagnosis, choice: Choice) -> Diagnosis:
    """The answer with the held number of the model that would say as much, if there is one; where
    it says more than all causes, nothing else is claimed."""
    selected, nothing = choice.decision.selected, choice.decision.nothing
    if answer.verdict == "nothing missing" or selected.owned:
        return answer
    found = wrong_constant(choice.setting, selected, nothing, choice.decision.count)
    if found is None:
        return answer
    trial, evidence = found
    (number,) = reestimated(trial.machine.model, trial)
    estimate = Estimate(number.name, number.value, number.sd, number.unit, "value")
    rival = Alternative(None, "parameter", (estimate,), max(evidence, 0.0), parameter=number.name)
    said = parameter_phrase(number)
    if selected.causes and evidence < -SIGNIFICANT:
        reason = f"A number that the model file holds explains more than all causes: {said}. {CURE}"
        answer = withdrawn(
            answer, f"{reason}; until that is settled no physics is named", "of causes fits best"
        )
        return replace(answer, alternatives=(rival, *answer.alternatives))
    doing = "says as much" if selected.causes else "explains it"
    sentence = f"One number that the model file holds {doing}: {said}. {CURE}."
    return replace(
        answer,
        sentence=f"{answer.sentence} {sentence}",
        alternatives=(rival, *answer.alternatives),
        notes=(sentence, *answer.notes),
    )


def wrong_constant(
    setting: Setting, selected: Refined, nothing: Refined, count: int
) -> tuple[Refined, float] | None:
    """The held parameter, as a structure by itself, that explains the recordings down to their
    noise with no more numbers than ``selected``, about as well or better, and its score against
    the selected structure's (negative: better); None if there is none."""
    best: tuple[Refined, float] | None = None
    for cause, change in _promising(setting, nothing):
        trial = refine(
            setting.windows.machine.model,
            (cause,),
            [{"value": change}],
            setting.stages[-1].cuts,
            setting.sd,
        )
        if trial.fit.reason or not trial.fit.scale < NEAR_NOISE or not _near(trial, cause):
            continue
        unit = piece_of(trial)
        mine = score(trial, unit, count)
        if not mine < score(nothing, unit, count):
            continue
        evidence = mine - score(selected, unit, count)
        fewer = not selected.causes or trial.numbers <= selected.numbers
        if fewer and evidence < CLOSE and (best is None or evidence < best[1]):
            best = trial, evidence
    return best


def _near(trial: Refined, cause: Hypothesis) -> bool:
    """Whether a fitted number is of the size that the file states."""
    held = trial.machine.values[trial.machine.column(cause.path)]
    return bool(1 / SLIP_MOST < trial.value(cause.path)[0] / held < SLIP_MOST)


def _promising(setting: Setting, nothing: Refined) -> Sequence[tuple[Hypothesis, float]]:
    """The held parameters that could take most of the mismatch, with their changes, SI."""
    machine, cuts = setting.windows.machine, setting.stages[-1].cuts
    known = {path for item in cuts for path in item.block.known}
    held = [
        wrong_parameter(item)
        for item in machine.model.parameters
        if item.sd is None and item.value != 0 and item.path not in known
    ]
    if not held:
        return []
    columns = tuple(machine.column(cause.path) for cause in held)
    problem = screen(
        setting.library, WindowModel(machine, columns), held, cuts, machine.values, setting.sd
    )
    base, first = solve(problem, ()), len(setting.library.hypotheses)
    if base is None:
        return []
    floor = float(nothing.fit.count[~nothing.fit.held].sum())
    subsets = [solve(problem, (first + i,)) for i in range(len(held))]
    able = [
        subset
        for subset in subsets
        if subset is not None and base.chi2 - subset.chi2 > MOST * (base.chi2 - floor)
    ]
    ranked = sorted(able, key=lambda subset: subset.chi2)[:TRIED]
    return [(held[s.causes[0] - first], float(s.values[0])) for s in ranked]
