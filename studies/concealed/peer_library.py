"""The library of the peers: what a user would offer to a sparse regression, and its words.

A peer regresses what the known equations leave over on one column a term. Every column is one word
of the vocabulary at one place, in the stretch s and the rate r of that place, so that what stays
active reads as a claim. That is more than a user of polynomials in all states gets: nothing has to
be disentangled. Numbers inside a law (clearance, period, frequency, Stribeck speed) cannot be
regressed; the *wide* library offers a few values of each, taken from the recording.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from laws import Array
from systems import System, Values

Shape = Callable[[Array, Array, Array], Array]  # s, r, t -> F for a unit of the number
PUSHING = ("constant", "harmonic", "ripple")
STOPS = (0.45, 0.6, 0.75)  # quantiles of the travel on one side where a stop may begin
PERIODS = np.geomspace(0.2, 1.0, 25)  # of half the travel
SLOW = (0.1, 0.25)  # Stribeck speeds, of the RMS rate


@dataclass(frozen=True, slots=True)
class Term:
    """One column: the ``key`` of a ``kind`` at a ``place``; ``given``: numbers that were not
    regressed, with the standard deviation of the grid they come from."""

    place: str
    kind: str
    key: str
    shape: Shape
    side: str = ""
    given: dict[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False)
class Estimate:
    """Motion as a peer estimates it: t (N,), q, v, a (n, N), recorded inputs u (k, N) and the force
    of the rig on an imposed coordinate (n, N), else zeros."""

    t: Array
    q: Array
    v: Array
    a: Array
    u: Array
    cell: Array


def known(system: System, p: Values, e: Estimate) -> tuple[Array, Array]:
    """M (n, n, N) and the known generalized forces by origin (parts, n, N)."""
    Q = system.forces(p, e.q, e.v, e.u)
    if system.imposed:
        Q = np.concatenate([Q, e.cell[None]])
    return system.mass(p, e.q), Q


def _plain(place: str, moving: bool) -> Iterator[Term]:
    yield Term(place, "constant", "constant", lambda s, r, t: np.ones_like(s))
    yield Term(place, "spring", "stiffness", lambda s, r, t: s)
    yield Term(place, "spring", "quadratic", lambda s, r, t: s**2)
    yield Term(place, "spring", "cubic", lambda s, r, t: s**3)
    yield Term(place, "damper", "damping", lambda s, r, t: r)
    yield Term(place, "damper", "asymmetry", lambda s, r, t: np.abs(r))
    yield Term(place, "drag", "drag", lambda s, r, t: np.abs(r) * r)
    yield Term(place, "friction", "coulomb", lambda s, r, t: np.sign(r))
    if moving:
        yield Term(place, "added_mass", "mass", lambda s, r, t: s)  # its column needs s''


def _wide(place: str, s: Array, r: Array, t: Array, left: Array | None) -> Iterator[Term]:
    """Stops, Stribeck's rise and, on a coordinate, waves in s and t that fit ``left`` best."""
    speed = float(np.sqrt(np.mean(r**2)))
    for slow in SLOW:
        given = {"stribeck": (slow * speed, 0.3 * slow * speed)}
        yield Term(place, "friction", "static", _stribeck(slow * speed), "", given)
    for side, travel in (("upper", s), ("lower", -s), ("both", np.abs(s))):
        inside = travel[travel > 0]
        if inside.size < 20:
            continue
        edges = np.quantile(inside, STOPS)
        width = float(edges[-1] - edges[0]) / (2 * (len(STOPS) - 1) * np.sqrt(3))
        for edge in map(float, edges):
            yield Term(
                place, "gap", "stiffness", _stop(edge, side), side, {"clearance": (edge, width)}
            )
    if left is None:
        return
    half = float(np.ptp(s)) / 2
    period = _best(left, s, 1 / (PERIODS * half)) ** -1
    frequencies = np.arange(1, 8 * int(t[-1] - t[0])) / (2 * (t[-1] - t[0]))
    frequency = _best(left, t, frequencies)
    fine = {"frequency": (frequency, float(frequencies[0]) / np.sqrt(12))}
    coarse = {"period": (period, period * 0.03)}
    for key, phase in (("sin", 0.0), ("cos", np.pi / 2)):
        yield Term(place, "ripple", key, _wave(1 / period, phase, True), "", coarse)
        yield Term(place, "harmonic", key, _wave(frequency, phase, False), "", fine)


def _stribeck(slow: float) -> Shape:
    return lambda s, r, t: np.sign(r) * np.exp(-((r / slow) ** 2))


def _stop(edge: float, side: str) -> Shape:
    def pushed(s: Array, r: Array, t: Array) -> Array:
        above, below = np.maximum(s - edge, 0), np.minimum(s + edge, 0)
        return {"upper": above, "lower": below, "both": above + below}[side]

    return pushed


def _wave(rate: float, phase: float, spatial: bool) -> Shape:
    return lambda s, r, t: np.sin(2 * np.pi * rate * (s if spatial else t) + phase)


def _best(left: Array, x: Array, rates: Array) -> float:
    """The rate whose sine and cosine in x take most of ``left``."""
    waves = np.exp(2j * np.pi * np.outer(rates, x[::4]))
    return float(rates[np.argmax(np.abs(waves @ (left[::4] - left.mean())))])


def columns(
    system: System, p: Values, e: Estimate, wide: bool, missing: Array
) -> tuple[list[Term], Array]:
    """All terms, and their generalized forces per unit (terms, n, N).

    ``missing`` (n, N) is the generalized force that the known equations leave over."""
    terms, rows = [], []
    for place in system.places:
        s, J = system.path(p, e.q, place)
        r = np.einsum("in,in->n", J, e.v)
        alone = place in system.coordinates
        left = missing[system.coordinates.index(place)] if alone else None
        here = [*_plain(place, alone), *(_wide(place, s, r, e.t, left) if wide else ())]
        rows += [push(system, p, e, term) for term in here]
        terms += here
    return terms, np.array(rows)


def push(system: System, p: Values, e: Estimate, term: Term) -> Array:
    """The generalized force (n, N) of a unit of a term."""
    s, J = system.path(p, e.q, term.place)
    r, a = (np.einsum("in,in->n", J, x) for x in (e.v, e.a))
    pushes = term.kind in PUSHING and term.place in system.coordinates
    force = a if term.kind == "added_mass" else term.shape(s, r, e.t)
    return np.asarray((1.0 if pushes else -1.0) * J * force)


def spoken(terms: Sequence[Term], value: Array, spread: Array) -> list[dict[str, Any]]:
    """Active terms (value not 0) as found effects in the form of a diagnosis, one a place and kind;
    several stops or Stribeck speeds of a place are one."""
    groups: dict[tuple[str, str], list[int]] = {}
    for i in np.flatnonzero(value):
        groups.setdefault((terms[i].place, terms[i].kind), []).append(int(i))
    found = []
    for (place, kind), rows in groups.items():
        keys = _keys(kind, [terms[i] for i in rows], value[rows], spread[rows])
        points = place.split("-")
        one: dict[str, Any] = {
            "kind": kind,
            "place": {"between": points} if len(points) == 2 else {"on": place},
            "parameters": {
                k: {"value": float(v), "sd": float(sd), "unit": "SI", "term": k}
                for k, (v, sd) in keys.items()
            },
        }
        if kind == "gap":
            sides = {terms[i].side for i in rows}
            one["options"] = {"side": sides.pop() if len(sides) == 1 else "both"}
        found.append(one)
    return found


def _keys(
    kind: str, terms: Sequence[Term], value: Array, spread: Array
) -> dict[str, tuple[float, float]]:
    numbers: dict[str, tuple[float, float]] = {
        term.key: (float(v), float(sd)) for term, v, sd in zip(terms, value, spread, strict=True)
    }
    if kind in ("harmonic", "ripple"):
        (a, sa), (b, sb) = numbers.get("sin", (0.0, 0.0)), numbers.get("cos", (0.0, 0.0))
        sd, size = float(np.hypot(sa, sb)), float(np.hypot(a, b))
        phase = float(np.arctan2(b, a)), sd / size
        return {"amplitude": (size, sd), "phase": phase, **terms[0].given}
    if kind == "damper" and len(numbers) == 2:
        (d, sd), (b, sb) = numbers["damping"], numbers["asymmetry"]
        return {"damping": (d, sd), "asymmetry": (b / d, float(np.hypot(sb, b / d * sd)) / abs(d))}
    if kind == "gap":
        weight = np.abs(value) / np.abs(value).sum()
        edge = float(sum(w * t.given["clearance"][0] for w, t in zip(weight, terms, strict=True)))
        total = float(value.sum()), float(np.sqrt(np.sum(spread**2)))
        return {"stiffness": total, "clearance": (edge, terms[0].given["clearance"][1])}
    if kind == "friction" and "static" in numbers:
        c, sc = numbers.get("coulomb", (0.0, 0.0))
        rise = [i for i, term in enumerate(terms) if term.key == "static"]
        static = (
            c + float(value[rise].sum()),
            float(np.hypot(sc, np.sqrt(np.sum(spread[rise] ** 2)))),
        )
        return {"coulomb": (c, sc), "static": static, **terms[rise[0]].given}
    return numbers
