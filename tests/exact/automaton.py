r"""An oscillator with dry friction by hand: an automaton around SciPy, without symhyb.

wall |--/\/\/--[m]--> x      m x'' = P(t) − c x − d x' − g(x') sgn x' (1 + e sgn x')
     |---|-]----|            held while at rest and −R0 (1 − e) ≤ P(t) − c x ≤ R0 (1 + e)
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, pi, sin

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Oscillator:
    """SI; ``R0`` is the level at rest, which falls to ``R`` over the speed ``vs`` (0: at once)."""

    m: float = 1.0
    c: float = 100.0
    d: float = 0.5
    R: float = 0.4905
    R0: float = 0.4905
    vs: float = 0.0
    e: float = 0.0
    P: float = 5.0
    f: float = 0.5
    force: Callable[[float], float] | None = None

    def pull(self, t: float, x: float) -> float:
        push = self.force(t) if self.force else self.P * sin(2 * pi * self.f * t)
        return push - self.c * x

    def level(self, v: float, way: int) -> float:
        g = self.R + (self.R0 - self.R) * exp(-((v / self.vs) ** 2)) if self.vs else self.R
        return g * (1 + way * self.e)

    def broken(self, pull: float) -> int:
        """The way in which a force at rest moves the mass; 0 if it holds."""
        return int(pull >= self.R0 * (1 + self.e)) - int(pull <= -self.R0 * (1 - self.e))


def automaton(
    o: Oscillator, t: Array, longest: float = 0.02
) -> tuple[Array, list[tuple[float, int]]]:
    """Places and speeds (N, 2) from rest at 0, and the events: time, and the new direction."""
    now, y, way = 0.0, np.zeros(2), 0
    out, events = np.zeros((t.size, 2)), []
    while True:

        def rate(s: float, y: Array, way: int = way) -> list[float]:
            if way == 0:
                return [0.0, 0.0]
            return [y[1], (o.pull(s, y[0]) - o.d * y[1] - way * o.level(y[1], way)) / o.m]

        def turns(s: float, y: Array, way: int = way, begun: float = now) -> float:
            return way * y[1] if s > begun + 1e-9 else 1.0

        def breaks(s: float, y: Array) -> float:
            pull = o.pull(s, y[0])
            return min(o.R0 * (1 + o.e) - pull, pull + o.R0 * (1 - o.e))

        event = turns if way else breaks
        event.terminal, event.direction = True, -1  # type: ignore[attr-defined]
        run = solve_ivp(
            rate,
            (now, t[-1]),
            y,
            "DOP853",
            rtol=1e-12,
            atol=1e-14,
            events=event,
            dense_output=True,
            max_step=longest,
        )
        rows = (t >= now) & (t <= run.t[-1])
        out[rows] = run.sol(t[rows]).T
        if run.status == 0:
            return out, events
        now, y = float(run.t_events[0][0]), run.y_events[0][0].copy()
        pull = o.pull(now, y[0])
        way = (1 if pull > 0 else -1) if way == 0 else o.broken(pull)
        y[1] = 0.0
        events.append((now, way))
