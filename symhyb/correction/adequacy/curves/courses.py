"""What a place moves through, and a fine broken line over it in the linear problem.

Sizes: N samples, n coordinates, G points of the fine line.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from symhyb.correction.adequacy.classes.columns import motions
from symhyb.correction.adequacy.curves.along import Instead, force_of, products_instead
from symhyb.correction.adequacy.curves.products import Products, products_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.discrepancy.places.hypotheses import Hypothesis, natural_length
from symhyb.judgement import HANDFUL
from symhyb.laws.curve import TIMES, speed_factor
from symhyb.laws.maths import NUMPY
from symhyb.model.types import Between, On, Place
from symhyb.model.vocabulary import Words
from symhyb.numeric.kernels.buffers import Array

FINE = 64  # points of the fine line, half of them evenly spread, half at quantiles
DIGITS = 3  # of the range: as exactly points are stated
APART = 0.25  # of an even distance: nearer points are one


@dataclass(frozen=True, slots=True)
class Form:
    """What a curve is a function of, and what it is a factor of: the options of a ``curve``."""

    over: Literal["stretch", "rate"]
    times: str = ""

    @property
    def options(self) -> Words:
        """As an element has them."""
        return (("over", self.over), *((("times", self.times),) if self.times else ()))

    def of(self, stretch: Array, rate: Array) -> Array:
        """What the curve is a function of (N,), of stretch and rate (N,) of a place, SI."""
        return rate if self.over == "rate" else stretch

    @property
    def other(self) -> "Form":
        """A curve over the other one of stretch and rate."""
        return Form("stretch" if self.over == "rate" else "rate")

    def factor(self, rate: Array) -> Array:
        """What the curve is a factor of (N,), at rates (N,), SI."""
        return np.asarray(speed_factor(NUMPY, rate, dict(self.options)) + np.zeros_like(rate))


def form_of(cause: Hypothesis) -> Form:
    """What a curve as a cause is a function of, and what it is a factor of."""
    words = dict(cause.options)
    return Form("rate" if words["over"] == "rate" else "stretch", words.get("times", ""))


ALONE = Form("stretch"), Form("rate")
FORMS = (*ALONE, *(Form("stretch", times) for times in TIMES))


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A force of stretch and rate of one ``form`` at the place of this number (``which``), as a
    broken line through values at ``x`` (G,), SI: the ``products`` of these values for every size of
    the unknown force; ``size`` is the value, SI, that by itself moves the place, ``rate`` the
    largest rate there, ``length`` what a stretch between two points is counted from. One
    ``through_zero``, which is one of ``x``, has no value there."""

    which: int
    form: Form
    x: Array
    products: tuple[Products, ...]
    size: float
    rate: float
    length: float | None = None
    through_zero: bool = False

    def stays(self, x: float) -> bool:
        """Whether the value at x, SI, is none because the line goes through zero there."""
        return self.through_zero and x == 0.0


def line_of(
    recorded: Recorded,
    trial: Fitted,
    which: int,
    form: Form,
    by: Callable[[Array], Array] | None = None,
    through_zero: bool = False,
    instead: Instead | None = None,
) -> Line | None:
    """The fine line at a place around a fitted structure, as a factor of the function ``by``, (N,)
    of (N,) of the other one of stretch and rate, SI; None where nothing moves there, or moves
    it. In place of a product that the structure has (``instead``), along its motion."""
    place = recorded.library.places[which]
    length = natural_length_at(recorded, place)
    parts = motions(recorded) if instead is None else instead.motions
    states = [(s[:, which] - (length or 0.0), r[:, which]) for s, r, _ in parts]
    moved = [form.of(s, r) for s, r in states]
    factors = [form.factor(r) if by is None else by(form.other.of(s, r)) for s, r in states]
    x, size = fine_points(np.concatenate(moved)), force_at(recorded, which)
    usual = float(np.sqrt(np.mean(np.concatenate(factors) ** 2)))
    if x is None or not (size > 0 and usual > 0):
        return None
    through_zero = through_zero and x[0] < 0 < x[-1]
    if through_zero:
        x = np.union1d(x[np.abs(x) > _apart(x[0], x[-1])], 0.0)
    resists = -1.0 if isinstance(place, On) else 1.0  # a tension pulls, whoever states it
    forces = [
        toward[:, :, which, None] * (resists * factor[:, None] * hats(values, x))[:, None]
        for (_, _, toward), factor, values in zip(parts, factors, moved, strict=True)
    ]
    if instead is None:
        products = products_of(recorded, trial, forces)
    else:
        old = [
            toward[:, :, which, None] * (resists * force_of(instead.cause, s, r))[:, None, None]
            for (_, _, toward), (s, r) in zip(parts, states, strict=True)
        ]
        products = products_instead(recorded, trial, forces, old, instead.cause)
    fastest = max(float(np.abs(r[:, which]).max()) for _, r, _ in parts)
    return Line(which, form, x, products, size / usual, fastest, length, through_zero)


def natural_length_at(recorded: Recorded, place: Place) -> float | None:
    """What the stretch of a place between two points is counted from, m; None on coordinates."""
    if not isinstance(place, Between):
        return None
    return natural_length(recorded.windows.machine.model, place)


def size_at(recorded: Recorded, which: int, form: Form) -> float:
    """The value of a curve at a place, SI, that by itself moves what it pushes."""
    factors = np.concatenate([form.factor(r[:, which]) for _, r, _ in motions(recorded)])
    return force_at(recorded, which) / (float(np.sqrt(np.mean(factors**2))) or 1.0)


def force_at(recorded: Recorded, which: int) -> float:
    """The force at a place, SI, that moves what it pushes; 0 where it pushes nothing."""
    power = np.mean([np.mean(d[:, :, which] ** 2, axis=0) for _, _, d in motions(recorded)], axis=0)
    share = float(np.max(np.sqrt(power) / recorded.scale_or_inf[:, 0]))
    return 1 / share if share > 0 else 0.0


def fine_points(values: Array) -> Array | None:
    """Where the fine line has its points (G,), SI, among ``values`` (N,), a handful of which lie
    beyond either end; None where there are too few, or all are the same."""
    if values.size <= 2 * HANDFUL:
        return None
    ordered = np.sort(values)
    low, high = float(ordered[HANDFUL]), float(ordered[-HANDFUL - 1])
    if not high > low:
        return None
    shares = np.linspace(0.0, 1.0, FINE // 2)
    inside = ordered[HANDFUL : -HANDFUL or None]
    both = np.sort(np.concatenate([low + shares * (high - low), np.quantile(inside, shares)]))
    least = _apart(low, high)
    digits = DIGITS - int(np.floor(np.log10(high - low)))
    low, high = round(low, digits), round(high, digits)
    kept = [low]
    for x in both[1:]:
        if x - kept[-1] > least and high - x > least:
            kept.append(round(float(x), digits))
    return np.array([*kept, high])


def _apart(low: float, high: float) -> float:
    """How near two points of a fine line between these ends may be, SI."""
    return APART * (high - low) / (FINE // 2 - 1)


def hats(values: Array, x: Array) -> Array:
    """Piecewise linear functions (N, G), without a unit, of values (N,): 1 at one of the points x
    (G,) each; beyond the ends they run on along lines."""
    before = np.clip(np.searchsorted(x, values, side="right") - 1, 0, x.size - 2)
    share = (values - x[before]) / (x[before + 1] - x[before])
    found, rows = np.zeros((values.size, x.size)), np.arange(values.size)
    found[rows, before], found[rows, before + 1] = 1 - share, share
    return found
