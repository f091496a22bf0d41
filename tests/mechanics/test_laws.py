"""Force laws against their formulas, and their energy class."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import sympy as sp

from symhyb.laws.friction import DEFAULT_TRANSITION
from symhyb.laws.maths import Action, Motion
from symhyb.mechanics.laws import action_of
from symhyb.model.curves import Curve
from symhyb.model.maps import Map
from symhyb.model.types import Element, On
from symhyb.model.vocabulary import KINDS
from symhyb.units import ONE

S, RATE, Z, W, T = sp.symbols("s rate z w t", real=True)
AT = Motion(S, RATE, (Z,), T)
GRID = np.linspace(-0.8, 0.8, 33)


def force(kind: str, **keys: float) -> np.ndarray:
    """F on a grid, of the stretch where it is conservative, else of the rate."""
    values = {key: sp.Float(value) for key, value in keys.items()}
    law = action_of(Element("it", kind, On("x"), ()), AT, values)
    function = sp.lambdify([S, RATE], law.force)
    stored = KINDS[kind].energy == "conservative"
    return np.array([float(function(*((x, 0.0) if stored else (0.3, x)))) for x in GRID])


x = GRID
FORMULAS = [
    ("spring", {"stiffness": 3.0}, 3 * x),
    ("spring", {"quadratic": 2.0, "cubic": -5.0}, 2 * x**2 - 5 * x**3),
    ("damper", {"damping": 4.0}, 4 * x),
    ("damper", {"damping": 4.0, "asymmetry": 0.25}, 4 * x * (1 + 0.25 * np.sign(x))),
    ("drag", {"drag": 0.7}, 0.7 * np.abs(x) * x),
    ("friction", {"coulomb": 2.0, "transition": 0.1}, 2 * np.tanh(x / 0.1)),
    ("friction", {"coulomb": 2.0}, 2 * np.tanh(x / DEFAULT_TRANSITION)),
    (
        "friction",
        {"coulomb": 2.0, "static": 3.0, "stribeck": 0.2, "transition": 0.05},
        (2 + 1.0 * np.exp(-((x / 0.2) ** 2))) * np.tanh(x / 0.05),
    ),
    (
        "friction",
        {"coulomb": 2.0, "transition": 0.1, "asymmetry": -0.4},
        2 * np.tanh(x / 0.1) * (1 - 0.4 * np.sign(x)),
    ),
    ("constant", {"constant": -1.5}, -1.5 + 0 * x),
    ("play", {"stiffness": 3.0, "clearance": 0.2}, -3 * np.clip(x, -0.2, 0.2)),
]


@pytest.mark.parametrize(("kind", "keys", "expected"), FORMULAS)
def test_force_against_its_formula(kind: str, keys: dict[str, float], expected: np.ndarray) -> None:
    assert force(kind, **keys) == pytest.approx(expected, abs=1e-12)
    if KINDS[kind].energy == "dissipative":
        assert np.all(force(kind, **keys) * GRID >= 0)


def test_what_a_spring_stores_is_the_integral_of_its_force() -> None:
    values = dict(zip(("stiffness", "quadratic", "cubic"), sp.symbols("a b c"), strict=True))
    law = action_of(Element("it", "spring", On("x"), ()), AT, values)
    assert sp.expand(sp.diff(law.stored, S) - law.force) == 0
    assert law.stored.subs(S, 0) == 0


PAIRED = {kind for kind, law in KINDS.items() if law.coupling is not None}  # test_pair_laws.py
MAP = Map("m", (0.0, 1.0), (0.0, 1.0), ((0.0, 1.0), (2.0, 3.0)), (ONE, ONE, ONE))
STORING = {
    "curve",
    "spring",
    "gap",
    "hysteresis",
    "friction_dynamic",
    "play",
    "relaxation",
    "mode",
    "hydromount",
}


@pytest.mark.parametrize("kind", sorted(set(KINDS) - STORING - PAIRED - {"network"}))
def test_other_kinds_store_nothing(kind: str) -> None:
    declared = KINDS[kind]
    one = {key: sp.Integer(1) for key in (*declared.strengths[:1], *declared.needs)}
    grid = MAP if kind == "map" else None
    assert action_of(Element("it", kind, On("x"), (), map=grid), AT, one).stored == 0


@pytest.mark.parametrize("kind", sorted(set(KINDS) - PAIRED))
def test_the_vocabulary_and_the_laws_agree_on_inner_states(kind: str) -> None:
    declared = KINDS[kind]
    one = {key: sp.Integer(1) for key in (*declared.strengths[:1], *declared.needs)}
    if kind == "network":  # its force is a hole that lowering fills
        assert not declared.states
        return
    curve = Curve("c", ((0.0, 0.0), (1.0, 1.0)), (ONE, ONE)) if kind == "curve" else None
    grid = MAP if kind == "map" else None
    options = tuple((key.name, key.choices[0]) for key in declared.keys if key.choices)
    element = Element("it", kind, On("x"), (), options=options, curve=curve, map=grid)
    law = action_of(element, replace(AT, z=(Z, W)[: len(declared.states)]), one)
    assert len(law.inner) == len(law.rest) == len(declared.states)
    assert (law.mass != 0) == (kind in ("added_mass", "payload", "added_inertia"))


def law(kind: str, options: tuple[tuple[str, str], ...] = (), **keys: float) -> Action:
    values = {key: sp.Float(value) for key, value in keys.items()}
    return action_of(Element("it", kind, On("x"), (), options=options), AT, values)


def numbers(expression: sp.Expr) -> Callable[..., float]:
    return sp.lambdify([S, RATE, Z, T], expression, modules=["numpy"])


GAP = {"stiffness": 200.0, "clearance": 0.1}
# Contact at +0.1 presses to the left (F > 0 resists), at −0.1 to the right.
SIDES = [
    ("upper", [0.0, 0.0, 0.0, 20.0]),
    ("lower", [-20.0, 0.0, 0.0, 0.0]),
    ("both", [-20.0, 0.0, 0.0, 20.0]),
]


@pytest.mark.parametrize(("side", "expected"), SIDES)
def test_a_gap_has_the_stops_that_it_says(side: str, expected: list[float]) -> None:
    force = numbers(law("gap", (("side", side),), **GAP).force)
    assert [force(s, 0, 0, 0) for s in (-0.2, -0.05, 0.1, 0.2)] == pytest.approx(expected)


def test_a_gap_without_a_word_has_both_stops_and_stores_its_springs() -> None:
    both = law("gap", **GAP)
    force, stored = numbers(both.force), numbers(both.stored)
    for s in (-0.3, -0.1, 0.02, 0.25):
        depth = max(abs(s) - 0.1, 0)
        assert force(s, 5, 0, 0) == pytest.approx(np.sign(s) * 200 * depth)
        assert stored(s, 5, 0, 0) == pytest.approx(100 * depth**2)


def test_the_damping_of_a_gap_acts_in_contact_only_and_never_pulls() -> None:
    """Pressed 0.1 m deep (20 N) with 10 N·s/m: leaving at 1 m/s it presses 10 N, at 5 m/s it
    would pull by 30 N, so it lets go."""
    force = numbers(law("gap", **GAP, damping=10.0).force)
    assert [force(0.2, r, 0, 0) for r in (1, -1, -5)] == pytest.approx([30, 10, 0])
    assert [force(-0.2, r, 0, 0) for r in (-1, 1, 5)] == pytest.approx([-30, -10, 0])
    assert [force(s, 50, 0, 0) for s in (-0.1, 0.0, 0.1)] == [0, 0, 0]
    grid = np.random.default_rng(1).uniform(-1, 1, (500, 2)) * [0.4, 30]
    assert all(force(s, r, 0, 0) * s >= 0 for s, r in grid)


def test_play_is_free_travel_of_the_spring_of_a_hysteresis() -> None:
    """F = k·dead(z): 0 up to the play, k (z − play) beyond; the law of z is not changed."""
    plain = law("hysteresis", stiffness=200.0, beta=4.0, gamma=2.0)
    loose = law("hysteresis", stiffness=200.0, beta=4.0, gamma=2.0, play=0.05)
    assert plain.inner == loose.inner
    force = numbers(loose.force)
    found = [force(0.3, 1, z, 0) for z in (-0.15, -0.05, 0.0, 0.04, 0.1)]
    assert found == pytest.approx([-20, 0, 0, 0, 10])


@pytest.mark.parametrize("n", [1.0, 2.0, 1.5])
def test_the_inner_law_of_a_hysteresis(n: float) -> None:
    """z' = s' − beta|s'||z|^(n−1) z − gamma s'|z|^n, at every sign of s' and z, and at z = 0."""
    rate = numbers(law("hysteresis", stiffness=1.0, beta=3.0, gamma=2.0, exponent=n).inner[0])
    for r in (-0.7, 0.0, 0.4):
        for z in (-0.3, 0.0, 0.2):
            expected = r - 3 * abs(r) * abs(z) ** (n - 1) * z - 2 * r * abs(z) ** n
            assert rate(0.1, r, z, 0) == pytest.approx(expected, rel=1e-12, abs=1e-15)


def test_friction_with_presliding_slips_at_its_level() -> None:
    """In steady sliding z' = 0, so stiffness·z = g(s')·sgn s', falling from static to coulomb."""
    keys = {"coulomb": 2.0, "static": 3.0, "stribeck": 0.1, "stiffness": 1e4}
    lugre = law("friction_dynamic", **keys, micro_damping=5.0)
    inner, force = numbers(lugre.inner[0]), numbers(lugre.force)
    for r in (-0.2, 0.01, 0.5):
        level = 2 + np.exp(-((r / 0.1) ** 2))
        z = np.sign(r) * level / 1e4
        assert inner(0, r, z, 0) == pytest.approx(0, abs=1e-12)
        assert force(0, r, z, 0) == pytest.approx(np.sign(r) * level)
    assert force(0, 0.5, 0, 0) == pytest.approx(5.0 * 0.5)  # not yet deflected: micro_damping·s'


def test_a_relaxing_spring_rests_where_it_is() -> None:
    maxwell = law("relaxation", stiffness=200.0, damping=5.0)
    assert maxwell.rest == (S,)
    assert numbers(maxwell.force)(0.3, 0, 0.1, 0) == pytest.approx(40)
    assert numbers(maxwell.inner[0])(0.3, 0, 0.1, 0) == pytest.approx(0.2 * 200 / 5)
    assert numbers(maxwell.stored)(0.3, 0, 0.1, 0) == pytest.approx(100 * 0.2**2)


def test_waves_in_time_and_in_position() -> None:
    wave = numbers(law("harmonic", amplitude=3.0, frequency=5.0, phase=0.4).force)
    ripple = numbers(law("ripple", amplitude=3.0, period=0.2, phase=0.4).force)
    assert wave(0, 0, 0, 0.13) == pytest.approx(3 * np.sin(2 * np.pi * 5 * 0.13 + 0.4))
    assert ripple(0.13, 0, 0, 0) == pytest.approx(3 * np.sin(2 * np.pi * 0.13 / 0.2 + 0.4))


def test_an_unknown_kind_is_refused() -> None:
    with pytest.raises(TypeError, match="glue"):
        action_of(Element("it", "glue", On("x"), ()), AT, {})
