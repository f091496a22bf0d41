"""A curve over the rate that is multiplied by one over the stretch, in the linear problem.

    F = h(s′)·w(s)

Each of the two is fitted while the other one is held, in turn, until both stand (alternating least
squares), as smooth lines; at last each gets points of its own. It begins with the likeliest curve
that is a part of such a product: one over the rate alone, or damping or drag that changes with the
stretch. How large the whole is, is said by the curve over the rate: the factor is 1 at the point
where it is known best.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.curves.along import Instead, curve_through, motions_along
from symhyb.correction.adequacy.curves.courses import FORMS, Form, Line, line_of
from symhyb.correction.adequacy.curves.fitted_curve import Offer
from symhyb.correction.adequacy.curves.points import placed, smoothed
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.characteristic import Characteristic, through
from symhyb.laws.curve import factor_name, value_name
from symhyb.numeric.kernels.buffers import Array

TURNS = 12
STANDS = 0.01  # relative: a line that changes by less stands
STRETCH, RATE = Form("stretch"), Form("rate")

Curve = Callable[[Array], Array]


def product(ground: Recorded, trial: Fitted, offers: Sequence[Offer]) -> Offer | None:
    """A curve over the rate with one over the stretch as its factor, around a structure; it begins
    with the best of the ``offers`` of a curve. None where none of these is a part of it."""
    start = next((one for one in offers if one.form == RATE or one.form.times), None)
    if start is None:
        return None
    by_rate: Curve = start.form.factor if start.form.times else curve_through(start.curve.points)
    return _product(_Problem(ground, trial, start.line.which), by_rate)


def product_again(ground: Recorded, found: Fitted, curve: Hypothesis) -> Offer | None:
    """The product in place of one, ``curve``, that a structure has, along the motion of that."""
    assert curve.place is not None
    which = ground.library.places.index(curve.place)
    instead = Instead(curve, motions_along(ground, found))
    return _product(_Problem(ground, found, which, instead), curve_through(curve.points))


class _Problem(NamedTuple):
    """The linear problem at a place around a structure, in place of a product ``instead``."""

    ground: Recorded
    trial: Fitted
    which: int
    instead: Instead | None = None

    def line(self, form: Form, by: Curve) -> Line | None:
        """The fine line of a form as a factor of a function of the other quantity."""
        zero = form == RATE
        return line_of(self.ground, self.trial, self.which, form, by, zero, self.instead)


def _product(problem: _Problem, by_rate: Curve) -> Offer | None:
    """The product that begins with a curve over the rate."""
    before = np.zeros(0)
    for _ in range(TURNS):
        over_stretch = problem.line(STRETCH, by_rate)
        if over_stretch is None:
            return None
        by_stretch, values = _smooth(over_stretch)
        over_rate = problem.line(RATE, by_stretch)
        if over_rate is None:
            return None
        by_rate, _ = _smooth(over_rate)
        if before.size and np.abs(values - before).max() < STANDS * np.abs(values).max():
            break
        before = values
    return _pointed(problem, by_rate)


def _smooth(line: Line) -> tuple[Characteristic, Array]:
    """The smooth line over one of stretch and rate beside that of the other one, and its values
    (G,), 1 at the largest."""
    mean, *_ = smoothed(line)
    values = mean / (mean[np.argmax(np.abs(mean))] or 1.0)
    return through("smooth", line.x.tolist(), values.tolist(), "linear"), values


def _pointed(problem: _Problem, by_rate: Curve) -> Offer | None:
    """Both curves through points: those over the stretch beside the smooth line over the rate,
    those over the rate beside the curve through these."""
    over_stretch = problem.line(STRETCH, by_rate)
    if over_stretch is None:
        return None
    some = placed(over_stretch)
    one = int(np.argmax(np.abs(some.y) / some.shift))  # the best known
    factors = tuple((x, y / some.y[one], shift / abs(some.y[one])) for x, y, shift in some.listed)
    over_rate = problem.line(RATE, curve_through(factors))
    if over_rate is None:
        return None
    points = placed(over_rate)
    terms = [value_name(i) for i, x in enumerate(points.x) if not over_rate.stays(x)]
    terms += [factor_name(i) for i in range(len(factors)) if i != one]
    curve = Hypothesis(
        "curve",
        problem.ground.library.places[problem.which],
        tuple(terms),
        (False,) * len(terms),
        () if over_rate.length is None else (("length", over_rate.length),),
        options=RATE.options,
        points=points.listed,
        by_stretch=factors,
    )
    price = np.log((len(FORMS) + 1) * some.tried * points.tried)
    return Offer(curve, points.worth, float(price), over_rate)
