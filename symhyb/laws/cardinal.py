"""A curve through points whose values are unknown: what each of the values multiplies.

    F(x; y) = Σ y_i φ_i(x)        φ_i = ∂F/∂y_i at the values that are stated

The slopes of a monotone curve are no linear function of its values. But twice the values are twice
the curve, so that by Euler's theorem the sum is the curve itself at the stated values, and about
them it is right to first order: a fit that states again what it found ends at the curve through
the points that it found.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from symhyb.laws.characteristic import Array, Characteristic, monotone_slopes, through


class Part(NamedTuple):
    """What the unknown value under a ``key`` multiplies: a ``curve`` over what the force is a
    function of, and, ``by_stretch``, one over the stretch that this is multiplied by."""

    key: str
    curve: Characteristic
    by_stretch: Characteristic | None = None


def parts_of(
    name: str,
    values: Sequence[tuple[str, Sequence[float]]],
    factors: Sequence[tuple[str, Sequence[float]]] = (),
) -> tuple[Part, ...]:
    """What each unknown of a curve through ``values``, keys with points (x, y, …), SI, multiplies.
    With ``factors``, keys with points (s, w, …), it is multiplied by the curve through these,
    F = y(x)·w(s): their unknowns are changes of w, and the force is that of a product to first
    order. What has an empty key is as stated."""
    (keys, points), names = zip(*values, strict=True), [key for key, _ in factors]
    x, y, *_ = zip(*points, strict=True)
    along = cardinals(name, x, y)
    if not factors:
        return tuple(Part(key, one) for key, one in zip(keys, along, strict=True) if key)
    s, w, *_ = zip(*(point for _, point in factors), strict=True)
    whole, by_stretch = through(name, x, y), through(f"{name} by stretch", s, w)
    unknown = [Part(key, one, by_stretch) for key, one in zip(keys, along, strict=True) if key]
    changed = cardinals(f"{name} by stretch", s, w)
    unknown += [Part(key, whole, one) for key, one in zip(names, changed, strict=True) if key]
    return tuple(unknown)


def cardinals(name: str, x: Sequence[float], y: Sequence[float]) -> tuple[Characteristic, ...]:
    """The function φ_i, without a unit, of the value at each of some points (x, y), SI, with
    increasing x, two of them at least: 1 there, 0 at all others. They run on along lines."""
    places, values = np.array(x, dtype=np.float64), np.array(y, dtype=np.float64)
    by_value = _slopes_by_value(places, values)
    return tuple(
        _part(f"{name} {i}", places, unit, slopes)
        for i, (unit, slopes) in enumerate(zip(np.eye(places.size), by_value.T, strict=True))
    )


def _slopes_by_value(x: Array, y: Array) -> Array:
    """How much the slope at every point (P, P) changes with each value, 1 over the unit of x."""
    h = np.diff(x)
    secants = np.diff(y) / h
    by_value = (np.eye(x.size)[1:] - np.eye(x.size)[:-1]) / h[:, None]  # of the secants
    if h.size == 1:
        return np.repeat(by_value, 2, axis=0)
    rows = np.zeros((x.size, x.size))
    for j in range(1, x.size - 1):
        left, right = secants[j - 1], secants[j]
        if left * right > 0:
            w1, w2 = 2 * h[j] + h[j - 1], h[j] + 2 * h[j - 1]
            whole = (w1 + w2) / (w1 / left + w2 / right) ** 2
            rows[j] = whole * (w1 / left**2 * by_value[j - 1] + w2 / right**2 * by_value[j])
    slopes = monotone_slopes(h, secants)
    for j, (a, b) in ((0, (0, 1)), (-1, (-1, -2))):
        near, far = secants[a], secants[b]
        plain = ((2 * h[a] + h[b]) * by_value[a] - h[a] * by_value[b]) / (h[a] + h[b])
        if slopes[j] == 0.0 and near != 0.0:
            continue
        steepest = np.sign(near) != np.sign(far) and slopes[j] == 3 * near and near != 0.0
        rows[j] = 3 * by_value[a] if steepest else plain
    return rows


def _part(name: str, x: Array, y: Array, slopes: Array) -> Characteristic:
    """The piecewise cubic of these values and slopes (P,), its pieces that are 0 joined."""
    h, secants = np.diff(x), np.diff(y) / np.diff(x)
    second = (3 * secants - 2 * slopes[:-1] - slopes[1:]) / h
    third = (slopes[:-1] + slopes[1:] - 2 * secants) / h**2
    pieces = [(x[0], y[0], slopes[0], 0.0, 0.0)]
    pieces += zip(x[:-1], y[:-1], slopes[:-1], second, third, strict=True)
    pieces.append((x[-1], y[-1], slopes[-1], 0.0, 0.0))
    nothing = [not any(piece[1:]) for piece in pieces]
    kept = [i for i in range(x.size) if not (nothing[i] and nothing[i + 1])]
    chosen = [pieces[kept[0]], *(pieces[i + 1] for i in kept)]
    return Characteristic(
        name,
        tuple(float(x[i]) for i in kept),
        tuple(tuple(map(float, piece)) for piece in chosen),
    )
