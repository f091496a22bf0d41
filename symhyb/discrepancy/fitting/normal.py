"""Normal equations of a few numbers in units of their own: a step within bounds, and the inverse.

Sizes: F numbers.
"""

import numpy as np
from scipy.optimize import lsq_linear

from symhyb.numeric.kernels.buffers import Array

UNSEEN = 1e-13  # of the largest eigenvalue of a scaled normal matrix
NARROW = 1e-12  # of the largest number of a scaled problem: no room between bounds
DEPENDENT = 1e-10  # the same, below which columns are one and the same: their share is split


def bounded_step(gram: Array, right: Array, damping: float, lower: Array, upper: Array) -> Array:
    """Minimise ½ xᵀ G x − rᵀ x (F,) within bounds, columns scaled to unit length; SI. There is no
    step where a run away left numbers that are not finite."""
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    with np.errstate(over="ignore"):
        balance = np.outer(scale, scale)
    if right.size == 0 or not all(np.isfinite(part).all() for part in (gram, balance, right)):
        return np.zeros_like(right)
    unit = gram / balance + (damping + 1e-12) * np.eye(right.size)
    triangle = np.linalg.cholesky(unit + 1e-12 * np.eye(right.size)).T
    target = np.asarray(np.linalg.solve(triangle.T, right / scale), float)
    x = np.linalg.solve(triangle, target)
    low, high = lower * scale, upper * scale
    if np.any(x < low) or np.any(x > high):
        x = np.clip(_bounded(triangle, target, low, high), low, high)
    return np.asarray(x / scale)


def _bounded(triangle: Array, target: Array, low: Array, high: Array) -> Array:
    """The least squares solution (F,) within bounds, by an interior point. It divides by the room
    between bounds and never ends where there is none: numbers without room are held there. The
    solver's bounds are a share of the room wider, so that one without another is none to it."""
    room = high - low
    held = room <= NARROW * max(float(np.abs(target).max()), float(np.abs(triangle).max()))
    x, free = np.where(held, low, 0.0), ~held
    if not free.any():
        return x
    rest = target - triangle[:, held] @ x[held]
    inside = low[free] - 1e-12 * room[free], high[free] + 1e-12 * room[free]
    x[free] = lsq_linear(triangle[:, free], rest, bounds=inside).x
    return x


def inverse_of(gram: Array) -> Array:
    """The inverse (F, F) of a normal matrix whose numbers have units of their own, SI."""
    if gram.size == 0:
        return gram
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    balance = np.outer(scale, scale)
    power, axes = np.linalg.eigh(gram / balance)
    # a direction that the data do not see is as uncertain as numbers go, not certain
    weight = 1 / np.maximum(power, max(UNSEEN * power[-1], UNSEEN**2))
    with np.errstate(over="ignore"):  # a number that does nothing is as uncertain as can be
        return np.asarray((axes * weight) @ axes.T / balance)


def shortest_solution(gram: Array, right: Array) -> Array:
    """Minimise ½ xᵀ G x − rᵀ x (F,), SI, also where G is singular: of all minima the shortest in
    scaled numbers, with 0 for a column that does nothing."""
    if right.size == 0:
        return np.zeros(0)
    scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    power, axes = np.linalg.eigh(gram / scale[:, None] / scale)
    seen = power > max(DEPENDENT * power[-1], 1e-300)
    weight = np.where(seen, 1 / np.where(seen, power, 1.0), 0.0)
    return np.asarray((axes * weight) @ (axes.T @ (right / scale)) / scale)
