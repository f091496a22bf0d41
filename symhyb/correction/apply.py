"""A model with what was found: the same file with elements appended and parameters replaced."""

from collections.abc import Sequence

from symhyb.asked import asked
from symhyb.correction.adequacy.in_time.stated_course import with_course
from symhyb.discrepancy.results import CourseFound, Found, Measurement, Reestimated
from symhyb.model.actuators import SENSOR_LAG
from symhyb.model.late import written_with_lag
from symhyb.model.types import Model
from symhyb.model.write import append_elements, hold_inputs, replace_parameters


@asked
def apply(
    model: Model,
    found: Sequence[Found],
    parameters: Sequence[Reestimated] = (),
    measurement: Sequence[Measurement] = (),
    courses: Sequence[CourseFound] = (),
) -> Model:
    """Return the corrected model; its text is the old one with the elements appended.

    Re-estimated ``parameters`` and channel faults (``measurement``) change in place, values and sd
    in the units that they carry; of an input that is held the file states that, and a sensor that
    lags gets a state, which is appended. A number with one of the ``courses`` has a factor of the
    time wherever it is used. The result is an ordinary model.

    Raises:
        InputError: a name or a unit that does not fit this model.
    """
    for course in courses:
        model = with_course(model, course)
    changed: dict[str, tuple[float, float | None]] = {
        item.name: (item.value, item.sd) for item in parameters
    }
    model = hold_inputs(model, [m.channel for m in measurement if m.kind == "held"])
    for m in measurement:
        if m.kind not in ("held", SENSOR_LAG):  # the factor between two units has no deviation
            changed[f"{m.channel}.{m.kind}"] = (m.value, m.sd or None)
    corrected = replace_parameters(model, changed) if changed else model
    for m in measurement:
        if m.kind == SENSOR_LAG:
            corrected = written_with_lag(corrected, m.channel, m.value, m.sd or None)
    elements = [item.element for item in found]
    return append_elements(corrected, elements) if elements else corrected
