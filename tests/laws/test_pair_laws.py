r"""Laws of a pair of coordinates: signs, units, energy, exported C, against SciPy by hand.

^ b
│ ▲ F_b       M q'' = −K q − D q' + (F_a, F_b) + u
│ └──▶ F_a
└────────▶ a
"""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.errors import InputError
from symhyb.laws import LAWS
from symhyb.laws.base import Law
from symhyb.laws.maths import Motion
from symhyb.mechanics.show import show_equations
from symhyb.model.read import parse_model
from symhyb.model.types import Model, Pair
from symhyb.model.vocabulary import key_unit
from symhyb.numeric.lowered.machine import build
from symhyb.report.sketch import sketch_of

BASE = """\
symhyb = 1
[coordinates]
x = { unit = "m", start = 0.02 }
phi = { unit = "rad", start = -0.05, start_rate = 0.3 }
[parameters]
m = { value = 1.5, unit = "kg" }
J = { value = 0.2, unit = "kg*m^2" }
k = { value = 90, unit = "N/m" }
c = { value = 20, unit = "N*m/rad" }
[points]
rail = ["x", "0"]
[bodies.slide]
mass = "m"
at = "rail"
[bodies.wheel]
mass = "m"
at = ["0", "0"]
inertia = "J"
angle = "phi"
[elements.first]
kind = "spring"
on = "x"
stiffness = "k"
[elements.second]
kind = "spring"
on = "phi"
stiffness = "c"
[sensors]
x_seen = { measures = "x", unit = "m" }
phi_seen = { measures = "phi", unit = "rad" }
"""
MATRICES = {  # of the force by (a, b) and by (a', b'), for a number of 1
    "gyroscopic": (np.zeros((2, 2)), np.array([[0.0, 1.0], [-1.0, 0.0]])),
    "circulatory": (np.array([[0.0, 1.0], [-1.0, 0.0]]), np.zeros((2, 2))),
    "skew_spring": (np.array([[0.0, -1.0], [-1.0, 0.0]]), np.zeros((2, 2))),
    "skew_damper": (np.zeros((2, 2)), np.array([[0.0, -1.0], [-1.0, 0.0]])),
}
UNITS = {"gyroscopic": "N*s/rad", "circulatory": "N/rad", "skew_spring": "N/rad"}
UNITS["skew_damper"] = "N*s/rad"
PAIRED = [law for law in LAWS if law.coupling is not None]


def named(law: Law) -> str:
    return law.name


def element(law: Law, value: float = 1.7, pair: str = '["x", "phi"]') -> str:
    (key,) = law.strengths
    unit = UNITS[law.name]
    return (
        f'[elements.coupling]\nkind = "{law.name}"\npair = {pair}\n{key} = "g"\n'
        f'[elements.coupling.parameters]\ng = {{ value = {value}, unit = "{unit}" }}\n'
    )


def run(model: Model, t: np.ndarray) -> Any:
    q, v = (np.array(part) for part in model.start())
    return sh.simulate(build(model), sh.Scenario(t, q, v, t[[0, -1]], np.zeros((2, 0))))


def test_the_four_laws_are_all_that_is_linear_in_the_other_coordinate() -> None:
    assert [law.name for law in PAIRED] == list(MATRICES)
    each = [np.concatenate([part[[0, 1], [1, 0]] for part in MATRICES[law.name]]) for law in PAIRED]
    assert np.linalg.matrix_rank(np.array(each)) == 4


@pytest.mark.parametrize("law", PAIRED, ids=named)
def test_a_coupling_acts_as_by_hand(law: Law) -> None:
    model = parse_model(BASE + element(law))
    t = np.linspace(0.0, 2.0, 201)
    made = run(model, t)
    by_place, by_rate = (1.7 * part for part in MATRICES[law.name])
    mass, stiffness = np.diag([1 / 1.5, 1 / 0.2]), np.diag([90.0, 20.0])

    def rate(_: float, state: np.ndarray) -> np.ndarray:
        q, v = state[:2], state[2:]
        return np.concatenate([v, mass @ (-stiffness @ q + by_place @ q + by_rate @ v)])

    hand = solve_ivp(rate, (0, 2), [0.02, -0.05, 0.0, 0.3], t_eval=t, rtol=1e-10, atol=1e-12)
    assert made.y == pytest.approx(hand.y[:2].T, abs=2e-7)
    bare = run(parse_model(BASE), t)
    assert np.abs(made.y - bare.y).max() > 1e-3


@pytest.mark.parametrize("law", PAIRED, ids=named)
def test_energy_is_what_the_law_says(law: Law) -> None:
    """The power that it puts in: none of a gyroscopic law, what a coupling spring gives back, the
    swept area of a circulatory law in an orbit, −2d·a'·b' of a coupling damper."""
    assert law.coupling is not None
    t = np.linspace(0.0, 2 * np.pi, 4001)
    a, da, b, db = np.sin(t), np.cos(t), 0.5 * np.cos(t - 0.4), -0.5 * np.sin(t - 0.4)
    (value,) = law.example.values()
    does = law.coupling(Motion(a, da, (), t), Motion(b, db, (), t), law.example)
    power = does.push[0] * da + does.push[1] * db
    work = float(np.trapezoid(power, t))
    if law.name == "gyroscopic":
        assert np.abs(power).max() < 1e-12
    if law.name == "skew_spring":
        assert np.gradient(does.stored, t)[1:-1] == pytest.approx(-power[1:-1], abs=1e-3)
        assert abs(work) < 1e-6
    if law.name == "circulatory":
        area = float(np.trapezoid(a * db - b * da, t)) / 2
        assert work == pytest.approx(-2 * value * area, rel=1e-6)
    if law.name == "skew_damper":
        assert power == pytest.approx(-2 * value * da * db)


@pytest.mark.parametrize("law", PAIRED, ids=named)
def test_units_are_the_same_whichever_comes_first(law: Law) -> None:
    model = parse_model(BASE)
    (key,) = law.strengths
    units = [key_unit(model, law.name, key, Pair(*names)) for names in (("x", "phi"), ("phi", "x"))]
    assert [unit.text for unit in units] == [UNITS[law.name]] * 2
    lengths = parse_model(BASE.replace("[parameters]", 'y = { unit = "mm" }\n[parameters]'))
    assert key_unit(lengths, law.name, key, Pair("x", "y")).text == UNITS[law.name].replace(
        "rad", "m"
    )


def test_a_pair_of_expressions_pushes_all_coordinates_in_them() -> None:
    text = BASE + element(PAIRED[0], pair='["x", "x/(1 m) - 2*phi"]').replace('"N*s/rad"', '"N*s"')
    machine = build(parse_model(text))
    q, v = np.array([0.1, 0.2]), np.array([0.7, -0.4])
    p, u = machine.values, np.zeros(0)
    forces = np.asarray(machine.elements(q, v, [], u, 0.0, p)).reshape(2, -1)
    g, a, b = 1.7, v[0], v[0] - 2 * v[1]
    assert forces[:, -1] == pytest.approx([g * b - g * a, 2 * g * a])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('["x", "phi"]', '["x", "x"]', "couples 'x' with itself"),
        ('["x", "phi"]', '"x"', "must be a list of two coordinates"),
        ('["x", "phi"]', '["x", "psi"]', "'psi' is not a known coordinate"),
        ('["x", "phi"]', '["x", "m"]', "'m' is not a known coordinate"),
        ('pair = ["x", "phi"]', 'on = "x"', "cannot stand 'on'; it needs 'pair'"),
        ("N*s/rad", "N/rad", "needs N*s/rad"),
    ],
)
def test_what_is_wrong_with_a_pair_is_said(old: str, new: str, said: str) -> None:
    text = BASE + element(PAIRED[0]).replace(old, new)
    with pytest.raises(InputError, match=r".") as caught:
        parse_model(text, "file")
    assert said in str(caught.value)


def test_a_pair_has_no_one_force_and_others_no_pair() -> None:
    cell = 'cell = { measures = "force(coupling)", unit = "N" }\n'
    with pytest.raises(InputError, match="pushes two coordinates"):
        parse_model(BASE + cell + element(PAIRED[0]))
    spring = '[elements.e]\nkind = "spring"\npair = ["x", "phi"]\nstiffness = "k"\n'
    with pytest.raises(InputError, match="cannot stand 'pair'"):
        parse_model(BASE + spring)


def test_equations_and_a_drawing_hold_it() -> None:
    model = parse_model(BASE + element(PAIRED[0]))
    text = show_equations(model)
    assert "coupling.g*phi'" in text
    assert "-coupling.g*x'" in text
    drawn = sketch_of(model)
    assert any(mark.name == "coupling" for mark in drawn.marks)
    assert not any("coupling" in said for said in drawn.left_out)
