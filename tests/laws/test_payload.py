"""A mass that is carried: in every coordinate that moves its point, by inertia and by weight.

hinge o--[l]--o--[l]--o hand        a from hanging, b from the upper link
              m       m
"""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.discrepancy.places.points import point_hypotheses
from symhyb.model.read import parse_model
from symhyb.model.types import At
from symhyb.numeric.lowered.machine import Machine, build

Array = NDArray[np.float64]
MASS, LENGTH, GRAVITY, CARRIED = 1.0, 0.7, 9.81, 0.4
TURNING, BALL = 0.01, 0.004  # of the forearm, of what it carries, kg·m²
Q, V = np.array([0.3, 0.8]), np.array([1.0, -2.0])
ARM = f"""symhyb = 1
gravity = ["0", "-g"]
[coordinates]
a = {{ unit = "rad", start = 0.3 }}
b = {{ unit = "rad", start = 0.2 }}
[parameters]
m = {{ value = {MASS}, unit = "kg" }}
l = {{ value = {LENGTH}, unit = "m" }}
g = {{ value = {GRAVITY}, unit = "m/s^2" }}
[inputs]
ta = {{ unit = "N*m" }}
tb = {{ unit = "N*m" }}
[points]
elbow = ["l*sin(a)", "-l*cos(a)"]
hand = ["l*sin(a) + l*sin(a + b)", "-l*cos(a) - l*cos(a + b)"]
[bodies.upper]
mass = "m"
at = "elbow"
[bodies.fore]
mass = "m"
at = "hand"
[elements.motor_a]
kind = "force"
on = "a"
force = "ta"
[elements.motor_b]
kind = "force"
on = "b"
force = "tb"
[sensors]
sa = {{ measures = "a", unit = "rad" }}
sb = {{ measures = "b", unit = "rad" }}
"""
LOAD = f"""
[elements.load]
kind = "{{}}"
at = "hand"
mass = "carried"
[elements.load.parameters]
carried = {{{{ value = {CARRIED}, unit = "kg" }}}}
"""


def arm(kind: str = "", gravity: bool = True) -> Machine:
    text = ARM if gravity else ARM.replace('gravity = ["0", "-g"]\n', "")
    return build(parse_model(text + (LOAD.format(kind) if kind else ""), "arm.toml"))


def hand(a: float, b: float) -> tuple[Array, Array]:
    """∂p/∂q (2, 2) of the hand, m, and its height, m."""
    s, c = LENGTH * np.sin([a, a + b]), LENGTH * np.cos([a, a + b])
    return np.array([[c.sum(), c[1]], [s.sum(), s[1]]]), -c.sum()


def test_inertia_and_weight_are_those_of_a_mass_at_the_hand() -> None:
    with_load, without = arm("payload"), arm()
    jacobian, _ = hand(*Q)
    added = np.array(with_load.M(Q, 0, with_load.values) - without.M(Q, 0, without.values))
    np.testing.assert_allclose(added, CARRIED * jacobian.T @ jacobian, atol=1e-12)
    forces = [np.array(m.k_e(Q, V, [], [0, 0], 0, m.values)).ravel() for m in (with_load, without)]
    weight = CARRIED * jacobian.T @ np.array([0, -GRAVITY])
    np.testing.assert_allclose(forces[0] - forces[1], weight, atol=1e-12)


def test_without_gravity_it_is_an_added_mass() -> None:
    payload, added = arm("payload", gravity=False), arm("added_mass", gravity=False)
    for one, other in ((payload.M, added.M),):
        np.testing.assert_array_equal(one(Q, 0, payload.values), other(Q, 0, added.values))
    forces = [np.array(m.k_e(Q, V, [], [0, 0], 0, m.values)) for m in (payload, added)]
    np.testing.assert_array_equal(*forces)


def test_it_is_tried_where_there_is_gravity() -> None:
    t = np.linspace(0, 1, 50)
    q, v = np.stack([np.sin(3 * t), np.sin(5 * t)], axis=1), np.ones((50, 2))
    for gravity in (True, False):
        tried = point_hypotheses(arm(gravity=gravity).model, [(q, v, t)], 1e-3)
        found = {h.place for h in tried if h.kind == "payload"}
        assert found == ({At("hand")} if gravity else set())


def turning_arm() -> Machine:
    """The same arm, whose forearm has a small inertia, and the hand fixed to it."""
    where = '["l*sin(a) + l*sin(a + b)", "-l*cos(a) - l*cos(a + b)"]'
    text = ARM.replace(f"hand = {where}", 'hand = { body = "fore", at = ["0", "0"] }')
    text = text.replace('at = "hand"', f'at = {where}\nangle = "a + b"\ninertia = "j"')
    number = f'j = {{ value = {TURNING}, unit = "kg*m^2" }}\n'
    return build(parse_model(text.replace("[inputs]", f"{number}[inputs]"), "arm.toml"))


def recorded(seed: int, inertia: float = 0.0) -> sh.Recording:
    """The arm with a load, by SciPy from equations by hand; the forearm has an ``inertia``."""
    random = np.random.default_rng(seed)
    t = 0.01 * np.arange(800)
    speeds, turns = random.uniform(1, 8, (2, 4)), random.uniform(0, 6, (2, 4))
    sizes = np.array([[8.0], [3.0]]) / 2
    masses = np.array([MASS, MASS + CARRIED])

    def push(now: float) -> Array:
        return np.asarray((sizes * np.sin(speeds * now + turns)).sum(axis=1))

    def rates(now: float, x: Array) -> Array:
        (a, b), (va, vb) = x[:2], x[2:]
        elbow, _ = hand(a, 0.0)
        first, last = np.array([elbow[:, 1], [0, 0]]).T, hand(a, b)[0]
        s, c = LENGTH * np.sin([a, a + b]), LENGTH * np.cos([a, a + b])
        turned = np.array([va, va + vb]) ** 2
        bent = np.array([-s * turned, c * turned])  # of each link, towards its hinge
        mass = masses[0] * first.T @ first + masses[1] * last.T @ last + inertia
        down = np.array([0, -GRAVITY])
        pull = masses[0] * first.T @ (down - bent[:, 0])
        pull += masses[1] * last.T @ (down - bent.sum(axis=1))
        return np.concatenate([x[2:], np.linalg.solve(mass, push(now) + pull)])

    run = solve_ivp(rates, t[[0, -1]], [0.3, 0.2, 0, 0], t_eval=t, rtol=1e-10, atol=1e-10)
    torques = np.array([push(now) for now in t])
    noise = 1e-4 * random.standard_normal((2, t.size))
    seen = run.y[:2] + noise
    return sh.Recording(
        f"run {seed}",
        t,
        {"ta": torques[:, 0], "tb": torques[:, 1]},
        {"sa": seen[0], "sb": seen[1]},
    )


@pytest.mark.slow
def test_a_load_in_the_hand_is_named_and_nothing_else() -> None:
    diagnosis = sh.diagnose(arm().model, recorded(1), recorded(2))
    (found,) = diagnosis.found
    assert (found.element.kind, found.element.place) == ("payload", At("hand"))
    (mass,) = found.estimates
    assert mass.value == pytest.approx(CARRIED, rel=0.01)
    assert abs(mass.value - CARRIED) < 3 * mass.sd
    assert "a payload of 0.3999" in found.sentence


@pytest.mark.slow
def test_a_load_that_is_no_point_has_an_inertia_of_its_own() -> None:
    runs = [recorded(seed, TURNING + BALL) for seed in (1, 2)]
    diagnosis = sh.diagnose(turning_arm().model, *runs)
    found = {one.element.kind: one for one in diagnosis.found}
    assert found.keys() == {"payload", "added_inertia"}
    for kind, true in (("payload", CARRIED), ("added_inertia", BALL)):
        (number,) = found[kind].estimates
        assert found[kind].element.place == At("hand")
        assert abs(number.value - true) < 3 * number.sd < 0.1 * true
    assert "added inertia of" in diagnosis.sentence
