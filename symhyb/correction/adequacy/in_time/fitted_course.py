"""A course fitted along whole recordings, beside the causes of a structure.

The model in which the number has a factor of the time is an ordinary model; the numbers of the
course are parameters of it, with what is possible as their prior.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.adequacy.evidence import classes
from symhyb.correction.adequacy.followed import scored
from symhyb.correction.adequacy.in_time.changing_number import Number
from symhyb.correction.adequacy.in_time.placing import Begun, again
from symhyb.correction.adequacy.in_time.shapes import (
    HERTZ,
    RADIANS,
    SECONDS,
    Shape,
    free_factor,
    numbers_of,
)
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import ACCURACY
from symhyb.model.types import Model, Parameter
from symhyb.model.varied import shown_with_factor, with_factor
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel
from symhyb.units import ONE

SHAPES = 4  # that compete
ROUNDS = 4
UNIFORM = 12**-0.5  # standard deviation of a uniform distribution over its range
NAME = "course"  # of the numbers on trial
_UNITS = {"time": SECONDS, "duration": SECONDS, "frequency": HERTZ, "phase": RADIANS}


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A ``shape`` of a number over the time, as fitted: one deviation of its numbers (F,), in the
    order of :func:`numbers_of`, SI; ``trial`` is the structure with it, fitted along whole
    recordings, with its evidence."""

    number: Number
    shape: Shape
    sd: Array
    trial: Fitted


def free_course(
    ground: Recorded, start: Fitted, base: Fitted, number: Number, offer: Begun
) -> Course:
    """A line through points, fitted beside the causes of ``base``, whose points are chosen again
    around what was fitted, as long as that is likelier."""
    best = fitted_course(ground, start, base, number, offer)
    for _ in range(ROUNDS):
        if best.trial.fit.reason:
            break
        held = [f"{NAME}_{key}" for key, _ in numbers_of(best.shape)]
        more = again(ground, best.trial, number, best.shape, held)
        if more is None:
            break
        found = fitted_course(ground, best.trial, base, number, more)
        if found.trial.evidence <= best.trial.evidence:
            break
        best = found
    return best


def fitted_course(
    ground: Recorded, start: Fitted, base: Fitted, number: Number, offer: Begun
) -> Course:
    """A shape fitted beside the causes of ``base``, along the trajectories of ``start``. The
    evidence pays for the choice of number and shape."""
    shape = offer.shape
    spreads = _spreads(ground, number, shape)
    model = _free(ground.windows.machine.model, number, shape, spreads)
    more = [
        Hypothesis("parameter", None, ("value",), (key == "duration",), path=f"{NAME}_{key}")
        for key, _ in numbers_of(shape)
    ]
    known = [one for one in ground.parametric if number.is_channel or one.path != number.path]
    windows = WindowModel(build(model, keep=False))
    there = replace(ground, windows=windows, parametric=(*known, *more))
    noise, states = ground.revived(start.fit.noise), start.fit.states
    trial = fitted(there, base.causes, grouped(base), noise, states)
    trial = scored(there, trial)
    rows = [trial.paths.index(one.path) for one in more]
    values = np.asarray(trial.fit.values)[rows]
    sd = np.sqrt(np.abs(np.diag(trial.fit.covariance)[rows]))
    sd[: len(shape.values)] = np.hypot(sd[: len(shape.values)], ACCURACY * _exactly(shape, values))
    if offer.shift is not None:
        sd = np.maximum(sd, offer.shift)
    begun = np.array([value for _, value in numbers_of(shape)])
    # a fit begins at its priors' means; those of the values are no change at all
    off = _plain(shape) - values, begun - values
    shift = 0.5 * float(np.sum((off[0] / spreads) ** 2 - (off[1] / spreads) ** 2))
    price = float(np.log(max(classes(ground), 2) * SHAPES)) + offer.price
    trial = replace(trial, evidence=trial.evidence - shift - price)
    return Course(number, shape.moved(values), sd, trial)


def _exactly(shape: Shape, values: Array) -> Array:
    """What the numerics err in proportion to: factors, not frequencies and phases."""
    own = np.abs(values[: len(shape.values)])
    if shape.name == "period":
        own[2:] = 0.0
    return own


def _plain(shape: Shape) -> Array:
    """The numbers (F,) of a factor that does not change; nothing else is known of times, of a
    frequency and of a phase."""
    numbers = np.array([value for _, value in numbers_of(shape)])
    if shape.name == "period":
        numbers[:2] = 1.0, 0.0
    else:
        numbers[: len(shape.values)] = 1.0
    return numbers


def _spreads(ground: Recorded, number: Number, shape: Shape) -> Array:
    """Prior deviations (F,) of the numbers of a shape, SI."""
    lasts = max(float(np.ptp(item.block.t[0])) for item in ground.items)
    wide = {
        "time": UNIFORM * lasts,
        "duration": UNIFORM * lasts,
        "frequency": UNIFORM * 2 / ground.period_s,
        "phase": UNIFORM * 2 * np.pi,
    }
    return np.array([wide.get(key, number.size) for key, _ in numbers_of(shape)])


def _free(model: Model, number: Number, shape: Shape, spreads: Sequence[float] | Array) -> Model:
    """The model with a course whose numbers are parameters with a prior; its level takes the place
    of the number, which is held."""
    pairs = zip(numbers_of(shape), spreads, strict=True)
    added = [
        Parameter(f"{NAME}_{key}", value, _UNITS.get(key, ONE), float(sd))
        for (key, value), sd in pairs
    ]
    if number.is_sensor:
        return shown_with_factor(model, number.path, free_factor(shape, NAME), added)
    held = tuple(
        replace(item, sd=None) if item.path == number.path else item for item in model.parameters
    )
    return with_factor(
        replace(model, parameters=held), number.path, free_factor(shape, NAME), added
    )
