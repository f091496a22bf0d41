"""How places move, at states about the start: what distinguishes two places.

Sizes: N states, n coordinates, P places.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.model.expression import parse_expression
from symhyb.model.types import Element, Model, Parameter, Place
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import closed, free_part

PROBES = 7  # states about the start at which places are compared
AROUND = 0.5  # spread of them, SI
PARALLEL = 1e-6  # relative: two ratios, or two ways of moving, are the same


def states_about_start(machine: Machine) -> tuple[Array, Array, Array]:
    """Random places and speeds (N, n) about the start, moved onto constraints, and times (N,),
    SI."""
    random, times = np.random.default_rng(0), np.linspace(0, 1, PROBES)
    start = np.array(machine.model.start()[0])
    q = start + AROUND * random.standard_normal((PROBES, start.size))
    v = random.standard_normal((PROBES, start.size))
    if machine.constraints:
        moved = closed(machine, (q, v, np.zeros_like(q)), times, machine.values, machine.imposed)
        q, v = moved.q, moved.v
    return q, v, times


def pushed(model: Model, places: Sequence[Place]) -> list[Array | None]:
    """d dᵀ (N, n, n) of the generalized force d of 1 N at each place, at states about the start:
    what constraints leave of it. None where it vanishes or is not finite."""
    probes = tuple(_probe(model, place, i) for i, place in enumerate(places))
    machine = build(replace(model, elements=(*model.elements, *probes)), keep=False)
    q, v, t = states_about_start(machine)
    *_, flat = along(machine.pathways, (q, v, t, machine.values), (3,), t.size)
    ways = flat.reshape(t.size, -1, machine.n)[:, -len(places) :].swapaxes(1, 2)
    ways = free_part(machine, q, t, machine.values, ways)
    found: list[Array | None] = []
    for way in np.moveaxis(ways, 2, 0):
        usable = bool(np.all(np.isfinite(way)) and np.any(way))
        found.append(way[:, :, None] * way[:, None, :] if usable else None)
    return found


def _probe(model: Model, place: Place, i: int) -> Element:
    name = f"push_at_{i}"
    value = Parameter("constant", 0.0, force_unit(model, place), owner=name)
    entries = (("constant", parse_expression("constant")),)
    return Element(name, "constant", place, entries, (value,))


def proportional(one: Array, other: Array, alike: float = PARALLEL) -> bool:
    """Whether two arrays (N, n, n), dimensionless or in one unit, are the same but for one positive
    factor, to ``alike``, relative."""
    length = float(np.linalg.norm(other))
    factor = float(np.sum(one * other)) / length**2 if length > 0 else 0.0
    return factor > 0 and float(np.abs(one - factor * other).max()) < alike * np.abs(one).max()
