r"""Exact stick and slip, by located events, against smoothing and against an automaton by hand.

    wall |--/\/\/--[m]--> x      m x'' = F sin(2π f t) − c x − d x' − R sgn x', held while it sticks
         |---|-]----|

The oscillator of :mod:`oscillators`, F = 5 N (slips) and F = 0.9 N (sticks for long). Smoothed
it is R tanh(x'/w), w = 1 mm/s, by CVODES. The automaton is SciPy's DOP853 at a relative tolerance
of 1e-12 with its own events, and shares nothing with symhyb.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray
from oscillators import (
    DAMPING,
    FREQUENCY,
    LEVEL,
    MASS,
    STIFFNESS,
    TEXT,
    error,
    scenario_of,
)
from scipy.integrate import solve_ivp
from timing import Row, in_turns, middle, milliseconds

from symhyb.exact.simulation import simulate
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build

Array = NDArray[np.float64]


def automaton(push: float, t: Array) -> tuple[Array, list[float]]:
    """States (N, 2) from rest at 0, and the times of all transitions."""
    now, y, way = 0.0, np.zeros(2), 0
    out, times = np.zeros((t.size, 2)), list[float]()

    def pull(s: float, x: float) -> float:
        return push * math.sin(2 * math.pi * FREQUENCY * s) - STIFFNESS * x

    while True:

        def rate(s: float, y: Array, way: int = way) -> list[float]:
            force = pull(s, y[0]) - DAMPING * y[1] - way * LEVEL
            return [y[1], force / MASS] if way else [0.0, 0.0]

        def ends(s: float, y: Array, way: int = way, begun: float = now) -> float:
            if way == 0:
                return LEVEL - abs(pull(s, y[0]))
            return way * float(y[1]) if s > begun + 1e-9 else 1.0

        event: Any = ends
        event.terminal, event.direction = True, -1
        run = solve_ivp(
            rate,
            (now, t[-1]),
            y,
            method="DOP853",
            rtol=1e-12,
            atol=1e-14,
            events=event,
            dense_output=True,
            max_step=0.02,
        )
        rows = (t >= now) & (t <= run.t[-1])
        out[rows] = run.sol(t[rows]).T
        if run.status == 0:
            return out, times
        now, y = float(run.t_events[0][0]), np.array([run.y_events[0][0][0], 0.0])
        force = pull(now, y[0])
        way = 0 if way and abs(force) < LEVEL else int(math.copysign(1, force))
        times.append(now)


def rows(duration: float = 60.0, outputs: int = 60_001, repeats: int = 9) -> list[Row]:
    """The bars of exact dry friction."""
    scenario, found = scenario_of(duration, outputs), list[Row]()
    for push, name in ((5.0, "slips"), (0.9, "sticks")):
        text = TEXT.replace("F = { value = 5.0,", f"F = {{ value = {push},")
        machine = build(parse_model(text, "oscillator.toml"))
        truth, times = automaton(push, scenario.t)
        exact, smooth = simulate(machine, scenario, exact=True), simulate(machine, scenario)
        spent = middle(
            in_turns(
                {
                    "exact": lambda m=machine: simulate(m, scenario, exact=True),
                    "smooth": lambda m=machine: simulate(m, scenario),
                },
                repeats,
            )
        )
        part = f"dry friction by events, {name}"
        located = np.array([event.time for event in exact.events])
        apart = np.abs(located - times).max() if located.size == len(times) else math.inf
        found += [
            Row(
                part,
                "time of the exact run over smoothing, both for all outputs",
                spent["exact"] / spent["smooth"],
                5.0,
                False,
                "×",
                f"{milliseconds(spent['exact'])}, {milliseconds(spent['smooth'])}; {outputs} "
                "outputs",
            ),
            Row(
                part,
                "NRMSE of x against an automaton by hand",
                error(exact.q, truth),
                1e-6,
                note=f"smoothed over 1 mm/s: {error(smooth.q, truth):.1e}",
            ),
            Row(
                part,
                "share of its transitions that are located",
                located.size / len(times),
                1.0,
                True,
                note=f"{located.size} of {len(times)}; times differ by at most {apart:.0e} s",
            ),
        ]
    return found
