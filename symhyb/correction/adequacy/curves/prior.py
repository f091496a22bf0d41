"""What is known of the values of a curve before a recording: they lie along a smooth line.

    cov(y_i, y_j) = size² (SIZE² k(|z_i − z_j|/length) + 3 z_i z_j)     z: x, between −1 and 1

a Gaussian process (Matérn 5/2) beside a straight line of any size, as the class of a force of
stretch and rate has it. Of values without a correlation each point more would cost as much as the
first, and a sharp knee would have fewer points than it needs. Along a smooth line a point costs
what it says that its neighbours do not.

Source: Rasmussen & Williams, Gaussian Processes for Machine Learning, 2006, §2.7 and §4.2.
Sizes: P points, S curves.
"""

import numpy as np

from symhyb.correction.adequacy.classes.columns import SIZE, matern
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import value_name
from symhyb.numeric.kernels.buffers import Array

STRAIGHT = 3.0  # 1 over the mean square of z, evenly spread between −1 and 1
ROUNDING = 1e-9  # of a variance: keeps the factors of values that are nearly the same real


def covariance(x: Array, length: float, zero: float | None = None) -> Array:
    """Prior covariance (P, P) of the values of a curve at x (P,), increasing, in units of size², or
    (S, P, P) of many curves, at x (S, P); ``length`` in half ranges. There is no value at ``zero``,
    if that is given."""
    low, high = x[..., :1], x[..., -1:]
    z = (2 * x - low - high) / (high - low)
    whole = _between(z, z, length)
    if zero is None:
        return whole
    at = (2 * zero - low - high) / (high - low)
    across = _between(z, at, length)
    return np.asarray(whole - across * np.swapaxes(across, -1, -2) / _between(at, at, length))


def _between(first: Array, second: Array, length: float) -> Array:
    """Covariance (P, Q) of values at (P,) and at (Q,), between −1 and 1, or (S, P, Q) of many."""
    a, b = first[..., :, None], second[..., None, :]
    return np.asarray(SIZE**2 * matern(a - b, length) + STRAIGHT * a * b)


def factor(x: Array, length: float, zero: float | None = None) -> Array:
    """Cholesky's factor (P, P), or (S, P, P) of many curves, of that covariance: with independent
    standard normal numbers behind it, it makes the values of a curve, in units of size."""
    whole = covariance(x, length, zero)
    return np.asarray(np.linalg.cholesky(whole + ROUNDING * np.eye(x.shape[-1])))


def of_curve(curve: Hypothesis, length: float) -> Array:
    """That covariance (P, P) of the unknown values of a curve, in units of size²; one whose value
    at rest is none goes through zero there."""
    x = np.array([x for x, _, _ in curve.points])
    known = [value_name(i) in curve.unknown for i in range(x.size)]
    whole = covariance(x, length, None if all(known) else 0.0)[known][:, known]
    return np.asarray(whole + ROUNDING * np.eye(len(whole)))
