"""A host that adds +ΔF from an FMU moves as the machine does; what a coupling loses is known.

The host is a mass on a cubic spring under a harmonic force, integrated here by Runge and Kutta's
method of order 4; the FMU brings drag and dry friction.
"""

from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import oscillator
from fmus import get, loaded, put, started, written
from scipy.integrate import solve_ivp

from symhyb.export.spec import Spec, spec_of

END = 5.0


@cache
def law() -> Spec:
    model = oscillator(
        {
            "drag": {"kind": "drag", "on": "x", "drag": "b"},
            "rub": {"kind": "friction", "on": "x", "coulomb": "fc", "transition": "vt"},
        },
        parameters={"b": (0.3, "N*s^2/m^2"), "fc": (0.1962, "N"), "vt": (1e-3, "m/s")},
    )
    return spec_of(model, "law", ("drag", "rub"))


def missing(v: float) -> float:
    return -0.3 * abs(v) * v - 0.1962 * float(np.tanh(v / 1e-3))


def rate(t: float, y: np.ndarray, force: float) -> np.ndarray:
    return np.array([y[1], 5 * np.sin(2 * np.pi * t) - 5 * y[0] ** 3 + force])


@cache
def reference(corrected: bool = True) -> np.ndarray:
    run = solve_ivp(
        lambda t, y: rate(t, y, missing(y[1]) if corrected else 0.0),
        (0, END),
        [0.5, 0.0],
        "Radau",
        np.linspace(0, END, 501),
        rtol=1e-10,
        atol=1e-12,
    )
    return run.y.T


def step(t: float, y: np.ndarray, h: float, force: Callable[[float, float], float]) -> np.ndarray:
    def f(s: float, z: np.ndarray) -> np.ndarray:
        return rate(s, z, force(s, z[1]))

    a = f(t, y)
    b = f(t + h / 2, y + h / 2 * a)
    c = f(t + h / 2, y + h / 2 * b)
    return y + h / 6 * (a + 2 * b + 2 * c + f(t + h, y + h * c))


def error(run: np.ndarray) -> float:
    """RMSE of the position over that of the host without any correction."""
    size = np.sqrt(np.mean((reference(False) - reference())[:, 0] ** 2))
    return float(np.sqrt(np.mean((run - reference())[:, 0] ** 2)) / size)


def tight(path: Path, h: float) -> np.ndarray:
    """Model exchange: the FMU is asked within every stage of the host."""
    y, out = np.array([0.5, 0.0]), []
    with loaded(path, 2, "me") as it:
        started(it, 2)

        def force(t: float, v: float) -> float:
            it.setTime(t)
            put(it, 2, [1], [v])
            return get(it, 2, [2])[0]

        for i in range(round(END / h) + 1):
            if i % round(0.01 / h) == 0:
                out.append(y)
            y = step(i * h, y, h, force)
    return np.array(out)


def lock_step(path: Path, h: float, delayed: bool) -> np.ndarray:
    """Co-simulation: the force is held over a step; ``delayed``: it is that of the step before."""
    y, out = np.array([0.5, 0.0]), []
    with loaded(path, 2, "cs") as it:
        started(it, 2)
        held = get(it, 2, [2])[0]
        for i in range(round(END / h) + 1):
            if i % round(0.01 / h) == 0:
                out.append(y)
            put(it, 2, [1], [y[1]])
            now = get(it, 2, [2])[0]
            used, held = (held, now) if delayed else (now, now)
            y = step(i * h, y, h, lambda t, v, used=used: used)
            it.doStep(i * h, h)
    return np.array(out)


@pytest.mark.slow
def test_couplings_lose_little_and_how_much(tmp_path: Path) -> None:
    """Of the error of the host without correction: model exchange less than 1 % at 1 ms, held
    forces in proportion to the step, one step late more than that."""
    path = written(tmp_path, law(), 2)
    exchange = error(tight(path, 1e-3))
    held = {h: error(lock_step(path, h, False)) for h in (1e-2, 1e-3)}
    late = {h: error(lock_step(path, h, True)) for h in (1e-2, 1e-3)}
    print(f"model exchange {exchange:.2e}, held {held}, late {late}")
    assert exchange < 0.01
    assert held[1e-3] < 0.01
    assert held[1e-3] < held[1e-2] / 3
    assert late[1e-2] > held[1e-2]
