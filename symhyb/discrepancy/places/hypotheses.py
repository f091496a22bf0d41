"""What could be wrong: laws of the vocabulary at places, and the parametric causes.

The vocabulary of elements is the vocabulary of hypotheses. A force hypothesis is an ordinary
element with unknown coefficients; its *probes* are the same element with one coefficient set to
one, so that the force of any combination is linear in the coefficients. A parametric cause is a
parameter that may be estimated, or gain, offset or delay of a channel. All compete in one list;
which laws are tried where, and in what shapes, is said by
:mod:`symhyb.discrepancy.places.candidates`.
"""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from math import inf, isfinite

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.places.placements import places_of as places_of
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.words.formula import LAW, law_element, law_unit
from symhyb.laws.base import Key, Terms
from symhyb.laws.cardinal import parts_of
from symhyb.laws.curve import factor_name, value_name
from symhyb.model.delays import Channel, channels_of, shared_delays
from symhyb.model.expression import parse_expression
from symhyb.model.types import (
    Between,
    Element,
    Model,
    On,
    Parameter,
    Place,
    place_text,
)
from symhyb.model.vocabulary import KINDS, curve_units, expressed, key_of, key_unit, worded
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import free_part
from symhyb.units import ONE, Unit, parse_unit

CHUNK = 100_000  # samples at once
ASSUMED = "assumed"  # a gain, offset or delay that the file does not state
_UNKNOWN = Key("", 0, 0, 0)  # of what is no key of a law: a parameter, a coefficient of a formula
_AS_THEY_ARE = Terms()


CurvePoint = tuple[float, float, float]
"""Where it stands, its value there, and what a smooth line without points says otherwise, SI."""


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """One cause: a law at a place, or (``place`` None) the parameter ``path`` of the model; of a
    ``law`` at a place ``path`` is the formula.

    ``terms`` are unknown coefficients in which the force is linear; ``shape`` are keys that are set
    beforehand (SI), ``refined`` those of them that are fitted afterwards and so cost a number each,
    ``tied`` those that grow with the first coefficient (the damping of a relaxation of a given
    time). ``positive`` says which terms physics forbids to be negative; ``options`` are words, or
    expressions (a ``load``); ``own`` are fitted keys that every recording has its own value of, or
    every group (``by``: key and grouping); ``added`` are the refined keys that make a variant of a
    plain law (the play of a hysteresis). ``bounds`` (key, lower, upper), SI, hold at this place
    where those of the law are too wide. A curve's terms are its values at ``points``: place, value
    about which it is linear, and what a smooth line without points says otherwise there, SI; then
    the changes of what it is multiplied by at points ``by_stretch``. A point without a term stands.
    """

    kind: str
    place: Place | None
    terms: tuple[str, ...]
    positive: tuple[bool, ...]
    shape: tuple[tuple[str, float], ...] = ()
    refined: tuple[str, ...] = ()
    path: str = ""
    tied: tuple[str, ...] = ()
    options: tuple[tuple[str, str], ...] = ()
    own: tuple[str, ...] = ()
    by: tuple[tuple[str, str], ...] = ()
    added: tuple[str, ...] = ()
    bounds: tuple[tuple[str, float, float], ...] = ()
    points: tuple[CurvePoint, ...] = ()
    by_stretch: tuple[CurvePoint, ...] = ()

    @property
    def keys(self) -> tuple[str, ...]:
        """The keys of the element that are fitted, those of the terms first."""
        named = self._read.keys
        return (*(named.get(term, term) for term in self.terms), *self.refined)

    @property
    def _read(self) -> Terms:
        """How the terms become keys."""
        return KINDS[self.kind].terms if self.kind in KINDS else _AS_THEY_ARE

    def grouping(self, key: str) -> str:
        """The grouping of the recordings that share an own key; empty where each has its own."""
        return dict(self.by).get(key, "")

    @property
    def numbers(self) -> int:
        """How many numbers the hypothesis fits."""
        return len(self.keys)

    @property
    def variant(self) -> bool:
        """Whether this is a plain law with something added, which is tried where the plain one was
        found: dry friction that falls with speed, damping that differs by direction."""
        return bool(self.added) or any(term in self._read.added for term in self.terms)

    @property
    def family(self) -> tuple[object, ...]:
        """What makes two hypotheses the same but for their shape."""
        many = bool(self.by_stretch)
        return self.kind, self.place, self.terms, self.refined, self.path, self.options, many

    @property
    def bent(self) -> bool:
        """Whether its law takes on shapes between those of simpler ones, as friction does between
        dry and viscous where the speed within which it turns over is fitted."""
        law = KINDS.get(self.kind)
        return law is not None and (law.bent or law.smoothed_over in self.refined)

    @property
    def several(self) -> bool:
        """Whether more than one of its law may act at one place."""
        law = KINDS.get(self.kind)
        return law is not None and law.several

    @property
    def subject(self) -> tuple[object, ...]:
        """What it is a law of: dry friction with and without memory is one contact."""
        law = KINDS.get(self.kind)
        return (law.subject if law and law.subject else self.kind), self.place, self.path

    def extends(self, other: "Hypothesis") -> bool:
        """Whether this is the law ``other``, perhaps with a key more."""
        mine = self.kind, self.place, self.path
        same = mine == (other.kind, other.place, other.path)
        return same and {*other.terms, *other.options} <= {*self.terms, *self.options}

    def __str__(self) -> str:
        if self.place is None:
            return self.path if self.kind == "law" else f"{self.kind} {self.path}"
        if self.kind == LAW:
            return f"law ({self.path}) {place_text(self.place)}"
        keys = (f"{len(self.points)} points",) if self.points else self.keys
        keys += (f"{len(self.by_stretch)} by stretch",) if self.by_stretch else ()
        said = ", ".join((*(f"{key} {word}" for key, word in self.options), *keys))
        return f"{self.kind} ({said}) {place_text(self.place)}"

    def values(self, coefficients: Sequence[float]) -> dict[str, float]:
        """The fitted keys (SI) that go with these coefficients of the terms, shapes as tried."""
        own = [float(c) for c in coefficients]
        if self.place is None:
            return {"value": own[0]}
        shape = {key: value * (own[0] if key in self.tied else 1) for key, value in self.shape}
        read = self._read.read(dict(zip(self.terms, own, strict=True)))
        for key in self._read.keys.values():  # no coefficient itself: bounds of physics hold later
            if key in read:
                lower, upper = self.limits(key)
                read[key] = min(max(read[key], lower), upper)
        return {key: read.get(key, shape.get(key, 0.0)) for key in self.keys}

    def limits(self, key: str) -> tuple[float, float]:
        """Bounds of a fitted key, SI: of this place, of physics, and of a refined key those about
        where it was tried."""
        for name, lower, upper in self.bounds:
            if name == key:
                return lower, upper
        declared = key_of(self.kind, key) or _UNKNOWN
        if key in self.tied and key in self.refined:
            return 0.0, inf
        if key in self.refined:
            return self._near(declared)
        forbidden = key in self.terms and self.positive[self.terms.index(key)]
        return max(declared.lower, 0.0 if forbidden else -inf), declared.upper

    def _near(self, key: Key) -> tuple[float, float]:
        """Bounds of a refined key about where it was tried; what was added to a plain law may fall
        back to it."""
        tried, shape = dict(self.shape)[key.name], dict(self.shape)
        upper, plain = tried * key.reach, key.plain({})
        if key.name in self.added and key.either_sign:
            return -upper, upper
        if key.above and key.above[0] in shape:
            return key.above[1] * shape[key.above[0]], upper
        if key.name in self.added and plain is not None:
            return plain, upper
        return (key.lower if isfinite(key.lower) else tried / key.reach), upper

    def unit(self, model: Model, key: str, exponent: float | None = None) -> Unit:
        """The unit of a key of a force hypothesis, as the model file writes it; ``exponent`` as of
        :func:`~symhyb.model.vocabulary.key_unit`, by default that of its shape."""
        assert self.place is not None
        if exponent is None:
            exponent = dict(self.shape).get("exponent", 1.0)
        if self.kind == LAW and isinstance(self.place, On):
            return law_unit(model, self.place, self.path, key)
        if key in self.terms and self.points:
            changed = key in self.factors
            return ONE if changed else curve_units(model, self.place, self.options)[1]
        return key_unit(model, self.kind, key, self.place, exponent)

    def element(self, model: Model, name: str, values: Mapping[str, float]) -> Element:
        """The element of a force hypothesis with these values of its keys, else its shape, SI."""
        assert self.place is not None
        if self.kind == LAW and isinstance(self.place, On):
            return law_element(model, name, self.place, self.path, {**dict(self.shape), **values})
        own = []
        for key, value in {**dict(self.shape), **values}.items():
            unit = self.unit(model, key)
            own.append(Parameter(key, value / unit.factor, unit, owner=name))
        entries = tuple((item.name, parse_expression(item.name)) for item in own)
        entries += expressed(self.kind, self.options)
        words = worded(self.kind, self.options)
        element = Element(name, self.kind, self.place, entries, tuple(own), options=words)
        if not self.points:
            return element
        by_stretch = self._keyed(factor_name, self.by_stretch)
        parts = parts_of(name, self._keyed(value_name, self.points), by_stretch)
        return replace(element, parts=parts)

    @property
    def unknown(self) -> Mapping[str, CurvePoint]:
        """The points of a curve whose values are unknown, by term."""
        return {key: point for key, point in self._keyed(value_name, self.points) if key}

    @property
    def factors(self) -> Mapping[str, CurvePoint]:
        """The points of what a curve is multiplied by whose changes are unknown, by term."""
        return {key: point for key, point in self._keyed(factor_name, self.by_stretch) if key}

    def _keyed(
        self, named: Callable[[int], str], points: Sequence[CurvePoint]
    ) -> list[tuple[str, CurvePoint]]:
        """Points with their terms; of one that is as it stands the term is empty."""
        keys = [named(i) for i in range(len(points))]
        return [
            (key if key in self.terms else "", point)
            for key, point in zip(keys, points, strict=True)
        ]

    def probes(self, model: Model, name: str) -> tuple[Element, ...]:
        """One element a term: this term 1, the others 0, the shape as set."""
        return tuple(
            self.element(model, f"{name}_{term}", values)
            for term, values in zip(self.terms, self.units(), strict=True)
        )

    def units(self) -> tuple[Mapping[str, float], ...]:
        """The fitted keys, SI, that make each term 1 and the others 0, shapes as tried."""
        apart = self._read.probes if self.variant else {}
        return tuple(
            apart.get(term) or self.values([float(i == j) for j in range(len(self.terms))])
            for i, term in enumerate(self.terms)
        )


def families_of(causes: Iterable[Hypothesis]) -> frozenset[tuple[object, int]]:
    """The families of causes with how many there are of each: two branches are more than one."""
    return frozenset(Counter(cause.family for cause in causes).items())


def parametric_hypotheses(model: Model) -> tuple[Hypothesis, ...]:
    """Parameters and numbers of actuators that state an ``sd``, gain, offset and delay of every
    channel, and delays that channels share.

    ``model`` must come from :func:`with_channels`.
    """
    found = [
        wrong_parameter(item)
        for item in (*model.parameters, *(p for e in model.elements for p in e.parameters))
        if item.sd is not None
    ]
    for number in (number for item in model.recorded_inputs for number in item.actuator):
        if number.sd is not None:
            found.append(Hypothesis(number.name, None, ("value",), (True,), path=number.path))
    for channel in channels_of(model):
        for kind in ("gain", "offset", "delay"):
            path = f"{channel.name}.{kind}"
            found.append(Hypothesis(kind, None, ("value",), (False,), path=path))
    for path, late in shared_delays(model).items():
        words = tuple(("late", name) for name in late)
        found.append(Hypothesis("delay", None, ("value",), (False,), path=path, options=words))
    return tuple(found)


def wrong_parameter(item: Parameter) -> Hypothesis:
    """The cause that a parameter of the model is off; it keeps a positive sign."""
    return Hypothesis("parameter", None, ("value",), (item.value > 0,), path=item.path)


def with_channels(model: Model) -> Model:
    """The same model in which every channel states gain, offset and delay: they may be fitted."""
    return replace(
        model,
        inputs=tuple(item if item.local else _stated(item) for item in model.inputs),
        sensors=tuple(_stated(item) for item in model.sensors),
    )


def _stated(channel: Channel) -> Channel:
    none = partial(Parameter, about=ASSUMED, owner=channel.name)
    gain = channel.gain or none("gain", 1.0, ONE)
    offset = channel.offset or none("offset", 0.0, channel.unit)
    late = channel.delay or none("delay", 0.0, parse_unit("s"))
    return replace(channel, gain=gain, offset=offset, delay=late)


@dataclass(frozen=True, slots=True, eq=False)
class Library:
    """Force hypotheses lowered together. ``columns`` are the probe columns of each hypothesis;
    ``machine`` is the model with a unit constant at every place and all probes behind, their
    inner states included."""

    machine: Machine
    places: tuple[Place, ...]
    hypotheses: tuple[Hypothesis, ...]
    columns: tuple[tuple[int, ...], ...]

    def forces(self, course: Course) -> Array:
        """Generalized forces (N, n, C) of all probes along a course of ``machine``, SI."""
        return _forces_along(self, course)[:, :, self._first :]

    def directions(self, course: Course) -> Array:
        """Generalized forces (N, n, places) of a unit force that acts at each place, SI."""
        return _forces_along(self, course)[:, :, self._first - len(self.places) : self._first]

    def motion(self, course: Course, rows: NDArray[np.int64] | None = None) -> tuple[Array, Array]:
        """Stretch and rate (…, places) of every place, SI, at ``rows`` (…) of a course or at all
        (N,) of them."""
        shape = course.t.shape if rows is None else rows.shape
        every = np.arange(course.t.size) if rows is None else rows.reshape(-1)
        places = slice(self._first - len(self.places), self._first)
        found = np.empty((2, every.size, len(self.places)))
        for begin in range(0, every.size, CHUNK):
            some = every[begin : begin + CHUNK]
            given = course.q[some], course.v[some], course.t[some], course.values(self.machine)
            stretch, rate, _ = along(self.machine.pathways, given, (3,), some.size)
            found[:, begin : begin + CHUNK] = stretch[:, places], rate[:, places]
        return found[0].reshape(*shape, -1), found[1].reshape(*shape, -1)

    @property
    def _first(self) -> int:
        return len(self.machine.model.elements) - sum(map(len, self.columns))


@lru_cache(maxsize=16)
def _forces_along(library: Library, course: Course) -> Array:
    """Generalized forces (N, n, E) of all elements of a library; zero for one that is not finite
    all along (its inner state ran away), which no selection takes."""
    machine, parts = library.machine, []
    for begin in range(0, course.t.size, CHUNK):
        rows = slice(begin, begin + CHUNK)
        q, v, a, z, u = (x[rows] for x in (course.q, course.v, course.a, course.z, course.u))
        t, p = course.t[rows], course.values(machine)
        (flat,) = along(machine.elements, (q, v, z, u, t, p), (5,), t.size)
        (carried,) = along(machine.carried, (q, v, a, t, p), (4,), t.size)
        each = (flat + carried).reshape(t.size, -1, machine.n).swapaxes(1, 2)
        parts.append(free_part(machine, q, t, p, np.ascontiguousarray(each)))
    forces = np.concatenate(parts)
    forces[:, :, ~np.isfinite(forces).all(axis=(0, 1))] = 0.0
    return forces


def library(model: Model, places: tuple[Place, ...], tried: tuple[Hypothesis, ...]) -> Library:
    """Lower a model with a unit force at every place and the probes of all hypotheses."""
    units = [
        Hypothesis("constant", place, ("constant",), (False,)).probes(model, f"place{i}")[0]
        for i, place in enumerate(places)
    ]
    probes: list[Element] = []
    columns: list[tuple[int, ...]] = []
    for i, hypothesis in enumerate(tried):
        mine = hypothesis.probes(model, f"try{i}")
        columns.append(tuple(range(len(probes), len(probes) + len(mine))))
        probes.extend(mine)
    extended = replace(model, elements=(*model.elements, *units, *probes))
    return Library(build(extended, keep=False), places, tried, tuple(columns))


def natural_length(model: Model, place: Between) -> float:
    """The length of the spring between two points, else their distance at the start, m."""
    gauge = Element("gauge", "spring", place, ())
    machine = build(replace(model, elements=(*model.elements, gauge)), keep=False)
    start = np.array(machine.model.start()[0])
    stretch, *_ = call(machine.pathways, (start, np.zeros_like(start), 0.0, machine.values))
    distance = float(stretch[0, -1])
    for i, element in enumerate(model.elements):
        if element.place == place and element.value("length") is not None:
            return distance - float(stretch[0, i])
    return distance
