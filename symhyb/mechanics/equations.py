"""From a model to what its equations are made of, in SymPy: positions, laws and outputs.

Only positions, laws and declared energies are built here, in plain symbols, never expanded. Speeds,
directions, M, k_c and k_e follow by differentiation: numerically in CasADi
(:mod:`symhyb.numeric.lowered.translate`), readably in :mod:`symhyb.mechanics.show`.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t) + ΔF,   p = ∂T/∂v,  M = ∂p/∂v,
    k_c = (∂p/∂q) v + ∂p/∂t − ∂T/∂q,   k_e = Σ Q − ∂V/∂q
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import sympy as sp

from symhyb.laws.maths import Action, Coupling, Motion
from symhyb.mechanics.attitude import Turn, Vector, across, along, tensor_of, turns_of
from symhyb.mechanics.kinematics import Geometry, geometry, located, stretch_of
from symhyb.mechanics.laws import ZERO, acting, action_of, coupling_of
from symhyb.mechanics.symbols import Symbols, symbols_of, to_sympy
from symhyb.model.expression import Expression, Reading, readings
from symhyb.model.space import dimension
from symhyb.model.turned import Quaternion
from symhyb.model.types import At, Body, Element, Model, On, Pair
from symhyb.model.vocabulary import KINDS


@dataclass(frozen=True, slots=True)
class Link:
    """How a body in space hangs on its ``parent`` (the ground, if empty): its ``joint`` (3,) in the
    axes of the parent, m, the ``turns`` from those axes to its own, and the ``centre`` (3,) of its
    mass in these, m. One that stands free has its centre for a joint, on the ground."""

    parent: str
    joint: Vector
    turns: tuple[Turn, ...]
    centre: Vector


@dataclass(frozen=True, slots=True)
class Mass:
    """What a body adds to T: ``mass`` (kg) at ``centre`` (m), ``inertia`` (kg·m²) turned by
    ``angle``; and in gravity to V. In space ½ ωᵀJω: ``tensor`` J (6,) in the axes of the body and
    its angular velocity ``omega`` (3,). ``quaternion`` are the four symbols q and their rates by
    which it is turned, if it is turned so; ``link`` is how it hangs on others."""

    body: str
    mass: sp.Expr
    centre: Vector
    inertia: sp.Expr
    angle: sp.Expr
    tensor: Vector = ()
    omega: Vector = ()
    quaternion: tuple[Vector, Vector] | None = None
    link: Link | None = None


@dataclass(frozen=True, slots=True)
class Term:
    """A force law with one stretch: ``path`` is s by the coordinates (or what s is counted from,
    ``length``, taken off), ``s`` and ``r`` the symbols that stand for s and s' in the ``law``.
    Q = ``sign``·(∂s/∂q)ᵀ F. ``hole`` is the symbol of a force that is filled in at lowering."""

    element: str
    path: sp.Expr
    s: sp.Symbol
    r: sp.Symbol
    law: Action
    sign: int
    hole: sp.Symbol | None = None


@dataclass(frozen=True, slots=True)
class Vectorial:
    """A force at a point: its ``position``, ``force`` [Fx, Fy] ([Fx, Fy, Fz] in space), the
    ``mass`` that moves with it, and the energy ``stored`` in its weight.

    An isotropic law acts against the velocity (``along`` are the symbols of its direction, ``r``
    that of the speed); of any other force these are unused."""

    element: str
    position: Vector
    force: Vector
    r: sp.Symbol
    along: tuple[sp.Symbol, ...]
    law: Action | None = None
    stored: sp.Expr = ZERO


@dataclass(frozen=True, slots=True)
class Couple:
    """A torque on a body in space: ``torque`` and the angular velocity ``omega`` (3,) of the body,
    both in its own axes. Q = (∂ω/∂q')ᵀ torque."""

    element: str
    torque: Vector
    omega: Vector
    law: None = None


@dataclass(frozen=True, slots=True)
class Turning:
    """An inertia that turns with a ``body``, by its ``angle``, in space with its angular velocity
    ``omega`` (3,) in its own axes: T = mass·|ω|²/2, with the mass of the ``law``."""

    element: str
    body: str
    angle: sp.Expr
    omega: Vector
    law: Action


@dataclass(frozen=True, slots=True)
class Mutual:
    """A law of a pair of stretches: the ``paths`` a and b by the coordinates, ``s`` and ``r`` the
    symbols of each and of its rate in the ``law``.
    Q = (∂a/∂q)ᵀ·push[0] + (∂b/∂q)ᵀ·push[1]."""

    element: str
    paths: tuple[sp.Expr, sp.Expr]
    s: tuple[sp.Symbol, sp.Symbol]
    r: tuple[sp.Symbol, sp.Symbol]
    law: Coupling


Acting = Term | Vectorial | Couple | Turning | Mutual
"""What an element does, whatever its place."""


@dataclass(frozen=True, slots=True)
class Equations:
    """A model in SymPy, coherent SI: the masses, declared energies (``potential``
    without gravity, which acts on the masses), one term an element, one output a sensor (m), the
    ``readings`` that outputs name by a symbol and lowering fills in, and the ``rates``, the
    ``starts`` and the values at the next sample (``nexts``) of declared states."""

    symbols: Symbols
    places: Geometry
    masses: tuple[Mass, ...]
    kinetic: sp.Expr
    potential: sp.Expr
    gravity: Vector
    terms: tuple[Acting, ...]
    outputs: tuple[sp.Expr, ...]
    readings: tuple[Reading, ...]
    networks: Mapping[str, tuple[sp.Expr, ...]]
    rates: tuple[sp.Expr, ...] = ()
    starts: tuple[sp.Expr, ...] = ()
    nexts: tuple[sp.Expr, ...] = ()


def derive(model: Model) -> Equations:
    """Build masses, laws and outputs of a checked model."""
    symbols = symbols_of(model)
    places, spatial = geometry(model, symbols), dimension(model) == 3
    masses = tuple(
        Mass(
            body.name,
            to_sympy(body.mass, symbols.scope),
            places.centres[body.name],
            ZERO if spatial else _optional(body.inertia, symbols),
            places.frames[body.name].angle,
            tensor_of(body, symbols) if spatial else (),
            places.attitude(body.name).omega if spatial else (),
            _quaternion(body.turned, symbols) if isinstance(body.turned, Quaternion) else None,
            _link(body, symbols) if spatial else None,
        )
        for body in model.bodies
    )
    nothing = (ZERO,) * dimension(model)
    gravity = nothing if model.gravity is None else located(model.gravity, symbols)
    terms = tuple(_term(model, element, places, symbols, gravity) for element in model.elements)
    return Equations(
        symbols=symbols,
        places=places,
        masses=masses,
        kinetic=_optional(model.energy.kinetic, symbols),
        potential=_optional(model.energy.potential, symbols),
        gravity=gravity,
        terms=terms,
        outputs=_outputs(model, symbols),
        readings=tuple(
            dict.fromkeys(r for sensor in model.sensors for r in readings(sensor.measures))
        ),
        networks={
            element.name: tuple(
                to_sympy(item, symbols.within(element.name)) for item in element.network.inputs
            )
            for element in model.elements
            if element.network is not None
        },
        rates=tuple(to_sympy(state.rate, symbols.scope) for state in model.states),
        starts=tuple(sp.Float(state.si_start) for state in model.states),
        nexts=tuple(
            symbol if state.next is None else to_sympy(state.next, symbols.scope)
            for state, symbol in zip(model.states, symbols.states, strict=True)
        ),
    )


def _optional(expression: Expression | None, symbols: Symbols) -> sp.Expr:
    return ZERO if expression is None else to_sympy(expression, symbols.scope)


def _quaternion(turned: Quaternion, symbols: Symbols) -> tuple[Vector, Vector]:
    q, v = (tuple(symbols.scope[name, order] for name in turned.parts) for order in (0, 1))
    return q, v


def _link(body: Body, symbols: Symbols) -> Link:
    at, turns = located(body.at, symbols), turns_of(body, symbols)
    if body.joint is None:
        return Link("", at, turns, (ZERO, ZERO, ZERO))
    return Link(body.parent, located(body.joint, symbols), turns, at)


def _term(
    model: Model, element: Element, places: Geometry, symbols: Symbols, gravity: Vector
) -> Acting:
    scope = symbols.within(element.name)
    values = {key: to_sympy(expression, scope) for key, expression in element.values}
    if isinstance(element.place, Pair):
        return _mutual(element, element.place, values, symbols)
    s, r = (sp.Symbol(f"{mark}({element.name})", real=True) for mark in ("s", "s'"))
    motion = Motion(s, r, symbols.z.get(element.name, ()), symbols.t)
    if isinstance(element.place, At):
        where = places.points[element.place.point]
        if element.kind == "torque":
            return _couple(model, element, places, values)
        if KINDS[element.kind].turns:
            return _turning(model, element, places, action_of(element, motion, values))
        return _vectorial(element, where, motion, values, places, gravity)
    path = stretch_of(model, element.place, places, symbols) - values.pop("length", ZERO)
    on = isinstance(element.place, On)
    sign = 1 if on and not KINDS[element.kind].passive else -1
    if element.kind == "network":
        hole = sp.Symbol(f"network({element.name})", real=True)
        return Term(element.name, path, s, r, acting(hole), sign, hole)
    return Term(element.name, path, s, r, action_of(element, motion, values), sign)


def _mutual(element: Element, pair: Pair, values: dict[str, sp.Expr], symbols: Symbols) -> Mutual:
    symbol = partial(sp.Symbol, real=True)
    a, b = (to_sympy(on.expression, symbols.scope) for on in pair.each)
    first, second = (
        Motion(
            symbol(f"s({element.name}.{side})"), symbol(f"s'({element.name}.{side})"), (), symbols.t
        )
        for side in "ab"
    )
    law = coupling_of(element, first, second, values)
    return Mutual(element.name, (a, b), (first.s, second.s), (first.r, second.r), law)


def _vectorial(
    element: Element,
    where: Vector,
    motion: Motion,
    values: dict[str, sp.Expr],
    places: Geometry,
    gravity: Vector,
) -> Vectorial:
    r"""Forces at a point: as given, or against its velocity with s' the speed, and its weight:

    p o───▶ v        F = −F(|v|) v/|v|
    """
    r = motion.r
    way = tuple(sp.Symbol(f"e{axis}({element.name})", real=True) for axis in "xyz"[: len(where)])
    kind = KINDS[element.kind]
    if not kind.passive:
        strength = next(key.name for key in kind.keys if key.vector)
        swing = action_of(element, motion, {strength: sp.Integer(1), **values}).force
        given = _components(strength, values, len(where))
        axes = element.option("axes", "")
        given = along(places.attitude(axes).axes, given) if axes else given
        return Vectorial(element.name, where, tuple(part * swing for part in given), r, way)
    law = action_of(element, motion, values)
    force = tuple(-law.force * part for part in way)
    if not kind.weighs:
        return Vectorial(element.name, where, force, r, way, law)
    weight = tuple(law.mass * part for part in gravity)
    force = tuple(one + other for one, other in zip(force, weight, strict=True))
    return Vectorial(element.name, where, force, r, way, law, -sp.Add(*map(sp.Mul, weight, where)))


def _components(key: str, values: dict[str, sp.Expr], size: int) -> Vector:
    return tuple(values.get(f"{key}.{axis}", ZERO) for axis in "xyz"[:size])


def _couple(model: Model, element: Element, places: Geometry, values: dict[str, sp.Expr]) -> Couple:
    """A torque on the body to which a point is fixed, in inertial axes unless it says whose."""
    body = _body_at(model, element)
    own, axes = places.attitude(body), element.option("axes", "")
    torque = _components("torque", values, 3)
    if axes != body:
        turned = along(places.attitude(axes).axes, torque) if axes else torque
        torque = across(own.axes, turned)
    return Couple(element.name, torque, own.omega)


def _turning(model: Model, element: Element, places: Geometry, law: Action) -> Turning:
    body = _body_at(model, element)
    omega = places.attitude(body).omega if places.frames[body].attitude else ()
    return Turning(element.name, body, places.frames[body].angle, omega, law)


def _body_at(model: Model, element: Element) -> str:
    """The body to which the point of an element is fixed."""
    assert isinstance(element.place, At)
    name = element.place.point
    return next(point.body for point in model.points if point.name == name)


def _outputs(model: Model, symbols: Symbols) -> tuple[sp.Expr, ...]:
    """recorded = gain·true + offset; a delay is applied in time, not here."""
    p = dict(zip((item.path for item in model.all_parameters()), symbols.p, strict=True))
    outputs = []
    for sensor in model.sensors:
        value = to_sympy(sensor.measures, symbols.scope)
        if sensor.gain is not None:
            value = p[sensor.gain.path] * value
        if sensor.offset is not None:
            value = value + p[sensor.offset.path]
        outputs.append(value)
    return tuple(outputs)
