r"""Force laws: a kind of the vocabulary as SymPy expressions in stretch, rate and inner state.

passive kinds resist:  Q = −(∂s/∂q)ᵀ F        wall |--/\/\/--[m]-> s   F > 0 pulls back
active kinds push:     Q = +F on a coordinate, a tension between points

Sources: Bouc, Proc. 4th Conf. Nonlinear Oscillation, 1967, and Wen, J. Eng. Mech. 102, 1976
(hysteresis); Canudas de Wit et al., IEEE Trans. Autom. Control 40, 1995 (friction_dynamic);
Hunt & Crossley, J. Appl. Mech. 42, 1975, for contact that never pulls (gap).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import sympy as sp

from symhyb.model.types import Element

SPEED_SCALE = 1.0  # m/s (rad/s …), where no recording tells how fast the machine moves
DEFAULT_TRANSITION = 1e-4  # of the speed scale
ZERO = sp.Integer(0)
TINY = sp.Float(1e-30)  # m: keeps the slope of abs(z)^n finite at z = 0


@dataclass(frozen=True, slots=True)
class Motion:
    """What a law may depend on: stretch ``s``, rate ``r``, inner state ``z`` and time ``t``."""

    s: sp.Expr
    r: sp.Expr
    z: sp.Expr
    t: sp.Expr


@dataclass(frozen=True, slots=True)
class Law:
    """``force`` F, the energy ``stored`` (zero for dissipative and active kinds), the rate z' of
    the ``inner`` state (None without one), and the ``mass`` that moves with the stretch."""

    force: sp.Expr
    stored: sp.Expr = ZERO
    inner: sp.Expr | None = None
    rest: sp.Expr = ZERO
    mass: sp.Expr = ZERO


Values = Mapping[str, sp.Expr]


def law_of(element: Element, at: Motion, values: Values) -> Law:
    """Return the law of ``element``; ``values`` are its set keys.

    Unset keys are 0, ``static`` is ``coulomb``, ``transition`` 1e-4 of the speed scale, the
    ``exponent`` of a hysteresis 1.

    Raises:
        TypeError: a kind without a law.
    """
    if element.kind in ("force", "torque", "law"):
        return Law(next(iter(values.values()), ZERO))
    law = _LAWS.get(element.kind)
    if law is None:
        raise TypeError(f"no law for kind {element.kind!r}")
    return law(element, at, values)


def _spring(_: Element, at: Motion, values: Values) -> Law:
    k1, k2, k3 = (values.get(key, ZERO) for key in ("stiffness", "quadratic", "cubic"))
    s = at.s
    return Law(
        k1 * s + k2 * s**2 + k3 * s**3,
        k1 * s**2 / 2 + k2 * s**3 / 3 + k3 * s**4 / 4,
    )


def _damper(_: Element, at: Motion, values: Values) -> Law:
    return Law(values.get("damping", ZERO) * at.r * _sided(at, values))


def _drag(_: Element, at: Motion, values: Values) -> Law:
    return Law(values.get("drag", ZERO) * sp.Abs(at.r) * at.r)


def _friction(_: Element, at: Motion, values: Values) -> Law:
    turning = sp.tanh(at.r / transition(values))
    return Law(friction_level(at.r, values) * turning * _sided(at, values))


def transition(values: Values) -> sp.Expr:
    """The speed within which friction turns, m/s."""
    return values.get("transition", sp.Float(DEFAULT_TRANSITION * SPEED_SCALE))


def friction_level(rate: sp.Expr, values: Values) -> sp.Expr:
    """g = coulomb + (static − coulomb)·exp(−(s'/stribeck)²), N."""
    coulomb = values.get("coulomb", ZERO)
    if "static" not in values or "stribeck" not in values:
        return coulomb
    return coulomb + (values["static"] - coulomb) * sp.exp(-((rate / values["stribeck"]) ** 2))


def _sided(at: Motion, values: Values) -> sp.Expr:
    """1 + asymmetry·sgn s'."""
    if "asymmetry" not in values:
        return sp.Integer(1)
    return 1 + values["asymmetry"] * sp.sign(at.r)


def _gap(element: Element, at: Motion, values: Values) -> Law:
    """Contact at s = clearance (upper) and s = −clearance (lower); with damping the contact force
    still never pulls."""
    k, d, c = (values.get(key, ZERO) for key in ("stiffness", "damping", "clearance"))
    side, force, stored = element.option("side", "both"), ZERO, ZERO
    for name, sign in (("upper", 1), ("lower", -1)):
        if side not in (name, "both"):
            continue
        depth = sp.Max(sign * at.s - c, 0)
        if "damping" not in values:
            pressed = k * depth
        else:  # the damper acts in contact only
            pressed = sp.Max(k * depth + d * sign * at.r * sp.Heaviside(depth, 0), 0)
        force += sign * pressed
        stored += k * depth**2 / 2
    return Law(force, stored)


def _hysteresis(_: Element, at: Motion, values: Values) -> Law:
    """z' = s' − beta·abs(s')·abs(z)^(n−1)·z − gamma·s'·abs(z)^n, F = stiffness·dead(z, play)."""
    beta, gamma, k = (values.get(key, ZERO) for key in ("beta", "gamma", "stiffness"))
    n = values.get("exponent", sp.Integer(1))
    z, r = at.z, at.r
    size = sp.Abs(z) + (0 if n == 1 else TINY)
    grown, turned = size**n, z if n == 1 else size ** (n - 1) * z
    taut = z
    if "play" in values:
        play = values["play"]
        taut = sp.Max(z - play, 0) + sp.Min(z + play, 0)
    inner = r - beta * sp.Abs(r) * turned - gamma * r * grown
    return Law(k * taut, k * taut**2 / 2, inner)


def _friction_dynamic(_: Element, at: Motion, values: Values) -> Law:
    k, d = values.get("stiffness", ZERO), values.get("micro_damping", ZERO)
    inner = at.r - k * sp.Abs(at.r) * at.z / friction_level(at.r, values)
    return Law(k * at.z + d * inner, k * at.z**2 / 2, inner)


def _relaxation(_: Element, at: Motion, values: Values) -> Law:
    k, d = values["stiffness"], values["damping"]
    return Law(k * (at.s - at.z), k * (at.s - at.z) ** 2 / 2, (at.s - at.z) * k / d, at.s)


def _constant(_: Element, at: Motion, values: Values) -> Law:
    return Law(values.get("constant", ZERO))


def _harmonic(_: Element, at: Motion, values: Values) -> Law:
    return Law(values.get("amplitude", ZERO) * wave(at, values))


def wave(at: Motion, values: Values) -> sp.Expr:
    """sin(2π·frequency·t + phase)."""
    return sp.sin(2 * sp.pi * values.get("frequency", ZERO) * at.t + values.get("phase", ZERO))


def _ripple(_: Element, at: Motion, values: Values) -> Law:
    turn = 2 * sp.pi * at.s / values["period"] + values.get("phase", ZERO)
    return Law(values.get("amplitude", ZERO) * sp.sin(turn))


def _added_mass(_: Element, at: Motion, values: Values) -> Law:
    """F = mass·s'' is the force of the kinetic energy mass·s'²/2; no other term is left."""
    return Law(ZERO, mass=values.get("mass", ZERO))


_LAWS: Mapping[str, Callable[[Element, Motion, Values], Law]] = {
    "spring": _spring,
    "damper": _damper,
    "drag": _drag,
    "friction": _friction,
    "gap": _gap,
    "hysteresis": _hysteresis,
    "friction_dynamic": _friction_dynamic,
    "relaxation": _relaxation,
    "constant": _constant,
    "harmonic": _harmonic,
    "ripple": _ripple,
    "added_mass": _added_mass,
}
