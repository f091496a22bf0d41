"""A curve fitted along whole recordings, its points where the linear problem needs them.

A curve is linear about values that are stated. It is fitted again about the values that were found,
until these stand.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from symhyb.correction.adequacy.curves.courses import FORMS, Form, Line, line_of
from symhyb.correction.adequacy.curves.points import Points, placed
from symhyb.correction.adequacy.followed import scored
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Row, fitted
from symhyb.correction.search.trajectory import grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import value_name
from symhyb.model.types import Place
from symhyb.numeric.kernels.buffers import Array

ROUNDS = 4
STANDS = 0.1  # standard deviations: values that move by less stand


class Offer(NamedTuple):
    """A ``curve`` as a cause, what it is ``worth`` in ln evidence in the linear problem, the
    ``price`` of having chosen its points, and the fine ``line`` that they were chosen on."""

    curve: Hypothesis
    worth: float
    price: float
    line: Line

    @property
    def form(self) -> Form:
        """What the curve is a function of, and what it is a factor of."""
        return self.line.form


def offered(ground: Recorded, trial: Fitted, which: int, form: Form) -> Offer | None:
    """A curve at the place of this number around a structure; None where nothing moves there."""
    line = line_of(ground, trial, which, form)
    if line is None:
        return None
    place = ground.library.places[which]
    points = placed(line, not any(one.points and one.place == place for one in trial.causes))
    curve = _cause(line, points, place)
    return Offer(curve, points.worth, float(np.log(len(FORMS) * points.tried)), line)


def _cause(line: Line, points: Points, place: Place) -> Hypothesis:
    count = points.x.size
    return Hypothesis(
        "curve",
        place,
        tuple(map(value_name, range(count))),
        (False,) * count,
        () if line.length is None else (("length", line.length),),
        options=line.form.options,
        points=tuple(zip(points.x.tolist(), points.y.tolist(), points.shift.tolist(), strict=True)),
    )


def values_of(cause: Hypothesis) -> Row:
    """The values about which a curve is linear, by key, SI."""
    return {key: y for key, (_, y, _) in zip(cause.terms, cause.points, strict=True)}


def restated(cause: Hypothesis, values: Array) -> Hypothesis:
    """A curve that is linear about other values (P,), SI."""
    x, _, shift = zip(*cause.points, strict=True)
    return replace(cause, points=tuple(zip(x, values.tolist(), shift, strict=True)))


def beside(ground: Recorded, start: Fitted, offer: Offer) -> Fitted:
    """A structure with a curve behind its causes, fitted along whole recordings from where that
    ended; its curves are made linear about what is found until that stands. The evidence pays for
    the choice of the points of the new one."""
    causes = (*start.causes, offer.curve)
    rows: Sequence[Row] = [*grouped(start), values_of(offer.curve)]
    noise, states = ground.revived(start.fit.noise), start.fit.states
    for _ in range(ROUNDS):
        found = scored(ground, fitted(ground, causes, rows, noise, states))
        if found.fit.reason:
            break
        again = _restated(found)
        if again == causes:
            break
        causes, rows = again, grouped(found)
        noise, states = found.fit.noise, found.fit.states
    return replace(found, evidence=found.evidence - offer.price)


def _restated(found: Fitted) -> tuple[Hypothesis, ...]:
    """The causes of a structure, curves whose values moved about where they are now."""
    sd, first, causes = np.sqrt(np.diag(found.fit.covariance)), 0, []
    for cause in found.causes:
        own = slice(first, first + cause.numbers)
        moved = found.fit.values[own] - np.array([y for _, y, _ in cause.points] or 0.0)
        if cause.points and np.any(np.abs(moved) >= STANDS * sd[own]):
            cause = restated(cause, found.fit.values[own])
        causes.append(cause)
        first += cause.numbers
    return tuple(causes)
