"""From a model and recordings to a diagnosis: the story, step by step.

Motion and noise → all causes screened together on growing windows → structures refined on
trajectories and judged on held windows → the map of places → what was found, in words. The unseen
recordings prove; they never choose. docs/method.md has the statistics and what was measured.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import NamedTuple

from symhyb.asked import asked
from symhyb.correction.adequacy.input_noise import stands, with_input_noise
from symhyb.correction.adequacy.judge import Adequacy, adequacy
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
from symhyb.correction.search.clocks import drifting
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting, around
from symhyb.correction.search.so_far import fits_best, if_interrupted
from symhyb.correction.search.trajectory import Refined
from symhyb.correction.search.wholes import at_level_of_forces
from symhyb.correction.verdict.actuator import acts_so, with_actuator
from symhyb.correction.verdict.choice import Choice, choose, chosen_again
from symhyb.correction.verdict.conclusion import concluded
from symhyb.correction.verdict.constants import with_constant
from symhyb.correction.verdict.estimate import Estimated, estimate
from symhyb.correction.verdict.hold import held_inputs, likelier, with_held, with_holds
from symhyb.correction.verdict.in_place_of_class import holds, one_value, with_law
from symhyb.correction.verdict.in_time import (
    Changing,
    changing,
    in_doubt,
    with_changing,
    without_numbers,
)
from symhyb.correction.verdict.leftover import leftover
from symhyb.correction.verdict.proof import prove
from symhyb.correction.verdict.refusal import (
    if_apart,
    if_bounded,
    if_confirmed,
    if_explained,
    if_long_enough,
    with_faults,
)
from symhyb.data.cleaning import still
from symhyb.data.groups import Own
from symhyb.data.recording import Recording, several
from symhyb.discrepancy.places.memoryless import memoryless
from symhyb.discrepancy.results import Diagnosis, Misfit, Repeats
from symhyb.errors import NumericsError
from symhyb.model.types import Model
from symhyb.numeric.kernels.threads import one_thread
from symhyb.numeric.lowered.either import model_of
from symhyb.numeric.lowered.machine import Machine
from symhyb.steps import Say, silent

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
) -> Diagnosis:
    """Say what the model lacks, from recordings of the machine.

    ``holdout`` are unseen recordings: they prove (shares and scores) and never choose. ``own``
    names what every recording has its own value of: parameters of the model, or keys of laws that
    may be found (``drag``); the phase of a harmonic force always. As a mapping, ``{"drag":
    "mount"}``, it says within which groups of recordings a number is shared. ``say`` gets a short
    line at every step.

    Raises:
        InputError: recordings that cannot be used with this model, an unknown name in ``own``, or
            a group that recordings do not state.
        NumericsError: the model cannot be simulated along the recordings at all.
    """
    return advised(conclude(model_of(model), recordings, holdout, own=own, say=say), say)


def conclude(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording] = (),
    *,
    own: Sequence[str] | Own = (),
    say: Say | None = None,
) -> Concluded:
    """:func:`diagnose` up to the advice on what to record next, which :func:`advised` adds."""
    with one_thread():
        concluded = _concluded(model, recordings, holdout, own, say or silent)
    return replace(concluded, diagnosis=replace(concluded.diagnosis, model=model))


def _concluded(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
    tell: Say,
) -> Concluded:
    if still(several(recordings)):
        return Concluded(Diagnosis("undecided", STILL, record_next=RECORD_NEXT))
    first = _decided(model, recordings, holdout, own, tell)
    prepared, choice = first.prepared, first.choice
    held = held_inputs(model, several(recordings), first.judged)
    if held:
        tell("deciding again, with an input that is held from sample to sample")
        stated = with_holds(model, held)
        again = _decided(stated, recordings, holdout, own, tell)
        if likelier(again.judged, first.judged):
            answer = _told(stated, again, tell)
            if answer.verdict != "undecided":
                return Concluded(with_held(answer, held), again.prepared, again.choice)
    with if_interrupted(lambda: fits_best(choice.decision.selected, len(choice.decision.trials))):
        one = changing(model, prepared, first.setting, choice, first.judged, tell)
    if one is not None and not one.others:
        tell("deciding again, with the course of a number in the model")
        concluded = _with_course(one, recordings, holdout, own, tell)
        if concluded is not None:
            return concluded
        one = None
    with if_interrupted(lambda: fits_best(choice.decision.selected, len(choice.decision.trials))):
        answer = _told(model, first, tell)
    return Concluded(answer if one is None else in_doubt(answer, one), prepared, choice)


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
        again = _decided(one.model, recordings, holdout, own, tell)
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


@dataclass(frozen=True, slots=True, eq=False)
class _Decided:
    """The ``setting`` of a decision, its ``choice``, the values of that (``known``) and what acts
    beyond it (``judged``)."""

    prepared: Prepared
    setting: Setting
    choice: Choice
    known: Estimated
    judged: Adequacy


class _Chosen(NamedTuple):
    """A choice, the values of its numbers, and what acts beyond it."""

    choice: Choice
    known: Estimated
    judged: Adequacy


def _decided(
    model: Model,
    recordings: Recording | Sequence[Recording],
    holdout: Recording | Sequence[Recording],
    own: Sequence[str] | Own,
    tell: Say,
) -> _Decided:
    """The causes that the recordings choose."""
    tell("estimating motion and noise")
    prepared, setting = _prepared(model, recordings, holdout, own)
    tell("pushing every cause at the level of forces")
    prepared, setting, forces = at_level_of_forces(prepared, setting, own)
    choice = choose(prepared, setting, forces, tell)
    nothing, selected = choice.decision.nothing, choice.decision.selected
    if nothing.fit.reason and not selected.causes:
        raise NumericsError(f"the model cannot be simulated: {nothing.fit.reason}")
    with if_interrupted(lambda: fits_best(selected, len(choice.decision.trials))):
        now = _judged(prepared, choice, tell)
        louder = with_input_noise(prepared, choice.setting, now.judged)
        if louder is not None:
            tell("deciding again, for noise of an input goes through the machine")
            again = _judged(prepared, chosen_again(prepared, louder, choice, tell), tell)
            now = again if stands(again.judged, now.judged) else now
        behind = with_actuator(prepared, now.choice, now.judged, tell)
        if behind is not None and behind.behind.trials:
            now = now._replace(choice=behind)
        elif behind is not None:
            again = _judged(prepared, behind, tell)
            now = again if acts_so(behind, again.judged, now.judged) else now
        named = with_law(prepared, now.choice, now.judged, tell)
        if named is not None:
            again = _judged(prepared, named, tell)
            stays = holds(named, again.judged, now.judged)
            stays = stays and one_value(again.known.final, again.judged.structure)
            now = again if stays else now
        return _Decided(prepared, setting, *now)


def _judged(prepared: Prepared, choice: Choice, tell: Say) -> _Chosen:
    """A choice with its values, and what acts beyond it; either knows what both doubt."""
    tell("estimating values")
    known = estimate(prepared, choice, tell)
    tell("looking for what acts beyond")
    along = choice.along if choice.along and choice.along.causes == known.final.causes else None
    judged = adequacy(prepared, choice.setting, known.final, known.windows, along)
    doubt = known.doubt | judged.doubt
    return _Chosen(choice, replace(known, doubt=doubt), replace(judged, doubt=doubt))


def _told(model: Model, decided: _Decided, tell: Say) -> Diagnosis:
    """What follows from a choice: shares, words, what must not be claimed."""
    prepared, choice = decided.prepared, decided.choice
    known, judged = decided.known, decided.judged
    nothing, selected = choice.decision.nothing, choice.decision.selected
    final, setting = known.final, choice.setting
    tell("holding the diagnosis against unseen windows")
    shown = prove(prepared, setting, final, known.stage, known.items, tell)
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
    answer = with_faults(answer, model, prepared.faults, final.fit.scale)
    answer = replace(answer, posterior=posterior_of(model, final, known.items, answer))
    along = cache(lambda: around(setting, selected))  # both need it, neither always
    answer = _with_isolability(_remembered(answer, prepared, setting), choice, along)
    return _with_rivals(_with_combinations(answer, choice, along), choice)


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


def _remembered(answer: Diagnosis, prepared: Prepared, setting: Setting) -> Diagnosis:
    """The answer with whether the missing force, if there is any, is a function of the state."""
    if answer.verdict != "missing physics" and answer.remainder != 1.0:
        return answer
    longest = setting.stages[-1].cuts  # there the missing force stands out of the noise most
    values = prepared.machine.values
    memory = memoryless(setting.library, setting.windows, longest, values, setting.sd)
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
        said = combined(choice.setting, choice.decision.selected, along)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "Which parameters are determined is not known", error)
    return replace(answer, notes=(*answer.notes, *said))


def _with_rivals(answer: Diagnosis, choice: Choice) -> Diagnosis:
    """The answer with what the most probable rivals simulate otherwise."""
    try:
        runs = rival_runs(choice.setting, choice.decision)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "Where rivals would differ is not known", error)
    return replace(answer, rivals=runs)


def advised(concluded: Concluded, say: Say | None = None) -> Diagnosis:
    """The diagnosis with the manoeuvre for what the recordings do not distinguish; a note where
    none can be worked out, the reason included. ``say`` gets a short line."""
    answer, prepared, choice = concluded.diagnosis, concluded.prepared, concluded.choice
    if prepared is None or choice is None or answer.record_next is not None:
        return answer
    if say is not None:
        say("looking for what to record next")
    try:
        with one_thread():
            sentence, manoeuvre = advise(prepared, choice.setting, choice.decision)
    except Exception as error:  # no finished diagnosis is lost for it
        return _with_note(answer, "No advice on what to record next", error)
    if sentence is None:
        return answer
    return replace(answer, record_next=sentence, manoeuvre=manoeuvre)


def _with_note(answer: Diagnosis, what: str, error: Exception) -> Diagnosis:
    """The answer with the reason why a part of it is not there, as a note and in the log."""
    reason = str(error) if isinstance(error, NumericsError) else f"{type(error).__name__}: {error}"
    note = f"{what}: {' '.join(reason.split()).rstrip('.')}."
    return replace(answer, notes=(*answer.notes, note), log=(*answer.log, note))
