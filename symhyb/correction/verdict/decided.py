"""A decision with its values and what acts beyond it; decided again where that asks for it.

Where the time that was allowed is spent on the way, it is what was compared by then, and says what
was not: nothing may be claimed of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from symhyb.correction.adequacy.beyond import NOTHING
from symhyb.correction.adequacy.input_noise import stands, with_input_noise
from symhyb.correction.adequacy.judge import Adequacy, adequacy
from symhyb.correction.search.clocks import drifting
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.so_far import fits_best, if_interrupted
from symhyb.correction.search.wholes import at_level_of_forces
from symhyb.correction.verdict.actuator import acts_so, with_actuator
from symhyb.correction.verdict.choice import Choice, choose, chosen_again
from symhyb.correction.verdict.estimate import Estimated, estimate
from symhyb.correction.verdict.in_place_of_class import holds, one_value, with_law
from symhyb.data.groups import Own
from symhyb.data.recording import Recording
from symhyb.deadline import SPENT, OutOfTimeError
from symhyb.errors import NumericsError
from symhyb.model.types import Model
from symhyb.steps import Say

BEYOND = "what acts beyond it, of which class that is, and whether that explains without its causes"
OTHERWISE = "inputs that are held, and numbers that change with time"
INSTEAD = "laws, actuators and noise of inputs in place of what acts beyond"


@dataclass(frozen=True, slots=True, eq=False)
class Decided:
    """The ``setting`` of a decision, its ``choice``, the values of that (``known``) and what acts
    beyond it (``judged``); ``unmade`` are comparisons, in words, that time did not allow, without
    which nothing may be claimed."""

    prepared: Prepared
    setting: Setting
    choice: Choice
    known: Estimated
    judged: Adequacy
    unmade: tuple[str, ...] = ()

    def without(self, *unmade: str) -> "Decided":
        """The decision with all of its causes in doubt, for time did not allow these
        comparisons."""
        every = frozenset(self.known.final.causes)
        known, judged = replace(self.known, doubt=every), replace(self.judged, doubt=every)
        return replace(self, known=known, judged=judged, unmade=(*self.unmade, *unmade))


def decided(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
    tell: Say,
) -> Decided:
    """The causes that the recordings choose.

    Raises:
        NumericsError: the model cannot be simulated along the recordings at all.
        OutOfTimeError: the time that was allowed was spent before any structure was fitted.
    """
    tell("estimating motion and noise")
    prepared, setting = _prepared(model, recordings, holdout, own)
    tell("pushing every cause at the level of forces")
    prepared, setting, forces = at_level_of_forces(prepared, setting, own)
    choice = choose(prepared, setting, forces, tell)
    decision = choice.decision
    selected, unmade = decision.selected, decision.unmade
    if decision.nothing.fit.reason and not selected.causes:
        if unmade:
            raise OutOfTimeError(SPENT)
        raise NumericsError(f"the model cannot be simulated: {decision.nothing.fit.reason}")
    so_far = _unjudged(prepared, setting, choice)
    if unmade:
        return so_far.without(*unmade, BEYOND)
    with if_interrupted(lambda: fits_best(selected, len(decision.trials))):
        try:
            so_far = _judged(so_far, choice, tell)
        except OutOfTimeError:
            return so_far.without(BEYOND)
        try:
            return _decided_again(so_far, tell)
        except OutOfTimeError:
            return so_far.without(INSTEAD)


def _decided_again(now: Decided, tell: Say) -> Decided:
    """What is decided once noise of inputs, what stands behind an input, or a law in the place of a
    class is known."""
    prepared, choice = now.prepared, now.choice
    louder = with_input_noise(prepared, choice.setting, now.judged)
    if louder is not None:
        tell("deciding again, for noise of an input goes through the machine")
        again = _judged(now, chosen_again(prepared, louder, choice, tell), tell)
        now = again if stands(again.judged, now.judged) else now
    behind = with_actuator(prepared, now.choice, now.judged, tell)
    if behind is not None and behind.behind.trials:
        now = replace(now, choice=behind)
    elif behind is not None:
        again = _judged(now, behind, tell)
        now = again if acts_so(behind, again.judged, now.judged) else now
    named = with_law(prepared, now.choice, now.judged, tell)
    if named is not None:
        again = _judged(now, named, tell)
        stays = holds(named, again.judged, now.judged)
        stays = stays and one_value(again.known.final, again.judged.structure)
        now = again if stays else now
    return now


def _judged(before: Decided, choice: Choice, tell: Say) -> Decided:
    """A choice with its values, and what acts beyond it; either knows what both doubt."""
    tell("estimating values")
    known = estimate(before.prepared, choice, tell)
    tell("looking for what acts beyond")
    along = choice.along if choice.along and choice.along.causes == known.final.causes else None
    judged = adequacy(before.prepared, choice.setting, known.final, known.windows, along)
    doubt = known.doubt | judged.doubt
    known, judged = replace(known, doubt=doubt), replace(judged, doubt=doubt)
    return replace(before, choice=choice, known=known, judged=judged)


def _unjudged(prepared: Prepared, setting: Setting, choice: Choice) -> Decided:
    """A choice as the windows have it, of which nothing else is known."""
    known = Estimated(choice.decision.selected, choice.setting.stages[-1], frozenset(), ())
    return Decided(prepared, setting, choice, known, Adequacy(NOTHING, unjudged=SPENT))


def _prepared(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
) -> tuple[Prepared, Setting]:
    """Motion, noise, windows and hypotheses, with a clock that drifts put right."""
    prepared = prepare(model, recordings, holdout, own=own)
    setting = settle(prepared, own)
    clock = drifting(
        setting, lambda clocks: settle(prepare(model, recordings, holdout, clocks, own), own)
    )
    if clock is None:
        return prepared, setting
    prepared = prepare(model, recordings, holdout, (clock,), own)
    return prepared, settle(prepared, own)
