"""The model that states a course: a number times a factor of the time, or of a channel."""

from symhyb.correction.adequacy.in_time.shapes import Shape, stated
from symhyb.discrepancy.results import CourseFound
from symhyb.model.types import Model
from symhyb.model.varied import written_with_factor


def with_course(model: Model, found: CourseFound) -> Model:
    """The model in which a number has its course.

    Raises:
        InputError: the model may not state it, as that of an added mass.
    """
    at = tuple(x for x, _, _ in found.points)
    shape = Shape(found.shape, at, found.factors, over=found.over or "")
    one = stated(shape, model, found.path, found.sentence)
    return written_with_factor(model, found.path, one.factor, one.parameters, one.curves)
