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
from symhyb.judgement import CERTAIN
from symhyb.laws.curve import factor_name, value_name
from symhyb.model.types import Place

ROUNDS = 4
TURNS = 12  # of a product, which is linear in the changes of both of its curves alone
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


def offered(
    ground: Recorded, trial: Fitted, which: int, form: Form, level: bool = True
) -> Offer | None:
    """A curve at the place of this number around a structure; None where nothing moves there. One
    over the rate without a ``level`` is no force at rest."""
    line = line_of(ground, trial, which, form, through_zero=form.over == "rate" and not level)
    if line is None:
        return None
    points = placed(line)
    curve = _cause(line, points, ground.library.places[which])
    return Offer(curve, points.worth, float(np.log(len(FORMS) * points.tried)), line)


def _cause(line: Line, points: Points, place: Place) -> Hypothesis:
    terms = [value_name(i) for i, x in enumerate(points.x) if not line.stays(x)]
    return Hypothesis(
        "curve",
        place,
        tuple(terms),
        (False,) * len(terms),
        () if line.length is None else (("length", line.length),),
        options=line.form.options,
        points=points.listed,
    )


def values_of(cause: Hypothesis) -> Row:
    """The values about which a curve is linear, by key, SI; no change of what it is multiplied
    by."""
    return {
        **{key: y for key, (_, y, _) in cause.unknown.items()},
        **dict.fromkeys(cause.factors, 0.0),
    }


def restated(cause: Hypothesis, values: Row) -> Hypothesis:
    """A curve that is linear about other values, by key, SI."""
    points = [
        (x, values.get(value_name(i), y), shift) for i, (x, y, shift) in enumerate(cause.points)
    ]
    factors = [
        (x, w + values.get(factor_name(i), 0.0), shift)
        for i, (x, w, shift) in enumerate(cause.by_stretch)
    ]
    return replace(cause, points=tuple(points), by_stretch=tuple(factors))


def beside(ground: Recorded, start: Fitted, offer: Offer) -> Fitted:
    """A structure with a curve behind its causes, fitted along whole recordings from where that
    ended; its curves are made linear about what is found until that stands. A product may end going
    to and fro between statements that are as likely; one that does not end is as little an answer
    as a fit that failed. The evidence pays for the choice of the points of the new one."""
    causes = (*start.causes, offer.curve)
    rows: Sequence[Row] = [*grouped(start), values_of(offer.curve)]
    noise, states = ground.revived(start.fit.noise), start.fit.states
    many = any(cause.by_stretch for cause in causes)
    done: list[Fitted] = []
    for _ in range(TURNS if many else ROUNDS):
        found = scored(ground, fitted(ground, causes, rows, noise, states))
        done.append(found)
        if found.fit.reason:
            break
        again = _restated(found)
        if again == causes:
            break
        causes = again
        rows = [
            values_of(cause) if cause.points else row
            for cause, row in zip(causes, grouped(found), strict=True)
        ]
        noise, states = found.fit.noise, found.fit.states
    else:
        if many:
            found = _settled(done[-ROUNDS:])
    return replace(found, evidence=found.evidence - offer.price)


def _settled(last: Sequence[Fitted]) -> Fitted:
    """The likeliest of the last statements of a product; of no evidence where they are not as
    likely, to 100 to 1."""
    best = max(last, key=lambda one: one.evidence)
    apart = best.evidence - min(one.evidence for one in last)
    return best if apart <= CERTAIN else replace(best, evidence=-np.inf)


def _restated(found: Fitted) -> tuple[Hypothesis, ...]:
    """The causes of a structure, curves whose values moved about where they are now."""
    sd, first, causes = np.sqrt(np.diag(found.fit.covariance)), 0, []
    for cause in found.causes:
        own = slice(first, first + cause.numbers)
        if cause.points:
            before = values_of(cause)
            moved = found.fit.values[own] - np.array([before[key] for key in cause.keys])
            if np.any(np.abs(moved) >= STANDS * sd[own]):
                cause = restated(cause, dict(zip(cause.keys, found.fit.values[own], strict=True)))
        causes.append(cause)
        first += cause.numbers
    return tuple(causes)
