"""Recordings of the driven mass of ``rigs.py`` with laws that remember or stop, by SciPy alone.

Every law is typed here a second time, from docs/model-file.md; nothing comes from symhyb.
"""

from collections.abc import Callable, Mapping

import numpy as np
from rigs import DAMPING, MASS, STIFFNESS
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording

Law = Callable[[float, float, float, float], tuple[float, float]]
"""(x, v, z, f) -> the force that resists, N, and z'; f is what the shaker pushes with."""


def bouc_wen(
    stiffness: float, beta: float, gamma: float, exponent: float = 1.0, play: float = 0.0
) -> Law:
    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        size = abs(z)
        turned = size ** (exponent - 1) * z if z else 0.0
        rate = v - beta * abs(v) * turned - gamma * v * size**exponent
        return stiffness * (max(z - play, 0.0) + min(z + play, 0.0)), rate

    return law


def lugre(
    coulomb: float, stiffness: float, micro: float = 0.0, static: float = 0.0, stribeck: float = 1.0
) -> Law:
    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        level = coulomb + (max(static, coulomb) - coulomb) * np.exp(-((v / stribeck) ** 2))
        rate = v - stiffness * abs(v) * z / level
        return stiffness * z + micro * rate, rate

    return law


def stop(stiffness: float, clearance: float, damping: float = 0.0) -> Law:
    def law(x: float, v: float, z: float, f: float) -> tuple[float, float]:
        if x > clearance:
            return max(stiffness * (x - clearance) + damping * v, 0.0), 0.0
        if x < -clearance:
            return min(stiffness * (x + clearance) + damping * v, 0.0), 0.0
        return 0.0, 0.0

    return law


def dead_zone(width: float) -> Law:
    """A shaker that pushes only beyond so many N: a dead zone of the input."""
    return lambda x, v, z, f: (float(np.clip(f, -width, width)), 0.0)


def absorber(mass: float, stiffness: float, damping: float) -> Callable[..., tuple[float, object]]:
    """A second mass on a spring and a damper, which no sensor sees: z are its place and speed."""

    def law(x: float, v: float, z: np.ndarray, f: float) -> tuple[float, object]:
        pull = stiffness * (z[0] - x) + damping * (z[1] - v)
        return -pull, [z[1], -pull / mass]

    return law


def product(c: float, of: Callable[[float, float, float], float]) -> Law:
    """c times a function of (x, v, f)."""
    return lambda x, v, z, f: (c * of(x, v, f), 0.0)


def driven(
    law: Law | Callable[..., tuple[float, object]],
    seed: int,
    *,
    inner: int = 1,
    lines: Mapping[float, float] | None = None,
    noise: float = 0.003,
    duration: float = 15.0,
    size: float = 8.0,
) -> Recording:
    """Position at 200 Hz under a multisine of ``size`` N; ``noise`` is relative to the standard
    deviation of the position, ``lines`` are unknown forces: amplitudes in N by frequency in Hz. A
    law with several ``inner`` states gets and returns an array of them."""
    random = np.random.default_rng(seed)
    t = np.arange(0, duration, 0.005)
    shaken, phases = np.linspace(0.3, 5, 14), random.uniform(0, 2 * np.pi, 14)

    def push(time: float) -> float:
        return float(size * np.sqrt(2 / 14) * np.sin(2 * np.pi * shaken * time + phases).sum())

    def hum(time: float) -> float:
        return sum(a * np.sin(2 * np.pi * f * time + f) for f, a in (lines or {}).items())

    def rate(time: float, state: np.ndarray) -> list[float]:
        x, v, *z = state
        f = push(time)
        force, drift = law(x, v, z[0] if inner == 1 else z, f)
        return [
            v,
            (f + hum(time) - STIFFNESS * x - DAMPING * v - force) / MASS,
            *np.atleast_1d(drift),
        ]

    run = solve_ivp(
        rate,
        (0, duration),
        [0] * (2 + inner),
        t_eval=t,
        method="LSODA",
        rtol=1e-8,
        atol=1e-10,
        max_step=0.005,
    )
    x = run.y[0]
    measured = x + noise * x.std() * random.standard_normal(t.size)
    return Recording(
        "rig.csv", t, {"f": np.array([push(s) for s in t])}, {"laser": measured}, (), ""
    )


RIG = """
symhyb = 1
title = "a part on a test rig"
[coordinates]
x = { unit = "m", imposed = true }
[parameters]
m = { value = 0.5, unit = "kg" }
[bodies.carriage]
mass = "m"
at = ["x", "0"]
[sensors]
cell = { measures = "reaction(x)", unit = "N" }
"""


def on_rig(law: Law, seed: int, *, noise: float = 0.005, duration: float = 10.0) -> Recording:
    """A rig moves the part by a multisine of 30 mm (RMS 13 mm) at 200 Hz, and a cell measures what
    that takes with ``noise``, relative to its standard deviation."""
    random = np.random.default_rng(seed)
    t = np.arange(0, duration, 0.005)
    lines, phases = np.linspace(0.3, 3, 8), random.uniform(0, 2 * np.pi, 8)
    turn = 2 * np.pi * lines

    def motion(time: float, derivative: int = 0) -> float:
        waves = turn**derivative * np.sin(turn * time + phases + derivative * np.pi / 2)
        return float(0.0065 * waves.sum())

    def rate(time: float, state: np.ndarray) -> list[float]:
        return [law(motion(time), motion(time, 1), state[0], 0.0)[1]]

    run = solve_ivp(
        rate, (0, duration), [0], t_eval=t, method="LSODA", rtol=1e-8, atol=1e-11, max_step=0.005
    )
    force = np.array(
        [
            0.5 * motion(s, 2) + law(motion(s), motion(s, 1), z, 0.0)[0]
            for s, z in zip(t, run.y[0], strict=True)
        ]
    )
    measured = force + noise * force.std() * random.standard_normal(t.size)
    x = np.array([motion(s) for s in t])
    return Recording("rig.csv", t, {"x": x}, {"cell": measured}, (), "")


PENDULUM = """
symhyb = 1
title = "two point masses on two rods"
gravity = ["0", "-g"]
[coordinates]
alpha = { unit = "rad" }
beta = { unit = "rad" }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
l_1 = { value = 0.7, unit = "m" }
l_2 = { value = 0.4, unit = "m" }
m_1 = { value = 1.3, unit = "kg" }
m_2 = { value = 0.6, unit = "kg" }
[points]
elbow = ["l_1*sin(alpha)", "-l_1*cos(alpha)"]
hand = ["l_1*sin(alpha) + l_2*sin(beta)", "-l_1*cos(alpha) - l_2*cos(beta)"]
[bodies.upper]
mass = "m_1"
at = "elbow"
[bodies.lower]
mass = "m_2"
at = "hand"
[sensors]
first = { measures = "alpha", unit = "rad" }
second = { measures = "beta", unit = "rad" }
"""


def pendulum(
    seed: int, *, tip: float = 0.0, upper: float = 0.0, noise: float = 2e-3, duration: float = 12.0
) -> Recording:
    """A free swing of the double pendulum at 100 Hz: ``tip`` is a drag in N·s²/m² against the
    velocity of the hand, ``upper`` one in N·m·s² on alpha; ``noise`` in rad."""
    random = np.random.default_rng(seed)
    t = np.arange(0, duration, 0.01)
    g, l1, l2, m1, m2 = 9.81, 0.7, 0.4, 1.3, 0.6

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        a, b, da, db = state
        c, s = np.cos(a - b), np.sin(a - b)
        mass = np.array([[(m1 + m2) * l1**2, m2 * l1 * l2 * c], [m2 * l1 * l2 * c, m2 * l2**2]])
        pull = np.array(
            [
                -m2 * l1 * l2 * s * db**2 - (m1 + m2) * g * l1 * np.sin(a),
                m2 * l1 * l2 * s * da**2 - m2 * g * l2 * np.sin(b),
            ]
        )
        jacobian = np.array([[l1 * np.cos(a), l2 * np.cos(b)], [l1 * np.sin(a), l2 * np.sin(b)]])
        velocity = jacobian @ [da, db]
        pull -= jacobian.T @ velocity * tip * np.hypot(*velocity)
        pull[0] -= upper * abs(da) * da
        return np.array([da, db, *np.linalg.solve(mass, pull)])

    start = [random.uniform(0.8, 1.3), random.uniform(-1.2, -0.7), 0.0, 0.0]
    run = solve_ivp(rate, (0, duration), start, t_eval=t, rtol=1e-9, atol=1e-11)
    first, second = run.y[:2] + noise * random.standard_normal((2, t.size))
    return Recording("swing.csv", t, {}, {"first": first, "second": second}, (), "")


def numbers(diagnosis: object) -> Mapping[str, tuple[float, float]]:
    """(value, sd) of everything found, as ``kind.key``; of several of a kind the last."""
    return {
        f"{found.element.kind}.{one.term}": (one.value, one.sd)
        for found in diagnosis.found  # type: ignore[attr-defined]
        for one in found.estimates
    }
