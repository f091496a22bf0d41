"""Quaternions of a run at length 1: their length is no physics, so it may be taken out.

While a run is integrated a force returns the length to 1
(:mod:`symhyb.numeric.lowered.translate`), which leaves errors of the size of the
tolerance. What a run shows is divided by the length.
"""

import numpy as np

from symhyb.model.turned import Quaternion
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array


def at_unit_length(model: Model, q: Array, v: Array) -> tuple[Array, Array]:
    """Places and rates (N, n), SI, with every quaternion at length 1 and its rate across it."""
    found = _columns(model)
    if not found:
        return q, v
    q, v = q.copy(), v.copy()
    for columns in found:
        length = np.linalg.norm(q[:, columns], axis=1, keepdims=True)
        unit, rate = q[:, columns] / length, v[:, columns] / length
        q[:, columns] = unit
        v[:, columns] = rate - unit * np.sum(unit * rate, axis=1, keepdims=True)
    return q, v


def length_directions(model: Model, q: Array) -> Array:
    """Unit vectors (Q, n), of order 1, along which the lengths of the Q quaternions change at a
    place q (n,), SI."""
    found = _columns(model)
    directions = np.zeros((len(found), q.size))
    for direction, columns in zip(directions, found, strict=True):
        direction[columns] = q[columns] / np.linalg.norm(q[columns])
    return directions


def _columns(model: Model) -> list[list[int]]:
    """The coordinates that are parts of each quaternion."""
    names = [coordinate.name for coordinate in model.coordinates]
    turned = (body.turned for body in model.bodies)
    return [
        [names.index(name) for name in item.parts]
        for item in turned
        if isinstance(item, Quaternion)
    ]
