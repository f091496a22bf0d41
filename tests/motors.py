"""A motor with the inductance of its armature, by SciPy alone; nothing comes from symhyb but the
reader of its model file.

    u ──R──L──(k φ')      L i' = u − R i − k φ',   J φ'' = k i − d φ' − friction
"""

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.model.types import Model

Array = NDArray[np.float64]
J, R, L, K, D = 2e-4, 1.0, 3e-3, 0.05, 1e-4

MOTOR = """symhyb = 1
title = "a motor with inductance"
[coordinates]
phi = { unit = "rad" }
[states]
i = { unit = "A", rate = "(u - R*i - k*phi')/L", about = "current of the armature" }
[parameters]
J = { value = 2e-4, unit = "kg*m^2" }
R = { value = 1.0, unit = "ohm", sd = 0.3 }
L = { value = 3.0, unit = "mH" }
k = { value = 0.05, unit = "N*m/A" }
d = { value = 1e-4, unit = "N*m*s/rad" }
[inputs]
u = { unit = "V" }
[bodies.rotor]
joint = ["0", "0"]
mass = "0"
inertia = "J"
angle = "phi"
[elements.motor]
kind = "torque"
on = "phi"
torque = "k*i"
[elements.bearing]
kind = "damper"
on = "phi"
damping = "d"
[sensors]
encoder = { measures = "phi", unit = "rad" }
"""
AMMETER = 'amps = { measures = "i", unit = "A" }\n'


def motor(more: str = "", ammeter: bool = False) -> Model:
    """The model of the motor, with further tables before its sensors."""
    text = MOTOR.replace("[sensors]\n", f"{more}[sensors]\n")
    return parse_model(text + (AMMETER if ammeter else ""), "motor.toml")


def turned(
    samples: int = 2000,
    resistance: float = R,
    friction: float = 0.0,
    begin: float = 0.0,
) -> tuple[Array, Array, Array]:
    """Times (N,), voltage (N,) and (φ, φ', i) (3, N) of the motor under twelve sines, 5 ms a
    sample; the current begins with ``begin``."""
    phases = np.random.default_rng(1).uniform(0, 2 * np.pi, 12)
    lines, t = np.linspace(0.3, 6.0, 12), 0.005 * np.arange(samples)

    def voltage(time: Array | float) -> Array:
        waves: Array = np.sin(2 * np.pi * np.multiply.outer(time, lines) + phases)
        return np.asarray(1.2 * waves.sum(axis=-1))

    def rates(time: float, state: Array) -> list[float]:
        _, w, i = state
        held = D * w + friction * np.tanh(w / 0.02)
        return [w, (K * i - held) / J, (float(voltage(time)) - resistance * i - K * w) / L]

    options = {"method": "LSODA", "rtol": 1e-8, "atol": 1e-10, "max_step": 0.005}
    run = solve_ivp(rates, (0, t[-1]), [0.0, 0.0, begin], t_eval=t, **options)
    return t, voltage(t), run.y


def recorded(ammeter: bool = False, **physics: float) -> Recording:
    """The angle with 0.1 % noise, and the current with 0.5 %, of the motor with other physics."""
    t, u, (phi, _, i) = turned(**physics)  # type: ignore[arg-type]
    random = np.random.default_rng(7)
    sensors = {"encoder": phi + 1e-3 * phi.std() * random.standard_normal(t.size)}
    if ammeter:
        sensors["amps"] = i + 5e-3 * i.std() * random.standard_normal(t.size)
    return Recording("motor.csv", t, {"u": u}, sensors, (), "")
