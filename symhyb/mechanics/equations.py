"""From a model to what its equations are made of, in SymPy: positions, laws and outputs.

Only positions, laws and declared energies are built here, in plain symbols, never expanded. Speeds,
directions, M, k_c and k_e follow by differentiation: numerically in CasADi
(:mod:`symhyb.numeric.translate`), readably in :mod:`symhyb.mechanics.show`.

    M(q,t) q'' + k_c(q,q',t) = k_e(q,q',u,t) + ΔF,   p = ∂T/∂v,  M = ∂p/∂v,
    k_c = (∂p/∂q) v + ∂p/∂t − ∂T/∂q,   k_e = Σ Q − ∂V/∂q
"""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from symhyb.mechanics.kinematics import Geometry, Vector, geometry, located, stretch_of
from symhyb.mechanics.laws import ZERO, Law, Motion, law_of, wave
from symhyb.mechanics.symbols import Symbols, symbols_of, to_sympy
from symhyb.model.expression import Expression, Reading, readings
from symhyb.model.types import At, Element, Model, On
from symhyb.model.vocabulary import KINDS


@dataclass(frozen=True, slots=True)
class Mass:
    """What a body adds to T: ``mass`` (kg) at ``centre`` (m), ``inertia`` (kg·m²) turned by
    ``angle``; and in gravity to V."""

    body: str
    mass: sp.Expr
    centre: Vector
    inertia: sp.Expr
    angle: sp.Expr


@dataclass(frozen=True, slots=True)
class Term:
    """A force law with one stretch: ``path`` is s by the coordinates (or what s is counted from,
    ``length``, taken off), ``s`` and ``r`` the symbols that stand for s and s' in the ``law``.
    Q = ``sign``·(∂s/∂q)ᵀ F. ``hole`` is the symbol of a force that is filled in at lowering."""

    element: str
    path: sp.Expr
    s: sp.Symbol
    r: sp.Symbol
    law: Law
    sign: int
    hole: sp.Symbol | None = None


@dataclass(frozen=True, slots=True)
class Vectorial:
    """A force at a point: its ``position``, ``force`` [Fx, Fy] and the ``mass`` that moves with it.

    An isotropic law acts against the velocity (``along`` are the symbols of its direction, ``r``
    that of the speed); of any other force these are unused."""

    element: str
    position: Vector
    force: Vector
    r: sp.Symbol
    along: tuple[sp.Symbol, sp.Symbol]
    law: Law | None = None


@dataclass(frozen=True, slots=True)
class Equations:
    """A model in SymPy, coherent SI: the masses, declared energies (``potential``
    without gravity, which acts on the masses), one term an element, one output a sensor (m), and
    the ``readings`` that outputs name by a symbol and lowering fills in."""

    symbols: Symbols
    places: Geometry
    masses: tuple[Mass, ...]
    kinetic: sp.Expr
    potential: sp.Expr
    gravity: Vector
    terms: tuple[Term | Vectorial, ...]
    outputs: tuple[sp.Expr, ...]
    readings: tuple[Reading, ...]
    networks: Mapping[str, tuple[sp.Expr, ...]]


def derive(model: Model) -> Equations:
    """Build masses, laws and outputs of a checked model."""
    symbols = symbols_of(model)
    places = geometry(model, symbols)
    masses = tuple(
        Mass(
            body.name,
            to_sympy(body.mass, symbols.scope),
            places.centres[body.name],
            _optional(body.inertia, symbols),
            places.frames[body.name].angle,
        )
        for body in model.bodies
    )
    gravity = (ZERO, ZERO) if model.gravity is None else located(model.gravity, symbols)
    terms = tuple(_term(model, element, places, symbols) for element in model.elements)
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
    )


def _optional(expression: Expression | None, symbols: Symbols) -> sp.Expr:
    return ZERO if expression is None else to_sympy(expression, symbols.scope)


def _term(model: Model, element: Element, places: Geometry, symbols: Symbols) -> Term | Vectorial:
    scope = symbols.within(element.name)
    values = {key: to_sympy(expression, scope) for key, expression in element.values}
    s, r = (sp.Symbol(f"{mark}({element.name})", real=True) for mark in ("s", "s'"))
    inner = symbols.z.get(element.name, ZERO)
    motion = Motion(s, r, inner, symbols.t)
    if isinstance(element.place, At):
        where = places.points[element.place.point]
        return _vectorial(element, where, motion, values)
    path = stretch_of(model, element.place, places, symbols) - values.pop("length", ZERO)
    on = isinstance(element.place, On)
    sign = 1 if on and not KINDS[element.kind].passive else -1
    if element.kind == "network":
        hole = sp.Symbol(f"network({element.name})", real=True)
        return Term(element.name, path, s, r, Law(hole), sign, hole)
    return Term(element.name, path, s, r, law_of(element, motion, values), sign)


def _vectorial(
    element: Element, where: Vector, motion: Motion, values: dict[str, sp.Expr]
) -> Vectorial:
    r"""Forces at a point: as given, or against its velocity with s' the speed:

    p o───▶ v        F = −F(|v|) v/|v|
    """
    r = motion.r
    along = tuple(sp.Symbol(f"{axis}({element.name})", real=True) for axis in ("ex", "ey"))
    strength = {"harmonic": "amplitude", "constant": "constant"}.get(element.kind, "force")
    x, y = (values.get(f"{strength}.{axis}", ZERO) for axis in ("x", "y"))
    if element.kind == "harmonic":
        swing = wave(motion, values)
        x, y = x * swing, y * swing
    if KINDS[element.kind].energy == "active":
        return Vectorial(element.name, where, (x, y), r, along)
    law = law_of(element, motion, values)
    force = (-law.force * along[0], -law.force * along[1])
    return Vectorial(element.name, where, force, r, along, law)


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
