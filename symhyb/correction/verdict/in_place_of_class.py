"""A choice with a law in place of a class: an own curve for a force of stretch and rate without a
name, a mode for a hidden mode, laws of a pair for a coupling.

The innovations along whole recordings say that it is one; the windows, which every structure is
decided by, fit its values and have the last word.
"""

from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.curves.answer import instead_of_class
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.named_coupling import couplings_instead, pair_of
from symhyb.correction.adequacy.named_mode import modes_instead
from symhyb.correction.adequacy.pairs import PAIR_LAWS
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.search.decide import decide_with
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.trajectory import Refined, grouped, keys_of
from symhyb.correction.verdict.choice import Choice
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import OUTSTANDING
from symhyb.model.types import Place
from symhyb.steps import Say

_TWICE = frozenset({"mode", "hydromount", *(law.name for law in PAIR_LAWS)})
"""Kinds whose numbers windows and innovations must agree on."""


def with_law(prepared: Prepared, choice: Choice, judged: Adequacy, say: Say) -> Choice | None:
    """The choice with what explains what was ``judged`` to be a force of stretch and rate, as a
    curve or by listed laws that are as good, or to be a hidden mode, as a mode, or a coupling, as
    laws of the pair. None where nothing does, or the windows do not agree."""
    if _place(judged) is None or choice.misfits:
        return None
    mode, pair = judged.certain("hidden mode") is not None, pair_of(judged)
    what = "a mode" if mode else "couplings" if pair is not None else "a curve"
    say(f"fitting {what} to a force without a name")
    ground = recorded(prepared, choice.setting)
    if ground is None:
        return None
    found = None
    if judged.certain("law") is not None:
        found = instead_of_class(ground, judged)
    elif mode:
        found = modes_instead(ground, judged)
    elif pair is not None:
        found = couplings_instead(ground, judged)
    if found is None:
        return None
    decision = decide_with(choice.setting, choice.decision, found.causes, grouped(found), say)
    before = {cause.family for cause in choice.decision.selected.causes}
    fresh = [cause for cause in decision.selected.causes if cause.family not in before]
    if not fresh:
        return None
    return replace(choice, decision=decision, along=None)


def holds(choice: Choice, again: Adequacy, before: Adequacy) -> bool:
    """Whether a choice with such a law stands when it is judged: nothing of it that is at the place
    of the class is in doubt, and that class is no more the answer."""
    place = _place(before)
    mine = {cause for cause in choice.decision.selected.causes if cause.place == place}
    return bool(mine) and not again.unjudged and not mine & again.doubt and _place(again) != place


def one_value(final: Refined, along: Fitted | None) -> bool:
    """Whether windows (``final``) and innovations (``along``) give every number of a mode and of a
    law of a pair one value, within three deviations of both: what two consistent estimators do not
    agree on is not right (Hausman, Econometrica 46, 1978)."""
    if along is None:
        return False
    theirs = _numbers(along)
    return all(
        key in theirs and abs(value - theirs[key][0]) <= OUTSTANDING * np.hypot(sd, theirs[key][1])
        for key, (value, sd) in _numbers(final).items()
    )


def _numbers(trial: Refined | Fitted) -> dict[tuple[Hypothesis, str], tuple[float, float]]:
    """Values and deviations of the numbers of modes, hydromounts and laws of a pair, SI."""
    spread = np.sqrt(np.diag(trial.fit.covariance))
    keys = [(cause, key) for cause in trial.causes for key in keys_of(cause)]
    return {
        pair: (float(trial.fit.values[i]), float(spread[i]))
        for i, pair in enumerate(keys)
        if pair[0].kind in _TWICE
    }


def _place(judged: Adequacy) -> Place | None:
    """Where a class acts that a law may be fitted in place of."""
    return judged.certain("law") or judged.certain("hidden mode") or pair_of(judged)
