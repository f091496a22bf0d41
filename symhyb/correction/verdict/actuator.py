"""A choice with the actuator of an input, where that does not act as it was recorded, or with a
sensor that lags.

The innovations along whole recordings say what it does; the windows, which every structure is
decided by, fit its number and have the last word.
"""

from dataclasses import replace

from symhyb.correction.adequacy.actuators import (
    NOTHING_BEHIND,
    deviating_input,
    instead_of_class,
    lagging_sensor,
)
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.search.decide import decide_with
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.trajectory import grouped
from symhyb.correction.verdict.choice import Choice
from symhyb.model.actuators import ACTUATOR_KEYS, SENSOR_LAG
from symhyb.steps import Say

_KINDS = (*ACTUATOR_KEYS, SENSOR_LAG)


def with_actuator(prepared: Prepared, choice: Choice, judged: Adequacy, say: Say) -> Choice | None:
    """The choice with what explains, as numbers of an actuator, what was ``judged`` to be an input
    that acts otherwise than recorded, or as its lag what was judged to be that of a sensor; None
    where nothing does, or the windows do not agree. Where several explain as well, the choice as it
    is, with these beside it."""
    late = lagging_sensor(judged)
    if choice.misfits or not (deviating_input(judged) or late):
        return None
    what = "a sensor that lags" if late else "an input that acts otherwise than recorded"
    say(f"fitting {what}")
    ground = recorded(prepared, choice.setting)
    found = NOTHING_BEHIND if ground is None else instead_of_class(ground, judged)
    if not found.trials:
        return None
    if len(found.trials) > 1 or found.sensors:
        return replace(choice, behind=found)
    (only,) = found.trials
    decision = decide_with(choice.setting, choice.decision, only.causes, grouped(only), say)
    if not any(cause.kind in _KINDS for cause in decision.selected.causes):
        return None
    return replace(choice, decision=decision, along=None)


def acts_so(choice: Choice, again: Adequacy, before: Adequacy) -> bool:
    """Whether a choice with an actuator, or a sensor that lags, stands when it is judged: none of
    its numbers is in doubt, and neither the input nor the sensor is the answer any more."""
    mine = {cause for cause in choice.decision.selected.causes if cause.kind in _KINDS}
    sure = bool(mine) and not again.unjudged and not mine & again.doubt
    return sure and _answer(again) != _answer(before)


def _answer(judged: Adequacy) -> tuple[str | None, str | None]:
    """The input that acts otherwise, or the sensor that lags."""
    return deviating_input(judged), lagging_sensor(judged)
