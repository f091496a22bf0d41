"""A smooth remainder on top of the named laws: measured and written down, but no physics.

    F = Σ r_ij sⁱ s'ʲ,   i + j ≤ degree,   s and s' held at the ends of 99 % of what was recorded

The named values stay. What the polynomial may take is orthogonal, along the recorded motion, to the
force that any change of a named value would make; else it would steal the share of the laws. It is
fitted by simulation error over windows, initial states projected out. The degree is chosen on held
windows of the training recordings; the values then come from all of their windows.
Sizes: N samples, n coordinates, W windows, T terms, K named values.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.asked import asked
from symhyb.correction.learning.orthogonal import beside, linear, named_forces, on_held, solved
from symhyb.correction.search.preparing import Prepared, last_windows, prepare
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem
from symhyb.judgement import SIGNIFICANT
from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, On, Parameter
from symhyb.model.vocabulary import force_unit, stretch_unit
from symhyb.model.write import append_elements
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel
from symhyb.units import parse_unit

DEGREE_MOST = 5  # of the polynomial
RARE = 0.005  # of the samples at either end: so few do not determine a polynomial there
STEPS = 2  # Gauss–Newton steps: the remainder is small, so that the problem is almost linear
NAME = "remainder"
NO_REMAINDER = "No smooth remainder: no polynomial is better on held windows than none."
ABOUT = "part of the smooth remainder: measured, but no physics known by name"

Powers = tuple[int, int]


@dataclass(frozen=True, slots=True)
class Remainder:
    """A smooth remainder: the ``model`` with it, its ``element`` and ``degree``; ``held`` is χ² per
    sample of the held windows by degree, from 0 (nothing) on."""

    model: Model
    element: Element
    degree: int
    held: tuple[float, ...]

    @property
    def sentence(self) -> str:
        """What was measured, in words."""
        return (
            f"A polynomial of degree {self.degree} in stretch and rate takes the χ² per sample of "
            f"held windows from {self.held[0]:.4g} to {self.held[self.degree]:.4g}. It is what "
            "the named laws leave, not a law."
        )


@dataclass(frozen=True, slots=True)
class _Place:
    """Where the remainder acts: its coordinate and the ranges of stretch and rate, SI."""

    on: On
    index: int
    stretch: tuple[float, float]
    rate: tuple[float, float]

    def forces(self, course: Course, powers: Sequence[Powers]) -> Array:
        """Every term (N, T) along a course, for a coefficient of 1 in SI."""
        s = np.clip(course.q[:, self.index], *self.stretch)
        r = np.clip(course.v[:, self.index], *self.rate)
        return np.column_stack([s**i * r**j for i, j in powers])


@asked
def remainder(
    model: Model, recordings: Recording | Sequence[Recording], on: str | None = None
) -> Remainder | None:
    """Fit a smooth remainder to what a corrected ``model`` leaves of its training recordings.

    ``on`` names the coordinate where it acts (default: the only one that is free). Returns None
    where no degree is better on held windows than nothing at all.

    Raises:
        InputError: no such coordinate, a remainder is there already, or unusable recordings.
    """
    prepared = prepare(model, recordings)
    place = _place(prepared, on)
    powers = _powers(DEGREE_MOST)
    whole = append_elements(prepared.model, [_element(prepared.model, place, powers)])
    machine = build(whole, keep=False)
    free = tuple(machine.column(f"{NAME}.{_name(term)}") for term in powers)
    window_model = WindowModel(machine, free)
    chosen = last_windows(prepared, spread=True)
    cuts = [item.suited(machine) for item in chosen]
    step = linear(window_model, cuts, machine.values, prepared.sd)
    held = [on_held(step, None)]
    for degree in range(1, DEGREE_MOST + 1):
        basis = _orthogonal(prepared, place, powers, degree)
        held.append(on_held(step, basis))
    degree = _chosen(held, step.unit)
    if degree == 0:
        return None
    cuts = [item.suited(machine) for item in last_windows(prepared, spread=False)]
    basis = _orthogonal(prepared, place, powers, degree)
    values = _fitted(window_model, cuts, prepared.sd, basis)
    few = _powers(degree)  # the first ones of all powers
    element = _element(model, place, few, values[: len(few)].tolist())
    scaled = tuple(chi2 / step.samples for chi2 in held)
    return Remainder(append_elements(model, [element]), element, degree, scaled)


def _place(prepared: Prepared, on: str | None) -> _Place:
    """The coordinate and what it moves through in the training recordings."""
    model = prepared.model
    free = [model.coordinates[i].name for i in prepared.machine.free]
    if NAME in [element.name for element in model.elements]:
        raise InputError(Problem("the model has a remainder already", f"elements.{NAME}"))
    if on is None and len(free) != 1:
        raise InputError(Problem(f"name the coordinate of the remainder: {', '.join(free)}"))
    name = on or free[0]
    if name not in free:
        raise InputError(Problem(f"'{name}' is no free coordinate; there are: {', '.join(free)}"))
    i = [c.name for c in model.coordinates].index(name)
    q = np.concatenate([run.motion.q[:, i] for run in prepared.runs])
    v = np.concatenate([run.motion.v[:, i] for run in prepared.runs])
    stretch, rate = (np.quantile(motion, [RARE, 1 - RARE]).tolist() for motion in (q, v))
    return _Place(On(name), i, (stretch[0], stretch[1]), (rate[0], rate[1]))


def _powers(degree: int) -> tuple[Powers, ...]:
    """The exponents of stretch and rate of all terms up to a degree, low degrees first."""
    return tuple((n - j, j) for n in range(degree + 1) for j in range(n + 1))


def _name(term: Powers) -> str:
    return f"r_{term[0]}_{term[1]}"


def _element(
    model: Model, place: _Place, powers: Sequence[Powers], values: Sequence[float] = ()
) -> Element:
    """The element of some terms, coefficients in SI (default 0), with its box."""
    stretch, force = stretch_unit(model, place.on), force_unit(model, place.on)
    rate, x = stretch / parse_unit("s"), place.on.coordinate
    ends = {"s_low": place.stretch[0], "s_high": place.stretch[1]}
    speeds = {"r_low": place.rate[0], "r_high": place.rate[1]}
    own = [
        Parameter(key, value / unit.factor, unit, about="end of the training", owner=NAME)
        for box, unit in ((ends, stretch), (speeds, rate))
        for key, value in box.items()
    ]
    texts = []
    for term, value in zip(powers, values or [0.0] * len(powers), strict=True):
        unit = force / (stretch ** term[0] * rate ** term[1])
        own.append(Parameter(_name(term), value / unit.factor, unit, about=ABOUT, owner=NAME))
        parts = [_name(term)]
        parts += [f"max(s_low, min({x}, s_high))**{term[0]}"] * (term[0] > 0)
        parts += [f"max(r_low, min({x}', r_high))**{term[1]}"] * (term[1] > 0)
        texts.append("*".join(parts))
    key = "torque" if force.text == "N*m" else "force"
    return Element(NAME, "law", place.on, ((key, parse_expression(" + ".join(texts))),), tuple(own))


def _chosen(held: Sequence[float], unit: float) -> int:
    """The degree whose held windows are best; a higher one must be significantly better, against
    what it leaves. ``unit`` is χ² per sample, times its correlation, where nothing is taken."""
    best = 0
    for degree, chi2 in enumerate(held):
        if (held[best] - chi2) * held[0] > SIGNIFICANT * unit * chi2:
            best = degree
    return best


def _orthogonal(prepared: Prepared, place: _Place, powers: Sequence[Powers], degree: int) -> Array:
    """The directions (T, D) of the coefficients up to a degree whose force is orthogonal, along the
    recorded motion, to what changes of the named values make."""
    few = [term for term in powers if sum(term) <= degree]
    terms, named = [], []
    for item in last_windows(prepared, spread=True):
        course = item.course(prepared.machine)
        terms.append(place.forces(course, few))
        named.append(named_forces(prepared.machine, course)[:, place.index])
    directions = beside(np.concatenate(terms), np.concatenate(named))
    basis = np.zeros((len(powers), directions.shape[1]))
    basis[: len(few)] = directions
    return basis


def _fitted(model: WindowModel, cuts: Sequence[Cut], sd: Array, basis: Array) -> Array:
    """The coefficients (T,), SI, within ``basis`` (T, D), from all windows."""
    p = model.machine.values.copy()
    cuts = [replace(item, held=np.zeros_like(item.held)) for item in cuts]
    for _ in range(STEPS):
        p[list(model.free)] += solved(linear(model, cuts, p, sd).gram, basis)
    return np.asarray(p[list(model.free)])
