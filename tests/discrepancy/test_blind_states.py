"""A place that no sensor shows is estimated with the model, declared states among it."""

import numpy as np
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build
from tests.builders import DRIVEN_MASS

COIL = DRIVEN_MASS.replace('f = { unit = "N" }', 'u = { unit = "V" }').replace(
    "[inputs]",
    """R = { value = 2.0, unit = "ohm" }
L = { value = 40.0, unit = "mH" }
c = { value = 5.0, unit = "N/A" }
[states]
i = { unit = "A", rate = "(u - R*i - c*x')/L" }
[inputs]""",
)


def test_a_mass_on_a_coil_under_an_accelerometer_alone() -> None:
    """With the current at 0 in the equations that guide it, the place was wrong by 14 % (RMS)."""
    text = COIL.replace('force = "f"', 'force = "c*i"')
    text = text.replace('measures = "x", unit = "m"', "measures = \"x''\", unit = 'm/s^2'")
    phases = np.random.default_rng(2).uniform(0, 2 * np.pi, 14)
    lines, t = np.linspace(0.4, 8.0, 14), 0.004 * np.arange(2000)

    def voltage(time: float) -> float:
        return float(np.sin(2 * np.pi * time * lines + phases).sum())

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v, i = state
        return [v, 5 * i - 25 * x - 0.6 * v, (voltage(time) - 2 * i - 5 * v) / 0.04]

    true = solve_ivp(rates, (0, t[-1]), [0, 0, 0], t_eval=t, rtol=1e-8, max_step=0.004).y
    pulls = 5 * true[2] - 25 * true[0] - 0.6 * true[1]
    noise = 5e-3 * pulls.std() * np.random.default_rng(4).standard_normal(t.size)
    volts = np.array([voltage(time) for time in t])
    recording = Recording("coil.csv", t, {"u": volts}, {"laser": pulls + noise}, (), "")
    motion = motion_of(recording, build(parse_model(text)))
    assert motion.blind == ("x",)
    assert np.std(motion.q[:, 0] - true[0]) < 0.1 * true[0].std()
    assert np.std(motion.v[:, 0] - true[1]) < 0.05 * true[1].std()
