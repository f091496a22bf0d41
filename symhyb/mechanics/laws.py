r"""Force laws: a kind of the vocabulary as a SymPy expression in stretch and rate.

passive kinds resist:  Q = −(∂s/∂q)ᵀ F        wall |--/\/\/--[m]-> s   F > 0 pulls back
active kinds push:     Q = +F on a coordinate, a tension between points
"""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from symhyb.model.types import Element

SPEED_SCALE = 1.0  # m/s (rad/s …), where no recording tells how fast the machine moves
DEFAULT_TRANSITION = 1e-4  # of the speed scale


@dataclass(frozen=True, slots=True)
class Law:
    """``force`` F(s, s') and the energy ``stored`` (zero for dissipative and active kinds)."""

    force: sp.Expr
    stored: sp.Expr


def law_of(element: Element, stretch: sp.Expr, rate: sp.Expr, values: Mapping[str, sp.Expr]) -> Law:
    """Return the law of ``element`` for stretch s and rate s'; ``values`` are its set keys.

    Unset keys are 0, ``static`` is ``coulomb``, ``transition`` 1e-4 of the speed scale.
    """
    zero = sp.Integer(0)

    def value(key: str, default: sp.Expr = zero) -> sp.Expr:
        return values.get(key, default)

    sided = 1 + value("asymmetry") * sp.sign(rate) if "asymmetry" in values else sp.Integer(1)
    s = stretch
    match element.kind:
        case "spring":
            stiffness, quadratic, cubic = value("stiffness"), value("quadratic"), value("cubic")
            return Law(
                stiffness * s + quadratic * s**2 + cubic * s**3,
                stiffness * s**2 / 2 + quadratic * s**3 / 3 + cubic * s**4 / 4,
            )
        case "damper":
            return Law(value("damping") * rate * sided, zero)
        case "drag":
            return Law(value("drag") * sp.Abs(rate) * rate, zero)
        case "friction":
            return Law(_friction(rate, values) * sided, zero)
        case "constant":
            return Law(value("constant"), zero)
        case "force" | "torque" | "law":
            return Law(next(iter(values.values()), zero), zero)
    raise TypeError(f"no law for kind {element.kind!r}")


def _friction(rate: sp.Expr, values: Mapping[str, sp.Expr]) -> sp.Expr:
    """F = g·tanh(s'/transition), g = coulomb + (static − coulomb)·exp(−(s'/stribeck)²)."""
    coulomb = values.get("coulomb", sp.Integer(0))
    transition = values.get("transition", sp.Float(DEFAULT_TRANSITION * SPEED_SCALE))
    level = coulomb
    if "static" in values and "stribeck" in values:
        fade = sp.exp(-((rate / values["stribeck"]) ** 2))
        level = coulomb + (values["static"] - coulomb) * fade
    return level * sp.tanh(rate / transition)
