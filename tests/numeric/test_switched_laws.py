"""Laws with where(...) in runs and in exported code, against SciPy with located events."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from symhyb.export.functions.exported import export_machine
from symhyb.export.spec import spec_of
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from tests.builders import DRIVEN_MASS

STAGES = DRIVEN_MASS.replace(
    'force = "f"', 'force = "f - where(x > 100 mm, 3 N/m*where(x\' > 0 m/s, 8, 4)*(x - 0.1 m), 0)"'
).replace("3 N/m*", "3 N/m * ")


def beyond(x: float, v: float) -> float:
    return 3 * (8 if v > 0 else 4) * (x - 0.1) if x > 0.1 else 0.0


def test_a_run_is_that_of_scipy_from_event_to_event() -> None:
    """A second stage engages beyond 100 mm, and is stiffer on the way in."""
    t = np.linspace(0, 8, 801)

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, 4 * np.sin(4 * time) - 25 * x - 0.6 * v - beyond(x, v)]

    options = {"rtol": 1e-9, "atol": 1e-11, "max_step": 1e-3, "method": "DOP853"}
    true = solve_ivp(rates, (0, 8), [0.0, 0.0], t_eval=t, **options).y
    fine = np.linspace(0, 8, 16001)
    given = Scenario(t, np.zeros(1), np.zeros(1), fine, 4 * np.sin(4 * fine)[:, None])
    run = simulate(build(parse_model(STAGES)), given)
    assert run.complete
    assert true[0].max() > 0.15
    np.testing.assert_allclose(run.q[:, 0], true[0], atol=2e-5)
    np.testing.assert_allclose(run.v[:, 0], true[1], atol=2e-4)


def test_a_relay_by_time_and_place() -> None:
    text = DRIVEN_MASS.replace('force = "f"', 'force = "where(1 s < t < 2 s and x < 1 m, 5 N, 0)"')
    t = np.linspace(0, 3, 301)
    run = simulate(
        build(parse_model(text)), Scenario(t, np.zeros(1), np.zeros(1), t, 0 * t[:, None])
    )
    assert np.abs(run.q[t < 0.995]).max() == 0
    w = np.sqrt(25 - 0.09)
    on = (t > 1) & (t < 2)
    s = t[on] - 1
    expected = 0.2 * (1 - np.exp(-0.3 * s) * (np.cos(w * s) + 0.3 / w * np.sin(w * s)))
    np.testing.assert_allclose(run.q[on, 0], expected, atol=1e-4)


@pytest.mark.parametrize("events", [False, True])
def test_exports_treat_it_as_a_jump(events: bool, tmp_path: Path) -> None:
    """Smoothed over p.smoothing, or in modes that an importer switches, as sign(...) is."""
    model = parse_model(STAGES)
    spec = spec_of(model, "stages", whole=True, events=events)
    names = [v.name for v in spec.variables]
    assert "p.smoothing" in names
    assert bool([name for name in names if name.startswith("mode.")]) == events
    exported = export_machine(model)
    p = exported.p.copy()
    p[[name for _, name in exported.parameters].index("smoothing")] = 0.0
    for x, v in ((0.05, 1.0), (0.3, 1.0), (0.3, -1.0)):
        rates, _ = exported.evaluate(0.0, np.array([x, v]), np.array([2.0]), p)
        assert rates[1] == pytest.approx(2.0 - 25 * x - 0.6 * v - beyond(x, v), rel=1e-12)
