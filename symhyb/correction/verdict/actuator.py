"""A choice with the actuator of an input, where that does not act as it was recorded.

The innovations along whole recordings say what it does; the windows, which every structure is
decided by, fit its number and have the last word.
"""

from dataclasses import replace

from symhyb.correction.adequacy.actuators import (
    NOTHING_BEHIND,
    deviating_input,
    instead_of_class,
    late_input,
)
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.search.decide import decide_with
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.trajectory import grouped
from symhyb.correction.verdict.choice import Choice
from symhyb.model.actuators import ACTUATOR_KEYS
from symhyb.steps import Say


def with_actuator(prepared: Prepared, choice: Choice, judged: Adequacy, say: Say) -> Choice | None:
    """The choice with what explains, as numbers of an actuator, what was ``judged`` to be an input
    that acts otherwise than recorded; None where nothing does, or the windows do not agree. Where
    several explain as well, the choice as it is, with these beside it."""
    machine = prepared.machine
    if choice.misfits or not (deviating_input(judged) or late_input(judged, machine)):
        return None
    say("fitting an actuator to an input that acts otherwise than recorded")
    ground = recorded(prepared, choice.setting)
    found = NOTHING_BEHIND if ground is None else instead_of_class(ground, judged)
    if not found.trials:
        return None
    if len(found.trials) > 1 or found.sensors:
        return replace(choice, behind=found)
    (only,) = found.trials
    decision = decide_with(choice.setting, choice.decision, only.causes, grouped(only), say)
    if not any(cause.kind in ACTUATOR_KEYS for cause in decision.selected.causes):
        return None
    return replace(choice, decision=decision, along=None)


def acts_so(choice: Choice, again: Adequacy, before: Adequacy) -> bool:
    """Whether a choice with an actuator stands when it is judged: none of its numbers is in doubt,
    and the input is no more the answer."""
    mine = {cause for cause in choice.decision.selected.causes if cause.kind in ACTUATOR_KEYS}
    sure = bool(mine) and not again.unjudged and not mine & again.doubt
    return sure and deviating_input(again) != deviating_input(before)
