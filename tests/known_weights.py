"""A pendulum whose weight and length differ from recording to recording, and are known."""

import numpy as np

from symhyb.data.recording import Recording
from symhyb.model.types import Model
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.running import simulate

PENDULUM = """
symhyb = 1
gravity = ["0", "-g"]

[coordinates]
q = { unit = "rad", start = 1.0 }

[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 500, unit = "g" }
l = { value = 0.1, unit = "m" }
c = { value = 0.01, unit = "N*m*s/rad", sd = 0.005 }

[points]
weight = ["l*sin(q)", "-l*cos(q)"]

[bodies.weight]
mass = "m"
at = "weight"

[elements.loss]
kind = "damper"
on = "q"
damping = "c"

[sensors]
encoder = { measures = "q", unit = "rad" }
"""

BARE = PENDULUM.replace(", sd = 0.005", "").replace("value = 0.01", "value = 0.0")
"""The same without a loss, and nothing uncertain."""

WEIGHTS = ((400.0, 0.1), (700.0, 0.15), (1100.0, 0.12))
"""Weights in g and lengths in m."""


def swing(model: Model, weight: float, length: float, **parameters: float) -> Trajectory:
    """A free swing of six seconds; ``parameters`` of the model besides."""
    known = {"m": weight, "l": length, **parameters}
    return simulate(model, end=6.0, step=0.01, parameters=known)


def recorded(
    model: Model, weight: float, length: float, *, knows: bool = True, **parameters: float
) -> Recording:
    """Such a swing as an encoder with noise of 1 mrad records it, which ``knows`` its weight."""
    run = swing(model, weight, length, **parameters)
    rng = np.random.default_rng(int(weight))
    known = {"m": weight / 1000, "l": length} if knows else {}
    seen = {"encoder": run.y[:, 0] + 1e-3 * rng.standard_normal(run.t.size)}
    return Recording(f"swing-{weight:g}.csv", run.t, {}, seen, parameters=known)
