"""The structure that recordings choose: of one recording throughout, of a part of it, of many.

Where an effect begins or ends on the way its law is sought where it acts; a recording that does not
fit the others is named, and does not choose with them.
"""

from dataclasses import dataclass, replace

from symhyb.correction.adequacy.actuators import NOTHING_BEHIND, Behind
from symhyb.correction.adequacy.finalists import settled
from symhyb.correction.adequacy.followed import followed
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.adequacy.sensor_noise import measured_again
from symhyb.correction.adequacy.structure import Fitted
from symhyb.correction.naming.fleet_words import misfit
from symhyb.correction.search.beginnings import active_part, changed, contradicted
from symhyb.correction.search.decide import decide, decide_among
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.fleet import Outlier, outliers, own_value, parted, without
from symhyb.correction.search.force_screen import ForceScreen
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.selection import many
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.so_far import fits_best, if_interrupted
from symhyb.deadline import OutOfTimeError
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.locate import locate
from symhyb.discrepancy.results import Change, Misfit, PlaceShare
from symhyb.judgement import CERTAIN, SIGNIFICANT
from symhyb.model.types import Model
from symhyb.steps import Say

ALONG_WHOLE = "structures of almost the same score along whole recordings"
EACH_OTHER = "the recordings against each other"
THROUGHOUT = "causes that act throughout, for what begins or ends on the way may do so"
COLOURED = "causes under noise of the sensors that is correlated in time"


@dataclass(frozen=True, slots=True)
class Choice:
    """A decision with the ``setting`` that it was made in, the map of ``places``, the ``change`` on
    the way that restricts it, and recordings that are ``misfits``; the selected structure
    ``along`` whole recordings, where that was needed; what may stand ``behind`` an input and is not
    distinguished."""

    setting: Setting
    decision: Decision
    places: tuple[PlaceShare, ...]
    change: Change | None
    misfits: tuple[Misfit, ...]
    along: Fitted | None = None
    behind: Behind = NOTHING_BEHIND

    def without(self, *unmade: str) -> "Choice":
        """The choice where time did not allow these comparisons, in words."""
        decision = replace(self.decision, unmade=(*self.decision.unmade, *unmade))
        return replace(self, decision=decision)


def choose(prepared: Prepared, setting: Setting, forces: ForceScreen | None, say: Say) -> Choice:
    """Screen all causes, map the places and decide; again where the sensors prove noisier."""
    choice = chosen(prepared, setting, forces, say)
    selected = choice.decision.selected
    if choice.decision.unmade or many(selected.causes):  # forces, not windows, show so many
        return choice
    try:
        sd, along = measured_again(prepared, choice.setting, selected, choice.along)
        choice = replace(choice, along=along)
        if sd is None:
            return choice
        say("deciding again, for the noise of a sensor is correlated in time")
        again = chosen(prepared, replace(setting, sd=sd), forces, say)
        if not again.decision.unmade:
            return again if _as_likely(prepared, again, choice) else choice
    except OutOfTimeError:
        pass
    return choice.without(COLOURED)


def _as_likely(prepared: Prepared, again: Choice, before: Choice) -> bool:
    """Whether a choice under another noise stands: it is of the same laws, or as likely along whole
    recordings, to 100 to 1. What a structure leaves of the forces may pass for noise of sensors,
    beside which no other one needs to explain anything."""
    selected, was = again.decision.selected, before.decision.selected
    if {cause.family for cause in selected.causes} == {cause.family for cause in was.causes}:
        return True
    ground = recorded(prepared, before.setting)  # which measures the noise of either
    if ground is None or before.along is None:
        return not selected.fit.reason
    along = followed(ground, selected, (selected, again.setting.stages[-1].cuts))
    return along.evidence > before.along.evidence - CERTAIN


def chosen_again(prepared: Prepared, setting: Setting, choice: Choice, say: Say) -> Choice:
    """A choice in another ``setting``, whose noise is another one, among the structures that were
    close; as it is where nothing can be fitted under that noise."""
    among = decide_among(setting, choice.decision, say)
    decision, along = settled(prepared, setting, among, say)
    again = replace(choice, setting=setting, decision=decision, along=along)
    return _or_before(again, choice)


def _or_before(again: Choice, before: Choice) -> Choice:
    """A choice under another noise; the one before where that noise hides all causes without which
    the model cannot be simulated."""
    selected = again.decision.selected
    return before if selected.fit.reason and not selected.causes else again


def chosen(prepared: Prepared, setting: Setting, forces: ForceScreen | None, say: Say) -> Choice:
    """One decision, with the noise of the sensors as it is known."""
    say("mapping the places")
    places = locate(
        setting.library,
        setting.windows,
        setting.middle.cuts,
        prepared.machine.values,
        setting.sd,
        setting.stages[0].cuts,
    )
    setting, decision, change = _where_it_acts(setting, forces, places, say)
    choice = Choice(setting, decision, places, change, ())
    if decision.unmade:
        return choice.without(ALONG_WHOLE)
    try:
        choice = _held_together(choice, prepared.model, forces, say)
    except OutOfTimeError:
        return choice.without(EACH_OTHER, ALONG_WHOLE)
    if choice.decision.unmade:
        return choice.without(ALONG_WHOLE)
    setting, decision = choice.setting, choice.decision
    try:
        with if_interrupted(lambda: fits_best(decision.selected, len(decision.trials))):
            decision, along = settled(prepared, setting, decision, say)
    except OutOfTimeError:
        return choice.without(ALONG_WHOLE)
    return replace(choice, decision=decision, along=along)


def _held_together(choice: Choice, model: Model, forces: ForceScreen | None, say: Say) -> Choice:
    """A choice of several recordings once they were held against each other: decided again without
    what does not fit the others, if anything does not."""
    setting, decision = choice.setting, choice.decision
    cuts = setting.stages[-1].cuts
    if len(cuts) < 2:
        return choice
    say("holding the recordings against each other")
    odd = outliers(model, decision.selected, setting.stages[-1], setting.sd)
    if not odd:
        return choice
    misfits = tuple(misfit(decision.selected, one, [i.source[0] for i in cuts]) for one in odd)
    say("deciding again, with what does not fit by itself")
    setting = (
        without(setting, [one.recording for one in odd])
        if len(cuts) > 2
        else parted(setting, decision.selected, odd[0], _rivals(decision, odd[0]))
    )
    decision = decide(setting, forces, say)
    if len(cuts) == 2 and (own := own_value(decision.selected, odd[0])) is not None:
        misfits = (misfit(decision.selected, own, [i.source[0] for i in cuts]),)
    return replace(choice, setting=setting, decision=decision, misfits=misfits)


def _rivals(decision: Decision, odd: Outlier) -> list[Hypothesis]:
    """What may take the place of the cause in which a recording differs."""
    place = decision.selected.causes[odd.cause].place
    return [
        cause
        for trial in decision.trials
        if place is not None and not trial.fit.reason and decision.behind(trial) < SIGNIFICANT
        for cause in trial.causes
        if cause.place == place and cause not in decision.selected.causes
    ]


def _where_it_acts(
    setting: Setting, forces: ForceScreen | None, places: tuple[PlaceShare, ...], say: Say
) -> tuple[Setting, Decision, Change | None]:
    """The decision in the part of a recording where the effect acts, if that is a part."""
    change = changed(places)
    part = active_part(setting, change)
    decision = decide(part, forces, say)
    if change is None or decision.unmade or contradicted(setting, decision.selected, change):
        return part, decision, change
    try:
        say("deciding again, for it may act throughout")
        return setting, decide(setting, forces, say), None
    except OutOfTimeError:
        return part, replace(decision, unmade=(THROUGHOUT,)), change
