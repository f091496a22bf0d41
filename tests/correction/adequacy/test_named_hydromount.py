r"""A hidden mode whose damper stands against rest becomes a hydromount; a mode does not.

wall |--/\/\/--[1 kg]--▶ x ──/\/\/──[m_f]──[===]──|
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from symhyb.correction.adequacy.named_mode import modes_instead
from symhyb.correction.search.trajectory import grouped
from symhyb.data.recording import Recording
from symhyb.model.types import On
from tests.correction.adequacy.test_named_mode import ridden
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, judged

CHAMBER, FLUID = 15.0, 0.266
LINES = np.linspace(0.2, 2.0, 10)


def mounted(loss: float, square: float, seed: int = 3, samples: int = 1000) -> Recording:
    """The pushed mass on a hydromount, by SciPy."""
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, LINES.size)

    def push(t: float) -> float:
        return float(4 * np.sqrt(2 / LINES.size) * np.sin(2 * np.pi * LINES * t + phases).sum())

    def rates(t: float, y: np.ndarray) -> list[float]:
        x, v, z, w = y
        pressed = CHAMBER * (x - z)
        lost = loss * w + square * abs(w) * w
        return [v, push(t) - STIFFNESS * x - DAMPING * v - pressed, w, (pressed - lost) / FLUID]

    t = STEP * np.arange(samples)
    run = solve_ivp(rates, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-11, max_step=STEP)
    seen = run.y[0] + NOISE * np.random.default_rng(900 + seed).standard_normal(samples)
    return Recording(
        "made.csv", t, {"f": np.array([push(now) for now in t])}, {"laser": seen}, (), ""
    )


@pytest.mark.slow
@pytest.mark.parametrize(("loss", "square"), [(0.6, 0.0), (0.3, 0.5)])
def test_the_fluid_of_a_track_becomes_a_hydromount_with_its_numbers(
    loss: float, square: float
) -> None:
    ground, found = judged(mounted(loss, square))
    assert found.certain("hidden mode") == On("x")
    answer = modes_instead(ground, found)
    assert answer is not None
    (cause,), (row,) = answer.causes, grouped(answer)
    assert cause.kind == "hydromount"
    true = {"stiffness": CHAMBER, "mass": FLUID, "damping": loss}
    if square:
        true["drag"] = square
    assert set(row) == set(true)
    deviations = np.sqrt(np.diag(answer.fit.covariance))
    for i, (key, value) in enumerate(row.items()):
        assert abs(value - true[key]) < 3 * deviations[i] + 2e-3 * true[key], key
        assert deviations[i] < 0.1 * true[key], key


@pytest.mark.slow
def test_a_mode_is_no_hydromount() -> None:
    ground, found = judged(ridden([(0.15, 2.9, 0.05)], 3))
    answer = modes_instead(ground, found)
    assert answer is not None
    assert [cause.kind for cause in answer.causes] == ["mode"]
