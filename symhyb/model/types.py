"""What a person declares: a model as small frozen values, exactly as the file says it.

Numbers keep the unit they were written in; ``Parameter.si`` gives the value in coherent SI
units, in which everything below this layer computes. Sizes: n coordinates, k inputs,
m sensors, P parameters.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, fields

from symhyb.by_name import Items, name_items
from symhyb.laws.cardinal import Part
from symhyb.laws.characteristic import Characteristic
from symhyb.laws.surface import Surface
from symhyb.model.constraints import Assembly, Constraint
from symhyb.model.curves import Curve
from symhyb.model.expression import Expression
from symhyb.model.fmu import Fmu
from symhyb.model.limits import Limit
from symhyb.model.local import Local
from symhyb.model.maps import Map
from symhyb.model.mujoco import Mujoco
from symhyb.model.places import At as At
from symhyb.model.places import Between as Between
from symhyb.model.places import On as On
from symhyb.model.places import Pair as Pair
from symhyb.model.places import Place as Place
from symhyb.model.places import place_text as place_text
from symhyb.model.states import State
from symhyb.model.turned import Quaternion, Rotations
from symhyb.shown import card, counted
from symhyb.units import ONE, Unit


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number with a unit; with ``sd`` (one standard deviation) it may be estimated.

    ``owner`` is empty for a parameter of the model, else the name of the element that declares it
    in its own ``parameters`` table; ``was`` is the value before a re-estimation.
    """

    name: str
    value: float
    unit: Unit
    sd: float | None = None
    about: str = ""
    was: float | None = None
    owner: str = ""

    @property
    def path(self) -> str:
        """The unique name within a model, ``"k"``, or ``"found_drag.b"`` of an element's own."""
        return f"{self.owner}.{self.name}" if self.owner else self.name

    @property
    def si(self) -> float:
        """The value in coherent SI units."""
        return self.value * self.unit.factor

    @property
    def si_sd(self) -> float | None:
        """The standard deviation in coherent SI units, None if the parameter is held."""
        return None if self.sd is None else self.sd * self.unit.factor


@dataclass(frozen=True, slots=True)
class Coordinate:
    """A generalized coordinate; ``start`` and ``start_rate`` (unit per s) serve simulations.

    ``stated`` says which of the two the file gives. The motion of an ``imposed`` coordinate is
    given (by a recording: a column with its name, or a sensor that measures it and nothing else)
    instead of following from the forces.
    """

    name: str
    unit: Unit
    start: float = 0.0
    start_rate: float = 0.0
    about: str = ""
    imposed: bool = False
    stated: tuple[str, ...] = field(default=(), compare=False)


@dataclass(frozen=True, slots=True)
class Input:
    """A recorded signal that acts: acting(t) = gain·recorded(t − delay) + offset. What the actuator
    does before that (:mod:`symhyb.model.actuators`) are the ``actuator`` numbers, in their order.

    ``between`` says how it runs between its samples: a ``line``, ``smooth`` or ``held``; unset, a
    recording shows whether it is smooth. ``local`` is a column of :mod:`symhyb.model.local`. A
    ``shared_delay`` (:mod:`symhyb.model.delays`), which is in no file, adds to the delay.
    """

    name: str
    unit: Unit
    about: str = ""
    gain: Parameter | None = None
    offset: Parameter | None = None
    delay: Parameter | None = None
    between: str = ""
    local: bool = False
    actuator: tuple[Parameter, ...] = ()
    shared_delay: Parameter | None = None

    @property
    def numbers(self) -> tuple[Parameter, ...]:
        """Gain, offset and delay, as far as stated, then the numbers of its actuator."""
        return (*filter(None, (self.gain, self.offset, self.delay)), *self.actuator)


@dataclass(frozen=True, slots=True)
class Sensor:
    """A recorded signal that measures: recorded(t) = gain·true(t − delay) + offset.

    ``measures`` is an expression in all that moves or acts, ``sd`` that of its noise, in ``unit``;
    ``shared_delay`` as of an input.
    """

    name: str
    measures: Expression
    unit: Unit
    sd: float | None = None
    about: str = ""
    gain: Parameter | None = None
    offset: Parameter | None = None
    delay: Parameter | None = None
    shared_delay: Parameter | None = None

    @property
    def numbers(self) -> tuple[Parameter, ...]:
        """Gain, offset and delay, as far as stated."""
        return tuple(filter(None, (self.gain, self.offset, self.delay)))


Vector = tuple[Expression, ...]
"""Two components in the plane, three in space."""


@dataclass(frozen=True, slots=True)
class Point:
    """A named place: its components in the inertial axes, or fixed to a ``body``, in the axes
    of that body and counted from its origin."""

    name: str
    at: Vector
    body: str = ""
    about: str = ""


@dataclass(frozen=True, slots=True)
class Body:
    r"""A point mass, or a rigid body with ``inertia`` about its centre of mass, and ``angle``.

    Without a ``joint`` the body stands free: ``at`` is its centre of mass in the inertial axes, its
    origin is there, and ``angle`` turns it. With a ``joint`` it hangs on its ``parent`` (another
    body; empty: the ground)::

        parent's origin o-- joint, in the parent's axes --o origin of the body
                                                           \  turned by ``angle`` to the parent
                                                            o centre of mass, ``at`` in own axes

    In space it is ``turned`` instead of by an angle, and ``tensor`` holds its inertia about the
    centre in its own axes, where that is not the same about every axis: three principal values, or
    Jxx, Jyy, Jzz, Jxy, Jxz, Jyz (kg·m², the last three as they stand in the matrix).
    """

    name: str
    mass: Expression
    at: Vector
    inertia: Expression | None = None
    angle: Expression | None = None
    about: str = ""
    parent: str = ""
    joint: Vector | None = None
    turned: Rotations | Quaternion | None = None
    tensor: Vector = ()


@dataclass(frozen=True, slots=True)
class Network:
    """A trained force law kept in a file of its own: ``weights`` is its path as written, beside
    the model file, ``sha256`` the hash of that file; ``inputs`` are what the network sees, and
    ``trust`` the box (low, high) of each in its training, SI, outside of which the force fades."""

    weights: str
    sha256: str
    inputs: tuple[Expression, ...]
    trust: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True, repr=False)
class Element:
    """A force law at a place. ``values`` maps the keys of its kind to expressions, ``options``
    those that are words.

    ``parameters`` are the element's own; its expressions see them before the model's.
    ``found`` is the provenance of a discovered element (a plain mapping as pairs), else empty.
    ``curve`` is the characteristic of a curve, its own or one of the model, and ``by_stretch`` the
    one that it is multiplied by; of a curve whose values are unknown there are ``parts`` instead:
    the function that each of its parameters multiplies. ``map`` is the map of an element of that
    kind, its own or one of the model.
    """

    name: str
    kind: str
    place: Place
    values: tuple[tuple[str, Expression], ...]
    parameters: Items[Parameter] = Items()
    found: tuple[tuple[str, object], ...] = ()
    about: str = ""
    options: tuple[tuple[str, str], ...] = ()
    network: Network | None = None
    curve: Curve | None = None
    by_stretch: Curve | None = None
    parts: tuple[Part, ...] = ()
    map: Map | None = None

    def __post_init__(self) -> None:
        name_items(self, "parameters")

    def __repr__(self) -> str:
        keys = "".join(f", {key} = {value.text}" for key, value in self.values)
        return f"<Element {self.name}: {self.kind} {place_text(self.place)}{keys}>"

    def option(self, key: str, default: str) -> str:
        """The word under ``key`` (the ``side`` of a gap), or ``default`` where it is unset."""
        return dict(self.options).get(key, default)

    def value(self, key: str) -> Expression | None:
        """The expression under ``key``, or None where the file leaves it unset."""
        return dict(self.values).get(key)

    def given(self) -> dict[str, object]:
        """What its law computes with that is no number, by name: curves and a map, SI."""
        entries = {
            "curve": self.curve and self.curve.characteristic,
            "by_stretch": self.by_stretch and self.by_stretch.characteristic,
            "parts": self.parts,
            "map": self.map and self.map.surface,
        }
        return {key: value for key, value in entries.items() if value}


@dataclass(frozen=True, slots=True)
class Energy:
    """Energies that bodies and elements cannot say, added to theirs."""

    kinetic: Expression | None = None
    potential: Expression | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Model:
    """A checked model file. ``energy_unit`` is the unit of T and V (J for mechanics; volts give
    others), ``text`` the file as written, which a correction extends by appending. ``assembly`` is
    where constraints close, once a machine was built, and ``local`` the equations of an ``fmu``
    or of ``mujoco`` along recordings: neither is in a file. A name finds its thing:
    ``model.inputs["f"]``."""

    title: str
    coordinates: Items[Coordinate] = Items()
    parameters: Items[Parameter] = Items()
    inputs: Items[Input] = Items()
    points: Items[Point] = Items()
    bodies: Items[Body] = Items()
    elements: Items[Element] = Items()
    sensors: Items[Sensor] = Items()
    energy: Energy = Energy()
    gravity: Vector | None = None
    energy_unit: Unit = ONE
    text: str = ""
    file: str = ""
    about: str = ""
    constraints: Items[Constraint] = Items()
    limits: Items[Limit] = Items()
    curves: Items[Curve] = Items()
    maps: Items[Map] = Items()
    states: Items[State] = Items()
    fmu: Fmu | None = None
    mujoco: Mujoco | None = None
    local: Local | None = None
    assembly: Assembly | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        name_items(self, *_DECLARED)

    def __repr__(self) -> str:
        nouns = ("coordinate", "input", "parameter", "element", "sensor")
        declared = [(noun, getattr(self, f"{noun}s").names()) for noun in nouns]
        parts = [counted(noun, names) for noun, names in declared if names]
        return f"<Model '{self.title or self.file}': {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        title, head = self.title or self.file or "Model", ("what", "name", "says", "about")
        return card(title, self.about, head, self._rows())

    def _rows(self) -> Iterator[tuple[str, str, str, str]]:
        """What the file declares, a row a thing, in words."""
        for q in self.coordinates:
            yield "coordinate", q.name, f"[{q.unit}]" + ", imposed" * q.imposed, q.about
        for state in self.states:
            yield "state", state.name, state.words, state.about
        for item in self.parameters:
            yield "parameter", item.name, _said(item), item.about
        for driver in self.inputs:
            yield "input", driver.name, f"[{driver.unit}]", driver.about
        for body in self.bodies:
            yield "body", body.name, f"mass {body.mass.text}", body.about
        for e in self.elements:
            keys = ", ".join(f"{key} = {value.text}" for key, value in e.values)
            own = ", ".join(f"{item.name} = {_said(item)}" for item in e.parameters)
            says = f"{e.kind} {place_text(e.place)}: {keys}" + (f" ({own})" if own else "")
            yield "element", e.name, says, e.about
        for sensor in self.sensors:
            yield "sensor", sensor.name, f"{sensor.measures.text} [{sensor.unit}]", sensor.about

    def start(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Places and speeds (n each, SI) at which simulations start, moved to hold constraints."""
        if self.assembly is not None:
            return self.assembly.q, self.assembly.v
        q = tuple(c.start * c.unit.factor for c in self.coordinates)
        return q, tuple(c.start_rate * c.unit.factor for c in self.coordinates)

    @property
    def engine(self) -> Fmu | Mujoco | None:
        """The program that has the equations of motion; None where the model itself has them."""
        return self.fmu or self.mujoco

    @property
    def recorded_inputs(self) -> tuple[Input, ...]:
        """The inputs that a recording has; columns of local equations come behind them."""
        return tuple(item for item in self.inputs if not item.local)

    def all_curves(self) -> tuple[Curve, ...]:
        """The curves of the file, then those of elements, each once."""
        own = (one for element in self.elements for one in (element.curve, element.by_stretch))
        return tuple(dict.fromkeys((*self.curves, *filter(None, own))))

    def all_maps(self) -> tuple[Map, ...]:
        """The maps of the file, then those of elements, each once."""
        own = (element.map for element in self.elements)
        return tuple(dict.fromkeys((*self.maps, *filter(None, own))))

    def characteristics(self) -> dict[tuple[str, str], Characteristic | Surface]:
        """The curves and maps of the file, SI, by the word that calls them and their name."""
        curves = {("curve", curve.name): curve.characteristic for curve in self.curves}
        return {**curves, **{("map", item.name): item.surface for item in self.maps}}

    def table_files(self) -> dict[str, tuple[Curve | Map, ...]]:
        """The ``curves`` and the ``maps`` whose numbers stand in files of their own, one a file."""
        found: dict[str, tuple[Curve | Map, ...]]
        found = {"curves": self.all_curves(), "maps": self.all_maps()}
        return {
            word: tuple({item.file: item for item in items if item.file}.values())
            for word, items in found.items()
        }

    def all_parameters(self) -> tuple[Parameter, ...]:
        """Every parameter in the order of the machine's vector p: the model's own, the elements',
        then the numbers that inputs and sensors state, then the delays that they share."""
        return tuple(self._parameters())

    def _parameters(self) -> Iterator[Parameter]:
        yield from self.parameters
        for element in self.elements:
            yield from element.parameters
        channels: tuple[Input | Sensor, ...] = (*self.inputs, *self.sensors)
        for channel in channels:
            yield from channel.numbers
        yield from dict.fromkeys(filter(None, (channel.shared_delay for channel in channels)))


_DECLARED = tuple(one.name for one in fields(Model) if one.default == ())  # what has names


def _said(item: Parameter) -> str:
    """A parameter with its deviation and unit, short."""
    spread = "" if item.sd is None else f" ± {item.sd:.3g}"
    return f"{item.value:.6g}{spread} {item.unit}".removesuffix(" 1")
