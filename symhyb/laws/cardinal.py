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

from symhyb.laws.characteristic import Array, Characteristic, through


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


def cardinal_values(x: Array, y: Array, at: Array) -> Array:
    """The functions φ_i of :func:`cardinals`, without a unit, at places ``at`` (G,), of many curves
    at once: (…, G, P), of curves through points ``x`` and ``y`` (…, P), SI."""
    by_value, last = _slopes_by_value(x, y), x.shape[-1] - 1
    first = np.clip(np.sum(x[..., None, :] <= at[:, None], axis=-1) - 1, 0, last - 1)
    ends = np.take_along_axis(x, first, -1), np.take_along_axis(x, first + 1, -1)
    h, begun = ends[1] - ends[0], at - ends[0]
    u = np.clip(begun / h, 0.0, 1.0)
    bump = u * (1 - u)  # of the two slopes; beyond the ends curves run on along lines
    before = np.where(begun < 0, begun, h * bump * (1 - u))
    behind = np.where(begun > h, begun - h, -h * bump * u)
    each = np.arange(last + 1)
    found = np.where(each == first[..., None], ((1 - u) ** 2 * (1 + 2 * u))[..., None], 0.0)
    found += np.where(each == first[..., None] + 1, (u**2 * (3 - 2 * u))[..., None], 0.0)
    found += before[..., None] * np.take_along_axis(by_value, first[..., None], -2)
    found += behind[..., None] * np.take_along_axis(by_value, first[..., None] + 1, -2)
    return np.asarray(found)


def _slopes_by_value(x: Array, y: Array) -> Array:
    """How much the slope at every point (…, P, P) changes with each value, 1 over the unit of x, of
    curves through points ``x`` and ``y`` (…, P)."""
    h, unit = np.diff(x), np.eye(x.shape[-1])
    secants = np.diff(y) / h
    by_value = (unit[1:] - unit[:-1]) / h[..., None]  # of the secants
    if h.shape[-1] == 1:
        return np.repeat(by_value, 2, axis=-2)
    left, right = secants[..., :-1, None], secants[..., 1:, None]
    w1 = (2 * h[..., 1:] + h[..., :-1])[..., None]
    w2 = (h[..., 1:] + 2 * h[..., :-1])[..., None]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        whole = (w1 + w2) / (w1 / left + w2 / right) ** 2
        along = w1 / left**2 * by_value[..., :-1, :] + w2 / right**2 * by_value[..., 1:, :]
        inside = np.where(left * right > 0, whole * along, 0.0)
    begin, end = (_end_by_value(h, secants, by_value, *pair) for pair in ((0, 1), (-1, -2)))
    return np.concatenate([begin[..., None, :], inside, end[..., None, :]], axis=-2)


def _end_by_value(h: Array, secants: Array, by_value: Array, a: int, b: int) -> Array:
    """How much the slope at an end (…, P) changes with each value: that of three points, unless it
    is held so that the curve stays monotone; ``a`` is the piece at the end, ``b`` the next, of
    widths ``h`` and ``secants`` (…, P − 1) that change as ``by_value`` says."""
    (h, beside), (near, far) = ((one[..., [a]], one[..., [b]]) for one in (h, secants))
    slope = ((2 * h + beside) * near - h * far) / (h + beside)
    own, other = by_value[..., a, :], by_value[..., b, :]
    plain = ((2 * h + beside) * own - h * other) / (h + beside)
    flat = (np.sign(slope) != np.sign(near)) & (near != 0.0)
    steepest = (np.sign(near) != np.sign(far)) & (np.abs(slope) > 3 * np.abs(near)) & (near != 0.0)
    return np.asarray(np.where(flat, 0.0, np.where(steepest, 3 * own, plain)))


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
