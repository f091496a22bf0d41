"""The five-bar robot against its mechanics in the two angles of its motors, written by hand.

The hand lies where two circles about the knees meet; CasADi differentiates.
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
    """(motor angles, rates, torques) -> all four angles, their rates and accelerations, and the
    kinetic energy."""
    p = numbers("five_bar")
    free, rate, torque = (ca.SX.sym(name, 2) for name in ("free", "rate", "torque"))
    bases = [ca.vertcat(0, 0), ca.vertcat(p["w"], 0)]
    arms = [ca.vertcat(ca.cos(free[i]), ca.sin(free[i])) for i in range(2)]
    knees = [base + p["a"] * arm for base, arm in zip(bases, arms, strict=True)]
    apart = knees[1] - knees[0]
    half = ca.norm_2(apart) / 2
    up = ca.vertcat(-apart[1], apart[0]) / (2 * half)
    hand = (knees[0] + knees[1]) / 2 + ca.sqrt(p["b"] ** 2 - half**2) * up
    rods = [hand - knee for knee in knees]
    turns = [ca.atan2(rod[1], rod[0]) for rod in rods]
    heavy = [(p["m_h"], hand)]
    heavy += [(p["m_a"], base + p["a"] / 2 * arm) for base, arm in zip(bases, arms, strict=True)]
    heavy += [(p["m_b"], knee + rod / 2) for knee, rod in zip(knees, rods, strict=True)]
    turning = [(p["J_a"], free[0]), (p["J_a"], free[1]), *((p["J_b"], turn) for turn in turns)]
    kinetic = sum(m / 2 * ca.sumsqr(ca.jtimes(at, free, rate)) for m, at in (*heavy, *turning))
    momentum = ca.gradient(kinetic, rate)
    mass = ca.jacobian(momentum, rate)
    swing = ca.jtimes(momentum, free, rate) - ca.gradient(kinetic, free)
    acceleration = ca.solve(mass, torque - swing)
    q = ca.vertcat(free, turns[0] - free[0], turns[1] - free[1])
    v = ca.jtimes(q, free, rate)
    a = ca.jtimes(v, free, rate) + ca.jtimes(v, rate, acceleration)
    return ca.Function("five_bar", [free, rate, torque], [q, v, a, kinetic])


def test_accelerations_agree_at_1000_states() -> None:
    machine, random, worst = machine_of("five_bar"), np.random.default_rng(4), 0.0
    for _ in range(1000):
        free = np.radians([random.uniform(80, 160), random.uniform(20, 100)])
        rate, torque = 5 * random.normal(size=2), random.normal(size=2)
        q, v, a, _ = (np.array(part).ravel() for part in by_hand()(free, rate, torque))
        given = q, v, EMPTY, torque, 0.0, machine.values
        (found,) = call(machine.acceleration, (*given, np.zeros(4), EMPTY))
        worst = max(worst, np.abs(found[0] - a).max() / np.abs(a).max())
    assert worst < 1e-9


def test_a_run_under_torques_stays_closed_and_takes_up_their_work() -> None:
    machine = machine_of("five_bar")
    start, t = [np.array(part) for part in machine.model.start()], np.linspace(0, 1, 1001)
    u = 0.1 * np.column_stack([np.sin(9 * t), -np.cos(7 * t)])
    run = simulate(machine, Scenario(t, *start, t, u))
    assert run.complete, run.reason
    gaps = gaps_of(machine, run.q, run.v, run.a, t, machine.values)
    assert np.abs(gaps.gap).max() < 1e-8
    energy = [float(by_hand()(q[:2], v[:2], [0, 0])[3]) for q, v in zip(run.q, run.v, strict=True)]
    power = np.sum(u * run.v[:, :2], axis=1)
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(t))])
    assert np.array(energy) == pytest.approx(work, abs=1e-5 * max(energy))
    by_angles = np.array(
        [
            np.array(by_hand()(q[:2], v[:2], [0, 0])[0]).ravel()
            for q, v in zip(run.q, run.v, strict=True)
        ]
    )
    assert np.abs(run.q - by_angles).max() < 1e-8
