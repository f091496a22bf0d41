r"""Simulation of an oscillator with dry friction: once over the whole grid, and many at a time.

    wall |--/\/\/--[m]--> x      m x'' = F sin(2π f t) − c x − d x' − R tanh(x'/w)
         |---|-]----|

m = 1 kg, c = 100 N/m, d = 0.5 N·s/m, R = 0.4905 N, w = 1 mm/s, F = 5 N, f = 0.5 Hz, from rest. The
others get rtol 1e-8 and atol 1e-10, and functions compiled by numba before the clock starts; symhyb
gets what it always takes, rtol 1e-8 and atol 1e-10 of the size of each state.
"""

import math
from collections.abc import Callable

import casadi as ca
import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from timing import Row, in_turns, middle, milliseconds

from symhyb.model.read import parse_model
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.optimisation.sweep import simulate_many

Array = NDArray[np.float64]
MASS, STIFFNESS, DAMPING, LEVEL, WIDTH = 1.0, 100.0, 0.5, 0.4905, 1e-3
PUSH, FREQUENCY = 5.0, 0.5
TEXT = f"""
symhyb = 1
title = "oscillator"
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = {MASS}, unit = "kg" }}
c = {{ value = {STIFFNESS}, unit = "N/m" }}
d = {{ value = {DAMPING}, unit = "N*s/m" }}
R = {{ value = {LEVEL}, unit = "N" }}
w = {{ value = {WIDTH}, unit = "m/s" }}
F = {{ value = {PUSH}, unit = "N" }}
f = {{ value = {FREQUENCY}, unit = "Hz" }}
[bodies]
block = {{ mass = "m", at = ["x", "0"] }}
[elements]
spring = {{ kind = "spring", on = "x", stiffness = "c" }}
damper = {{ kind = "damper", on = "x", damping = "d" }}
rail = {{ kind = "friction", on = "x", coulomb = "R", transition = "w" }}
shaker = {{ kind = "harmonic", on = "x", amplitude = "F", frequency = "f" }}
"""


def machine_of() -> Machine:
    """The oscillator."""
    return build(parse_model(TEXT, "oscillator.toml"))


def scenario_of(duration: float, outputs: int) -> Scenario:
    """From rest, without recorded inputs."""
    t = np.linspace(0.0, duration, outputs)
    return Scenario(t, np.zeros(1), np.zeros(1), t[[0, -1]], np.empty((2, 0)))


def right_side() -> Callable[[float, Array], Array]:
    """The same by hand, compiled by numba if that is installed."""

    def rate(t: float, x: Array) -> Array:
        force = PUSH * math.sin(2 * math.pi * FREQUENCY * t) - LEVEL * math.tanh(x[1] / WIDTH)
        return np.array([x[1], (force - STIFFNESS * x[0] - DAMPING * x[1]) / MASS])

    try:
        import numba
    except ImportError:
        return rate
    compiled: Callable[[float, Array], Array] = numba.njit(rate)
    compiled(0.0, np.zeros(2))
    return compiled


def lsoda(rate: Callable[[float, Array], Array], t: Array, rtol: float, atol: float) -> Array:
    """States (N, 2) by SciPy's LSODA."""
    run = solve_ivp(
        rate, (t[0], t[-1]), np.zeros(2), method="LSODA", t_eval=t, rtol=rtol, atol=atol
    )
    return np.asarray(run.y.T)


def reference(rate: Callable[[float, Array], Array], t: Array) -> Array:
    """States (N, 2) by DOP853 at a relative tolerance of 1e-12."""
    run = solve_ivp(
        rate, (t[0], t[-1]), np.zeros(2), method="DOP853", t_eval=t, rtol=1e-12, atol=1e-14
    )
    return np.asarray(run.y.T)


def one_step_loop(machine: Machine, t: Array, size: Array) -> Callable[[], Array]:
    """States (N, 2) by the same integrator, equations and tolerances, states divided by their
    ``size`` (2,) as there, called once for every output in a loop."""
    x, time, start = ca.SX.sym("x", 2), ca.SX.sym("t"), ca.SX.sym("start")
    p = ca.SX.sym("p", machine.values.size)
    rates = state_form(machine).rates()
    full = x * size
    slopes = rates(full, ca.SX(0, 1), start + time, p, ca.SX.zeros(1))
    step = ca.integrator(
        "step",
        "cvodes",
        {"x": x, "t": time, "p": ca.vertcat(start, p), "ode": ca.vertcat(full[1], slopes) / size},
        0.0,
        t[1] - t[0],
        {"reltol": 1e-8, "abstol": 1e-10},
    )

    def loop() -> Array:
        state, states = ca.DM.zeros(2), np.zeros((t.size, 2))
        for i in range(1, t.size):
            state = step(x0=state, p=np.append(t[i - 1], machine.values))["xf"]
            states[i] = state.full().ravel() * size
        return states

    return loop


def error(states: Array, truth: Array) -> float:
    """RMSE of the place over its range."""
    return float(np.sqrt(np.mean((states[:, 0] - truth[:, 0]) ** 2)) / np.ptp(truth[:, 0]))


def run_rows(duration: float = 60.0, outputs: int = 60_001, repeats: int = 9) -> list[Row]:
    """Bars of one run over the whole grid. The loop runs over a tenth of it, and counts ten
    times."""
    machine, scenario, rate = machine_of(), scenario_of(duration, outputs), right_side()
    t = scenario.t
    truth, found = reference(rate, t), simulate(machine, scenario)
    part = t[: 1 + (t.size - 1) // 10]
    loop = one_step_loop(machine, part, np.abs(truth).max(axis=0))
    many = middle(
        in_turns(
            {
                "ours": lambda: simulate(machine, scenario),
                "lsoda": lambda: lsoda(rate, t, 1e-8, 1e-10),
                "loop": loop,
            },
            repeats,
        )
    )
    errors = [error(found.q, truth), error(lsoda(rate, t, 1e-8, 1e-10), truth)]
    alike = as_accurate(lambda tol: lsoda(rate, t, tol, 1e-2 * tol), truth, errors[0])
    equal = middle(in_turns({"lsoda": lambda: lsoda(rate, t, alike, 1e-2 * alike)}, 3))["lsoda"]
    stepped = many["loop"] * (t.size - 1) / (part.size - 1)
    name = f"{duration:.0f} s, {outputs} outputs"
    return [
        Row(
            name,
            "time of SciPy's LSODA with numba over ours, both at rtol 1e-8",
            many["lsoda"] / many["ours"],
            2.5,
            True,
            "×",
            f"{milliseconds(many['lsoda'])}, {milliseconds(many['ours'])}; NRMSE of x against "
            f"DOP853 at 1e-12: LSODA {errors[1]:.1e}, ours {errors[0]:.1e}",
        ),
        Row(
            name,
            "the same with LSODA at the loosest rtol of 1, 2, 5·10ⁿ that is as accurate as ours",
            equal / many["ours"],
            None,
            True,
            "×",
            f"rtol {alike:.0e}",
        ),
        Row(
            name,
            "time of a loop of one-step integrations over ours",
            stepped / many["ours"],
            50,
            True,
            "×",
            milliseconds(stepped),
        ),
    ]


def as_accurate(run: Callable[[float], Array], truth: Array, wanted: float) -> float:
    """The loosest relative tolerance of 1, 2, 5·10ⁿ with an error of at most ``wanted``."""
    for power in range(5, 13):
        for first in (10, 5, 2):
            tolerance = first * 10.0 ** -(power + 1)
            if error(run(tolerance), truth) <= wanted:
                return tolerance
    return 1e-13


def sweep_rows(
    sets: int = 64, duration: float = 60.0, outputs: int = 6001, repeats: int = 3
) -> list[Row]:
    """The bar of many parameter sets on two cores."""
    machine, scenario = machine_of(), scenario_of(duration, outputs)
    spread = 1 + 0.05 * np.random.default_rng(1).standard_normal((sets, machine.values.size))
    given = machine.values * spread
    contenders = {
        "two": lambda: simulate_many(machine, scenario, given, workers=2),
        "one": lambda: simulate_many(machine, scenario, given),
    }
    first = middle(in_turns({"two": contenders["two"]}, 1))["two"]
    times = middle(in_turns(contenders, repeats))
    part = f"{sets} parameter sets"
    note = f"{milliseconds(times['one'])}, {milliseconds(times['two'])}; {outputs} outputs each"
    return [
        Row(
            part,
            "time in one process over time in two",
            times["one"] / times["two"],
            1.7,
            True,
            "×",
            note,
        ),
        Row(
            part,
            "the same with the processes started anew",
            times["one"] / first,
            None,
            True,
            "×",
            milliseconds(first),
        ),
    ]
