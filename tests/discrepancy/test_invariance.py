"""How a machine is written must not change what is computed: coordinates, places, units, order."""

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest
from builders import value
from rewritings import Array, Writing, chains, multisine, quarter_cars

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis, library, natural_length
from symhyb.discrepancy.places.placements import places_of
from symhyb.discrepancy.places.probing import proportional, pushed
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import lay, reduce
from symhyb.model.types import Between, Place
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.windows import WindowModel

T = np.arange(0, 6, 0.01)
PUSH = multisine(T, 8.0)
ROAD_HZ, ROAD_M = 2 * np.pi * np.array([1.3, 7.0]), np.array([8e-3, 2e-3])
LAWS: Mapping[str, Mapping[str, float]] = {
    "spring": {"cubic": 9e3},
    "damper": {"damping": 1.5},
    "drag": {"drag": 2.0},
    "friction": {"coulomb": 0.4, "transition": 1e-3},
    "gap": {"stiffness": 900.0, "clearance": 0.004},
    "friction_dynamic": {"coulomb": 0.4, "stiffness": 700.0},
    "relaxation": {"stiffness": 90.0, "damping": 3.0},
    "added_mass": {"mass": 0.2},
}


@cache
def written(family: str) -> tuple[Writing, ...]:
    if family == "quarter car":
        return quarter_cars()
    return chains(turning=family == "shafts")


FAMILIES = ("masses", "shafts", "quarter car")
WAYS = [(family, i) for family in FAMILIES for i in range(1, len(written(family)))]
NAMES = [f"{family}: {written(family)[i].name}" for family, i in WAYS]
each_way = pytest.mark.parametrize(("family", "i"), WAYS, ids=NAMES)


def simulated(way: Writing, family: str) -> Trajectory:
    if family != "quarter car":
        return way.simulated(T, [0.01, -0.02], [0.1, 0.0], PUSH[:, None])
    turns = ROAD_HZ * T[:, None]
    road = (np.sin(turns), ROAD_HZ * np.cos(turns), -(ROAD_HZ**2) * np.sin(turns))
    given = np.stack([part @ ROAD_M for part in road], axis=1)
    return way.simulated(T, [0.575, 0.283, 0.0], [0, 0, given[0, 1]], np.empty((T.size, 0)), given)


@cache
def recorded(family: str) -> Recording:
    """The recording of the first way with friction that no model knows, 1 % noise."""
    first = written(family)[0]
    place = "strut" if family == "quarter car" else "link"
    level = 60.0 if family == "quarter car" else 0.5
    run = simulated(first.with_law("friction", place, coulomb=level, transition=1e-3), family)
    assert run.complete
    road = np.sin(ROAD_HZ * T[:, None]) @ ROAD_M
    inputs = {"h": road} if family == "quarter car" else {"f": PUSH}
    return first.recorded(run, inputs, noise=0.01, seed=3)


@each_way
def test_simulations_are_the_same(family: str, i: int) -> None:
    """To the accuracy of the integration, which is less where damping and tyre have a kink."""
    first, other = (simulated(written(family)[k], family) for k in (0, i))
    assert other.complete
    difference = np.abs(other.y - first.y).max(axis=0) / np.ptp(first.y, axis=0)
    assert difference.max() < (2e-5 if family == "quarter car" else 1e-8)


@each_way
def test_accelerations_and_forces_are_the_same(family: str, i: int) -> None:
    first, other = written(family)[0], written(family)[i]
    one, two = build(first.model), build(other.model)
    run = simulated(first, family)
    u = np.empty((T.size, 0)) if family == "quarter car" else PUSH[:, None]
    for row in range(0, T.size, 50):
        q, v = run.q[row], run.v[row]
        q_own, v_own = other.motion(q), other.motion(v)
        force = value(one.k_e, q, v, [], u[row], T[row], one.values)
        own = value(two.k_e, q_own, v_own, [], u[row], T[row], two.values)
        size = np.abs(force).max()
        assert own == pytest.approx(other.forces(force), rel=1e-10, abs=1e-10 * size)


@pytest.mark.parametrize("kind", LAWS)
@pytest.mark.parametrize("where", ["wall", "link", "far"])
@pytest.mark.parametrize("family", ["masses", "shafts"])
def test_a_law_at_a_logical_place_is_the_same_force(family: str, where: str, kind: str) -> None:
    """Every kind at every place, in every way: the generalized force, transformed."""
    random = np.random.default_rng(4)
    side = "upper" if kind == "gap" else ""
    for q, v in 0.03 * random.standard_normal((5, 2, 2)):
        a = random.standard_normal(2)
        found = []
        for way in written(family):
            machine = build(way.with_law(kind, where, side=side, **LAWS[kind]).model)
            own, z = [way.motion(x) for x in (q, v, a)], inner(way, kind, where)
            force = value(machine.elements, own[0], own[1], z, [0.0], 0.0, machine.values)
            carried = value(machine.carried, *own, 0.0, machine.values)
            total = (force + carried).reshape(-1, 2)[-1]
            found.append(np.linalg.solve(way.turn.T, total))
        size = np.abs(found[0]).max()
        if kind not in ("gap", "added_mass"):
            assert size > 0
        for force in found[1:]:
            assert force == pytest.approx(found[0], rel=1e-9, abs=1e-9 * size)


def inner(way: Writing, kind: str, where: str) -> list[float]:
    """An inner state; that of a relaxation is a stretch, which between points begins elsewhere."""
    if kind not in ("friction_dynamic", "relaxation"):
        return []
    far = kind == "relaxation" and isinstance(way.places[where], Between)
    return [0.01 + (way.lengths[where] if far else 0.0)]


@pytest.mark.slow
@each_way
def test_the_lacking_force_is_the_same(family: str, i: int) -> None:
    """ΔF with its motion, from noisy recordings; on coordinates that move freely."""
    gaps, ways = [], (written(family)[0], written(family)[i])
    for way in ways:
        gaps.append(sh.compare(build(way.model), recorded(family)))
    first, other = gaps
    size = np.abs(first.force).max()
    assert size > 0
    expected = ways[1].forces(first.force)
    free = list(build(ways[1].model).free)
    assert other.force[:, free] == pytest.approx(expected[:, free], abs=1e-6 * size)
    moved = ways[1].motion(first.motion.q)
    assert other.motion.q == pytest.approx(moved, abs=1e-9 * np.abs(moved).max())
    assert other.motion.sd == pytest.approx(first.motion.sd, rel=1e-6)


def columns(way: Writing, family: str) -> tuple[Array, Array]:
    """What windows of 0.6 s see of a machine: the whitened Gram matrices (W, F + 1, F + 1) of the
    residual and of laws at logical places, initial states removed, and the samples they count."""
    record, machine = recorded(family), build(way.model)
    motion = motion_of(record, machine)
    cut = lay(record, machine, motion, 0.6)
    assert cut is not None
    places = tuple(way.places.values())
    tried = tuple(h for place in places for h in _laws(way, place))
    laws = library(way.model, places, tried)
    forces = laws.forces(cut.course(laws.machine))[cut.rows]
    model = WindowModel(machine)
    linear = model.along(cut.block, cut.states, machine.values)
    residual = cut.block.y - linear.output - linear.from_defect()
    sd = np.array([np.nanstd(y) for y in record.sensors.values()]) * 0.01
    reduced = reduce(cut, residual, linear.from_start(), linear.from_forces(forces), sd)
    return reduced.grams, reduced.count


def _laws(way: Writing, place: Place) -> tuple[Hypothesis, ...]:
    between = isinstance(place, Between)
    length = (("length", natural_length(way.model, place)),) if between else ()
    slip = (("transition", 1e-2),)
    return (
        Hypothesis("spring", place, ("stiffness",), (False,), length),
        Hypothesis("damper", place, ("damping",), (True,)),
        Hypothesis("drag", place, ("drag",), (True,)),
        Hypothesis("friction", place, ("coulomb",), (True,), slip),
    )


@pytest.mark.slow
@each_way
def test_windows_see_the_same(family: str, i: int) -> None:
    """Residuals and candidate columns of the linearised windows, without their initial states."""
    first, count = columns(written(family)[0], family)
    other, counted = columns(written(family)[i], family)
    assert counted.tolist() == count.tolist()
    scale = np.sqrt(np.diagonal(first, axis1=1, axis2=2).mean(axis=0))
    assert np.all(scale > 0)
    whitened, same = (grams / scale[:, None] / scale for grams in (first, other))
    assert same == pytest.approx(whitened, abs=1e-6 * np.abs(whitened).max())


@pytest.mark.parametrize("family", FAMILIES)
def test_places_of_hypotheses_cover_all_logical_places(family: str) -> None:
    """Each way offers places that move as the link and as both masses, though it names others."""
    for way in written(family):
        offered = places_of(way.model)
        ways = pushed(way.model, (*offered, *way.places.values()))
        known = [one for one in ways[: len(offered)] if one is not None]
        assert len(known) == len(offered)
        for where, one in zip(way.places, ways[len(offered) :], strict=True):
            assert one is not None
            assert sum(proportional(one, other) for other in known) == 1, (way.name, where)
