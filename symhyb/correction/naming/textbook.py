"""What a found value means in the terms of a textbook, where the model allows it."""

from math import isfinite, sqrt

import numpy as np

from symhyb.model.types import Model, On, Place
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.lowered.machine import Machine, build

_STEPS = (1e-3, -2e-3, 7e-3)  # of the coordinate, its rate: where a linear model stays linear
_LINEAR = 1e-6  # relative


def critical_share(model: Model, place: Place, damping: float) -> float | None:
    """``damping`` (SI) on the only coordinate of a linear model over its critical damping,
    ζ = d/(2·√(m·k)), with the mass m and stiffness k of the model as given; None elsewhere.

    A model is linear here if it has no inner states and mass and forces, without inputs, say so at
    a few points about the start.
    """
    if len(model.coordinates) != 1 or place != On(model.coordinates[0].name):
        return None
    if model.engine is not None and model.local is None:  # it states no stiffness
        return None
    machine = build(model)
    if machine.imposed or machine.inner_states:
        return None
    start = np.array([c.start * c.unit.factor for c in model.coordinates])
    rest = _force(machine, start, 0.0)
    m, k = _mass(machine, start), (rest - _force(machine, start + _STEPS[0], 0.0)) / _STEPS[0]
    d = (rest - _force(machine, start, _STEPS[0])) / _STEPS[0]
    for step, rate in zip(_STEPS, _STEPS[::-1], strict=True):
        expected = rest - k * step - d * rate
        scale = abs(k * step) + abs(d * rate) + abs(rest)
        if abs(_force(machine, start + step, rate) - expected) > _LINEAR * scale:
            return None
        if abs(_mass(machine, start + step) - m) > _LINEAR * m:
            return None
    share = damping / (2.0 * sqrt(m * k)) if m > 0.0 and k > 0.0 else float("nan")
    return share if isfinite(share) else None


def _mass(machine: Machine, q: Array) -> float:
    (mass,) = call(machine.M, (q, 0.0, machine.values))
    return float(mass[0, 0])


def _force(machine: Machine, q: Array, rate: float) -> float:
    """k_e − k_c at rest inputs and t = 0."""
    v, u = np.full(1, rate), np.zeros(len(machine.model.inputs))
    (applied,) = call(machine.k_e, (q, v, np.zeros(0), u, 0.0, machine.values))
    (inertial,) = call(machine.k_c, (q, v, 0.0, machine.values))
    return float(applied.reshape(-1)[0] - inertial.reshape(-1)[0])
