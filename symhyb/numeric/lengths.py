"""Quaternions of a run at length 1: their length is no physics, so it may be taken out.

While a run is integrated a force returns the length to 1 (:mod:`symhyb.numeric.translate`), which
leaves errors of the size of the tolerance. What a run shows is divided by the length.
"""

import numpy as np

from symhyb.model.types import Model, Quaternion
from symhyb.numeric.buffers import Array


def at_unit_length(model: Model, q: Array, v: Array) -> tuple[Array, Array]:
    """Places and rates (N, n), SI, with every quaternion at length 1 and its rate across it."""
    names = [coordinate.name for coordinate in model.coordinates]
    found = [body.turned.parts for body in model.bodies if isinstance(body.turned, Quaternion)]
    if not found:
        return q, v
    q, v = q.copy(), v.copy()
    for parts in found:
        columns = [names.index(name) for name in parts]
        length = np.linalg.norm(q[:, columns], axis=1, keepdims=True)
        unit, rate = q[:, columns] / length, v[:, columns] / length
        q[:, columns] = unit
        v[:, columns] = rate - unit * np.sum(unit * rate, axis=1, keepdims=True)
    return q, v
