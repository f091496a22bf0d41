"""From a model and recordings to a diagnosis: the story, step by step.

Motion and noise → all causes screened together on growing windows → structures refined on
trajectories and judged on held windows → the map of places → what was found, in words. The unseen
recordings prove; they never choose. docs/method has the statistics and what was measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

from symhyb.asked import asked
from symhyb.correction.advice.advice import advise
from symhyb.correction.advice.combinations import combined
from symhyb.correction.advice.isolability import Along, isolability
from symhyb.correction.advice.rival_runs import rival_runs
from symhyb.correction.naming.beside_words import together
from symhyb.correction.naming.dispute_words import dispute_sentence
from symhyb.correction.naming.fleet_words import parameters_with_own, repeats_said
from symhyb.correction.naming.jitter_words import jitter_sentence
from symhyb.correction.naming.joint import posterior_of
from symhyb.correction.search.beginnings import in_part
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting, around
from symhyb.correction.search.so_far import fits_best, if_interrupted
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.verdict.choice import Choice
from symhyb.correction.verdict.conclusion import concluded
from symhyb.correction.verdict.constants import with_constant
from symhyb.correction.verdict.decided import OTHERWISE, Decided, decided
from symhyb.correction.verdict.hold import held_inputs, likelier, with_held, with_holds
from symhyb.correction.verdict.in_time import (
    Changing,
    changing,
    in_doubt,
    with_changing,
    without_numbers,
)
from symhyb.correction.verdict.leftover import leftover
from symhyb.correction.verdict.proof import Proof, prove
from symhyb.correction.verdict.refusal import (
    if_apart,
    if_bounded,
    if_confirmed,
    if_explained,
    if_long_enough,
    with_faults,
)
from symhyb.correction.verdict.unfinished import nothing_compared, unfinished
from symhyb.data.cleaning import still
from symhyb.data.groups import Own
from symhyb.data.recording import Recording, several
from symhyb.deadline import SPENT, Deadline, OutOfTimeError, deadline_of, require_time, within
from symhyb.discrepancy.places.memoryless import memoryless
from symhyb.discrepancy.results import Budget, Diagnosis, Misfit, Repeats
from symhyb.errors import NumericsError
from symhyb.model.types import Model
from symhyb.numeric.kernels.threads import one_thread
from symhyb.numeric.lowered.either import model_of
from symhyb.numeric.lowered.machine import Machine
from symhyb.steps import Say

RECORD_NEXT = (
    "a longer run, of at least ten periods of the slowest motion, driven so that every coordinate "
    "moves at least thirty times its sensor's noise"
)

STILL = (
    "These recordings cannot tell: no sensor changes in any of them, so that the machine stands "
    "still or its sensors are dead. Nothing in them contradicts the model."
)


@dataclass(frozen=True, slots=True)
class Concluded:
    """A ``diagnosis`` without advice, and what advice rests on: the ``prepared`` recordings and the
    ``choice`` among causes, None where nothing had to be chosen."""

    diagnosis: Diagnosis
    prepared: Prepared | None = None
    choice: Choice | None = None


@asked
def diagnose(
    model: Model | Machine,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    *,
    own: Sequence[str] | Own = (),
    say: Say | None = None,
    budget: float | str | None = None,
) -> Diagnosis:
    """Say what the model lacks, from recordings of the machine.

    ``holdout`` are unseen recordings: they prove (shares and scores) and never choose. ``own``
    names what every recording has its own value of: parameters of the model, or keys of laws that
    may be found (``drag``); the phase of a harmonic force always. As a mapping, ``{"drag":
    "mount"}``, it says within which groups of recordings a number is shared. ``say`` gets a short
    line at every step. ``budget`` is a time in s, or a text with its unit (``"10min"``), after
    which it ends: comparisons that were not made by then are named, and nothing is claimed that
    they might withdraw.

    Raises:
        InputError: recordings that cannot be used with this model, an unknown name in ``own``,
            a group that recordings do not state, or a budget that is no time.
        NumericsError: the model cannot be simulated along the recordings at all.
    """
    deadline = deadline_of(budget)
    return advised(
        conclude(model_of(model), recordings, holdout, own=own, say=say, deadline=deadline),
        say,
        deadline,
    )


def conclude(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    *,
    own: Sequence[str] | Own = (),
    say: Say | None = None,
    deadline: Deadline | None = None,
) -> Concluded:
    """:func:`diagnose` up to the advice on what to record next, which :func:`advised` adds; it ends
    when the ``deadline`` has passed."""
    with one_thread(), within(deadline):
        found = _concluded(
            model, recordings, holdout, own, _ending(say), deadline.budget_s if deadline else 0.0
        )
    answer = replace(found.diagnosis, model=model)
    if deadline is not None and answer.budget is None:
        answer = replace(answer, budget=Budget(deadline.budget_s))
    return replace(found, diagnosis=answer)


def _ending(say: Say | None) -> Say:
    """``say``, or silence, as a place where work ends when there is no time left."""

    def tell(step: str) -> None:
        if say is not None:
            say(step)
        require_time()

    return tell


def _concluded(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
    tell: Say,
    budget_s: float,
) -> Concluded:
    if still(several(recordings)):
        return Concluded(Diagnosis("undecided", STILL, record_next=RECORD_NEXT))
    try:
        first = decided(model, recordings, holdout, own, tell)
    except OutOfTimeError:
        return Concluded(nothing_compared(budget_s))
    prepared, choice = first.prepared, first.choice
    one = None
    if not first.unmade:
        try:
            again, one = _otherwise(model, recordings, holdout, own, first, tell)
            if again is not None:
                return again
        except OutOfTimeError:
            first = first.without(OTHERWISE)
    if first.unmade:
        with within(None):
            return Concluded(unfinished(model, first, budget_s), prepared)
    with if_interrupted(lambda: fits_best(choice.decision.selected, len(choice.decision.trials))):
        answer = _told(model, first, tell)
    return Concluded(answer if one is None else in_doubt(answer, one), prepared, choice)


def _otherwise(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
    first: Decided,
    tell: Say,
) -> tuple[Concluded | None, Changing | None]:
    """What is concluded where an input is held, or a number has a course, in place of what was
    decided ``first``; None where neither is the answer. With it the courses of several numbers that
    explain as much, of which none is named."""
    held = held_inputs(model, several(recordings), first.judged)
    if held:
        tell("deciding again, with an input that is held from sample to sample")
        stated = with_holds(model, held)
        again = _whole(decided(stated, recordings, holdout, own, tell))
        if likelier(again.judged, first.judged):
            answer = _told(stated, again, tell)
            if answer.verdict != "undecided":
                return Concluded(with_held(answer, held), again.prepared, again.choice), None
    prepared, choice = first.prepared, first.choice
    with if_interrupted(lambda: fits_best(choice.decision.selected, len(choice.decision.trials))):
        one = changing(model, prepared, first.setting, choice, first.judged, tell)
    if one is None or one.others:
        return None, one
    tell("deciding again, with the course of a number in the model")
    return _with_course(one, recordings, holdout, own, tell), None


def _whole(decision: Decided) -> Decided:
    """A decision of which all comparisons were made.

    Raises:
        OutOfTimeError: some were not.
    """
    if decision.unmade:
        raise OutOfTimeError(SPENT)
    return decision


def _with_course(
    one: Changing,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
    tell: Say,
) -> Concluded | None:
    """What is concluded of a model in which a number has its course; None where that is not known
    either, so that the course may only imitate what acts."""
    try:
        again = _whole(decided(one.model, recordings, holdout, own, tell))
    except NumericsError:  # along the course it cannot be simulated
        return None
    doubt = without_numbers(again.judged, again.known.final.causes)
    again = replace(
        again,
        known=replace(again.known, doubt=again.known.doubt | doubt),
        judged=replace(again.judged, doubt=doubt),
    )
    answer = _told(one.model, again, tell)
    if answer.verdict == "undecided" and not again.judged.adequate:
        return None
    return Concluded(with_changing(answer, one), again.prepared, again.choice)


def _told(model: Model, decided: Decided, tell: Say) -> Diagnosis:
    """What follows from a choice: shares, words, what must not be claimed. What withdraws claims
    takes the time that it takes; what else is to be said is left out where none is left."""
    prepared, choice = decided.prepared, decided.choice
    final, setting, selected = decided.known.final, choice.setting, choice.decision.selected
    items = decided.known.items
    with within(None):
        tell("holding the diagnosis against unseen windows")
    shown = prove(prepared, setting, final, decided.known.stage, items, tell)
    with within(None):
        answer = _guarded(model, decided, shown)
        answer = replace(answer, posterior=posterior_of(model, final, items, answer))
    along = cache(lambda: around(setting, selected))  # both need it, neither always
    answer = _with_isolability(_remembered(answer, prepared, setting), choice, along)
    return _with_rivals(_with_combinations(answer, choice, along), choice)


def _guarded(model: Model, decided: Decided, shown: Proof) -> Diagnosis:
    """What a choice says once all that it must not claim is withdrawn."""
    prepared, choice = decided.prepared, decided.choice
    known, judged = decided.known, decided.judged
    nothing, selected = choice.decision.nothing, choice.decision.selected
    final, setting = known.final, choice.setting
    held = shown
    if prepared.holdout:  # what is unseen proves and never chooses
        held = prove(replace(prepared, holdout=()), setting, final, known.stage, ())
    beyond = known.tells and shown.remainder != 0.0  # of nothing, no law explains a part
    left = leftover(setting, known.seen or selected) if beyond else ()
    answer = concluded(model, prepared, choice, known, shown, left, judged)
    answer = _of_several(answer, final, choice.misfits, repeats_said(prepared))
    disputes = [dispute_sentence(prepared.model, one) for one in judged.disputed]
    sums = together(prepared.model, final, known.items)
    answer = in_part(_noted(answer, [*sums, *known.drifts, *disputes]), choice.change)
    clocks = tuple(jitter_sentence(one) for one in judged.jitter)
    answer = replace(answer, notes=(*clocks, *answer.notes))
    answer = if_explained(answer, selected, nothing)
    answer = if_confirmed(answer, held, shown)
    answer = if_bounded(answer, final, nothing, prepared.runs, prepared.holdout)
    answer = if_long_enough(answer, prepared.runs)
    answer = if_apart(answer, prepared.model, prepared.runs)
    answer = with_constant(answer, choice)
    return with_faults(answer, model, prepared.faults, final.fit.scale)


def _remembered(answer: Diagnosis, prepared: Prepared, setting: Setting) -> Diagnosis:
    """The answer with whether the missing force, if there is any, is a function of the state."""
    if answer.verdict != "missing physics" and answer.remainder != 1.0:
        return answer
    longest = setting.stages[-1].cuts  # there the missing force stands out of the noise most
    values = prepared.machine.values
    try:
        require_time()
        memory = memoryless(setting.library, setting.windows, longest, values, setting.sd)
    except OutOfTimeError as error:
        return _with_note(answer, "Whether the missing force remembers is not known", error)
    return replace(answer, memory=memory)


def _noted(found: Diagnosis, sentences: Sequence[str]) -> Diagnosis:
    """The diagnosis with sentences that its answer and its notes must not go without."""
    return replace(
        found,
        sentence=" ".join([found.sentence, *sentences]),
        notes=(*sentences, *found.notes),
    )


def _of_several(
    found: Diagnosis, final: Refined, misfits: Sequence[Misfit], repeats: Sequence[Repeats]
) -> Diagnosis:
    """The diagnosis with what several recordings say of each other."""
    said = [*(one.sentence for one in misfits), *(one.sentence for one in repeats)]
    return replace(
        found,
        sentence=" ".join([found.sentence, *(one.sentence for one in misfits)]),
        parameters=parameters_with_own(final, found.parameters),
        misfits=tuple(misfits),
        repeats=tuple(repeats),
        notes=(*said, *found.notes),
    )


def _with_isolability(answer: Diagnosis, choice: Choice, along: Along) -> Diagnosis:
    """The answer with what the recordings distinguish; a note where that cannot be computed."""
    try:
        require_time()
        table = isolability(choice.setting, choice.decision, along)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "No table of which causes these recordings tell apart", error)
    if table is not None and not (answer.found or answer.parameters or answer.measurement):
        table = replace(table, found=(False,) * len(table.found))  # what fits best is not claimed
    return replace(answer, isolability=table)


def _with_combinations(answer: Diagnosis, choice: Choice, along: Along) -> Diagnosis:
    """The answer with notes on parameters that the recordings do not determine, or determine only
    together."""
    try:
        require_time()
        said = combined(choice.setting, choice.decision.selected, along)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "Which parameters are determined is not known", error)
    return replace(answer, notes=(*answer.notes, *said))


def _with_rivals(answer: Diagnosis, choice: Choice) -> Diagnosis:
    """The answer with what the most probable rivals simulate otherwise."""
    try:
        require_time()
        runs = rival_runs(choice.setting, choice.decision)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "Where rivals would differ is not known", error)
    return replace(answer, rivals=runs)


def advised(
    concluded: Concluded, say: Say | None = None, deadline: Deadline | None = None
) -> Diagnosis:
    """The diagnosis with the manoeuvre for what the recordings do not distinguish; a note where
    none can be worked out, the reason included, as that the ``deadline`` has passed. ``say`` gets a
    short line."""
    answer, prepared, choice = concluded.diagnosis, concluded.prepared, concluded.choice
    if prepared is None or choice is None or answer.record_next is not None:
        return answer
    if say is not None:
        say("looking for what to record next")
    try:
        with one_thread(), within(deadline):
            require_time()
            sentence, manoeuvre = advise(prepared, choice.setting, choice.decision)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "No advice on what to record next", error)
    if sentence is None:
        return answer
    return replace(answer, record_next=sentence, manoeuvre=manoeuvre)


def _with_note(answer: Diagnosis, what: str, error: Exception) -> Diagnosis:
    """The answer with the reason why a part of it is not there, as a note and in the log."""
    plain = isinstance(error, NumericsError | OutOfTimeError)
    reason = str(error) if plain else f"{type(error).__name__}: {error}"
    note = f"{what}: {' '.join(reason.split()).rstrip('.')}."
    return replace(answer, notes=(*answer.notes, note), log=(*answer.log, note))
