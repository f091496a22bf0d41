"""A machine behind an actuator: simulated and along windows, against SciPy and differences."""

from functools import partial

import numpy as np
import pytest
from builders import DRIVEN_MASS
from scipy.integrate import solve_ivp

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.signals import driving
from symhyb.discrepancy.recorded.windows import Cut, lay
from symhyb.errors import InputError
from symhyb.exact.simulation import simulate
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.actuators import acted
from symhyb.numeric.kernels.buffers import Array, held_at
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.between import finer
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel
from symhyb.optimisation.rollout import Rollout
from symhyb.simulation import run_model

STIFFNESS, DAMPING = 25.0, 0.6  # of a mass of 1 kg
NUMBERS = {"dead_band": 0.2, "backlash": 0.4, "limit": 1.8, "rate_limit": 9.0, "lag": 0.04}
BETWEEN = ("line", "smooth", "held")


def model(between: str, numbers: dict[str, float], more: str = "") -> Model:
    said = "".join(f", {key} = {value}" for key, value in numbers.items())
    text = DRIVEN_MASS.replace(", sd = 0.5", "").replace(
        'f = { unit = "N"', f'f = {{ unit = "N", between = "{between}"{said}{more}'
    )
    return parse_model(text)


def drive() -> tuple[Array, Array]:
    t = np.linspace(0.0, 6.0, 301)
    return t, 2 * np.sin(3 * t) + np.sin(7.1 * t)


def followed(between: str, numbers: dict[str, float], delay: float = 0.0) -> tuple[Array, Array]:
    """Places and speeds (N, 2) from rest, by SciPy on a fine grid."""
    t, u = drive()
    fine, raw = finer(t, u[:, None], (0,) if between == "smooth" else ())
    at = np.linspace(0.0, 6.0, 60_001)
    signal = (
        held_at(t, u, at - delay) if between == "held" else np.interp(at - delay, fine, raw[:, 0])
    )
    force = acted(at, signal, numbers, fine=True).at(at)

    def rates(s: float, x: Array) -> list[float]:
        return [x[1], float(np.interp(s, at, force)) - STIFFNESS * x[0] - DAMPING * x[1]]

    run = solve_ivp(rates, (0, 6), [0, 0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=2e-3)
    return t, run.y.T


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("between", BETWEEN)
def test_a_run_follows_what_the_actuator_passes_on(between: str, exact: bool) -> None:
    t, expected = followed(between, NUMBERS)
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, drive()[1][:, None])
    run = simulate(build(model(between, NUMBERS)), scenario, exact=exact)
    bare = simulate(build(model(between, {})), scenario, exact=exact)
    off = np.abs(run.q[:, 0] - expected[:, 0]).max()
    assert off < 2e-3 * np.ptp(expected[:, 0])
    assert np.abs(bare.q[:, 0] - expected[:, 0]).max() > 50 * off


def test_a_run_of_other_numbers_takes_them_from_the_parameters() -> None:
    t, expected = followed("line", {"limit": 0.7})
    machine = build(model("line", {"limit": 1.8}))
    p = machine.values.copy()
    p[machine.column("f.limit")] = 0.7
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, drive()[1][:, None])
    run = simulate(machine, scenario, p)
    assert run.q[:, 0] == pytest.approx(expected[:, 0], abs=2e-3 * np.ptp(expected[:, 0]))


@pytest.mark.parametrize("exact", [False, True])
@pytest.mark.parametrize("between", BETWEEN)
def test_a_run_follows_the_steps_of_a_converter(between: str, exact: bool) -> None:
    """Against SciPy with steps at their very instants."""
    t, u = drive()
    fine, raw = finer(t, u[:, None], (0,) if between == "smooth" else ())
    at = np.linspace(0.0, 6.0, 60_001)
    signal = held_at(t, u, at) if between == "held" else np.interp(at, fine, raw[:, 0])
    force = 0.7 * np.round(signal / 0.7)

    def rates(s: float, x: Array) -> list[float]:
        now = force[min(int(s * 1e4 + 1e-6), force.size - 1)]
        return [x[1], now - STIFFNESS * x[0] - DAMPING * x[1]]

    run = solve_ivp(rates, (0, 6), [0, 0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=2e-3)
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, u[:, None])
    found = simulate(build(model(between, {"quantum": 0.7})), scenario, exact=exact)
    bare = simulate(build(model(between, {})), scenario, exact=exact)
    off = np.abs(found.q[:, 0] - run.y[0]).max()
    assert off < 2e-3 * np.ptp(run.y[0])
    assert np.abs(bare.q[:, 0] - run.y[0]).max() > 20 * off


def recorded(between: str, delay: float) -> tuple[Recording, Array]:
    t, states = followed(between, NUMBERS, delay)
    return Recording("r", t, {"f": drive()[1]}, {"laser": states[:, 0]}, (), ""), states


def cut(recording: Recording, machine: Machine, steps: int) -> Cut:
    parts = np.full(recording.t.size - 1, steps)
    found = lay(recording, machine, motion_of(recording, machine), 1.0, parts)
    assert found is not None
    return found


@pytest.mark.parametrize("delay", [0.0, 0.03])
@pytest.mark.parametrize("between", BETWEEN)
def test_windows_and_runs_follow_a_recording(between: str, delay: float) -> None:
    recording, states = recorded(between, delay)
    machine = build(model(between, NUMBERS, f", delay = {delay}" if delay else ""))
    item = cut(recording, machine, 8)
    x, _ = WindowModel(machine).simulate(item.block, states[item.rows[:, 0]], machine.values)
    off = np.abs(x - states[item.rows]).max(axis=(0, 1)) / np.ptp(states, axis=0)
    assert off == pytest.approx(0.0, abs=5e-3)
    _, _, run = run_model(machine.model, recording)
    assert run.q[:, 0] == pytest.approx(states[:, 0], abs=5e-3 * np.ptp(states[:, 0]))
    # what windows see at their samples is what the motion sees
    drive_of_windows = item.course(machine).drive[item.rows][..., 0]
    assert item.block.d[..., 0] == pytest.approx(drive_of_windows)


@pytest.mark.parametrize("delay", [0.0, 0.03])
@pytest.mark.parametrize("between", BETWEEN)
def test_slopes_of_windows_are_those_of_differences(between: str, delay: float) -> None:
    recording, states = recorded(between, delay)
    stated = f", delay = {{ value = {delay}, sd = 0.01 }}"
    machine = build(model(between, NUMBERS, stated))
    paths = [f"f.{key}" for key in (*NUMBERS, "delay")]
    columns = tuple(machine.column(path) for path in paths)
    window, item = WindowModel(machine, columns), cut(recording, machine, 4)
    start, p = states[item.rows[:, 0]], machine.values.copy()
    p[list(columns)] *= 1.02
    slopes = window.differentiate(item.block, start, p).from_free()
    for j, column in enumerate(columns):
        change = 1e-5 * (abs(p[column]) or 0.01)

        def shown(off: float, column: int = column) -> Array:
            moved = p.copy()
            moved[column] += off
            return window.simulate(item.block, start, moved)[1]

        expected = (shown(change) - shown(-change)) / (2 * change)
        reach = max(np.abs(expected).max(), 1e-6)
        if paths[j] == "f.delay":  # its slope is that of lines between the samples
            assert slopes[..., j] == pytest.approx(expected, abs=0.1 * reach)
        else:
            assert slopes[..., j] == pytest.approx(expected, abs=0.01 * reach), paths[j]


@pytest.mark.parametrize("between", BETWEEN)
def test_windows_follow_the_steps_that_a_run_follows(between: str) -> None:
    t, u = drive()
    machine = build(model(between, {"quantum": 0.7}))
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, u[:, None])
    run = simulate(machine, scenario)
    states = np.column_stack([run.q[:, 0], run.v[:, 0]])
    recording = Recording("r", t, {"f": u}, {"laser": states[:, 0]}, (), "")
    item = cut(recording, machine, 4)
    x, _ = WindowModel(machine).simulate(item.block, states[item.rows[:, 0]], machine.values)
    off = np.abs(x - states[item.rows]).max(axis=(0, 1)) / np.ptp(states, axis=0)
    assert off == pytest.approx(0.0, abs=5e-3)


@pytest.mark.parametrize("between", ["line", "smooth"])
def test_slopes_of_windows_by_the_size_of_steps(between: str) -> None:
    """Of a held input the slope is that of the mean: single samples step at single values."""
    t, u = drive()
    machine = build(model(between, {"quantum": 0.7}))
    recording = Recording("r", t, {"f": u}, {"laser": np.sin(t)}, (), "")
    column = machine.column("f.quantum")
    window, item = WindowModel(machine, (column,)), cut(recording, machine, 4)
    start, p = np.zeros((item.rows.shape[0], 2)), machine.values.copy()
    slopes = window.differentiate(item.block, start, p).from_free()

    def shown(off: float) -> Array:
        moved = p.copy()
        moved[column] += off
        return window.simulate(item.block, start, moved)[1]

    expected = (shown(1e-6) - shown(-1e-6)) / 2e-6
    reach = np.abs(expected).max()
    assert slopes[..., 0] == pytest.approx(expected, abs=0.01 * reach)
    assert reach > 1e-3


def test_a_course_has_the_numbers_of_its_machine() -> None:
    recording, _ = recorded("line", 0.0)
    machine = build(model("line", {"limit": 0.5}))
    motion = motion_of(recording, machine)
    assert np.abs(course_of(recording, machine, motion).u).max() == pytest.approx(0.5)
    t_u, u = driving(recording, machine)  # what the actuator gets
    assert u[:, 0] == pytest.approx(recording.inputs["f"])
    assert t_u == pytest.approx(recording.t)


def test_a_rollout_refuses_an_actuator() -> None:
    t, u = drive()
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, u[:, None])
    run = partial(Rollout, build(model("line", {"lag": 0.1})), scenario)
    with pytest.raises(InputError, match=r"inputs\.f: has an actuator"):
        run()
