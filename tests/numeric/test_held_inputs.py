"""Inputs that are held from sample to sample, against exact discretisation: every response to a
staircase follows from the matrix exponential."""

from dataclasses import replace

import numpy as np
import pytest
from builders import DRIVEN_MASS
from scipy.linalg import expm

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.signals import acting, driving
from symhyb.discrepancy.recorded.windows import lay
from symhyb.exact.simulation import simulate
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.model.write import text_of
from symhyb.numeric.kernels.buffers import Array, held_at, held_line
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs import integrate
from symhyb.numeric.runs.between import finer, stepped, with_jumps
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import WindowModel
from symhyb.simulation import run_model, run_table

MASS, STIFFNESS, DAMPING, STEP = 1.0, 25.0, 0.6, 0.05
SYSTEM = np.array([[0.0, 1.0], [-STIFFNESS / MASS, -DAMPING / MASS]])


def model(more: str = ', between = "held"', sensors: str = "") -> Model:
    text = DRIVEN_MASS.replace(", sd = 0.5", "").replace(
        'f = { unit = "N"', f'f = {{ unit = "N"{more}'
    )
    return parse_model(text + sensors)


def staircase(t: Array, u: Array, delay: float = 0.0) -> Array:
    """Places and speeds (N, 2) from rest under u(t − delay), u held; exact."""

    def over(x: Array, force: float, h: float) -> Array:
        whole = np.zeros((3, 3))
        whole[:2, :2], whole[1, 2] = SYSTEM * h, h / MASS
        return np.asarray((expm(whole) @ [*x, force])[:2])

    rows = [np.zeros(2)]
    for i, h in enumerate(np.diff(t)):
        first = over(rows[-1], u[max(i - 1, 0)], delay)
        rows.append(over(first, u[i], h - delay))
    return np.array(rows)


def drive(count: int = 200) -> tuple[Array, Array]:
    """Uneven times and a force that jumps at each of them."""
    random = np.random.default_rng(5)
    t = np.concatenate([[0.0], np.cumsum(STEP * random.uniform(0.6, 1.4, count))])
    return t, random.standard_normal(t.size)


@pytest.mark.parametrize(
    ("method", "allowed"), [("explicit", 1e-7), ("cvodes", 2e-5), ("exact", 1e-7)]
)
def test_an_oscillator_follows_the_staircase(
    method: str, allowed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    if method == "cvodes":
        monkeypatch.setattr(integrate, "field", lambda form: None)
    t, u = drive()
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, u[:, None])
    run = simulate(build(model()), scenario, exact=method == "exact")
    assert run.complete
    exact = staircase(t, u)
    error = np.abs(np.column_stack([run.q, run.v]) - exact).max(axis=0)
    assert np.all(error < allowed * np.abs(exact).max(axis=0))
    # what acts at a sample is its own value: m x'' = u − k x − d x'
    assert run.a[:-1, 0] == pytest.approx(u[:-1] + exact[:-1] @ SYSTEM[1], abs=1e-5)


def test_lines_are_half_a_sample_ahead() -> None:
    t, u = drive()
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, u[:, None])
    run = simulate(build(model("")), scenario)
    exact = staircase(t, u)
    assert np.abs(run.q[:, 0] - exact[:, 0]).max() > 0.02 * np.abs(exact[:, 0]).max()


def recorded(delay: float, count: int = 300) -> tuple[Recording, Array]:
    t = np.arange(count) * STEP
    u = np.random.default_rng(6).standard_normal(count)
    states = staircase(t, u, delay)
    return Recording("r", t, {"f": u}, {"laser": states[:, 0]}, (), ""), states


@pytest.mark.parametrize(
    ("delay", "steps", "allowed"), [(0.0, 1, 2e-4), (0.017, 1, 2e-4), (0.017, 8, 1e-6)]
)
def test_windows_follow_the_staircase_and_its_delay(
    delay: float, steps: int, allowed: float
) -> None:
    recording, states = recorded(delay)
    machine = build(model(f', between = "held", delay = {delay}'))
    cut = lay(recording, machine, motion_of(recording, machine), 2.0, np.full(299, steps))
    assert cut is not None
    start = states[cut.rows[:, 0]]
    x, _ = WindowModel(machine).simulate(cut.block, start, machine.values)
    assert np.abs(x - states[cut.rows]).max(axis=(0, 1)) / np.ptp(states, axis=0) == pytest.approx(
        0.0, abs=allowed
    )


def test_the_slope_by_the_delay_of_a_held_input_is_that_of_differences() -> None:
    recording, states = recorded(0.017)
    machine = build(model(', between = "held", delay = { value = 0.01, sd = 0.01 }'))
    column = machine.column("f.delay")
    window = WindowModel(machine, (column,))
    cut = lay(recording, machine, motion_of(recording, machine), 2.0, np.full(299, 4))
    assert cut is not None
    start, p = states[cut.rows[:, 0]], machine.values.copy()
    p[column] = 0.0171
    slope = window.differentiate(cut.block, start, p).from_free()[..., 0]
    sides = []
    for change in (-1e-5, 1e-5):
        moved = p.copy()
        moved[column] += change
        sides.append(window.simulate(cut.block, start, moved)[1])
    assert slope == pytest.approx((sides[1] - sides[0]) / 2e-5, abs=1e-4 * np.abs(slope).max())
    # and the model with the right delay is nearer than one with another
    p[column] = 0.017
    best = window.simulate(cut.block, start, p)[1]
    p[column] = 0.027
    other = window.simulate(cut.block, start, p)[1]
    y = cut.block.y
    assert np.abs(best - y).max() < 0.05 * np.abs(other - y).max()


def test_the_motion_sees_the_mean_of_both_sides_of_a_jump() -> None:
    recording, _ = recorded(0.0)
    machine, u = build(model()), recording.inputs["f"]
    course = course_of(recording, machine, motion_of(recording, machine))
    assert course.u[1:, 0] == pytest.approx((u[1:] + u[:-1]) / 2)
    assert course.drive[:, 0] == pytest.approx(u)
    assert acting(recording, machine)[:, 0] == pytest.approx(u)


def test_a_simulation_from_a_recording_holds_with_its_delay() -> None:
    recording, states = recorded(0.017)
    held = model(', between = "held", delay = 0.017')
    machine, scenario, run = run_model(held, recording)
    assert np.abs(run.q[:, 0] - states[:, 0]).max() < 3e-7 * np.ptp(states[:, 0])
    t, _ = driving(recording, machine)
    assert t.size == 2 * recording.t.size - 1  # the last jump comes after the end
    rows = run_table(machine, scenario, run).splitlines()[1:]
    written = [float(row.split(",")[1]) for row in rows]
    assert written == pytest.approx([recording.inputs["f"][0], *recording.inputs["f"][:-1]])


def test_steps_between_steps_keep_other_columns_straight() -> None:
    t, u = drive(20)
    values = np.column_stack([u, 2 * t])
    at, lines = stepped(t, values, (0,))
    assert np.all(np.diff(at) > 0)
    middle = (t[1:] + t[:-1]) / 2
    assert np.interp(middle, at, lines[:, 0]) == pytest.approx(u[:-1], abs=0)
    assert lines[:, 1] == pytest.approx(2 * at)
    assert stepped(t, np.ones((t.size, 1)), (0,))[0] is t  # nothing jumps
    fine, both = finer(t, np.column_stack([u, np.sin(t)]), (1,), (0,))
    assert both[:, 0] == pytest.approx(held_at(t, u, fine), abs=0)
    assert with_jumps(t, values, (0,), (0.0, 1.0))[0] is t


def test_a_line_over_a_staircase_has_its_area_and_its_first_moment() -> None:
    t, u = np.array([0.0, 1.0, 3.0]), np.array([2.0, -1.0, 5.0])
    begin, end = np.array([0.5, -1.0, 2.0, 0.9]), np.array([2.5, 1.0, 4.0, 3.1])
    (first, last), (early, late) = held_line(t, u, begin, end)
    h = end - begin
    assert (first + last) / 2 == pytest.approx([-0.25, 2.0, 2.0, (0.2 - 2 + 0.5) / 2.2])
    fine = np.linspace(begin, end, 200_001)
    weighed = (end - fine) * held_at(t, u, fine)
    moment = np.trapezoid(weighed, fine, axis=0)
    assert h**2 * (2 * first + last) / 6 == pytest.approx(moment, abs=1e-4)
    inner = [0, 2, 3]  # no jump at an end of the step
    step = 1e-6
    sides = [held_line(t, u, begin + move, end + move)[0] for move in (-step, step)]
    slopes = (sides[1] - sides[0])[:, inner] / (2 * step)
    assert np.stack([early, late])[:, inner] == pytest.approx(slopes, abs=1e-5)
    assert held_line(t, u, np.array([1.2]), np.array([1.4])) == pytest.approx(
        np.array([[[-1.0], [-1.0]], [[0.0], [0.0]]])
    )
    assert held_at(t, u, np.array([-1.0, 1.0 - 1e-9, 1.0, 2.9, 9.0])).tolist() == [2, -1, -1, -1, 5]


def test_the_word_is_read_and_written() -> None:
    assert model().inputs[0].between == "held"
    rendered = text_of(replace(model(), text=""))
    assert parse_model(rendered).inputs == model().inputs
