r"""A mode: a mass on a spring and a damper that rides on a place, against the same machine with one
body more, and against SciPy.

    wall |--/\/\/--[m]--o──▶ x ──/\/\/──┐
         |--[===]--                [===]──[m_h]──▶ u
"""

from functools import cache

import numpy as np
import pytest
from builders import model_of
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.exact.simulation import simulate
from symhyb.mechanics.show import show_equations
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import Block, WindowModel

Array = NDArray[np.float64]
M, K, D, HIDDEN, FREQUENCY, RATIO = 1.2, 980.0, 1.5, 0.2, 7.0, 0.04
PACE = 2 * np.pi * FREQUENCY
K_H, D_H = HIDDEN * PACE**2, 2 * RATIO * HIDDEN * PACE
PARAMETERS = {
    "m": (M, "kg"),
    "k": (K, "N/m"),
    "d": (D, "N*s/m"),
    "m_h": (HIDDEN, "kg"),
    "f_h": (FREQUENCY, "Hz"),
    "zeta_h": (RATIO, "1"),
    "k_h": (K_H, "N/m"),
    "d_h": (D_H, "N*s/m"),
    "fc": (0.8, "N"),
    "far": (2.0, "m"),
}
MODE = {"kind": "mode", "mass": "m_h", "frequency": "f_h", "damping_ratio": "zeta_h"}
HELD = {
    "spring": {"kind": "spring", "on": "x", "stiffness": "k"},
    "oil": {"kind": "damper", "on": "x", "damping": "d"},
    "shaker": {"kind": "force", "on": "x", "force": "f"},
}
T = np.linspace(0, 4, 801)
PUSH = 3 * np.sin(2 * np.pi * 5 * T) + np.sin(2 * np.pi * 6.5 * T)


def riding(place: dict[str, object] | None = None, **more: object) -> Model:
    """One mass, with a mode on its coordinate or at another place."""
    return model_of(
        coordinates={"x": {"unit": "m", "start": 0.01, "start_rate": 0.2}},
        parameters=PARAMETERS,
        inputs={"f": {"unit": "N"}},
        points={"wall": ["-far", "0"], "end": ["x", "0"]},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={**HELD, "load": {**MODE, **(place or {"on": "x"})}, **more},
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "pull": {"measures": "force(load)", "unit": "N"},
        },
    )


def second_body() -> Model:
    """The same with the hidden mass as a body, its spring and its damper."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "u": {"unit": "m"}},
        parameters=PARAMETERS,
        inputs={"f": {"unit": "N"}},
        bodies={
            "block": {"mass": "m", "at": ["x", "0"]},
            "hidden": {"mass": "m_h", "at": ["u", "0"]},
        },
        elements={
            **HELD,
            "strap": {"kind": "spring", "on": "x - u", "stiffness": "k_h"},
            "loss": {"kind": "damper", "on": "x - u", "damping": "d_h"},
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


@cache
def machine() -> Machine:
    return build(riding())


def scenario(q: float = 0.01, v: float = 0.2) -> Scenario:
    return Scenario(T, np.array([q]), np.array([v]), T, PUSH[:, None])


def test_it_moves_as_the_machine_with_one_body_more() -> None:
    run = simulate(machine(), scenario())
    both, settled = build(second_body()), np.array([0.2, 0.2])
    other = simulate(both, Scenario(T, np.array([0.01, 0.01]), settled, T, PUSH[:, None]))
    assert run.y[:, 0] == pytest.approx(other.y[:, 0], abs=1e-8)
    assert run.z[:, 0] == pytest.approx(other.q[:, 0] - other.q[:, 1], abs=1e-8)
    assert run.z[:, 1] == pytest.approx(other.v[:, 1], abs=1e-6)


def by_hand() -> Array:
    """x (N,) by SciPy from the equations of two masses."""

    def rates(now: float, y: Array) -> list[float]:
        x, v, u, w = y
        pull = K_H * (x - u) + D_H * (v - w)
        return [v, (np.interp(now, T, PUSH) - K * x - D * v - pull) / M, w, pull / HIDDEN]

    begin = [0.01, 0.2, 0.01, 0.2]
    run = solve_ivp(rates, (0, 4), begin, "DOP853", T, rtol=1e-11, atol=1e-13, max_step=0.005)
    return np.asarray(run.y[0])


def test_it_moves_as_scipy_says() -> None:
    assert simulate(machine(), scenario()).y[:, 0] == pytest.approx(by_hand(), abs=1e-8)


@pytest.mark.slow
def test_the_exact_run_is_the_same() -> None:
    assert simulate(machine(), scenario(), exact=True).y[:, 0] == pytest.approx(by_hand(), abs=1e-7)


def test_friction_may_hold_the_place_while_the_mass_swings_on() -> None:
    """x rests, so the mass swings freely at its own frequency and decays by its own damping."""
    rub = {"kind": "friction", "on": "x", "coulomb": "fc"}
    still = build(riding(rub=rub))
    quiet = Scenario(T, np.zeros(1), np.zeros(1), T, np.zeros((T.size, 1)), z=np.array([0.0, 0.05]))
    run = simulate(still, quiet, exact=True)
    assert np.abs(run.q).max() < 1e-12
    swing = PACE * np.sqrt(1 - RATIO**2)
    expected = -0.05 / swing * np.exp(-RATIO * PACE * T) * np.sin(swing * T)
    assert run.z[:, 0] == pytest.approx(expected, abs=1e-7)


def test_far_below_its_frequency_it_is_an_added_mass_and_beyond_a_spring_with_a_damper() -> None:
    """F/s'' → mass, and F → k s + d s'."""
    for pace, expected in ((PACE / 100, -HIDDEN * (PACE / 100) ** 2), (PACE * 100, None)):
        s = 1j * pace
        inside = np.array([[s, 1], [-(PACE**2), s + 2 * RATIO * PACE]])
        e, w = np.linalg.solve(inside, np.array([s, 2 * RATIO * PACE * s]))
        still, nothing = np.zeros(1), np.zeros(1)
        at = [part(np.array([e, w])) for part in (np.real, np.imag)]
        rate = [part(np.array([s])) for part in (np.real, np.imag)]
        forces = [
            call(machine().elements, (still, v, z, nothing, 0.0, machine().values))[0][3, 0]
            for v, z in zip(rate, at, strict=True)
        ]
        plain = K_H + 1j * pace * D_H if expected is None else expected
        assert -complex(*forces) == pytest.approx(plain, rel=2e-3, abs=abs(plain) * 2e-3)


def test_it_settles_against_a_place_that_moves_on_and_does_not_pull_then() -> None:
    q, v, nothing = np.array([123.0]), np.array([2.0]), np.zeros(1)
    (z,) = call(machine().inner_rest, (q, v, 0.0, machine().values))
    assert z.ravel() == pytest.approx([0.0, 2.0])
    (rates,) = call(machine().inner, (q, v, z, nothing, 0.0, machine().values))
    (forces,) = call(machine().elements, (q, v, z, nothing, 0.0, machine().values))
    assert rates == pytest.approx(0)
    assert forces[3, 0] == 0


def test_energy_is_kept_but_for_what_its_damper_takes() -> None:
    run = simulate(machine(), scenario())
    energy = np.array(
        [
            sum(
                float(np.sum(part))
                for part in call(machine().energy, (q, v, z, t, machine().values))
            )
            for q, v, z, t in zip(run.q, run.v, run.z, T, strict=True)
        ]
    )
    v, slip = run.v[:, 0], run.v[:, 0] - run.z[:, 1]
    power = PUSH * v - D * v**2 - D_H * slip**2
    work = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(T))])
    assert energy - energy[0] == pytest.approx(work, abs=5e-3 * np.ptp(work))


def test_between_two_points_it_is_the_same_as_on_their_distance() -> None:
    placed = build(riding({"between": ["wall", "end"]}))
    assert simulate(placed, scenario()).y == pytest.approx(simulate(machine(), scenario()).y)


def test_windows_carry_both_states() -> None:
    t, u = T[None, :61], PUSH[None, :61, None]
    begin = np.array([[0.01, 0.2, 0.002, 0.1]])
    parts = np.full((1, 60), 4)
    blocks = Block(t, u, np.zeros((1, 61, 2)), parts)
    x, _ = WindowModel(machine()).simulate(blocks, begin, machine().values)
    run = simulate(
        machine(), Scenario(T[:61], begin[0, :1], begin[0, 1:2], T, PUSH[:, None], z=begin[0, 2:])
    )
    expected = np.column_stack([run.q, run.v, run.z])
    assert x[0] == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())


def test_the_equations_name_both_states() -> None:
    text, latex = show_equations(riding()), show_equations(riding(), latex=True)
    assert "e(load)' = -w(load) + x'" in text
    assert "w(load)' = " in text
    assert r"\dot{e_{\text{load}}}" in latex
