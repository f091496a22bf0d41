"""What a place moves through, and a fine broken line over it in the linear problem.

Sizes: N samples, n coordinates, G points of the fine line.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from symhyb.correction.adequacy.classes.columns import motions
from symhyb.correction.adequacy.curves.products import Products, products_of
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted
from symhyb.discrepancy.places.hypotheses import natural_length
from symhyb.judgement import HANDFUL
from symhyb.laws.curve import TIMES, speed_factor
from symhyb.laws.maths import NUMPY
from symhyb.model.types import Between, On
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

    def factor(self, rate: Array) -> Array:
        """What the curve is a factor of (N,), at rates (N,), SI."""
        return np.asarray(speed_factor(NUMPY, rate, dict(self.options)) + np.zeros_like(rate))


ALONE = Form("stretch"), Form("rate")
FORMS = (*ALONE, *(Form("stretch", times) for times in TIMES))


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """A force of stretch and rate of one ``form`` at the place of this number (``which``), as a
    broken line through values at ``x`` (G,), SI: the ``products`` of these values for every size of
    the unknown force; ``size`` is the value, SI, that by itself moves the place, ``rate`` the
    largest rate there, ``length`` what a stretch between two points is counted from."""

    which: int
    form: Form
    x: Array
    products: tuple[Products, ...]
    size: float
    rate: float
    length: float | None = None


def line_of(recorded: Recorded, trial: Fitted, which: int, form: Form) -> Line | None:
    """The fine line at a place around a fitted structure; None where nothing moves there, or moves
    it."""
    place = recorded.library.places[which]
    length = None
    if isinstance(place, Between):
        length = natural_length(recorded.windows.machine.model, place)
    parts = motions(recorded)
    moved = [form.of(s[:, which] - (length or 0.0), r[:, which]) for s, r, _ in parts]
    factors = [form.factor(r[:, which]) for _, r, _ in parts]
    x, size = fine_points(np.concatenate(moved)), force_at(recorded, which)
    usual = float(np.sqrt(np.mean(np.concatenate(factors) ** 2)))
    if x is None or not (size > 0 and usual > 0):
        return None
    resists = -1.0 if isinstance(place, On) else 1.0  # a tension pulls, whoever states it
    forces = [
        toward[:, :, which, None] * (resists * factor[:, None] * hats(values, x))[:, None]
        for (_, _, toward), factor, values in zip(parts, factors, moved, strict=True)
    ]
    fastest = max(float(np.abs(r[:, which]).max()) for _, r, _ in parts)
    products = products_of(recorded, trial, forces)
    return Line(which, form, x, products, size / usual, fastest, length)


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
    least = APART * (high - low) / (FINE // 2 - 1)
    digits = DIGITS - int(np.floor(np.log10(high - low)))
    low, high = round(low, digits), round(high, digits)
    kept = [low]
    for x in both[1:]:
        if x - kept[-1] > least and high - x > least:
            kept.append(round(float(x), digits))
    return np.array([*kept, high])


def hats(values: Array, x: Array) -> Array:
    """Piecewise linear functions (N, G), without a unit, of values (N,): 1 at one of the points x
    (G,) each; beyond the ends they run on along lines."""
    before = np.clip(np.searchsorted(x, values, side="right") - 1, 0, x.size - 2)
    share = (values - x[before]) / (x[before + 1] - x[before])
    found, rows = np.zeros((values.size, x.size)), np.arange(values.size)
    found[rows, before], found[rows, before + 1] = 1 - share, share
    return found
