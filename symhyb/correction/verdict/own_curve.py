"""A choice with an own curve, where what acts is a force of stretch or of rate without a name.

The innovations along whole recordings say that it is one; the windows, which every structure is
decided by, fit its values and have the last word.
"""

from dataclasses import replace

from symhyb.correction.adequacy.curves.answer import instead_of_class, is_law
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.search.decide import decide_with
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.trajectory import grouped
from symhyb.correction.verdict.choice import Choice
from symhyb.steps import Say


def with_curve(prepared: Prepared, choice: Choice, judged: Adequacy, say: Say) -> Choice | None:
    """The choice with what explains, as a curve or by listed laws that are as good, what was
    ``judged`` to be a force of stretch and rate; None where nothing does, or the windows do not
    agree."""
    if is_law(judged) is None or choice.misfits:
        return None
    say("fitting a curve to a force without a name")
    ground = recorded(prepared, choice.setting)
    found = None if ground is None else instead_of_class(ground, judged)
    if found is None:
        return None
    decision = decide_with(choice.setting, choice.decision, found.causes, grouped(found), say)
    before = {cause.family for cause in choice.decision.selected.causes}
    fresh = [cause for cause in decision.selected.causes if cause.family not in before]
    if not fresh:
        return None
    return replace(choice, decision=decision, along=None)


def holds(choice: Choice, again: Adequacy, before: Adequacy) -> bool:
    """Whether a choice with a curve stands when it is judged: nothing of it that is at the place of
    the force without a name is in doubt, and that is no more the answer."""
    place = is_law(before)
    mine = {cause for cause in choice.decision.selected.causes if cause.place == place}
    return bool(mine) and not again.unjudged and not mine & again.doubt and is_law(again) != place
