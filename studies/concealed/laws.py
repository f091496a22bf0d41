"""The force laws that are concealed, written by hand for NumPy.

F resists (Q = −Jᵀ F) except for the kinds that push a coordinate. All quantities are in
coherent SI; arrays may have any shape, so that one function serves one state and many. Nothing here
comes from symhyb: the laws are those of ``docs/model-file.md``, typed a second time.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
PUSHING = ("constant", "harmonic", "ripple")
REMEMBERING = ("hysteresis", "friction_dynamic", "relaxation")


@dataclass(frozen=True, slots=True)
class Effect:
    """One concealed force: its kind, the name of its place, the values of its keys in SI."""

    kind: str
    place: str
    keys: dict[str, float]
    side: str = "both"

    @property
    def remembers(self) -> bool:
        """Whether the law has an inner state z."""
        return self.kind in REMEMBERING

    @property
    def sign(self) -> float:
        """+1 where F pushes a coordinate, −1 where it resists or pulls two points together."""
        return 1.0 if self.kind in PUSHING and "-" not in self.place else -1.0


def level(effect: Effect, rate: Any) -> Any:
    """The size g of dry friction in N at a rate: Coulomb, with Stribeck's rise at low speed."""
    keys = effect.keys
    coulomb = keys["coulomb"]
    if "static" not in keys:
        return coulomb + 0 * np.abs(rate)
    return coulomb + (keys["static"] - coulomb) * np.exp(-((rate / keys["stribeck"]) ** 2))


def force(effect: Effect, s: Any, r: Any, z: Any, t: Any, direction: Any) -> Any:
    """F in N at stretch ``s``, rate ``r``, inner state ``z``, time ``t``.

    ``direction`` is the sign of the rate for dry friction, which the caller keeps: exact from a
    located reversal, or smooth where only derivatives are wanted.
    """
    keys = effect.keys
    match effect.kind:
        case "spring":
            stiffness, quadratic = keys.get("stiffness", 0.0), keys.get("quadratic", 0.0)
            return (stiffness + (quadratic + keys.get("cubic", 0.0) * s) * s) * s
        case "damper":
            return keys["damping"] * r * (1 + keys.get("asymmetry", 0.0) * np.sign(r))
        case "drag":
            return keys["drag"] * np.abs(r) * r
        case "friction":
            return level(effect, r) * direction
        case "gap":
            return _stop(effect, s)
        case "hysteresis":
            return keys["stiffness"] * z
        case "friction_dynamic":
            return keys["stiffness"] * z + keys.get("micro_damping", 0.0) * drift(effect, s, r, z)
        case "relaxation":
            return keys["stiffness"] * (s - z)
        case "constant":
            return keys["constant"] + 0 * s
        case "harmonic":
            return keys["amplitude"] * np.sin(2 * np.pi * keys["frequency"] * t + keys["phase"])
        case "ripple":
            return keys["amplitude"] * np.sin(2 * np.pi * s / keys["period"] + keys["phase"])
    raise ValueError(f"'{effect.kind}' has no force of its own")


def _stop(effect: Effect, s: Any) -> Any:
    clearance, pushed = effect.keys["clearance"], 0.0 * s
    if effect.side != "lower":
        pushed = pushed + np.maximum(s - clearance, 0)
    if effect.side != "upper":
        pushed = pushed + np.minimum(s + clearance, 0)
    return effect.keys["stiffness"] * pushed


def drift(effect: Effect, s: Any, r: Any, z: Any) -> Any:
    """z' of a law that remembers: Bouc-Wen with exponent 1, Dahl and LuGre, Maxwell."""
    keys = effect.keys
    match effect.kind:
        case "hysteresis":
            return r - keys["beta"] * np.abs(r) * z - keys["gamma"] * r * np.abs(z)
        case "friction_dynamic":
            return r - keys["stiffness"] * np.abs(r) * z / level(effect, r)
        case "relaxation":
            return (s - z) * keys["stiffness"] / keys["damping"]
    raise ValueError(f"'{effect.kind}' has no inner state")
