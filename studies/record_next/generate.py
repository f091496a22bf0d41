"""Recordings of a sledge on a spring with something concealed, by NumPy and SciPy alone.

The sledge (machine.toml): m x'' + d x' + k x = f + what is concealed. Dry friction is exact: the
sledge slides or sticks, and every change is located as an event. Shares no code with symhyb.
"""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Array = NDArray[np.float64]
Signal = Callable[[float], float]

MASS, STIFFNESS, DAMPING = 2.0, 200.0, 1.2


def simulate(
    t: Array, force: Signal, hidden: Mapping[str, float], start: tuple[float, float] = (0.0, 0.0)
) -> Array:
    """Positions (N,) at times ``t`` (N,), SI, from x, x' at the ``start``; ``hidden`` by name:
    coulomb, damping, drag, cubic, mass, delay, stiffness with time (a Maxwell element)."""
    late, dry = hidden.get("delay", 0.0), hidden.get("coulomb", 0.0)
    inertia, branch = MASS + hidden.get("mass", 0.0), hidden.get("stiffness", 0.0)
    viscous = DAMPING + hidden.get("damping", 0.0)

    def pull(s: float, y: Array) -> float:
        x, v, z = y
        back = STIFFNESS * x + hidden.get("cubic", 0.0) * x**3 + viscous * v
        back += hidden.get("drag", 0.0) * abs(v) * v + branch * (x - z)
        return force(max(s - late, t[0])) - back

    def rates(s: float, y: Array, way: int) -> list[float]:
        x, v, z = y
        yielding = (x - z) / hidden["time"] if branch else 0.0
        if dry and way == 0:
            return [0.0, 0.0, yielding]
        return [v, (pull(s, y) - dry * way) / inertia, yielding]

    def reversed_(s: float, y: Array, way: int) -> float:
        return float(y[1])

    def torn(s: float, y: Array, way: int) -> float:
        return abs(pull(s, y)) - dry

    reversed_.terminal = torn.terminal = True  # type: ignore[attr-defined]
    torn.direction = 1  # type: ignore[attr-defined]
    state, now, positions = np.array([*start, start[0]]), float(t[0]), np.full(t.size, np.nan)
    positions[0] = start[0]
    way = _way(state[1], pull(now, state), dry)
    while now < t[-1]:
        events = None if not dry else ([torn] if way == 0 else [reversed_])
        if events and way:
            reversed_.direction = -way  # type: ignore[attr-defined]
        run = solve_ivp(
            rates,
            (now, t[-1]),
            state,
            args=(way,),
            events=events,
            dense_output=True,
            rtol=1e-9,
            atol=1e-11,
            max_step=0.02,
        )
        inside = (t > now) & (t <= run.t[-1])
        if inside.any():
            positions[inside] = run.sol(t[inside])[0]
        now, state = float(run.t[-1]), run.y[:, -1].copy()
        if run.status == 1:
            rested = way != 0
            if rested:
                state[1] = 0.0
            acting = pull(now, state)
            way = _way(0.0, acting, dry) if rested else int(np.sign(acting))
    return positions


def _way(speed: float, acting: float, dry: float) -> int:
    """+1 or −1 while it slides, 0 while it sticks."""
    if speed:
        return int(np.sign(speed))
    return int(np.sign(acting)) if abs(acting) > dry else 0


def recorded(t: Array, force: Signal, x: Array, sd: float, seed: int) -> dict[str, Array]:
    """The columns t, f and laser (N,), the laser with white noise of ``sd`` in m."""
    noise = sd * np.random.default_rng(seed).standard_normal(t.size)
    return {"t": t, "f": np.array([force(s) for s in t]), "laser": x + noise}
