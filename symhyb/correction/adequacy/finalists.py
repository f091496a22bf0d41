"""Which of the structures that windows cannot distinguish is selected: the innovations decide.

Windows with free beginnings are quick and robust, and lose what acts slowly. Structures whose
scores are too close for a decision are fitted along whole recordings by the innovations likelihood,
in which an unknown force stands for what all of them lack. One of them rules another out only as
far as it does with the prior of one sample too: where the odds come from how wide a prior nobody
stated is, the recordings did not decide.
"""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.followed import followed
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.conventions import exchange
from symhyb.correction.search.decision import CLOSE_MOST, Decision
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.score import believable, prior_sd
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import families_of
from symhyb.judgement import CLOSE
from symhyb.model.vocabulary import steep
from symhyb.steps import Say, counted, silent

STEP = "holding what is close against whole recordings"


def settled(
    prepared: Prepared, setting: Setting, decision: Decision, say: Say = silent
) -> tuple[Decision, Fitted | None]:
    """The decision with the structure selected among those of almost its score, and that structure
    as it was fitted along whole recordings; None where that was not needed. Where no structure is
    so close beside a steep law, along which fits to windows end in minima of their own, it is
    selected among its parts. ``say`` gets the step, counted."""
    finalists = _finalists(setting, decision)
    if len(finalists) == 1 and steep(decision.selected.machine.model):
        return _needed(prepared, setting, decision, say)
    ground = recorded(prepared, setting) if len(finalists) > 1 else None
    if ground is None:
        return decision, None
    cuts = setting.stages[-1].cuts
    trials = counted(say, STEP, finalists)
    found = [followed(ground, trial, (trial, cuts)) for trial in trials]
    stated = np.array([one.evidence for one in found])
    if not np.isfinite(stated).any():  # none of them could be followed along whole recordings
        return decision, None
    best = int(np.argmax(stated))  # the first of equals: the selected structure
    reference = np.array([evidence(ground, one, by_reference=True) for one in found])
    behind = np.fmin(stated[best] - stated, reference[best] - reference)
    selected = finalists[best]
    judged = tuple(
        (trial, 2 * float(worse)) for trial, worse in zip(finalists, behind, strict=True)
    )
    log = tuple(f"{trial.name}: {-worse / 2:.3g} of ln evidence" for trial, worse in judged)
    settled_one = replace(decision, selected=selected, judged=judged, log=(*decision.log, *log))
    return settled_one, found[best]


def _needed(
    prepared: Prepared, setting: Setting, decision: Decision, say: Say
) -> tuple[Decision, Fitted | None]:
    """The decision without a cause that whole recordings speak against. Of a parameter that states
    an sd they say nothing: it is free in every structure there, named or not."""
    selected, cuts = decision.selected, setting.stages[-1].cuts
    every = {*selected.causes}
    less = [every - {cause} for cause in every if prior_sd(selected, cause) == np.inf]
    parts = [
        trial
        for trial in decision.trials
        if trial.causes and not trial.fit.reason and {*trial.causes} in less
    ]
    ground = recorded(prepared, setting) if parts else None
    if ground is None:
        return decision, None
    trials = counted(say, STEP, (selected, *parts))
    found = [followed(ground, trial, (trial, cuts)) for trial in trials]
    stated = [one.evidence for one in found]
    best = int(np.argmax(stated))
    if not np.isfinite(stated[best]):
        return decision, None
    if best == 0:
        return decision, found[0]
    part, ahead = parts[best - 1], float(stated[best] - stated[0])
    judged = ((part, 0.0), (selected, 2 * ahead))
    log = (*decision.log, f"{part.name}: {ahead:.3g} of ln evidence before {selected.name}")
    return replace(decision, selected=part, judged=judged, log=log), found[best]


def _finalists(setting: Setting, decision: Decision) -> list[Refined]:
    """The selected structure, and the structures of almost its score that are another answer, best
    first."""
    selected, length_s = decision.selected, setting.stages[-1].length_s
    near = [
        trial
        for trial in decision.near(CLOSE)
        if not exchange(trial.causes, selected.causes).conventional
        and families_of(trial.causes) != families_of(selected.causes)
        and believable(trial, length_s)
    ]
    return [selected, *near[: CLOSE_MOST - 1]]
