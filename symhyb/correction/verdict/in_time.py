"""A number that changes along the recordings: its course, and the model that states it.

A class says which number changes. A step is too fast for the functions of time of that class, but
seen as a mismatch that begins within a recording: there the number, which was claimed for a part,
is the one. What was decided without its course is decided again with it in the model.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.in_time.answer import (
    Answer,
    alike,
    changes,
    course_of,
    course_of_any,
    course_of_class,
)
from symhyb.correction.adequacy.in_time.changing_number import number_at
from symhyb.correction.adequacy.in_time.stated_course import with_course
from symhyb.correction.adequacy.judge import Adequacy, adequacy
from symhyb.correction.adequacy.recorded import recorded
from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.correction.naming.classes import class_found
from symhyb.correction.naming.course_words import course_found, reach_said
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.setting import Setting
from symhyb.correction.verdict.choice import Choice
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import (
    Alternative,
    ClassFound,
    ClassName,
    CourseFound,
    Diagnosis,
)
from symhyb.errors import InputError
from symhyb.model.expression import ExpressionError
from symhyb.model.types import Model
from symhyb.steps import Say


@dataclass(frozen=True, slots=True, eq=False)
class Changing:
    """A number with its course (``found``), the ``model`` that states it, the ``classes`` that said
    so, and the courses of other numbers that explain as much, with how much less likely (ln) they
    are (``others``)."""

    found: CourseFound
    model: Model
    classes: tuple[ClassFound, ...]
    others: tuple[tuple[CourseFound, float], ...] = ()


def changing(
    model: Model, prepared: Prepared, setting: Setting, choice: Choice, judged: Adequacy, say: Say
) -> Changing | None:
    """The course of a number of which it is certain that it changes along the recordings; None
    where none is, where no course explains it, or where a model may not state it."""
    if choice.misfits or model.engine is not None:
        return None
    moved = _begins(choice)
    without = judged.beyond.acts and not judged.classes
    if moved is None and changes(judged) is None and not without:
        return None
    say("looking for the course of a number that changes with time")
    ground, whole = recorded(prepared, choice.setting), judged
    if choice.change is not None:
        throughout = replace(setting, sd=choice.setting.sd)
        nothing = choice.decision.nothing
        ground = recorded(prepared, throughout)
        whole = adequacy(prepared, throughout, nothing, (nothing, choice.setting.stages[-1].cuts))
    if ground is None or whole.structure is None:
        return None
    answer = course_of_class(ground, whole)
    if answer is None and moved is not None:
        number = number_at(ground, moved.path)
        answer = None if number is None else course_of(ground, whole, number)
    answer = answer or course_of_any(ground, whole)
    if answer is None:
        return None
    found = course_found(model, answer.course, answer.rivals, ground)
    others = tuple(
        (course_found(model, course, (), ground), behind)
        for course, behind in alike(ground, whole, answer)
    )
    try:
        varied = with_course(model, found)
    except (InputError, ExpressionError):
        return None
    return Changing(found, varied, (_class(whole, answer),), others)


def _class(judged: Adequacy, answer: Answer) -> ClassFound:
    """The class that the course of a number is of."""
    number = answer.course.number
    best = judged.classes[0] if judged.classes else None
    if best is not None and best.generic.where == number.path:
        return class_found(best)
    chance, nothing = answer.probability, np.zeros(0)
    kind: ClassName = "input" if number.is_input else "time-varying"
    generic = Generic(kind, number.path, (), nothing, does="fades" if number.is_input else "")
    return class_found(Likely(generic, chance))


def _begins(choice: Choice) -> Hypothesis | None:
    """The parameter that is all that was decided for the part of a recording in which a mismatch
    acts."""
    causes = choice.decision.selected.causes
    one = causes[0] if choice.change is not None and len(causes) == 1 else None
    return one if one is not None and one.kind == "parameter" and "." not in one.path else None


def in_doubt(answer: Diagnosis, one: Changing) -> Diagnosis:
    """The diagnosis where other numbers with courses of their own explain as much: all of them are
    alternatives, and none is claimed."""
    every = [(one.found, 0.0), *one.others]
    said = [found.sentence for found, _ in every]
    note = f"Several numbers may be the one that changes with time: {' Or: '.join(said)}"
    known = {(one.channel, one.parameter) for one in answer.alternatives if one.place is None}
    rivals = tuple(
        Alternative(
            None,
            "parameter" if found.parameter else "gain",
            (),
            2 * max(behind, 0.0),
            channel=found.channel,
            parameter=found.parameter,
        )
        for found, behind in every
        if (found.channel, found.parameter) not in known
    )
    return replace(
        answer,
        sentence=f"{answer.sentence} {note}",
        alternatives=(*answer.alternatives, *rivals),
        notes=(note, *answer.notes),
    )


def without_numbers(judged: Adequacy, final: Sequence[Hypothesis]) -> frozenset[Hypothesis]:
    """The causes that are in doubt beside a course: numbers of the model and of channels, whose
    effect its values may hold a part of."""
    return judged.doubt | {cause for cause in final if cause.place is None}


def with_changing(answer: Diagnosis, one: Changing) -> Diagnosis:
    """The diagnosis of the model with a course as that of the model as it was given."""
    found = one.found
    classes = (*one.classes, *(c for c in answer.classes if c.parameter != found.parameter))
    claims = bool(answer.found or answer.parameters or answer.measurement)
    said, along = f"{found.sentence} {reach_said(found)}", found.over or "time"
    if claims:
        sentence, verdict = f"{answer.sentence} Besides, {said}", answer.verdict
    else:
        verdict = "parameters" if found.parameter else "measurement"
        if answer.verdict == "nothing missing":
            what = "one of its numbers" if found.parameter else "the factor of an input"
            sentence = f"The model lacks no physics, but {what} changes with {along}: {said}"
        else:
            what = "A number of the model" if found.parameter else "The factor of an input"
            sentence = f"{what} changes with {along}: {said} {answer.sentence}"
    return replace(
        answer,
        verdict=verdict,
        sentence=sentence,
        classes=classes,
        courses=(found, *answer.courses),
        notes=(said, *answer.notes),
    )
