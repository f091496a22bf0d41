r"""Every kind of the vocabulary at every place against equations written by hand, run by SciPy.

    B o (0, 0.8 + y)
      |\
      | \   the element ``between`` A and B
      |  \
      +---o A (1 + x, 0)            ``at``: the point C = (1 + x, 0.8 + y)
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest
from builders import model_of, run, value
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.model.expression import parse_expression
from symhyb.model.types import At, Between, Element, Model, On, Parameter, Place
from symhyb.model.vocabulary import KINDS, key_unit
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build

Array = NDArray[np.float64]
M, K, C = 1.2, 40.0, 0.5
W, PUSH = np.array([5.0, 6.5]), np.array([6.0, -5.0])
FROM, V0 = np.array([0.05, -0.08]), np.array([0.4, 0.9])
T = np.linspace(0, 2, 81)
PLACES: Mapping[str, Place] = {"on": On("x"), "between": Between("A", "B"), "at": At("C")}


def sliders() -> Model:
    """Two blocks on two rails, each on a spring with damping, shaken by harmonic forces."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={
            "m": (M, "kg"),
            "k": (K, "N/m"),
            "c": (C, "N*s/m"),
            "l": (1.0, "m"),
            "h": (0.8, "m"),
            "w": (W[0], "1/s"),
            "o": (W[1], "1/s"),
            "f": (PUSH[0], "N"),
            "g": (PUSH[1], "N"),
        },
        points={"A": ["l + x", "0"], "B": ["0", "h + y"], "C": ["l + x", "h + y"]},
        bodies={"a": {"mass": "m", "at": "A"}, "b": {"mass": "m", "at": "B"}},
        elements={
            "left": {"kind": "law", "on": "x", "force": "f*sin(w*t) - k*x - c*x'"},
            "down": {"kind": "law", "on": "y", "force": "g*cos(o*t) - k*y - c*y'"},
        },
    )


def element(
    model: Model, kind: str, where: str, keys: Mapping[str, float], side: str = ""
) -> Element:
    """An element whose keys are parameters of its own, in the units of their places."""
    own = []
    for key, number in keys.items():
        unit = key_unit(model, kind, key, PLACES[where], keys.get("exponent", 1.0))
        own.append(Parameter(key.replace(".", "_"), number / unit.factor, unit, owner="it"))
    values = tuple((key, parse_expression(key.replace(".", "_"))) for key in keys)
    options = (("side", side),) if side else ()
    return Element("it", kind, PLACES[where], values, tuple(own), options=options)


@dataclass(frozen=True)
class Case:
    """Keys (without ``length``) and the law by hand: (s, s', z, t) -> F, z'."""

    kind: str
    keys: Mapping[str, float]
    law: Callable[[float, float, float, float], tuple[float, float]]
    side: str = ""
    name: str = ""

    @property
    def label(self) -> str:
        return self.name or self.kind


def hand_gap(s: float, r: float, lower: bool = True, upper: bool = True) -> float:
    k, c, clearance = 300.0, 4.0, 0.05
    if upper and s > clearance:
        return max(k * (s - clearance) + c * r, 0.0)
    if lower and s < -clearance:
        return min(k * (s + clearance) + c * r, 0.0)
    return 0.0


def hand_bend(r: float, z: float, n: float, play: float) -> tuple[float, float]:
    taut = np.sign(z) * max(abs(z) - play, 0.0)
    return 60 * taut, r - 6 * abs(r) * abs(z) ** (n - 1) * z - 3 * r * abs(z) ** n


def hand_level(r: float, coulomb: float, static: float, stribeck: float) -> float:
    return coulomb + (static - coulomb) * float(np.exp(-((r / stribeck) ** 2)))


def hand_bristle(r: float, z: float) -> tuple[float, float]:
    rate = r - 400 * abs(r) * z / hand_level(r, 0.8, 1.1, 0.1)
    return 400 * z + 2 * rate, rate


GAP = {"stiffness": 300.0, "clearance": 0.05, "damping": 4.0}
BENT = {"stiffness": 60.0, "beta": 6.0, "gamma": 3.0}
SLIP = {"coulomb": 0.8, "static": 1.2, "stribeck": 0.2, "transition": 0.05, "asymmetry": -0.2}
CASES = [
    Case(
        "spring",
        {"stiffness": 80.0, "quadratic": 50.0, "cubic": 300.0},
        lambda s, r, z, t: (80 * s + 50 * s**2 + 300 * s**3, 0),
    ),
    Case("damper", {"damping": 3.0}, lambda s, r, z, t: (3 * r, 0)),
    Case(
        "damper",
        {"damping": 3.0, "asymmetry": 0.3},
        lambda s, r, z, t: (3.9 * r if r > 0 else 2.1 * r, 0),
        name="sided",
    ),
    Case("drag", {"drag": 4.0}, lambda s, r, z, t: (4 * abs(r) * r, 0)),
    Case(
        "friction",
        SLIP,
        lambda s, r, z, t: (
            hand_level(r, 0.8, 1.2, 0.2) * np.tanh(r / 0.05) * (0.8 if r > 0 else 1.2),
            0,
        ),
    ),
    Case("gap", GAP, lambda s, r, z, t: (hand_gap(s, r), 0), name="both stops"),
    Case("gap", GAP, lambda s, r, z, t: (hand_gap(s, r, lower=False), 0), "upper", "upper stop"),
    Case("gap", GAP, lambda s, r, z, t: (hand_gap(s, r, upper=False), 0), "lower", "lower stop"),
    Case("hysteresis", BENT, lambda s, r, z, t: hand_bend(r, z, 1, 0), name="bend, n = 1"),
    Case(
        "hysteresis",
        {**BENT, "exponent": 2.0},
        lambda s, r, z, t: hand_bend(r, z, 2, 0),
        name="bend, n = 2",
    ),
    Case(
        "hysteresis",
        {**BENT, "exponent": 1.5, "play": 0.03},
        lambda s, r, z, t: hand_bend(r, z, 1.5, 0.03),
        name="bend, n = 1.5, play",
    ),
    Case(
        "friction_dynamic",
        {"coulomb": 0.8, "static": 1.1, "stribeck": 0.1, "stiffness": 400.0, "micro_damping": 2.0},
        lambda s, r, z, t: hand_bristle(r, z),
    ),
    Case(
        "relaxation",
        {"stiffness": 60.0, "damping": 6.0},
        lambda s, r, z, t: (60 * (s - z), 10 * (s - z)),
    ),
    Case("constant", {"constant": 1.5}, lambda s, r, z, t: (1.5, 0)),
    Case(
        "harmonic",
        {"amplitude": 2.0, "frequency": 1.3, "phase": 0.4},
        lambda s, r, z, t: (2 * np.sin(2 * np.pi * 1.3 * t + 0.4), 0),
    ),
    Case(
        "ripple",
        {"amplitude": 1.5, "period": 0.21, "phase": 0.3},
        lambda s, r, z, t: (1.5 * np.sin(2 * np.pi * s / 0.21 + 0.3), 0),
    ),
]
PUSHING = ("constant", "harmonic", "ripple")
MASS = 0.7
LENGTH = 1.25


def path(q: Array, v: Array, where: str) -> tuple[float, float, Array]:
    """s, s' and ∂s/∂q of the place."""
    if where == "on":
        return q[0], v[0], np.array([1.0, 0.0])
    a, b = 1 + q[0], 0.8 + q[1]
    length = float(np.hypot(a, b))
    direction = np.array([a, b]) / length
    return length - LENGTH, float(direction @ v), direction


def by_hand(
    force: Callable[[float, Array, Array, float], tuple[Array, float]],
    z0: float,
    mass: Callable[[Array], Array] = lambda q: M * np.eye(2),
) -> Array:
    """q and v (N, 4) of the sliders under one more generalized ``force`` (t, q, v, z) -> Q, z'."""

    def rate(t: float, state: Array) -> Array:
        q, v, z = state[:2], state[2:4], float(state[4])
        extra, inner = force(t, q, v, z)
        shaken = PUSH * [np.sin(W[0] * t), np.cos(W[1] * t)] - K * q - C * v
        return np.concatenate([v, np.linalg.solve(mass(q), shaken + extra), [inner]])

    start = np.concatenate([FROM, V0, [z0]])
    done = solve_ivp(rate, (0, T[-1]), start, "LSODA", T, rtol=1e-10, atol=1e-12, max_step=0.005)
    assert done.success
    return np.asarray(done.y.T)


def simulated(item: Element) -> tuple[Array, Array]:
    model = sliders()
    result = run(replace(model, elements=(*model.elements, item)), T, FROM, V0)
    assert result.complete
    return np.hstack([result.q, result.v]), result.z


@pytest.mark.parametrize("where", ["on", "between"])
@pytest.mark.parametrize("case", CASES, ids=lambda case: case.label)
def test_a_kind_is_its_law_in_the_equations_of_motion(case: Case, where: str) -> None:
    sign = 1.0 if case.kind in PUSHING and where == "on" else -1.0

    def force(t: float, q: Array, v: Array, z: float) -> tuple[Array, float]:
        s, r, direction = path(q, v, where)
        strength, inner = case.law(s, r, z, t)
        return sign * direction * strength, inner

    length = {"length": LENGTH} if where == "between" else {}
    z0 = path(FROM, V0, where)[0] if case.kind == "relaxation" else 0.0
    expected = by_hand(force, z0)
    found, z = simulated(element(sliders(), case.kind, where, {**case.keys, **length}, case.side))
    assert found == pytest.approx(expected[:, :4], abs=2e-5)
    if KINDS[case.kind].states:
        assert np.ptp(z) > 1e-3
        assert z[:, 0] == pytest.approx(expected[:, 4], abs=2e-5)
    free = by_hand(lambda t, q, v, z: (np.zeros(2), 0.0), 0.0)
    assert np.abs(found - free[:, :4]).max() > 5e-3  # the law is felt


@pytest.mark.parametrize(
    "case",
    [
        c
        for c in CASES
        if "at" in KINDS[c.kind].placements
        and c.label not in ("constant", "harmonic", "sided")
        and c.kind != "friction"
    ],
    ids=lambda case: case.label,
)
def test_at_a_point_a_kind_acts_against_the_velocity(case: Case) -> None:
    """F = −F(|v|) v/|v|; C moves with x and y, so Q is the force itself."""

    def force(t: float, q: Array, v: Array, z: float) -> tuple[Array, float]:
        speed = float(np.hypot(*v))
        return -case.law(0, speed, 0, t)[0] * v / speed, 0.0

    found, _ = simulated(element(sliders(), case.kind, "at", case.keys))
    assert found == pytest.approx(by_hand(force, 0.0)[:, :4], abs=2e-5)


def test_friction_at_a_point_has_one_level_in_every_direction() -> None:
    keys = {"coulomb": 0.8, "static": 1.2, "stribeck": 0.2, "transition": 0.05}

    def force(t: float, q: Array, v: Array, z: float) -> tuple[Array, float]:
        speed = max(float(np.hypot(*v)), 1e-12)
        return -hand_level(speed, 0.8, 1.2, 0.2) * np.tanh(speed / 0.05) * v / speed, 0.0

    found, _ = simulated(element(sliders(), "friction", "at", keys))
    assert found == pytest.approx(by_hand(force, 0.0)[:, :4], abs=2e-5)


def test_vectors_at_a_point_push_along_the_axes() -> None:
    still = element(sliders(), "constant", "at", {"constant.x": 1.5, "constant.y": -0.8})
    expected = by_hand(lambda t, q, v, z: (np.array([1.5, -0.8]), 0.0), 0.0)
    assert simulated(still)[0] == pytest.approx(expected[:, :4], abs=2e-5)
    keys = {"amplitude.x": 1.5, "amplitude.y": -0.8, "frequency": 1.3, "phase": 0.4}

    def swing(t: float, q: Array, v: Array, z: float) -> tuple[Array, float]:
        return np.array([1.5, -0.8]) * np.sin(2 * np.pi * 1.3 * t + 0.4), 0.0

    found, _ = simulated(element(sliders(), "harmonic", "at", keys))
    assert found == pytest.approx(by_hand(swing, 0.0)[:, :4], abs=2e-5)


@pytest.mark.parametrize("where", ["on", "between", "at"])
def test_added_mass_is_a_heavier_body(where: str) -> None:
    """On x the block A is heavier, at C both are; between A and B it resists s'' = d·q'' + d'·q',
    where d' = ((A', B') − d s')/|B − A|."""

    def force(t: float, q: Array, v: Array, z: float) -> tuple[Array, float]:
        s, r, direction = path(q, v, where)
        if where != "between":
            return np.zeros(2), 0.0
        turned = (v - direction * r) / (s + LENGTH)
        return -MASS * direction * float(turned @ v), 0.0

    def mass(q: Array) -> Array:
        direction = path(q, np.zeros(2), where)[2]
        more = np.eye(2) if where == "at" else np.outer(direction, direction)
        return M * np.eye(2) + MASS * more

    keys = {"mass": MASS, "length": LENGTH} if where == "between" else {"mass": MASS}
    found, _ = simulated(element(sliders(), "added_mass", where, keys))
    if where == "at":
        expected = by_hand(lambda t, q, v, z: (np.zeros(2), 0.0), 0.0, mass)
    else:
        expected = by_hand(force, 0.0, mass)
    assert found == pytest.approx(expected[:, :4], abs=2e-5)


SIGNALS = {"on": ("force",), "between": ("tension",), "at": ("force.x", "force.y")}


@pytest.mark.parametrize("kind", ["force", "law"])
@pytest.mark.parametrize("where", ["on", "between", "at"])
def test_an_expression_of_the_motion_and_of_time_is_a_force(kind: str, where: str) -> None:
    texts = ("2*f*sin(3*w*t)*x*y'/c", "g*cos(x/l)")
    numbers = [
        lambda t, q, v: 2 * PUSH[0] * np.sin(3 * W[0] * t) * q[0] * v[1] / C,
        lambda t, q, v: PUSH[1] * np.cos(q[0]),
    ]

    def force(t: float, q: Array, v: Array, z: float) -> tuple[Array, float]:
        first = float(numbers[0](t, q, v))
        if where == "at":
            return np.array([first, float(numbers[1](t, q, v))]), 0.0
        direction = path(q, v, where)[2]
        return (first if where == "on" else -first) * direction, 0.0

    keys = SIGNALS[where]
    values = tuple((key, parse_expression(text)) for key, text in zip(keys, texts, strict=False))
    found, _ = simulated(Element("it", kind, PLACES[where], values))
    assert found == pytest.approx(by_hand(force, 0.0)[:, :4], abs=2e-5)


# --- signs, as a picture -------------------------------------------------------------------


# (kind, keys, inner state at the right, force on x at x = 0.2, x' = 0.3, that to the left)
SIGNS: list[tuple[str, Mapping[str, float], float | None, float]] = [
    ("spring", {"stiffness": 80.0}, None, -16.0),
    ("damper", {"damping": 3.0}, None, -0.9),
    ("drag", {"drag": 4.0}, None, -0.36),
    ("friction", {"coulomb": 0.8, "transition": 1e-3}, None, -0.8),
    ("gap", {"stiffness": 300.0, "clearance": 0.05}, None, -45.0),
    ("gap", GAP, None, -46.2),
    ("hysteresis", BENT, 0.1, -6.0),
    ("hysteresis", {**BENT, "play": 0.04}, 0.1, -3.6),
    ("friction_dynamic", {"coulomb": 0.8, "stiffness": 400.0}, 0.002, -0.8),
    ("relaxation", {"stiffness": 60.0, "damping": 6.0}, 0.15, -3.0),
]


@pytest.mark.parametrize(("kind", "keys", "z", "expected"), SIGNS)
@pytest.mark.parametrize("mirror", [1, -1])
def test_pulled_to_the_right_it_pulls_to_the_left(
    kind: str, keys: Mapping[str, float], z: float | None, expected: float, mirror: int
) -> None:
    model = sliders()
    machine = build(replace(model, elements=(element(model, kind, "on", keys),)))
    q, v = mirror * np.array([0.2, 0.0]), mirror * np.array([0.3, 0.0])
    inner = [] if z is None else [mirror * z]
    each = value(machine.elements, q, v, inner, [], 0, machine.values)
    assert each == pytest.approx([mirror * expected, 0.0])
    assert value(machine.k_e, q, v, inner, [], 0, machine.values) == pytest.approx(each)


@pytest.mark.parametrize(("kind", "keys", "z", "expected"), SIGNS)
def test_pulled_apart_two_points_are_pulled_together(
    kind: str, keys: Mapping[str, float], z: float | None, expected: float
) -> None:
    """A and B 0.2 m further apart than the length, leaving each other at 0.3 m/s; the element read
    from the other end is the same."""
    model, distance = sliders(), float(np.hypot(1, 0.8))
    item = element(model, kind, "between", {**keys, "length": distance - 0.2})
    direction = np.array([1, 0.8]) / distance
    for place in (Between("A", "B"), Between("B", "A")):
        machine = build(replace(model, elements=(replace(item, place=place),)))
        inner = [] if z is None else [z]
        arguments = (np.zeros(2), 0.3 * direction, inner, [], 0, machine.values)
        assert value(machine.elements, *arguments) == pytest.approx(expected * direction)
        stretch, rate, _ = call(machine.pathways, (*arguments[:2], 0.0, machine.values))
        assert [stretch[0, 0], rate[0, 0]] == pytest.approx([0.2, 0.3])


@pytest.mark.parametrize("where", ["on", "between", "at"])
def test_what_added_mass_carries_is_its_part_of_the_balance(where: str) -> None:
    """M a + k_c with the mass is that without it, less the force that the mass exerts."""
    model = sliders()
    keys = {"mass": MASS, "length": LENGTH} if where == "between" else {"mass": MASS}
    item = element(model, "added_mass", where, keys)
    bare, heavy = build(model), build(replace(model, elements=(*model.elements, item)))
    rng = np.random.default_rng(3)
    for _ in range(5):
        q, v, a = rng.normal(size=(3, 2)) * [[0.3], [1.0], [5.0]]
        rests = [
            value(machine.discrepancy, q, v, a, [], [], 0.2, machine.values)
            for machine in (bare, heavy)
        ]
        carried = value(heavy.carried, q, v, a, 0.2, heavy.values)
        assert carried[:2] == pytest.approx(np.zeros((2, 2)))
        assert rests[1] == pytest.approx(rests[0] - carried[2])
        assert value(heavy.elements, q, v, [], [], 0.2, heavy.values)[2] == pytest.approx([0, 0])
