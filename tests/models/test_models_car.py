"""The car against its mechanics in x, twist and pitch, written by hand.

The wheels roll and the gears mesh, so that wheels and engine follow; CasADi differentiates.
"""

from functools import cache

import casadi as ca
import numpy as np
import pytest
from shipped import machine_of
from textbook import numbers

from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.manifold import gaps_of
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

EMPTY = np.empty(0)


@cache
def by_hand() -> ca.Function:
    """(x, twist, theta), their rates, the torque -> all five coordinates, rates and accelerations,
    and the power of all forces but those that the energy holds; the energy."""
    p = numbers("car")
    free, rate, torque = ca.SX.sym("free", 3), ca.SX.sym("rate", 3), ca.SX.sym("torque")
    x, twist, theta = ca.vertsplit(free)
    wheel = x / p["r"]
    q = ca.vertcat(x, wheel, p["n"] * (wheel + twist), twist, theta)
    v = ca.jtimes(q, free, rate)
    centre = ca.vertcat(x - p["h"] * ca.sin(theta), p["h"] * ca.cos(theta))
    kinetic = p["m_b"] / 2 * ca.sumsqr(ca.jtimes(centre, free, rate)) + p["J_b"] / 2 * v[4] ** 2
    kinetic += p["m_w"] / 2 * v[0] ** 2 + p["J_w"] / 2 * v[1] ** 2 + p["J_m"] / 2 * v[2] ** 2
    up = ca.vertcat(ca.sin(p["slope"]), ca.cos(p["slope"]))
    potential = p["m_b"] * p["g"] * ca.dot(centre, up) + p["m_w"] * p["g"] * x * up[0]
    potential += p["k"] / 2 * twist**2 + p["k_p"] / 2 * theta**2
    loss = ca.vertcat(
        p["c_a"] * ca.fabs(rate[0]) * rate[0] + p["f_r"], p["d"] * rate[1], p["d_p"] * rate[2]
    )
    drive = torque * ca.gradient(q[2], free)
    momentum = ca.gradient(kinetic, rate)
    mass = ca.jacobian(momentum, rate)
    pull = drive - loss - ca.gradient(potential, free)
    swing = ca.jtimes(momentum, free, rate) - ca.gradient(kinetic, free)
    acceleration = ca.solve(mass, pull - swing)
    a = ca.jtimes(v, free, rate) + ca.jtimes(v, rate, acceleration)
    power = ca.dot(drive - loss, rate)
    return ca.Function("car", [free, rate, torque], [q, v, a, power, kinetic + potential])


def test_accelerations_agree_at_1000_states() -> None:
    machine, random, worst = machine_of("car"), np.random.default_rng(4), 0.0
    for _ in range(1000):
        free, rate = random.normal(size=3) * [50, 0.1, 0.1], random.normal(size=3) * [20, 2, 0.5]
        torque = 100 * random.normal()
        q, v, a, *_ = (np.array(part).ravel() for part in by_hand()(free, rate, torque))
        given = q, v, EMPTY, [torque], 0.0, machine.values
        (found,) = call(machine.acceleration, (*given, np.zeros(5), EMPTY))
        worst = max(worst, np.abs(found[0] - a).max() / np.abs(a).max())
    assert worst < 1e-9


def test_it_pulls_away_without_slip_and_takes_up_the_work() -> None:
    machine = machine_of("car")
    start, t = [np.array(part) for part in machine.model.start()], np.linspace(0, 5, 5001)
    u = 60 * (1 - np.exp(-t / 0.2))[:, None] + 20 * np.sin(40 * t)[:, None]
    run = simulate(machine, Scenario(t, *start, t, u))
    assert run.complete, run.reason
    gaps = gaps_of(machine, run.q, run.v, run.a, t, machine.values)
    assert np.abs(gaps.gap).max() < 1e-8
    chosen = [0, 3, 4]
    rows = [
        [np.array(part).ravel() for part in by_hand()(q[chosen], v[chosen], torque)]
        for q, v, torque in zip(run.q, run.v, u, strict=True)
    ]
    power, energy = (np.array([row[i][0] for row in rows]) for i in (3, 4))
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(t))])
    assert energy - energy[0] == pytest.approx(work, abs=1e-5 * np.abs(work).max())
    assert np.abs(run.q - [row[0] for row in rows]).max() < 1e-7
    assert run.v[-1, 0] > 5.0  # m/s


def test_its_shafts_jerk_at_the_frequency_of_two_inertias() -> None:
    """Engine against car: ω² = k (1/J_engine + 1/J_car), both as the shafts feel them."""
    p, machine = numbers("car"), machine_of("car")
    car = p["J_w"] + (p["m_w"] + p["m_b"]) * p["r"] ** 2
    expected = np.sqrt(p["k"] * (1 / (p["n"] ** 2 * p["J_m"]) + 1 / car)) / (2 * np.pi)
    values = machine.values.copy()
    values[machine.column("d")] = 0.0
    values[machine.column("k_p")] = 1e9  # a body that does not pitch
    t = np.linspace(0, 2, 20001)
    q0 = np.array(by_hand()([0, 0.01, 0], [20, 0, 0], 0)[0]).ravel()
    v0 = np.array(by_hand()([0, 0.01, 0], [20, 0, 0], 0)[1]).ravel()
    run = simulate(machine, Scenario(t, q0, v0, t, np.zeros((t.size, 1))), values)
    twist = run.q[:, 3] - run.q[:, 3].mean()
    ups = t[1:][(twist[:-1] < 0) & (twist[1:] >= 0)]
    assert 1 / np.diff(ups).mean() == pytest.approx(expected, rel=2e-3)
