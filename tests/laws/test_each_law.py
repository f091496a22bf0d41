"""Every law by itself: units, bounds, energy over a cycle, candidates and words.

The examples of the laws are moved by s = 0.3·sin 5t, SI, so that rates reach 1.5.
"""

import subprocess
import sys
from functools import cache
from typing import Any

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import solve_ivp

from symhyb.discrepancy.places.candidates import hypothesis_of
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.results import Estimate
from symhyb.discrepancy.words.wording import effect_phrase, effect_sentence
from symhyb.laws import LAWS
from symhyb.laws.base import Key, Law
from symhyb.laws.characteristic import Characteristic, through
from symhyb.laws.maths import NUMPY, Action, Motion
from symhyb.laws.reach import Reach
from symhyb.laws.surface import Surface, bilinear
from symhyb.laws.variants import Pace
from symhyb.mechanics.laws import action_of
from symhyb.model.curves import Curve
from symhyb.model.maps import Map
from symhyb.model.types import Coordinate, Element, Model, On
from symhyb.model.vocabulary import key_unit
from symhyb.units import ONE, parse_unit

AMPLITUDE, PACE = 0.3, 5.0
CYCLE = 2 * np.pi / PACE
SETTLED = 30  # cycles, after which a mode swings as it is driven
ACTING = [law for law in LAWS if law.action is not None]
LAW_OF = {law.name: law for law in LAWS}
PASSIVE = [law for law in ACTING if law.passive]
WORDED = [law for law in ACTING if law.strengths and any(not key.signal for key in law.keys)]
POINTS = ((-2.0, -3.0), (-1.0, -2.5), (-0.2, -1.0), (0.0, 0.0), (0.3, 0.5), (1.2, 0.7))
CURVE = through("c", *zip(*POINTS, strict=True))
GRID = ((-0.3, 0.0, 0.2), (-2.0, 0.0, 1.0), ((-3.0, 0.0, 2.0), (-2.0, 0.0, 1.0), (-4.0, 0.0, 3.0)))
MAP = Map("m", *GRID, (ONE, ONE, ONE))
MODEL = Model("", (Coordinate("x", parse_unit("m")),), energy_unit=parse_unit("J"))


def named(law: Law) -> str:
    return law.name


def numeric(law: Law) -> list[Key]:
    """The keys that are numbers: neither words nor expressions of a whole force."""
    return [key for key in law.keys if not key.choices and not key.signal and key.name != "length"]


def table_of(law: Law) -> dict[str, Characteristic | Surface]:
    """What a curve or a map runs through beside the values of its keys."""
    return {"curve": {"curve": CURVE}, "map": {"map": MAP.surface}}.get(law.name, {})


def options_of(law: Law) -> dict[str, str]:
    return {"over": "rate"} if law.name == "curve" else {}


def acts(law: Law, motion: Motion, values: dict[str, Any] | None = None) -> Action:
    assert law.action is not None
    given = {**law.example, **table_of(law)} if values is None else values
    return law.action(NUMPY, motion, given, options_of(law))


@cache
def cycle(law: Law) -> tuple[Motion, Action]:
    """The law along the third of three cycles, or of many where a memory is long to settle, its
    inner states from rest."""

    def motion(t: np.ndarray, z: tuple[np.ndarray, ...]) -> Motion:
        s = AMPLITUDE * np.sin(PACE * t)
        return Motion(s, AMPLITUDE * PACE * np.cos(PACE * t), z, t)

    last = SETTLED if len(law.states) > 1 else 3
    t = np.linspace((last - 1) * CYCLE, last * CYCLE, 4001)
    z: tuple[np.ndarray, ...] = ()
    if law.states:

        def rate(at: float, z: np.ndarray) -> np.ndarray:
            return np.array(acts(law, motion(np.array(at), tuple(z))).inner)

        begun = np.zeros(len(law.states))
        done = solve_ivp(rate, (0, t[-1]), begun, "LSODA", t, rtol=1e-8, atol=1e-12)
        assert done.success
        z = tuple(done.y)
    along = motion(t, z)
    return along, acts(law, along)


def integral(of: np.ndarray, motion: Motion) -> float:
    return float(np.trapezoid(of * np.ones_like(motion.t), motion.t))


@pytest.mark.parametrize("law", PASSIVE, ids=named)
def test_a_passive_law_gives_back_no_more_than_it_took(law: Law) -> None:
    motion, does = cycle(law)
    work = integral(does.force * motion.r, motion)
    size = integral(np.abs(does.force * motion.r), motion)
    if law.energy == "dissipative":
        assert work > 1e-3 * size > 0
    else:
        assert abs(work) <= 1e-5 * size


@pytest.mark.parametrize("law", PASSIVE, ids=named)
def test_what_is_stored_and_lost_is_the_power_that_goes_in(law: Law) -> None:
    """F·s' − dU/dt is the power that is lost: never negative, zero of a conservative law; so the
    slope of the energy is the elastic force."""
    motion, does = cycle(law)
    step = 1e-7
    ahead = Motion(
        motion.s + step * motion.r,
        motion.r,
        tuple(z + step * rate for z, rate in zip(motion.z, does.inner, strict=True)),
        motion.t,
    )
    grown = (acts(law, ahead).stored - does.stored) / step
    lost = does.force * motion.r - grown
    tolerance = 1e-4 * (np.max(np.abs(does.force * motion.r)) + 1e-12)
    assert np.min(lost) >= -tolerance
    if law.energy == "conservative":
        assert np.max(np.abs(lost)) <= tolerance


@pytest.mark.parametrize("law", [law for law in ACTING if not law.passive], ids=named)
def test_an_active_law_stores_nothing(law: Law) -> None:
    _, does = cycle(law)
    assert np.all(does.stored == 0)
    assert np.any(does.force != 0)


@pytest.mark.parametrize("law", ACTING, ids=named)
def test_the_declared_units_are_those_of_the_law(law: Law) -> None:
    """In other units of force, length and time, all numbers change and the physics does not."""
    newton, metre, second = 5.0, 1000.0, 2.0
    motion, does = cycle(law)
    n = law.example.get("exponent", 1.0)
    values: dict[str, Any] = {}
    if law.name == "curve":
        x, y = np.array(POINTS).T
        values["curve"] = through("other", x * metre / second, y * newton)
    if law.name == "map":
        s, r, rows = map(np.array, GRID)
        values["map"] = bilinear("other", s * metre, r * metre / second, rows * newton)
    for key, value in law.example.items():
        declared = law.key(key)
        assert declared is not None
        length = metre ** (declared.stretch * (n if declared.exponent else 1.0))
        values[key] = value * newton**declared.force * length * second**declared.time
    units = [metre * second**state.time for state in law.states]
    z = tuple(unit * one for unit, one in zip(units, motion.z, strict=True))
    other = Motion(metre * motion.s, metre / second * motion.r, z, second * motion.t)
    changed = acts(law, other, values)
    scale = np.max(np.abs(does.force))
    assert changed.force == pytest.approx(newton * does.force, rel=1e-9, abs=1e-9 * newton * scale)
    assert changed.stored == pytest.approx(newton * metre * does.stored, rel=1e-9, abs=1e-12)
    heavy = newton * second**2 * (metre if law.turns else 1 / metre)  # of an inertia, of a mass
    assert changed.mass == pytest.approx(heavy * does.mass, rel=1e-9)
    for unit, mine, its in zip(units, does.inner, changed.inner, strict=True):
        assert its == pytest.approx(unit / second * mine, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("law", ACTING, ids=named)
def test_the_equations_hold_the_same_law(law: Law) -> None:
    symbols = s, r, *z, t = sp.symbols(
        ["s", "r", *(state.name for state in law.states), "t"], real=True
    )
    values = {key: sp.Float(value) for key, value in law.example.items()}
    curve = Curve("c", POINTS, (ONE, ONE)) if law.name == "curve" else None
    grid = MAP if law.name == "map" else None
    options = tuple(options_of(law).items())
    element = Element("it", law.name, On("x"), (), options=options, curve=curve, map=grid)
    built = action_of(element, Motion(s, r, tuple(z), t), values)
    motion, does = cycle(law)
    given = (motion.s, motion.r, *motion.z, motion.t)
    force = sp.lambdify(symbols, built.force, [{"c": CURVE, "m": MAP.surface}, "numpy"])(*given)
    stored = sp.lambdify(symbols, built.stored, "numpy")(*given)
    assert force * np.ones_like(motion.t) == pytest.approx(does.force * np.ones_like(motion.t))
    assert stored * np.ones_like(motion.t) == pytest.approx(does.stored * np.ones_like(motion.t))
    assert len(built.inner) == len(built.rest) == len(law.states)
    assert bool(built.mass != 0) == law.inertial


@pytest.mark.parametrize("law", ACTING, ids=named)
def test_the_example_sets_every_number_and_keeps_to_the_bounds(law: Law) -> None:
    keys = {key.name: key for key in law.keys}
    assert {key.name for key in numeric(law)} <= set(law.example) <= set(keys)
    for name, value in law.example.items():
        assert keys[name].lower <= value <= keys[name].upper
        assert keys[name].reach > 1
        assert not keys[name].exponent or keys[name].exponent in keys
        assert keys[name].above is None or keys[name].above[1] > 0
    for key in (*law.strengths, *law.needs, law.resists, law.pushes, law.critical):
        assert not key or key in keys
    assert len({key.symbol or key.name for key in law.keys}) == len(law.keys)


def reach(length: float | None = None) -> Reach:
    """What a place moves through that swings about 0.1, with lines in the force that is lacking."""
    t = np.arange(4000) / 200
    s = AMPLITUDE * np.sin(PACE * t) + 0.1 * np.sin(2.3 * t) + 0.1
    rng = np.random.default_rng(4)
    force = np.sin(2 * np.pi * 7.3 * t) + np.sin(2 * np.pi * s / 0.05) + 0.1 * rng.normal(size=4000)
    return Reach(s, np.gradient(s, t), force, t, length)


def hypotheses(law: Law) -> list[Hypothesis]:
    return [hypothesis_of(law.name, On("x"), tried) for tried in law.candidates(reach())]


WITH_CANDIDATES = [law for law in LAWS if hypotheses(law)]


@pytest.mark.parametrize("law", WITH_CANDIDATES, ids=named)
def test_what_is_tried_lies_within_its_bounds(law: Law) -> None:
    for hypothesis in hypotheses(law):
        shape = dict(hypothesis.shape)
        assert set(hypothesis.refined) <= set(shape)
        assert len(hypothesis.terms) == len(hypothesis.positive)
        for key in (*hypothesis.keys, *shape):
            assert law.key(key) is not None
        for key in set(hypothesis.refined) - set(hypothesis.tied):
            lower, upper = hypothesis.limits(key)
            assert lower <= shape[key] <= upper
            assert lower < upper
    orders = [tried.order for tried in law.candidates(reach())]
    assert orders == sorted(orders)


@pytest.mark.parametrize("law", WITH_CANDIDATES, ids=named)
def test_the_force_of_what_is_tried_grows_with_its_coefficients(law: Law) -> None:
    """The screen is linear in the coefficients: twice of each is twice the force, and the mass."""
    place = reach()
    z = tuple(0.1 * place.stretch for _ in law.states)
    motion = Motion(place.stretch, place.rate, z, place.t)
    for hypothesis in hypotheses(law):
        first = [1.3, 0.4][: len(hypothesis.terms)]
        sums = []
        for factor in (1.0, 2.0):
            coefficients = [factor * c for c in first]
            values = {**dict(hypothesis.shape), **hypothesis.values(coefficients)}
            assert law.action is not None
            does = law.action(NUMPY, motion, values, dict(hypothesis.options))
            sums.append(does.force + does.mass * np.ones_like(motion.t))
        assert sums[1] == pytest.approx(2 * sums[0], rel=1e-9, abs=1e-12)
        assert np.any(sums[0] != 0)


@pytest.mark.parametrize("law", WITH_CANDIDATES, ids=named)
def test_a_variant_begins_with_its_keys_and_each_is_added_once(law: Law) -> None:
    """With an added key the law is not varied by it again, so that the variants come to an end."""
    pace = Pace(1.0, 1.5, 0.2)
    row = {**law.example, "stiffness": 200.0}
    plain = {key for tried in hypotheses(law) for key in tried.keys}
    for variant in law.variants({k: v for k, v in row.items() if k in plain}, pace, ()):
        keys = LAW_OF[variant.law or law.name].keys
        assert set(variant.first) <= {key.name for key in keys}
        assert {*variant.added, *variant.tried} <= set(variant.first)
        assert set(variant.tied) <= set(variant.added)
        assert all(np.isfinite(value) for value in variant.first.values())
        own = [v for v in law.variants({**row, **variant.first}, pace, variant.added) if not v.law]
        assert not any(set(other.added) & set(variant.added) for other in own)


@pytest.mark.parametrize("law", WORDED, ids=named)
def test_an_effect_is_worded_with_its_numbers(law: Law) -> None:
    keys = [key for key in numeric(law) if key.name != "asymmetry"]
    n = law.example.get("exponent", 1.0)
    estimates = []
    for key in keys:
        unit, value = key_unit(MODEL, law.name, key.name, On("x"), n), law.example[key.name]
        name = key.symbol or key.name
        estimates.append(Estimate(name, value, 0.01 * abs(value), unit.text, key.name))
    sentence = effect_sentence(law.name, On("x"), estimates, 0.4)
    assert sentence.startswith("On x, ")
    assert sentence.endswith(".")
    assert "not known" not in sentence
    strength = law.key(law.strengths[0])
    assert strength is not None
    assert f"{abs(law.example[strength.name]):g}" in sentence.replace("\N{MINUS SIGN}", "")
    assert effect_phrase(law.name, []) != ""


@pytest.mark.parametrize("law", ACTING, ids=named)
def test_the_law_as_text_holds_every_key_that_is_set(law: Law) -> None:
    text = law.text(list(law.example), {})
    assert [key.name for key in numeric(law) if key.name not in text] == []


def test_the_laws_have_their_own_names_and_load_no_heavy_library() -> None:
    assert len({law.name for law in LAWS}) == len(LAWS)
    code = "import sys, symhyb.laws; print({'sympy', 'casadi', 'scipy'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
