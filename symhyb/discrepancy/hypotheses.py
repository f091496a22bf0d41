"""What could be wrong: every law of the vocabulary at every place, and the dull causes.

The vocabulary of elements is the vocabulary of hypotheses. A force hypothesis is an ordinary
element with unknown coefficients; its *probes* are the same element with one coefficient set to
one, so that the force of any combination is linear in the coefficients. A dull cause is a parameter
that may be estimated, or the gain or offset of a channel. All compete in one list.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from symhyb.model.expression import parse_expression
from symhyb.model.types import (
    Between,
    Element,
    Input,
    Model,
    On,
    Parameter,
    Place,
    Sensor,
    place_text,
)  # fmt: skip
from symhyb.model.vocabulary import key_unit
from symhyb.numeric.buffers import Array, call, mapped
from symhyb.numeric.machine import Machine, build
from symhyb.units import ONE

TRANSITION_SHARE = 1e-4  # of the largest rate: the friction transition that is tried
GAIN_REACH = 0.5  # a gain further from 1 is a wrong unit or sign, not a gain
ASSUMED = "assumed"  # a gain or offset that the file does not state
STRIBECK_SHARES = (0.05, 0.2)  # of the largest rate


@dataclass(frozen=True, slots=True)
class Hypothesis:
    """One cause: a law at a place, or (``place`` None) the parameter ``path`` of the model.

    ``terms`` are the keys whose values are unknown, linear in the force; ``shape`` are keys that
    are set beforehand (SI), ``refined`` those of them that are fitted afterwards and so cost a
    number each; ``positive`` says which terms physics forbids to be negative.
    """

    kind: str
    place: Place | None
    terms: tuple[str, ...]
    positive: tuple[bool, ...]
    shape: tuple[tuple[str, float], ...] = ()
    refined: tuple[str, ...] = ()
    path: str = ""

    @property
    def numbers(self) -> int:
        """How many numbers the hypothesis fits."""
        return len(self.terms) + len(self.refined)

    @property
    def family(self) -> tuple[str, Place | None, tuple[str, ...], str]:
        """What makes two hypotheses the same but for their shape."""
        return self.kind, self.place, self.terms, self.path

    def __str__(self) -> str:
        if self.place is None:
            return self.path if self.kind == "law" else f"{self.kind} {self.path}"
        return f"{self.kind} ({', '.join(self.terms)}) {place_text(self.place)}"

    def element(self, model: Model, name: str, values: Mapping[str, float]) -> Element:
        """The element of a force hypothesis with these values of its terms and shape, SI."""
        assert self.place is not None
        own = []
        for key, value in {**dict(self.shape), **values}.items():
            unit = key_unit(model, self.kind, key, self.place)
            own.append(Parameter(key, value / unit.factor, unit, owner=name))
        entries = tuple((item.name, parse_expression(item.name)) for item in own)
        return Element(name, self.kind, self.place, entries, tuple(own))

    def probes(self, model: Model, name: str) -> tuple[Element, ...]:
        """One element a term: this term 1, the others 0, the shape as set."""
        return tuple(
            self.element(model, f"{name}_{term}", {key: float(key == term) for key in self.terms})
            for term in self.terms
        )


def force_hypotheses(model: Model, speeds: Mapping[Place, float]) -> tuple[Hypothesis, ...]:
    """Every law at every place; ``speeds`` is the largest rate at each, SI (0: it never moves).

    Negative damping, drag and friction are not offered: a passive machine only loses energy.
    """
    return tuple(h for place, speed in speeds.items() for h in _at_place(model, place, speed))


def _at_place(model: Model, place: Place, speed: float) -> Iterator[Hypothesis]:
    yield Hypothesis("constant", place, ("constant",), (False,))
    length = (("length", natural_length(model, place)),) if isinstance(place, Between) else ()
    for term in ("stiffness", "quadratic", "cubic"):
        yield Hypothesis("spring", place, (term,), (False,), length)
    if speed <= 0:
        return
    transition = (("transition", TRANSITION_SHARE * speed),)
    yield Hypothesis("damper", place, ("damping",), (True,))
    yield Hypothesis("drag", place, ("drag",), (True,))
    yield Hypothesis("friction", place, ("coulomb",), (True,), transition)
    for share in STRIBECK_SHARES:
        shape = (("stribeck", share * speed), *transition)
        yield Hypothesis(
            "friction", place, ("coulomb", "static"), (True, True), shape, ("stribeck",)
        )


def dull_hypotheses(model: Model) -> tuple[Hypothesis, ...]:
    """Parameters that state an ``sd``, and gain and offset of every channel.

    ``model`` must come from :func:`with_channels`.
    """
    found = [
        Hypothesis("parameter", None, ("value",), (item.value > 0,), path=item.path)
        for item in (*model.parameters, *(p for e in model.elements for p in e.parameters))
        if item.sd is not None
    ]
    channels: tuple[Input | Sensor, ...] = (*model.inputs, *model.sensors)
    for channel in channels:
        for kind in ("gain", "offset"):
            path = f"{channel.name}.{kind}"
            found.append(Hypothesis(kind, None, ("value",), (False,), path=path))
    return tuple(found)


def with_channels(model: Model) -> Model:
    """The same model in which every channel states its gain and offset, so they may be fitted."""
    return replace(
        model,
        inputs=tuple(_stated(item) for item in model.inputs),
        sensors=tuple(_stated(item) for item in model.sensors),
    )


Channel = TypeVar("Channel", Input, Sensor)


def _stated(channel: Channel) -> Channel:
    gain = channel.gain or Parameter("gain", 1.0, ONE, about=ASSUMED, owner=channel.name)
    offset = channel.offset or Parameter(
        "offset", 0.0, channel.unit, about=ASSUMED, owner=channel.name
    )
    return replace(channel, gain=gain, offset=offset)


def places_of(model: Model) -> tuple[Place, ...]:
    """Places worth a hypothesis: every coordinate and, where a machine has several, every pair of
    points that an element joins."""
    places: list[Place] = [On(c.name) for c in model.coordinates]
    if len(model.coordinates) > 1:
        for element in model.elements:
            if isinstance(element.place, Between) and element.place not in places:
                places.append(element.place)
    return tuple(places)


@dataclass(frozen=True, slots=True)
class Library:
    """Force hypotheses lowered together. ``columns`` are the probe columns of each hypothesis;
    ``machine`` is the model with a unit constant at every place and all probes behind."""

    machine: Machine
    places: tuple[Place, ...]
    hypotheses: tuple[Hypothesis, ...]
    columns: tuple[tuple[int, ...], ...]

    def forces(self, q: Array, v: Array, u: Array, t: Array) -> Array:
        """Generalized forces (N, n, C) of all probes at N samples, SI."""
        first = len(self.machine.model.elements) - sum(map(len, self.columns))
        return np.ascontiguousarray(self._all(q, v, u, t)[:, :, first:])

    def directions(self, q: Array, v: Array, u: Array, t: Array) -> Array:
        """Generalized forces (N, n, places) of a unit force that acts at each place, SI."""
        last = len(self.machine.model.elements) - sum(map(len, self.columns))
        return self._all(q, v, u, t)[:, :, last - len(self.places) : last]

    def motion(self, q: Array, v: Array, t: Array) -> tuple[Array, Array]:
        """Stretch and rate (N, places) of every place, SI."""
        last = len(self.machine.model.elements) - sum(map(len, self.columns))
        function = mapped(self.machine.pathways, t.size, repeated=(3,))
        stretch, rate, _ = call(function, (q, v, t, self.machine.values))
        chosen = slice(last - len(self.places), last)
        return stretch[:, chosen], rate[:, chosen]

    def _all(self, q: Array, v: Array, u: Array, t: Array) -> Array:
        function = mapped(self.machine.elements, t.size, repeated=(4,))
        (flat,) = call(function, (q, v, u, t, self.machine.values))
        return flat.reshape(t.size, -1, self.machine.n).swapaxes(1, 2)


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
    return Library(build(extended), places, tried, tuple(columns))


def natural_length(model: Model, place: Between) -> float:
    """The length of the spring between two points, else their distance at the start, m."""
    gauge = Element("gauge", "spring", place, ())
    machine = build(replace(model, elements=(*model.elements, gauge)))
    start = np.array([c.start * c.unit.factor for c in model.coordinates])
    stretch, *_ = call(machine.pathways, (start, np.zeros_like(start), 0.0, machine.values))
    distance = float(stretch[0, -1])
    for i, element in enumerate(model.elements):
        if element.place == place and element.value("length") is not None:
            return distance - float(stretch[0, i])
    return distance
