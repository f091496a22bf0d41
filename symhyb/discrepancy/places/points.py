"""Laws at points: damping, drag, friction, mass and payload at a declared point of a machine that
moves in its own way, and inertia of the body to which it is fixed, if that turns in its own way.

On one coordinate, and at a point that moves with one coordinate alone or with a sum of two that is
a place, such a law is the same as one on the coordinate: the coordinate is named.
Sizes: N samples, n coordinates, K points, Q places.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from symhyb.discrepancy.places.candidates import in_order
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.placements import places_of
from symhyb.discrepancy.places.probing import proportional, pushed, states_about_start
from symhyb.laws import LAWS, added_inertia, added_mass
from symhyb.laws.reach import Reach
from symhyb.model.expression import parse_expression
from symhyb.model.types import At, Element, Model, On, Parameter
from symhyb.model.vocabulary import KINDS, key_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import closed, tangent

PROBE = "at_point_"  # begins the names of the masses that only compare points
PARALLEL = 1e-9  # relative: two points move the same
_AT_POINTS = tuple(law for law in LAWS if law.passive and "at" in law.placements)
MOVED, TURNED = added_mass.LAW.name, added_inertia.LAW.name  # what compares points, and bodies
_NONE = np.empty(0)

Motion = tuple[Array, Array, Array]
"""q (N, n), v (N, n), t (N,), SI."""


def point_hypotheses(
    model: Model, motions: Sequence[Motion], narrow: float
) -> tuple[Hypothesis, ...]:
    """Damper, drag, friction, added mass and, under gravity, payload at every point that moves in
    its own way, and inertia of every body with a point that turns in its own way; ``narrow`` is the
    friction transition over the largest speed of the point along the ``motions``: q, v (N, n) and
    t (N,), SI."""
    offered = [law for law in _AT_POINTS if model.gravity is not None or not law.weighs]
    return tuple(
        hypothesis
        for probe, turns in ((MOVED, False), (TURNED, True))
        for place, speed in _speeds(model, motions, probe)
        for hypothesis in in_order(
            [law for law in offered if law.turns == turns],
            place,
            Reach(_NONE, np.array([speed]), _NONE, _NONE, narrow=narrow),
        )
        if not (hypothesis.variant or hypothesis.bent)
    )


def _speeds(model: Model, motions: Sequence[Motion], probe: str) -> Iterator[tuple[At, float]]:
    """The points of :func:`moving_points`, each with its largest speed (99 % of the samples are
    slower), m/s or rad/s."""
    points = moving_points(model, probe)
    if not points:
        return
    machine = _probed(model, points, probe)
    squares = [np.einsum("ni,knij,nj->kn", v, _inertias(machine, q, t), v) for q, v, t in motions]
    speeds = np.quantile(np.sqrt(np.concatenate(squares, axis=1)), 0.99, axis=1)
    yield from ((place, float(one)) for place, one in zip(points, speeds, strict=True) if one > 0)


def moving_points(model: Model, probe: str = MOVED) -> tuple[At, ...]:
    """The points that move, each once, but neither as one coordinate does nor as another point. By
    the ``probe`` of what turns, the points whose bodies turn so."""
    places = tuple(At(point.name) for point in model.points if probe == MOVED or point.body)
    if len(model.coordinates) < 2 or not places:
        return ()
    probed = _probed(model, places, probe)
    q, _, times = states_about_start(probed)
    if probed.constraints:
        return tuple(places[i] for i in _moving_closed(probed, q, times))
    inertias, combined = _inertias(probed, q, times), _combined(model)
    chosen: list[int] = []
    for i, inertia in enumerate(inertias):
        size = float(np.abs(inertia).max())
        if not np.isfinite(size) or size == 0 or _of_one(inertia, size):
            continue
        if any(proportional(inertia, way, PARALLEL) for way in combined):
            continue
        if all(np.abs(inertia - inertias[j]).max() > PARALLEL * size for j in chosen):
            chosen.append(i)
    return tuple(places[i] for i in chosen)


def _combined(model: Model) -> list[Array]:
    """d dᵀ (N, n, n) of the places that are combinations of coordinates."""
    places = [p for p in places_of(model) if isinstance(p, On) and not p.plain]
    return [way for way in pushed(model, places) if way is not None] if places else []


def _moving_closed(machine: Machine, q: Array, t: Array) -> tuple[int, ...]:
    """The same for a closed loop, near places q (N, n): along its free directions a point must
    move neither as a coordinate does, but for a constant, nor as a point before it."""
    still, p = np.zeros_like(q), machine.values
    q = closed(machine, (q, still, still), t, p, machine.imposed).q
    held = tangent(machine, q, still, t, p, machine.imposed)
    free = list(machine.free)
    first = held.basis.shape[2] - max(len(free) - machine.constraints, 0)
    along_free = held.basis[:, len(free) :, first:]
    seen = [part[:, None] * part[:, :, None] for part in along_free.swapaxes(0, 1)]
    chosen: list[int] = []
    for i, inertia in enumerate(_inertias(machine, q, t)):
        pulled = along_free.swapaxes(1, 2) @ inertia[:, free][:, :, free] @ along_free
        size = float(np.linalg.norm(pulled))
        if not size > 0 or any(proportional(pulled, other, PARALLEL) for other in seen):
            continue
        seen.append(pulled)
        chosen.append(i)
    return tuple(chosen)


def _of_one(inertia: Array, size: float) -> bool:
    """Whether the speed of a point is a constant times the rate of one coordinate: its ``inertia``
    JᵀJ (Q, n, n) has one entry, on the diagonal, which is the same everywhere."""
    same = bool(np.all(np.abs(inertia - inertia[0]) < PARALLEL * size))
    rest = inertia[0].copy()
    first = int(np.argmax(np.diagonal(rest)))
    rest[first, first] = 0.0
    return same and float(np.abs(rest).max()) < PARALLEL * size


def _probed(model: Model, places: Sequence[At], probe: str) -> Machine:
    """The model with one mass, 0 kg, at each place, behind all its elements; or an inertia."""
    probes, key = [], KINDS[probe].strengths[0]
    for i, place in enumerate(places):
        name = f"{PROBE}{i}"
        nothing = Parameter(key, 0.0, key_unit(model, probe, key, place), owner=name)
        probes.append(Element(name, probe, place, ((key, parse_expression(key)),), (nothing,)))
    return build(replace(model, elements=(*model.elements, *probes)), keep=False)


def _inertias(machine: Machine, q: Array, t: Array) -> Array:
    """JᵀJ (K, N, n, n) of each probed point: what a mass of 1 kg there, or an inertia of 1 kg·m²,
    adds to the mass matrix."""
    probes = [e for e in machine.model.elements if e.name.startswith(PROBE)]
    columns = [machine.column(f"{e.name}.{KINDS[e.kind].strengths[0]}") for e in probes]
    shape = (t.size, machine.n, machine.n)

    def mass(p: Array) -> Array:
        return along(machine.M, (q, t, p), (2,), t.size)[0].reshape(shape)

    base = mass(machine.values)
    found = []
    for column in columns:
        p = machine.values.copy()
        p[column] = 1.0
        found.append(mass(p) - base)
    return np.array(found).reshape(-1, *shape)
