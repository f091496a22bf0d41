"""Force laws that nobody listed: formulas that are put together at random.

    spring      g(x)                x = s/RMS, resists the stretch
    loss        h(y)                y = s'/RMS, resists the motion
    zone        f(x)·h(y)           a loss that changes with the stretch
    both        g(x) + h(y)         a spring and a loss of their own

Each of f, g and h is drawn from a list with numbers of its own.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from bare import Bare, draw_place, rms, share
from kinds_force import Law, law_at
from numpy.random import Generator
from shared import Array
from simulate import Change

Shape = Callable[[Array | float], Array | float]
FORMS = ("spring", "loss", "zone", "both")
LISTED = (0.0, 1.0, 2.0, 3.0)  # powers that laws by name have
APART = 0.2  # of a drawn power from them


def formula(bare: Bare, sizes: Generator, fresh: Generator) -> Change:
    """A law of stretch and rate at a place; the form is drawn first."""
    place = draw_place(bare, sizes)
    form = str(sizes.choice(FORMS))
    far, fast = rms(place.s - np.mean(place.s)), rms(place.w)
    g, (h, exponent), f = _spring(sizes), _loss(sizes), _zone(sizes)
    # two forces side by side are of one size along the bare run
    x, y = place.s / far, place.w / fast
    even = rms(np.asarray(g(x))) / rms(np.asarray(h(y)))
    laws: dict[str, Law] = {
        "spring": lambda s, w: g(s / far),
        "loss": lambda s, w: h(w / fast),
        "zone": lambda s, w: f(s / far) * h(w / fast),
        "both": lambda s, w: g(s / far) + even * h(w / fast),
    }
    change = law_at(bare, place, laws[form], share(sizes))
    known = {"exponent": exponent} if form == "loss" and exponent is not None else {}
    return replace(change, facts={**(change.facts or {}), "form": FORMS.index(form), **known})


def _power(sizes: Generator, low: float, high: float) -> float:
    """A power that no law by name has."""
    while True:
        drawn = float(sizes.uniform(low, high))
        if min(abs(drawn - one) for one in LISTED) > APART:
            return drawn


def _spring(sizes: Generator) -> Shape:
    """A force of the stretch, 0 at 0, that pulls back somewhere."""
    a, p = sizes.uniform(0.5, 2.0), _power(sizes, 0.4, 2.8)
    shapes: tuple[Shape, ...] = (
        lambda x: np.sign(x) * np.abs(x) ** p,
        lambda x: np.arcsinh(2 * a * x),
        lambda x: x / (1 + np.abs(a * x)),
        lambda x: np.expm1(a * x),
        lambda x: x * np.exp(-((a * x) ** 2)),
        lambda x: np.log1p(np.exp(3 * (x - a / 2))) - np.log1p(np.exp(-1.5 * a)),
    )
    return shapes[int(sizes.integers(len(shapes)))]


def _loss(sizes: Generator) -> tuple[Shape, float | None]:
    """A force of the rate that resists everywhere, and its exponent if it is a power."""
    a, p = sizes.uniform(0.5, 2.0), _power(sizes, 0.3, 2.7)
    shapes: tuple[Shape, ...] = (
        lambda y: np.sign(y) * np.abs(y) ** p,
        lambda y: np.tanh(1.5 * a * y),
        lambda y: np.arcsinh(3 * a * y),
        lambda y: y * np.exp(-np.abs(a * y)),
        lambda y: np.sinh(a * y),
        lambda y: y * (1 + 0.8 * np.tanh(a * y)),
    )
    which = int(sizes.integers(len(shapes)))
    return shapes[which], (p if which == 0 else None)


def _zone(sizes: Generator) -> Shape:
    """How much of a loss acts at a stretch: nowhere less than nothing."""
    a, p = sizes.uniform(0.5, 2.0), _power(sizes, 0.4, 2.8)
    shapes: tuple[Shape, ...] = (
        lambda x: np.abs(x) ** p,
        lambda x: np.exp(a * x),
        lambda x: 1 / (1 + (a * x) ** 2),
        lambda x: 1 + np.tanh(a * x),
        lambda x: 1 + 0.9 * np.cos(2 * a * x),
        lambda x: np.exp(-((x - a / 2) ** 2)),
    )
    return shapes[int(sizes.integers(len(shapes)))]
