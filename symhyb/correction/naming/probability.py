"""The posterior probability of each cause of a decision.

Scores are −2 ln of posterior probabilities, so the fitted admissible structures share
them by exp(−score/2), and a cause has what the structures with it have together (Bayesian model
averaging: Hoeting et al., Statistical Science 14, 1999). What was never fitted has no share: a
search fits whatever the linear problem lets come near. Where the structures that come near were
judged along whole recordings, those share it.
"""

import numpy as np

from symhyb.correction.search.conventions import exchange
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.score import believable
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis


def probabilities(decision: Decision) -> tuple[float, ...]:
    """The posterior probability of each cause of the selected structure."""
    selected, shared = decision.selected, shares(decision)
    return tuple(
        float(sum(share for trial, share in shared if _holds(trial, cause, selected)))
        for cause in selected.causes
    )


def shares(decision: Decision) -> list[tuple[Refined, float]]:
    """The structures that share all probability, each with its part."""
    selected, judged = decision.selected, [trial for trial, _ in decision.judged]
    trials = [
        trial
        for trial in judged or decision.trials
        if trial is selected or (not trial.causes and not trial.fit.reason) or believable(trial)
    ]
    behind = np.array([decision.against(trial) for trial in trials])
    weights = np.where(np.isfinite(behind), np.exp(-(behind - np.nanmin(behind)) / 2), 0.0)
    return list(zip(trials, (weights / weights.sum()).tolist(), strict=True))


def _holds(trial: Refined, cause: Hypothesis, selected: Refined) -> bool:
    """Whether a structure holds a cause: the law in any shape, with a key more or less, or another
    one that convention alone sets apart from it."""
    if any(mine.extends(cause) or cause.extends(mine) for mine in trial.causes):
        return True
    change = exchange(trial.causes, selected.causes)
    return change.conventional and cause in change.lost
