"""Friction by place holds as long as its level there allows: a block on a spring in a guide."""

import numpy as np
import pytest
from builders import model_of

from symhyb.exact.simulation import simulate
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario

STIFFNESS, LEVEL, SLOPE = 50.0, 1.0, 40.0  # N/m, N, N/m


@pytest.mark.parametrize(("start", "holds"), [(0.05, True), (-0.024, False), (0.12, False)])
def test_a_block_holds_where_the_guide_is_tight_enough(start: float, holds: bool) -> None:
    """It holds where F_c + g·x is more than k·|x|: between -1/90 and 1/10 m."""
    assert (max(LEVEL + SLOPE * start, 0.0) > STIFFNESS * abs(start)) == holds
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={
            "m": (0.5, "kg"),
            "k": (STIFFNESS, "N/m"),
            "F_c": (LEVEL, "N"),
            "g_s": (SLOPE, "N/m"),
        },
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "spring": {"kind": "spring", "on": "x", "stiffness": "k"},
            "guide": {"kind": "friction", "on": "x", "coulomb": "F_c", "slope": "g_s"},
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    t = np.linspace(0, 2, 401)
    scenario = Scenario(t, np.array([start]), np.zeros(1), t[[0, -1]], np.empty((2, 0)))
    run = simulate(build(model), scenario, exact=True)
    assert run.complete
    if holds:
        assert np.all(run.q == start)
        return
    pull = STIFFNESS * abs(start) - max(LEVEL + SLOPE * start, 0.0)
    gone = abs(run.q[2, 0] - start)
    assert gone == pytest.approx(pull / 0.5 * t[2] ** 2 / 2, rel=0.02)
    last = run.q[-1, 0]  # it comes to hold where it can
    assert run.q[-1] == run.q[-40]
    assert max(LEVEL + SLOPE * last, 0.0) >= STIFFNESS * abs(last)
