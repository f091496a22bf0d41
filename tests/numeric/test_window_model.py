"""Windows: simulated like CVODES does, and linearised like differences do."""

from dataclasses import replace

import numpy as np
import pytest
from blocks import block, slope, uneven
from builders import cart_pole, damper, model_of, oscillator, push, run, spring
from numpy.typing import NDArray

from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs import window_steps
from symhyb.numeric.runs.windows import Block, WindowModel

Array = NDArray[np.float64]


def by_cvodes(machine: Machine, windows: Block, start: Array) -> tuple[Array, Array]:
    """States (W, L, 2n) and outputs (W, L, m) of the same windows."""
    n = machine.n
    runs = [
        run(machine, t, x[:n], x[n:], u)
        for t, x, u in zip(windows.t, start, windows.d, strict=True)
    ]
    assert all(result.complete for result in runs)
    states = np.array([np.hstack([result.q, result.v]) for result in runs])
    return states, np.array([result.y for result in runs])


def sticking(transition: float) -> Model:
    """A mass on a spring in dry friction, pushed slowly through several reversals."""
    return oscillator(
        {
            "hold": spring("k"),
            "rail": {"kind": "friction", "on": "x", "coulomb": "c", "transition": "w"},
            "motor": push("f"),
        },
        {"k": (120.0, "N/m"), "c": (1.5, "N"), "w": (transition, "m/s")},
        {
            "place": {"measures": "x", "unit": "m"},
            "speed": {"measures": "x'", "unit": "m/s"},
        },
        {"f": {"unit": "N"}},
    )


def test_windows_against_cvodes() -> None:
    machine = build(cart_pole())
    t = uneven(3, 40, seed=1)
    u = 2 * np.sin(5 * t)[..., None]
    rng = np.random.default_rng(2)
    start = rng.normal(size=(3, 4)) * [0.1, 0.5, 0.3, 1.0]
    windows = block(t, u, 3, substeps=2)
    x, y = WindowModel(machine).simulate(windows, start, machine.values)
    states, outputs = by_cvodes(machine, windows, start)
    assert np.ptp(states[..., 0]) > 0.05
    scale = np.abs(states).max(axis=(0, 1))
    assert x / scale == pytest.approx(states / scale, abs=1e-3)
    assert y[..., :2] == pytest.approx(outputs[..., :2], abs=1e-3)


@pytest.mark.parametrize(("transition", "error"), [(0.05, 2e-6), (1e-4, 5e-4)])
def test_windows_with_dry_friction_against_cvodes(transition: float, error: float) -> None:
    """A mass that sticks and slips; the amplitude is 3 cm."""
    machine = build(sticking(transition))
    t = np.linspace(0, 2, 401)[None] + np.array([[0.0], [0.3]])
    u = 4 * np.sin(6 * t)[..., None]
    windows = block(t, u, 2, substeps=4)
    start = np.array([[0.02, 0.1], [-0.01, 0.0]])
    x, _ = WindowModel(machine).simulate(windows, start, machine.values)
    states, _ = by_cvodes(machine, windows, start)
    assert np.ptp(states[..., 0]) > 0.04
    assert x[..., 0] == pytest.approx(states[..., 0], abs=error)


def test_more_substeps_come_closer() -> None:
    machine = build(cart_pole())
    t = np.linspace(0, 1, 21)[None]
    u = 2 * np.sin(5 * t)[..., None]
    start = np.array([[0.05, 0.6, 0.2, -1.0]])
    model = WindowModel(machine)
    exact, _ = by_cvodes(machine, block(t, u, 3), start)
    errors = [
        np.abs(model.simulate(block(t, u, 3, parts), start, machine.values)[0] - exact).max()
        for parts in (1, 4, 16)
    ]
    assert errors[0] > 3 * errors[1] > 9 * errors[2]
    assert errors[2] < 1e-4


def test_substeps_may_differ_from_interval_to_interval() -> None:
    """One window in one call is the same as its intervals one by one."""
    machine = build(sticking(0.01))
    model = WindowModel(machine)
    t = uneven(1, 12, seed=3)
    u = 3 * np.cos(9 * t)[..., None]
    parts = np.random.default_rng(4).integers(1, 5, (1, 11))
    x, _ = model.simulate(block(t, u, 2, parts), np.array([[0.01, 0.2]]), machine.values)
    state = x[:, 0]
    for i in range(11):
        both = slice(i, i + 2)
        one = block(t[:, both], u[:, both], 2, parts[:, i : i + 1])
        state = model.simulate(one, state, machine.values)[0][:, 1]
        assert state == pytest.approx(x[:, i + 1], abs=1e-14)


def test_an_interval_of_no_length_keeps_the_state() -> None:
    machine = build(sticking(0.01))
    t = np.array([[0.0, 0.01, 0.01, 0.02]])
    u = np.ones((1, 4, 1))
    x, _ = WindowModel(machine).simulate(block(t, u, 2), np.array([[0.01, 0.2]]), machine.values)
    assert x[0, 2] == pytest.approx(x[0, 1], abs=1e-15)
    assert x[0, 3] != pytest.approx(x[0, 2], abs=1e-6)


def test_a_window_that_diverges_is_not_finite_and_leaves_the_others_alone() -> None:
    model = oscillator(
        {"soft": {"kind": "spring", "on": "x", "cubic": "c"}}, {"c": (-5.0, "N/m^3")}
    )
    machine = build(model)
    t = np.tile(np.linspace(0, 6, 200), (2, 1))
    start = np.array([[30.0, 0.0], [0.01, 0.0]])
    with np.errstate(all="ignore"):
        x, y = WindowModel(machine).simulate(
            block(t, np.empty((2, 200, 0)), 1), start, machine.values
        )
    assert not np.isfinite(x[0, -1]).all()
    assert np.isfinite(x[1]).all()
    assert np.isfinite(y[1]).all()


# --- derivatives ---------------------------------------------------------------------------


@pytest.fixture(scope="module")
def swinging() -> tuple[Machine, WindowModel, Block, Array]:
    """The cart and pole, two windows with uneven samples and substeps; all but g is free."""
    machine = build(cart_pole())
    t = uneven(2, 15, seed=5)
    u = 2 * np.sin(5 * t)[..., None]
    parts = np.random.default_rng(6).integers(6, 10, (2, 14))
    model = WindowModel(machine, tuple(range(1, machine.values.size)))
    start = np.array([[0.05, 0.6, 0.2, -1.0], [0.1, -0.4, -0.3, 0.5]])
    return machine, model, block(t, u, 3, parts), start


def test_derivatives_by_initial_states(swinging: tuple[Machine, WindowModel, Block, Array]) -> None:
    machine, model, windows, start = swinging
    exact = model.differentiate(windows, start, machine.values).from_start()
    assert exact.shape == (2, 15, 3, 4)
    for i in range(4):
        moved = np.eye(4)[i]
        found = slope(
            lambda h, d=moved: model.simulate(windows, start + h * d, machine.values)[1], 1e-4
        )
        assert exact[..., i] == pytest.approx(found, rel=1e-4, abs=2e-5 * np.abs(found).max())


def test_derivatives_by_both_are_the_same_in_one_pass(
    swinging: tuple[Machine, WindowModel, Block, Array],
) -> None:
    machine, model, windows, start = swinging
    linear = model.differentiate(windows, start, machine.values)
    by_start, by_free = linear.from_start_and_free()
    assert by_start == pytest.approx(linear.from_start(), rel=1e-12, abs=1e-14)
    assert by_free == pytest.approx(linear.from_free(), rel=1e-12, abs=1e-14)


def test_derivatives_by_parameters(swinging: tuple[Machine, WindowModel, Block, Array]) -> None:
    machine, model, windows, start = swinging
    exact = model.differentiate(windows, start, machine.values).from_free()
    assert exact.shape == (2, 15, 3, 10)
    p = machine.values
    for column, i in enumerate(model.free):
        moved = np.eye(p.size)[i] * p[i]
        found = slope(lambda h, d=moved: model.simulate(windows, start, p + h * d)[1], 1e-3)
        found /= p[i]
        assert exact[..., column] == pytest.approx(found, rel=1e-4, abs=1e-5 * np.abs(found).max())


def linear_model() -> Model:
    """Two masses and springs, with a recorded force; everything about it is linear."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "k": (120.0, "N/m"), "d": (0.8, "N*s/m"), "far": (1.0, "m")},
        inputs={"f": {"unit": "N"}, "g": {"unit": "N"}},
        points={"a": ["x", "0"], "b": ["far + y", "0"]},
        bodies={"one": {"mass": "m", "at": "a"}, "two": {"mass": "m", "at": "b"}},
        elements={
            "hold": spring("k"),
            "oil": damper("d", on="y"),
            "link": {"kind": "spring", "between": ["a", "b"], "stiffness": "3*k", "length": "far"},
            "motor": push("f"),
            "other": push("g", on="y"),
        },
        sensors={
            "place": {"measures": "x + 2*y", "unit": "m"},
            "accel": {"measures": "y''", "unit": "m/s^2"},
        },
    )


@pytest.mark.parametrize("parts", [1, 3])
def test_response_to_test_forces_is_that_of_the_same_forces_as_inputs(parts: int) -> None:
    """On a linear machine from rest; the test force is held at its middle value in each step, an
    input runs linearly, which differs by a little of the second order of the step."""
    machine = build(linear_model())
    t = np.tile(np.linspace(0, 0.8, 161), (2, 1))
    force = np.stack([np.sin(7 * t), np.cos(4 * t) * t], axis=-1) * [[[1.0, 2.0]], [[-2.0, 0.5]]]
    still = block(t, np.zeros((2, 161, 2)), 2, parts)
    model = WindowModel(machine)
    linear = model.differentiate(still, np.zeros((2, 4)), machine.values, forces=True)
    response = linear.from_forces(force[..., None])[..., 0]
    _, y = model.simulate(block(t, force, 2, parts), np.zeros((2, 4)), machine.values)
    size = np.abs(y).max(axis=(0, 1))
    assert np.all(size > 1e-3)
    assert response / size == pytest.approx(y / size, abs=1e-3)


def test_response_to_test_forces_scales_and_adds() -> None:
    machine = build(linear_model())
    t = np.linspace(0, 0.8, 41)[None]
    model = WindowModel(machine)
    linear = model.differentiate(
        block(t, np.zeros((1, 41, 2)), 2), np.zeros((1, 4)), machine.values, forces=True
    )
    rng = np.random.default_rng(7)
    one, two = rng.normal(size=(2, 1, 41, 2))
    both = np.stack([one, two, 2 * one - 3 * two], axis=-1)
    response = linear.from_forces(both)
    assert response.shape == (1, 41, 2, 3)
    assert response[..., 2] == pytest.approx(2 * response[..., 0] - 3 * response[..., 1])


def test_along_a_simulated_motion_there_is_no_defect() -> None:
    machine = build(cart_pole())
    model = WindowModel(machine, (5,))
    t = uneven(2, 15, seed=5)
    windows = block(t, 2 * np.sin(5 * t)[..., None], 3, 2)
    start = np.array([[0.05, 0.6, 0.2, -1.0], [0.1, -0.4, -0.3, 0.5]])
    x, y = model.simulate(windows, start, machine.values)
    along = model.along(windows, x, machine.values)
    assert along.defect == pytest.approx(np.zeros_like(along.defect), abs=1e-12)
    assert along.output == pytest.approx(y)
    again = model.differentiate(windows, start, machine.values, forces=True)
    for name in ("transition", "left", "right", "by_free", "by_state", "by_force", "direct"):
        assert getattr(along, name) == pytest.approx(getattr(again, name), abs=1e-12)


def test_what_a_linear_model_fails_to_do_is_found_from_a_measured_motion() -> None:
    """Along any motion, output − from_defect is what the model does from the motion's start."""
    machine = build(linear_model())
    model = WindowModel(machine)
    t = np.linspace(0, 0.8, 41)[None]
    u = np.stack([np.sin(7 * t), np.cos(4 * t)], axis=-1)
    windows = block(t, u, 2, substeps=8)
    motion = np.stack([np.sin(3 * t), t**2, 3 * np.cos(3 * t), 2 * t], axis=-1)
    linear = model.along(windows, motion, machine.values)
    _, y = model.simulate(windows, motion[:, 0], machine.values)
    assert np.abs(linear.defect).max() > 1e-2
    assert linear.output + linear.from_defect() == pytest.approx(y, rel=2e-5, abs=1e-6)


@pytest.mark.parametrize("substeps", [10, 24, 64])
def test_slopes_along_pieces_of_many_steps_are_those_of_the_steps(
    substeps: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pieces of one, three and eight steps: the run is the same, and collocation errs little."""
    machine = build(cart_pole())
    model = WindowModel(machine, (machine.column("g"), machine.column("m_p")))
    t = np.broadcast_to(np.arange(40) / 50, (3, 40))
    windows = block(t, 2 * np.sin(5 * t)[..., None], 3, substeps=substeps)
    start = np.array([[0.0, 0.5, 0.2, 0.0], [0.1, 0.3, 0.0, 1.0], [0.0, 0.2, 0.1, -1.0]])
    in_pieces = model.differentiate(windows, start, machine.values, forces=True)
    asked: list[int] = []
    whole = window_steps.Steps.slopes

    def counted(self: window_steps.Steps, run: window_steps.Taken, p: Array, forces: bool) -> Array:
        asked.append(len(run.given[3]))
        return whole(self, run, p, forces)

    monkeypatch.setattr(window_steps.Steps, "slopes", counted)
    model.differentiate(windows, start, machine.values)
    monkeypatch.setattr(window_steps, "PIECES_MOST", substeps)
    by_step = model.differentiate(windows, start, machine.values, forces=True)
    intervals = windows.substeps.size
    assert asked == [intervals * (10 if substeps == 10 else 8), intervals * substeps]
    assert np.array_equal(in_pieces.x, by_step.x)
    for mine, theirs, error in (
        (in_pieces.from_start(), by_step.from_start(), 1e-5),
        (in_pieces.from_free(), by_step.from_free(), 1e-5),
        (in_pieces.left, by_step.left, 1e-3),  # a test force is constant within a piece
        (in_pieces.right, by_step.right, 1e-3),
    ):
        assert np.abs(mine - theirs).max() < error * np.abs(theirs).max()


@pytest.mark.parametrize("substeps", [1, 3, "uneven"])
def test_slopes_of_few_windows_are_those_of_the_same_windows_among_many(
    substeps: int | str,
) -> None:
    """Whatever evaluates the slopes of the rates for so many steps, and with whichever other steps
    side by side."""
    machine = build(cart_pole())
    rng = np.random.default_rng(5)
    t = np.tile(uneven(2, 60, seed=4), (6, 1))
    u = np.tile(rng.normal(size=(2, 60, 1)), (6, 1, 1))
    parts = rng.integers(1, 4, (2, 59)) if substeps == "uneven" else np.full((2, 59), substeps)
    start = np.tile(rng.normal(size=(2, 4)) * 0.1, (6, 1))
    model, m = WindowModel(machine, (0, 1)), len(machine.model.sensors)
    many = block(t, u, m, np.tile(parts, (6, 1)))
    few = block(t[:2], u[:2], m, parts)
    one, other = (
        model.differentiate(windows, start[: len(windows.t)], machine.values, forces=True)
        for windows in (few, many)
    )
    np.testing.assert_array_equal(one.x, other.x[:2])
    for name in ("transition", "left", "right", "by_free"):
        assert getattr(one, name) == pytest.approx(getattr(other, name)[:2], rel=1e-9, abs=1e-12)


def test_windows_of_many_lengths_are_linearised_without_a_free_parameter() -> None:
    machine = build(cart_pole())
    t = uneven(9, 12, seed=3)
    rng = np.random.default_rng(4)
    start = rng.normal(size=(9, 4)) * [0.1, 0.5, 0.3, 1.0]
    even = block(t, np.zeros((*t.shape, 1)), 3)
    windows = replace(even, substeps=rng.integers(6, 10, even.substeps.shape))
    model = WindowModel(machine)
    linear = model.differentiate(windows, start, machine.values)
    x, y = model.simulate(windows, start, machine.values)
    assert linear.x == pytest.approx(x)
    assert linear.output == pytest.approx(y)
    assert linear.by_free.shape == (9, 11, 4, 0)

    def seen(step: float) -> Array:
        return model.simulate(windows, start + step * np.eye(4)[0], machine.values)[1]

    assert linear.from_start()[..., 0] == pytest.approx(slope(seen, 1e-4), rel=3e-4, abs=1e-5)


@pytest.mark.parametrize("windows_many", [3, 12])
def test_slopes_come_closer_to_differences_of_runs_as_steps_get_finer(windows_many: int) -> None:
    """Taken from the slopes of the rates they differ by the error of the integration."""
    machine = build(cart_pole())
    model = WindowModel(machine, (0, 1))
    t = uneven(windows_many, 30, seed=1)
    start = np.random.default_rng(2).normal(size=(windows_many, 4)) * [0.1, 0.5, 0.3, 1.0]
    p, gaps = machine.values, []
    for substeps in (1, 2, 4):
        windows = block(t, 2 * np.sin(5 * t)[..., None], 3, substeps=substeps)
        linear = model.differentiate(windows, start, p)
        np.testing.assert_array_equal(linear.x, model.simulate(windows, start, p)[0])

        def seen(begin: Array, p: Array = p, windows: Block = windows) -> Array:
            return model.simulate(windows, begin, p)[1]

        by_start = [slope(lambda h, d=d: seen(start + h * d), 1e-5) for d in np.eye(4)]
        by_free = [slope(lambda h, d=d: seen(start, p + h * d), 1e-4) for d in np.eye(p.size)[:2]]
        pairs = (
            (linear.from_start(), np.stack(by_start, -1)),
            (linear.from_free(), np.stack(by_free, -1)),
        )
        gaps.append([np.abs(a - b).max() / np.abs(b).max() for a, b in pairs])
    assert max(gaps[-1]) < 1e-3
    assert all(b < a / 20 for a, b in zip(gaps[0], gaps[-1], strict=True)), gaps
