r"""What a law computes with: the same function builds SymPy expressions and evaluates on arrays.

passive laws resist:  Q = −(∂s/∂q)ᵀ F        wall |--/\/\/--[m]-> s   F > 0 pulls back
active laws push:     Q = +F on a coordinate, a tension between points
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symhyb.laws.characteristic import Characteristic
from symhyb.laws.surface import Surface

Value = Any
"""A SymPy expression, a NumPy array or a number, always in SI."""
Values = Mapping[str, Value]
"""The keys that are set, by name; of a ``curve`` its :class:`Characteristic` too, and that of the
stretch that it is multiplied by, or the :class:`~symhyb.laws.cardinal.Part` of each value that is
unknown; of a ``map`` its :class:`~symhyb.laws.surface.Surface`."""
Options = Mapping[str, str]
"""The words of an element, by key: the ``side`` of a gap."""


@dataclass(frozen=True, slots=True)
class Maths:
    """The functions of one library; ``step`` is 1 above 0 and 0 at it and below, ``curve`` the
    value of a characteristic, ``map`` that of a surface."""

    abs: Callable[[Value], Value]
    sign: Callable[[Value], Value]
    step: Callable[[Value], Value]
    exp: Callable[[Value], Value]
    sin: Callable[[Value], Value]
    tanh: Callable[[Value], Value]
    max: Callable[[Value, Value], Value]
    min: Callable[[Value, Value], Value]
    curve: Callable[[Characteristic, Value], Value]
    map: Callable[[Surface, Value, Value], Value]
    pi: Value


NUMPY = Maths(
    np.abs,
    np.sign,
    lambda x: np.heaviside(x, 0.0),
    np.exp,
    np.sin,
    np.tanh,
    np.maximum,
    np.minimum,
    lambda curve, x: curve(x),
    lambda surface, x, y: surface(x, y),
    np.pi,
)


@dataclass(frozen=True, slots=True)
class Motion:
    """What a law may depend on: stretch ``s``, rate ``r``, inner states ``z`` and time ``t``."""

    s: Value
    r: Value
    z: tuple[Value, ...]
    t: Value


@dataclass(frozen=True, slots=True)
class Action:
    """What a law does: its ``force`` F, the energy ``stored`` (zero for dissipative and active
    laws), the rates z' of the ``inner`` states and where these settle while the place moves on at
    the same rate (``rest``), one each, and the ``mass`` that moves with the stretch."""

    force: Value
    stored: Value = 0
    inner: tuple[Value, ...] = ()
    rest: tuple[Value, ...] = ()
    mass: Value = 0


@dataclass(frozen=True, slots=True)
class Coupling:
    """What a law does at a pair of stretches a and b: the ``push`` along each,
    Q = (∂a/∂q)ᵀ·push[0] + (∂b/∂q)ᵀ·push[1], and the energy ``stored``."""

    push: tuple[Value, Value]
    stored: Value = 0
