"""Friction by a load holds exactly as long as what presses allows: a pendulum that stays up."""

import numpy as np
import pytest
from builders import model_of

from symhyb.exact.simulation import simulate
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario

WEIGHT = 0.5 * 9.81 * 0.2  # N*m, of the arm when it is level
LEVEL, START = 0.1, 0.6  # N*m, rad


@pytest.mark.parametrize(("coefficient", "holds"), [(0.84, True), (0.80, False)])
def test_a_pendulum_whose_bearing_is_pressed_by_its_weight(coefficient: float, holds: bool) -> None:
    """It holds where coulomb + mu·|m g l sin phi| is more than |m g l sin phi|: mu above 0.82."""
    pull = WEIGHT * np.sin(START)
    assert (LEVEL + coefficient * pull > pull) == holds
    model = model_of(
        coordinates={"phi": {"unit": "rad"}},
        parameters={
            "m": (0.5, "kg"),
            "l": (0.2, "m"),
            "g": (9.81, "m/s^2"),
            "T": (LEVEL, "N*m"),
            "mu": (coefficient, "1"),
        },
        gravity=["0", "-g"],
        bodies={"weight": {"mass": "m", "at": ["l*sin(phi)", "-l*cos(phi)"]}},
        elements={
            "bearing": {
                "kind": "friction",
                "on": "phi",
                "coulomb": "T",
                "load_coefficient": "mu",
                "load": "m*g*l*sin(phi)",
            }
        },
        sensors={"angle": {"measures": "phi", "unit": "rad"}},
    )
    t = np.linspace(0, 1, 201)
    scenario = Scenario(t, np.array([START]), np.zeros(1), t[[0, -1]], np.empty((2, 0)))
    run = simulate(build(model), scenario, exact=True)
    assert run.complete
    if holds:
        assert np.all(run.q == START)
    else:  # it begins to fall by what is left, and comes to hold lower down
        fall = (pull - LEVEL - coefficient * pull) / (0.5 * 0.2**2)
        assert run.q[10, 0] - START == pytest.approx(-fall * t[10] ** 2 / 2, rel=0.02)
