"""A loss of which more acts at one place than at another, out of a linear problem."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symhyb.correction.adequacy.curves import product as module
from symhyb.correction.adequacy.curves.courses import Form, Line, fine_points, hats
from symhyb.correction.adequacy.curves.fitted_curve import Offer
from symhyb.correction.adequacy.curves.product import RATE, STRETCH, Curve, product
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.kernels.buffers import Array

T = np.linspace(0, 60, 3000)
S = np.sin(1.3 * T) + 0.6 * np.sin(2.9 * T)
R = 1.3 * np.cos(1.3 * T) + 0.6 * 2.9 * np.cos(2.9 * T)


def more_there(s: Array) -> Array:
    return np.exp(-((s - 0.3) ** 2))


def loss(r: Array) -> Array:
    return np.asarray(np.tanh(2 * r))


def started(monkeypatch: pytest.MonkeyPatch, force: Array, noise: float = 0.02) -> Offer | None:
    """The product that stands for a force along a motion, with white noise."""
    left = force + noise * np.random.default_rng(3).normal(size=T.size)

    def line(ground: Any, trial: Any, which: int, form: Form, by: Curve, *_: Any) -> Line:
        over, other = (R, S) if form.over == "rate" else (S, R)
        x = fine_points(over)
        assert x is not None
        if form == RATE:
            x = np.union1d(x[np.abs(x) > 0.02], 0.0)
        columns = np.column_stack([hats(over, x) * by(other)[:, None], -left]) / noise
        size = float(np.std(force)) / float(np.sqrt(np.mean(by(other) ** 2)))
        gram = columns.T @ columns
        return Line(which, form, x, ((gram, 0.0),), size, 3.0, through_zero=form == RATE)

    monkeypatch.setattr(module, "line_of", line)
    ground: Any = SimpleNamespace(library=SimpleNamespace(places=(On("x"),)))
    points = tuple((float(x), float(x), 0.0) for x in np.linspace(-3, 3, 5))
    curve = Hypothesis("curve", On("x"), ("f1",), (False,), options=RATE.options, points=points)
    trial: Any = None
    first = Offer(curve, 1.0, 0.0, line(ground, trial, 0, RATE, np.ones_like))
    return product(ground, trial, [first])


def test_both_curves_are_found_to_their_noise(monkeypatch: pytest.MonkeyPatch) -> None:
    offer = started(monkeypatch, loss(R) * more_there(S))
    assert offer is not None
    curve = offer.curve
    for x, y, shift in curve.points:
        assert abs(y - loss(np.array(x))) < 4 * max(shift, 0.02)
    for x, w, shift in curve.by_stretch:
        assert abs(w - more_there(np.array(x))) < 4 * max(shift, 0.02)
    assert 1.0 in [w for _, w, _ in curve.by_stretch]


def test_what_states_its_size_has_no_term(monkeypatch: pytest.MonkeyPatch) -> None:
    offer = started(monkeypatch, loss(R) * more_there(S))
    assert offer is not None
    curve = offer.curve
    assert len(curve.factors) == len(curve.by_stretch) - 1
    assert len(curve.unknown) == len(curve.points) - 1  # none at rest
    assert (0.0, 0.0) in [(x, y) for x, y, _ in curve.points]


def test_nothing_that_it_could_begin_with_is_none() -> None:
    ground: Any = None
    over_stretch: Any = SimpleNamespace(form=STRETCH)
    assert product(ground, ground, [over_stretch]) is None
