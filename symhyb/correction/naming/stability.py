"""Whether a choice holds when the windows are weighed anew.

One score says how much better the selected structure is over all windows together; it does not
say whether a few windows carry that. So the windows are resampled: every draw weighs them by
exponential weights (the Bayesian bootstrap: Rubin, Annals of Statistics 9, 1981), and each cause is
asked whether the selected structure still beats every structure without it. The fitted trials give
χ² by window, so no draw costs a fit. A plain bootstrap would leave windows out altogether, and an
effect that shows in two of nine would be lost in a tenth of the draws by the draw alone. The share
is reported; what decides is the probability.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.search.conventions import exchange
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.score import believable, piece_of, price
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import FEWEST
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array

DRAWS = 400  # a share of 0.9 is then known to 1.5 %


def stabilities(decision: Decision) -> tuple[float | None, ...]:
    """For each cause of the selected structure the share of draws in which it stays chosen.

    It stays where the selected structure's score is below that of every trial without it, over all
    windows, weighed by the draw: what chose it, asked again. None where too few windows are there.
    """
    selected = decision.selected
    windows = selected.fit.chi2.size
    if windows < FEWEST:
        return (None,) * len(selected.causes)
    weights = np.random.default_rng(0).exponential(size=(DRAWS, windows))
    weights *= windows / weights.sum(axis=1, keepdims=True)
    judged = [trial for trial, _ in decision.judged]  # along whole recordings, not by windows
    margins = [
        (trial, _margin(decision, trial, weights))
        for trial in decision.trials
        if not any(trial is one for one in judged)
    ]
    shares = []
    for cause in selected.causes:
        kept = np.ones(DRAWS, bool)
        for trial, margin in margins:
            if _denies(trial, selected, cause):
                kept &= margin > 0
        shares.append(float(np.mean(kept)))
    return tuple(shares)


def weakest(
    shares: Mapping[Hypothesis, float | None], causes: Sequence[Hypothesis]
) -> float | None:
    """The smallest share of the causes that are reported as one effect."""
    bare = {replace(cause, own=(), by=()): share for cause, share in shares.items()}
    known = [bare.get(replace(cause, own=(), by=())) for cause in causes]
    return min((share for share in known if share is not None), default=None)


def _margin(decision: Decision, trial: Refined, weights: Array) -> Array:
    """By how much the score of a trial is worse than the selected structure's, by draw (DRAWS,)."""
    selected = decision.selected
    if trial.fit.chi2.size != selected.fit.chi2.size:
        return np.full(len(weights), np.inf)
    gain = (trial.fit.chi2 - selected.fit.chi2) / piece_of(selected)
    paid = price(selected, decision.count) - price(trial, decision.count)
    with np.errstate(invalid="ignore"):
        margin = weights @ np.where(np.isfinite(gain), gain, np.inf)
    return np.asarray(margin - paid)


def _denies(trial: Refined, selected: Refined, cause: Hypothesis) -> bool:
    """Whether a trial is an answer without this cause: the law in another shape is no denial, an
    extension that was refused is none, and what convention separates no window does."""
    mine = _sort(cause)
    if trial.fit.reason or any(_sort(other) == mine for other in trial.causes):
        return False
    if not believable(trial):
        return False
    change = exchange(trial.causes, selected.causes)
    return not change.conventional and not change.grows


def _sort(cause: Hypothesis) -> tuple[object, ...]:
    """What a cause is, whatever its shape: springs of two orders are two, Stribeck friction is
    friction."""
    order = cause.terms if cause.kind in KINDS and KINDS[cause.kind].joins else ()
    return cause.kind, cause.place, cause.path, order
