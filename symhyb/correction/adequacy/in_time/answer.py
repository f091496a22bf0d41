"""Which course a number has that changes along recordings.

    class > unknown force       it changes with time: which number, the class says
    course ≥ class              a shape explains as much: it is the answer
    shape > other shapes        where others are as likely, to 100 to 1, they are its rivals
    number > other numbers      the same of other numbers with a course of their own

All are compared by the evidence of the innovations along whole recordings.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.explained import decided as left_by
from symhyb.correction.adequacy.followed import likeliest
from symhyb.correction.adequacy.in_time.changing_number import (
    Number,
    input_at,
    number_at,
    number_of,
    sensors_of,
)
from symhyb.correction.adequacy.in_time.fitted_course import (
    Course,
    fitted_course,
    free_course,
)
from symhyb.correction.adequacy.in_time.placing import (
    POINTS_MOST,
    Begun,
    begun,
    ended,
    worth_along,
)
from symhyb.correction.adequacy.in_time.shapes import Shape
from symhyb.correction.adequacy.judge import CLASSES_MOST, Adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic
from symhyb.correction.search.trajectory import grouped
from symhyb.judgement import CERTAIN, HOPELESS, MOST, PROBABLE, SMALL


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """The ``course`` of the largest evidence, and the other shapes that are as likely, to 100 to 1;
    ``base`` is the structure that it stands beside, ``probability`` its posterior one against what
    was decided and the class."""

    course: Course
    rivals: tuple[Course, ...]
    base: Fitted
    probability: float


def changes(judged: Adequacy) -> Generic | None:
    """The class by which a number of the model or an input changes with time, where it is certain
    among classes; None where it is not. Whether it explains all that acts, its course shows."""
    best = judged.classes[0] if judged.classes else None
    if best is None or best.probability <= PROBABLE:
        return None
    fades = best.generic.kind == "input" and best.generic.does == "fades"
    return best.generic if fades or best.generic.kind == "time-varying" else None


def course_of_class(ground: Recorded, judged: Adequacy) -> Answer | None:
    """The course of the number of which it is certain that it changes; None where no shape explains
    that."""
    generic = changes(judged)
    number = None if generic is None else number_of(ground, generic)
    return None if number is None else course_of(ground, judged, number)


def course_of(ground: Recorded, judged: Adequacy, number: Number) -> Answer | None:
    """The course of a number, beside the laws that stay, that explains what acts beyond a decided
    structure and is more likely than that and than any class; None where no shape is."""
    decided, by_class = judged.structure, judged.by_class
    if decided is None:
        return None
    base = _without_numbers(ground, decided, by_class, judged)
    if base.fit.reason:
        return None
    start = by_class or base
    least = decided.evidence + CERTAIN
    if by_class is not None:
        least = max(least, by_class.evidence - CERTAIN)
    whole = left_by(ground, decided, judged.beyond.acts)
    courses = []
    for offer in begun(ground, base, number):
        fit = free_course if offer.shape.name == "free" else fitted_course
        courses.append(fit(ground, start, base, number, offer))
    enough = [
        one
        for one in courses
        if ended(one.shape)
        and one.trial.evidence > least
        and whole.explained_by(ground, one.trial, SMALL)
    ]
    if not enough:
        return None
    best = _timed(max(enough, key=lambda one: one.trial.evidence), enough)
    near = [one for one in enough if one.trial.evidence > best.trial.evidence - CERTAIN]
    near.sort(key=lambda one: one.trial.evidence)
    rivals = {(one.shape.name, one.shape.over): one for one in near if _another(one, best, ground)}
    last = max(one.evidence for one in (decided, by_class) if one is not None)
    probability = 1 / (1 + float(np.exp(last - best.trial.evidence)))
    return Answer(best, tuple(reversed(rivals.values())), base, probability)


def _timed(best: Course, enough: Sequence[Course]) -> Course:
    """A course whose time is known no better than two steps that explain, one of them of any
    duration, differ in it."""
    others = [one for one in enough if one.shape.name == "step" and one is not best]
    if best.shape.name != "step" or not others:
        return best
    sd, row = best.sd.copy(), len(best.shape.values)
    sd[row] = np.hypot(sd[row], others[0].shape.middle - best.shape.middle)
    return replace(best, sd=sd)


def course_of_any(ground: Recorded, judged: Adequacy) -> Answer | None:
    """The course of a number where something acts and no class explains it: levels that a number
    is held at are too many for the functions of time of a class. Of the numbers whose course is
    worth most in the linear problem the likeliest."""
    decided = judged.structure
    if decided is None or judged.classes or not judged.beyond.acts:
        return None
    base = _without_numbers(ground, decided, None, judged)
    if base.fit.reason:
        return None
    times = [item.block.t[0] for item in ground.items]
    even = np.linspace(min(t[0] for t in times), max(t[-1] for t in times), POINTS_MOST)
    line = Shape("free", tuple(even.tolist()), (1.0,) * POINTS_MOST)
    worths = [(worth_along(ground, base, one, line), one) for one in _others(ground, None)]
    best = sorted(worths, key=lambda pair: -pair[0])[:CLASSES_MOST]
    promising = [one for worth, one in best if worth > CERTAIN]
    found = [answer for one in promising if (answer := course_of(ground, judged, one)) is not None]
    return max(found, key=lambda one: one.course.trial.evidence, default=None)


def alike(ground: Recorded, judged: Adequacy, answer: Answer) -> tuple[tuple[Course, float], ...]:
    """The courses of other numbers, and of what sensors show, that explain as much, to 100 to 1,
    with how much less likely they are (ln of the odds)."""
    found, mine = [], answer.course
    reach = worth_along(ground, answer.base, mine.number, mine.shape) - HOPELESS
    for other in _others(ground, mine.number):
        if worth_along(ground, answer.base, other, mine.shape) > reach:
            own = course_of(ground, judged, other)
            behind = mine.trial.evidence - own.course.trial.evidence if own else CERTAIN
            if own is not None and behind < CERTAIN:
                found.append((own.course, behind))
    for sensor in sensors_of(ground):
        rival = fitted_course(ground, mine.trial, answer.base, sensor, Begun(mine.shape, 0.0))
        behind = mine.trial.evidence - rival.trial.evidence
        if behind < CERTAIN:
            found.append((rival, behind))
    return tuple(found)


def _others(ground: Recorded, mine: Number | None) -> Iterator[Number]:
    """The other numbers that may change: parameters that state an sd, and inputs."""
    model = ground.windows.machine.model
    frequency, known = (mine.frequency, mine.path) if mine else (float("nan"), "")
    paths = [item.path for item in model.parameters if item.sd is not None]
    numbers = [number_at(ground, path, frequency) for path in paths if path != known]
    inputs = [item.name for item in model.recorded_inputs if item.name != known]
    yield from (one for one in (*numbers, *(input_at(ground, i) for i in inputs)) if one)


def _another(one: Course, best: Course, ground: Recorded) -> bool:
    """Whether a course is another shape: a step that takes most of the recordings is a drift."""
    lasts = max(float(item.block.t[0][-1] - item.block.t[0][0]) for item in ground.items)

    def name(course: Course) -> tuple[str, str]:
        slow = course.shape.name == "step" and course.shape.duration > MOST * lasts
        return "drift" if slow else course.shape.name, course.shape.over

    return name(one) != name(best)


def _without_numbers(
    ground: Recorded, decided: Fitted, by_class: Fitted | None, judged: Adequacy
) -> Fitted:
    """The laws that stay beside the class, fitted beside an unknown force: what a number is that
    stands in for one that changes is open."""
    by = by_class or decided
    pairs = zip(by.causes, grouped(by), strict=True)
    kept = [(one, row) for one, row in pairs if one.place is not None and one not in judged.doubt]
    causes = tuple(one for one, _ in kept)
    if causes == decided.causes:
        return decided
    return likeliest(ground, causes, [row for _, row in kept])
