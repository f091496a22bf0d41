"""A stiffness that changes with time: in runs, exact runs, windows and exported C one and the same,
that of SciPy."""

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.windows import stretches
from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import spec_of
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel
from symhyb.running import simulate
from tests.builders import DRIVEN_MASS
from tests.changing import changing, staged
from tests.pushed import pushed_model

POINTS = [(4.0, 1.0), (4.2, 0.9), (9.0, 0.9), (9.2, 1.06), (14.0, 1.06), (14.2, 0.96)]  # staged
COURSE = f"""[curves.k_course]
units = ["s", "1"]
points = {[list(point) for point in POINTS]}
interpolation = "linear"
extrapolation = "hold"
"""


def model() -> Model:
    text = DRIVEN_MASS.replace('stiffness = "k"', 'stiffness = "k*curve(k_course, t)"')
    return pushed_model(text + COURSE)


@pytest.mark.parametrize("exact", [False, True])
def test_a_run_is_that_of_scipy(exact: bool) -> None:
    t = np.linspace(0.0, 20.0, 401)

    def rates(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        return [v, 3 * np.sin(time) - 25.0 * staged(time) * x - 0.6 * v]

    true = solve_ivp(rates, (0, 20), [0.1, 0.0], t_eval=t, rtol=1e-9, atol=1e-11, max_step=0.01)
    drive = {"f": lambda time: 3 * np.sin(time)}
    dense = simulate(model(), end=20.0, step=0.005, inputs=drive, start={"x": 0.1}, exact=exact)
    assert dense.q[::10, 0] == pytest.approx(true.y[0], abs=2e-5)


def test_windows_follow_a_recording_to_its_noise() -> None:
    machine, run = build(model()), changing(5, staged)
    (item,) = stretches(run, machine, motion_of(run, machine), 4, 1)
    windows = WindowModel(machine)
    _, y = windows.simulate(item.block, item.start, machine.values)
    later = item.block.t[0] > 10.0  # the start, of a spline, is known to its noise, and decays
    left = (y[0, :, 0] - run.sensors["laser"][item.rows[0]])[later]
    assert np.sqrt(np.mean(left**2)) < 2.2e-3  # of which 2 mm are noise
    plain = WindowModel(build(pushed_model()))
    _, other = plain.simulate(item.block, item.start, plain.machine.values)
    without = (other[0, :, 0] - run.sensors["laser"][item.rows[0]])[later]
    assert np.std(without) > 5 * np.std(left)


def test_the_c_program_finds_no_difference(tmp_path: Path) -> None:
    spec = spec_of(model(), "machine", whole=True)
    put_files(tmp_path, c_files(spec))
    reported = compiled(tmp_path, f"{spec.identifier}.c", f"{spec.identifier}_check.c")
    assert reported == f"0 {spec.identifier}: {SAMPLES} samples, largest relative difference 0\n"


def test_exported_rates_have_the_factor_of_their_time() -> None:
    spec = spec_of(model(), "machine", whole=True)
    e = spec.exported
    for t, factor in [(1.0, 1.0), (6.0, 0.9), (11.0, 1.06), (30.0, 0.96)]:
        rates, _ = e.evaluate(t, np.array([0.2, 0.0]), np.zeros(1), e.p)
        assert rates[1] == pytest.approx(-25.0 * factor * 0.2)
