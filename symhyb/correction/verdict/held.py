"""Deviations of fitted values where a parameter of the model is held that is itself uncertain.

A parameter that states an sd and was not chosen as a cause stays at its stated value; the values
that were fitted beside it hold for that value alone. What its sd, narrowed by the recordings,
leaves open of them is part of their deviation (Guide to the expression of uncertainty in
measurement, 2008, 5.2). A parameter has no part in it where a variant of its law stands beside its
element: of a damper and of one by direction beside it the recordings determine the sum alone.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.search.setting import Setting, Stage
from symhyb.correction.search.trajectory import Refined, grouped, refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.standing import taken_over, uncertain_beside
from symhyb.model.types import Model


def with_what_is_held(model: Model, setting: Setting, final: Refined, stage: Stage) -> Refined:
    """The structure with deviations that allow for the parameters that are held. Its values stay:
    the corrected model states those parameters as before."""
    sums = {path for cause in final.causes for path in taken_over(model, cause)}
    beside = uncertain_beside(model, setting.parametric, final.causes)
    held = tuple(cause for cause in beside if cause.path not in sums)
    if not held or not final.numbers:
        return final
    start = [*grouped(final), *({"value": 0.0} for _ in held)]
    freed = refine(
        model,
        (*final.causes, *held),
        start,
        stage.cuts,
        setting.sd,
        final.fit.starts,
        everything=True,
    )
    if freed.fit.reason:
        return final
    rows = _rows(final, held, freed)
    old, new = np.diag(final.fit.covariance), np.diag(freed.fit.covariance)[rows]
    known = np.isfinite(old) & np.isfinite(new)  # what nobody knows becomes no less known
    ratio = np.divide(new, np.maximum(old, 1e-300), out=np.ones_like(new), where=known)
    wider = np.sqrt(np.maximum(ratio, 1.0))
    covariance = final.fit.covariance * np.outer(wider, wider)
    return replace(final, fit=replace(final.fit, covariance=covariance))


def _rows(final: Refined, held: Sequence[Hypothesis], freed: Refined) -> list[int]:
    """Where the numbers of a structure stand among those with ``held`` ones behind the causes."""
    if not freed.owned:
        return list(range(final.numbers))
    rows = np.arange(final.numbers)
    for columns, wider in zip(final.owned, freed.owned, strict=bool(final.owned)):
        rows[list(columns)] = wider[: len(columns)]
    return list(rows)
