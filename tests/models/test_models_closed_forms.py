"""Shipped models against formulas: what a textbook says of each, with numbers by hand."""

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.special import ellipj, ellipk
from shipped import machine_of
from textbook import entries, numbers

from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario


def run(
    name: str, end: float, q: list[float], v: list[float], u: list[float] | None = None
) -> Trajectory:
    """A run with constant inputs."""
    t, held = np.linspace(0, end, 201), np.array(u or [], dtype=float)
    t_u = np.array([0.0, end])
    scenario = Scenario(t, np.array(q), np.array(v), t_u, np.array([held, held]))
    done = simulate(machine_of(name), scenario)
    assert done.complete, done.reason
    return done


def test_a_ball_falls_towards_its_terminal_speed() -> None:
    p = numbers("falling_ball")
    drag = p["rho"] * p["c_d"] * np.pi * p["r"] ** 2 / 2
    terminal = np.sqrt(p["m"] * p["g"] / drag)
    done = run("falling_ball", 12.0, [0.0, 45.0], [0.0, 0.0])
    fallen = terminal**2 / p["g"] * np.log(np.cosh(p["g"] * done.t / terminal))
    assert done.q[:, 1] == pytest.approx(45 - fallen, rel=1e-6, abs=1e-6)
    assert done.v[:, 1] == pytest.approx(-terminal * np.tanh(p["g"] * done.t / terminal), rel=1e-6)
    assert done.v[-1, 1] == pytest.approx(-terminal, rel=1e-4)
    assert np.all(done.q[:, 0] == 0)


def test_a_dropped_ball_falls_along_a_parabola() -> None:
    done = run("dropped_ball", 3.0, [45.0], [0.0])
    assert done.q[:, 0] == pytest.approx(
        45 - numbers("dropped_ball")["g"] * done.t**2 / 2, abs=1e-6
    )


def test_a_cubic_spring_swings_as_an_elliptic_function() -> None:
    p, size = numbers("oscillator"), 0.4
    done = run("oscillator", 5.0, [size], [0.0], [0.0])
    cn = ellipj(size * np.sqrt(p["c"] / p["m"]) * done.t, 0.5)[1]
    assert done.q[:, 0] == pytest.approx(size * cn, abs=2e-6 * size)


def test_a_pendulum_swings_with_the_period_of_the_elliptic_integral() -> None:
    p, size = numbers("pendulum"), 2.5
    slow = np.sqrt(p["m"] * p["g"] * p["l"] / (p["J"] + p["m"] * p["l"] ** 2))
    period = 4 / slow * ellipk(np.sin(size / 2) ** 2)
    done = run("pendulum", 10 * period, [size], [0.0])
    assert done.q[-1, 0] == pytest.approx(size, abs=1e-5)
    assert done.q[10::20, 0] == pytest.approx(-size, abs=1e-5)  # half a period later


def test_linear_machines_ring_at_their_frequency() -> None:
    duffing = numbers("duffing")
    done = run("duffing", 2.0, [0.01], [0.0], [0.0])
    swing = np.cos(np.sqrt(duffing["k"] / duffing["m"]) * done.t)
    assert done.q[:, 0] == pytest.approx(0.01 * swing, abs=1e-8)
    ship = numbers("ship_roll")
    inertia, righting = ship["m"] * ship["i"] ** 2 + ship["A"], ship["m"] * ship["g"] * ship["GM"]
    done = run("ship_roll", 10.0, [0.1], [0.0])
    assert done.q[:, 0] == pytest.approx(
        0.1 * np.cos(np.sqrt(righting / inertia) * done.t), abs=1e-7
    )


def test_the_silverbox_answers_a_step() -> None:
    p = numbers("silverbox")
    decay, size = p["d"] / (2 * p["m"]), 0.05
    ring = np.sqrt(p["k"] / p["m"] - decay**2)
    done = run("silverbox", 0.1, [0.0], [0.0], [size])
    t = done.t
    swing = np.exp(-decay * t) * (np.cos(ring * t) + decay / ring * np.sin(ring * t))
    assert done.q[:, 0] == pytest.approx(size / p["k"] * (1 - swing), abs=1e-6 * size)


def test_the_drive_accelerates_evenly() -> None:
    done = run("emps", 1.0, [0.0], [0.0], [30.0])
    assert done.q[:, 0] == pytest.approx(30 * done.t**2 / (2 * numbers("emps")["M"]), abs=1e-9)


@pytest.mark.parametrize("mode", [1, 2, 3, 4])
def test_a_chain_of_masses_swings_in_its_modes(mode: int) -> None:
    p = numbers("chain_of_masses")
    shape = 1e-3 * np.sin(np.pi * mode * np.arange(1, 5) / 5)
    pitch = 2 * np.sqrt(p["k"] / p["m"]) * np.sin(mode * np.pi / 10)
    done = run("chain_of_masses", 0.5, list(shape), [0.0] * 4, [0.0])
    assert done.q == pytest.approx(np.outer(np.cos(pitch * done.t), shape), abs=2e-9)


def test_a_rotor_stays_on_the_orbit_of_its_imbalance() -> None:
    p = numbers("rotor_imbalance")
    w, sag = p["spin"], p["m"] * p["g"] / p["k_y"]
    push = p["m"] * p["e"] * w**2  # along exp(i w t) across, along −i exp(i w t) upright
    across = push / (p["k_x"] - p["m"] * w**2 + 1j * w * p["d"])
    upright = -1j * push / (p["k_y"] - p["m"] * w**2 + 1j * w * p["d"])
    turn = 1j * w
    start = [across.real, upright.real - sag], [(turn * across).real, (turn * upright).real]
    done = run("rotor_imbalance", 20 * 2 * np.pi / w, *start)
    orbit = np.exp(1j * w * done.t)
    assert done.q[:, 0] == pytest.approx((across * orbit).real, abs=1e-6 * abs(across))
    assert done.q[:, 1] == pytest.approx((upright * orbit).real - sag, abs=1e-6 * abs(upright))
    assert abs(across) > 1.5 * p["e"]  # on the way to its critical speed


def test_a_loudspeaker_is_a_linear_circuit_with_a_cone() -> None:
    p, volts = numbers("loudspeaker"), 2.0
    matrix = np.array(
        [  # x, x', i
            [0, 1, 0],
            [-p["k"] / p["m"], -p["d"] / p["m"], p["Bl"] / p["m"]],
            [0, -p["Bl"] / p["L_e"], -p["R_e"] / p["L_e"]],
        ]
    )
    rest = np.linalg.solve(matrix, [0, 0, -volts / p["L_e"]])
    done = run("loudspeaker", 0.05, [0.0, 0.0], [0.0, 0.0], [volts])
    wanted = np.array([rest - expm(matrix * t) @ rest for t in done.t])
    sizes = np.abs(wanted).max(axis=0)
    found = np.column_stack([done.q[:, 0], done.v[:, 0], done.v[:, 1]])
    assert np.all(np.abs(found - wanted) < 1e-6 * sizes)
    assert done.q[-1, 0] > 0  # a positive voltage pushes the cone outwards


def test_a_levitating_ball_leaves_its_balance_as_the_linearised_equations_say() -> None:
    """Gap, its rate and current about the balance at 10 mm, from 0.1 µm below it."""
    p, gap = numbers("maglev"), 0.01
    far = gap + p["a"]
    current = np.sqrt(2 * p["m"] * p["g"] / p["K"]) * far
    whole, pull = p["L_c"] + p["K"] / far, p["K"] * current / far**2
    matrix = np.array(
        [
            [0, 1, 0],
            [2 * p["g"] / far, 0, -pull / p["m"]],
            [0, pull / whole, -p["R_e"] / whole],
        ]
    )
    away = np.array([1e-7, 0, 0])
    done = run("maglev", 0.05, [gap + away[0], 0.0], [0.0, current], [p["R_e"] * current])
    wanted = np.array([expm(matrix * t) @ away for t in done.t])
    found = np.column_stack([done.q[:, 0] - gap, done.v[:, 0], done.v[:, 1] - current])
    assert np.all(np.abs(found - wanted) < 1e-3 * np.abs(wanted).max(axis=0))
    assert wanted[-1, 0] > 3 * wanted[0, 0]  # it falls
    assert current == pytest.approx(1.00031, abs=1e-5)  # the start that the file states


def test_a_motor_crosses_its_play_alone() -> None:
    p, torque = numbers("two_inertia_backlash"), 0.02
    done = run("two_inertia_backlash", 0.05, [0.0, 0.0], [0.0, 0.0], [torque])
    fade = p["J_m"] / p["d_m"]
    alone = torque / p["d_m"] * (done.t - fade * (1 - np.exp(-done.t / fade)))
    free = alone < p["play"]
    assert 20 < free.sum() < 180
    assert done.q[free, 0] == pytest.approx(alone[free], abs=1e-8)
    assert done.q[free, 1] == pytest.approx(alone[free], abs=1e-8)  # the load stands still
    assert done.q[-1, 0] - done.q[-1, 1] > 0  # then the load is driven the same way


def test_a_damper_on_a_rig_runs_through_the_loop_of_its_law() -> None:
    p = numbers("damper_rig")
    speed, far = 0.02, 0.02  # out, then back: dz/dx = 1 − b z out, 1 + b z back
    t_u = np.array([0.0, far / speed, far / speed + 1e-9, 2 * far / speed])
    given = np.zeros((4, 3))
    given[:, 0], given[:, 1] = [0, far, far, 0], [speed, speed, -speed, -speed]
    t = np.linspace(0, t_u[-1], 401)
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t_u, np.zeros((4, 0)), given=given)
    done = simulate(machine_of("damper_rig"), scenario)
    assert done.complete, done.reason
    b, x = p["b"], done.q[:, 0]
    out, peak = (1 - np.exp(-b * x)) / b, (1 - np.exp(-b * far)) / b
    back = -1 / b + (peak + 1 / b) * np.exp(-b * (far - x))
    z = np.where(t <= t_u[1], out, back)
    taut = np.sign(z) * np.maximum(np.abs(z) - p["p"], 0)
    assert done.y[:, 0] == pytest.approx(p["k"] * taut, abs=1e-6 * p["k"] * peak)
    assert done.y[100, 0] > 0  # moved along +x, the rig pushes along +x
    assert done.y[-1, 0] < 0


def test_cars_stand_on_their_springs() -> None:
    p = numbers("quarter_car")
    w = p["r"] - p["g"] * (p["m_b"] + p["m_w"]) / p["k_t"]
    z = w + p["l_s"] - p["g"] * p["m_b"] / p["k_s"]
    _still("quarter_car", [z, w, 0.0], [], [0.0, 0.0, -p["g"] * (p["m_b"] + p["m_w"])])
    p = numbers("half_car")
    p_front, p_rear = (p["m"] * p["g"] * p[arm] / (p["a"] + p["b"]) for arm in ("b", "a"))
    hubs = [p["r"] - (load + p["m_w"] * p["g"]) / p["k_t"] for load in (p_front, p_rear)]
    tops = [
        hub + p["l_s"] - load / p[k]
        for hub, load, k in zip(hubs, (p_front, p_rear), ("k_f", "k_r"), strict=True)
    ]
    slope = (tops[0] - tops[1]) / (p["a"] + p["b"])  # of a car that pitches by less than 0.01 rad
    start = [tops[1] + p["b"] * slope, np.arctan(slope), *hubs]
    done = run("half_car", 5.0, start, [0.0] * 4, [0.0, 0.0])
    assert np.abs(slope) > 1e-3
    assert done.q == pytest.approx(np.tile(start, (done.t.size, 1)), abs=1e-5)


def test_a_strut_takes_at_each_speed_what_was_measured() -> None:
    """In N at mm/s, read from the file without symhyb; and no force from its spring at rest."""
    machine = machine_of("strut")
    points = entries("strut", "elements")["strut"]["points"]
    assert isinstance(points, list)
    for speed, force in points:
        at = (np.zeros(1), np.array([speed / 1e3]), np.empty(0), np.zeros(1), 0, machine.values)
        assert call(machine.k_e, at)[0][0] == pytest.approx([-force], abs=1e-9)


def test_a_standing_car_shows_its_weight_to_the_rig() -> None:
    p, machine = numbers("quarter_car"), machine_of("quarter_car")
    w = p["r"] - p["g"] * (p["m_b"] + p["m_w"]) / p["k_t"]
    q = np.array([w + p["l_s"] - p["g"] * p["m_b"] / p["k_s"], w, 0.0])
    at_rest = (q, np.zeros(3), np.zeros(3), [], [], 0, machine.values)
    body, wheel, travel, post = call(machine.outputs, at_rest)[0][0]
    assert (body, wheel) == (0, 0)
    assert travel == pytest.approx(q[0] - q[1])
    assert post == pytest.approx(p["g"] * (p["m_b"] + p["m_w"]))  # the rig pushes upwards


def _still(name: str, q: list[float], u: list[float], wanted: list[float]) -> None:
    machine, still = machine_of(name), np.zeros(len(q))
    force = call(machine.k_e, (np.array(q), still, np.empty(0), np.array(u), 0, machine.values))
    assert force[0][0] == pytest.approx(np.array(wanted), abs=1e-6)


def test_an_arm_is_held_by_the_torques_of_its_weight() -> None:
    p, (alpha, beta) = numbers("two_link_arm"), (0.7, -1.1)
    far = p["g"] * np.cos(alpha + beta) * (p["m_2"] * p["a_2"] + p["load"] * p["l_2"])
    near = p["g"] * np.cos(alpha)
    near *= p["m_1"] * p["a_1"] + (p["m_2"] + p["load"]) * p["l_1"]
    _still("two_link_arm", [alpha, beta], [near + far, far], [0.0, 0.0])
