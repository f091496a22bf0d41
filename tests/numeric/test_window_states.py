"""Windows of machines that remember, of motion that is given, and of channels that are late."""

from dataclasses import replace

import numpy as np
import pytest
from blocks import block, slope, uneven
from builders import model_of, oscillator, push, spring
from numpy.typing import NDArray

from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario
from symhyb.numeric.runs.windows import Block, WindowModel

Array = NDArray[np.float64]


def remembering() -> Model:
    """A mass on a spring, on a hysteresis and on one that relaxes; a force cell."""
    return oscillator(
        {
            "hold": spring("k"),
            "bend": {
                "kind": "hysteresis",
                "on": "x",
                "stiffness": "k",
                "beta": "b",
                "gamma": "b/2",
                "exponent": 2,
            },
            "slow": {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"},
            "motor": push("f"),
        },
        {"k": (120.0, "N/m"), "d": (6.0, "N*s/m"), "b": (400.0, "1/m^2")},
        {
            "place": {"measures": "x", "unit": "m"},
            "cell": {"measures": "force(bend) + force(slow)", "unit": "N"},
        },
        {"f": {"unit": "N"}},
    )


def excited(seed: int = 1) -> tuple[Machine, Block, Array]:
    """Two windows of the machine that remembers, begun anywhere."""
    t = uneven(2, 60, seed)
    start = np.array([[0.01, 0.3, 0.02, -0.01], [-0.02, -0.5, 0.015, 0.03]])
    return build(remembering()), block(t, 9 * np.sin(9 * t)[..., None], 2, substeps=3), start


def test_windows_carry_inner_states_like_cvodes_does() -> None:
    machine, windows, start = excited()
    x, y = WindowModel(machine).simulate(windows, start, machine.values)
    assert x.shape == (2, 60, 4)
    for w in range(2):
        t, u = windows.t[w], windows.d[w]
        q, v, z = np.split(start[w], [1, 2])
        result = simulate(machine, Scenario(t, q, v, t, u, z=z))
        assert result.complete
        states = np.hstack([result.q, result.v, result.z])
        assert np.all(np.ptp(states, axis=0) > [0.05, 0.5, 0.03, 0.03])
        assert x[w] == pytest.approx(states, abs=1e-4)
        assert y[w] == pytest.approx(result.y, abs=1e-2)


def test_derivatives_by_inner_states_and_their_parameters() -> None:
    """Where a rate changes sign within a step the slopes are as coarse as the step; differences are
    taken close by, as the step itself jumps a little there."""
    machine, windows, start = excited()
    windows = replace(windows, substeps=10 * windows.substeps)
    free = tuple(machine.column(name) for name in ("k", "d", "b"))
    model, p = WindowModel(machine, free), machine.values
    linear = model.differentiate(windows, start, p)
    exact = linear.from_start()
    assert exact.shape == (2, 60, 2, 4)
    for i in range(4):
        moved = np.eye(4)[i]
        found = slope(lambda h, d=moved: model.simulate(windows, start + h * d, p)[1], 1e-6)
        assert exact[..., i] == pytest.approx(found, rel=2e-3, abs=2e-3 * np.abs(found).max())
    exact = linear.from_free()
    for column, i in enumerate(free):
        moved = np.eye(p.size)[i] * p[i]
        found = slope(lambda h, d=moved: model.simulate(windows, start, p + h * d)[1], 1e-6)
        found /= p[i]
        assert exact[..., column] == pytest.approx(found, rel=2e-2, abs=1e-2 * np.abs(found).max())


def moved_base(block_free: bool = True) -> Model:
    """A mass on a base that a rig moves (it may be clamped, too), the force of the rig measured."""
    return model_of(
        coordinates={
            "base": {"unit": "m", "imposed": True},
            "x": {"unit": "m", "imposed": not block_free},
        },
        parameters={"m": (1.2, "kg"), "k": (90.0, "N/m"), "d": (2.0, "N*s/m"), "far": (1.0, "m")},
        points={"foot": ["base", "0"], "head": ["far + x", "0"]},
        bodies={"table": {"mass": "m", "at": "foot"}, "block": {"mass": "m", "at": "head"}},
        elements={
            "hold": {
                "kind": "spring",
                "between": ["foot", "head"],
                "stiffness": "k",
                "length": "far",
            },
            "oil": {"kind": "damper", "between": ["foot", "head"], "damping": "d"},
        },
        sensors={
            "place": {"measures": "x", "unit": "m"},
            "cell": {"measures": "reaction(base)", "unit": "N"},
        },
    )


def shaken(t: Array) -> Array:
    """Place, speed and acceleration (…, 3) of the base."""
    return 0.02 * np.stack([np.sin(7 * t), 7 * np.cos(7 * t), -49 * np.sin(7 * t)], axis=-1)


def test_windows_follow_a_motion_that_is_given() -> None:
    machine = build(moved_base())
    t = np.linspace(0, 1.5, 301)[None]
    start = np.array([[0.01, -0.1]])
    windows = block(t, shaken(t), 2, substeps=2)
    x, y = WindowModel(machine).simulate(windows, start, machine.values)
    q, v = np.array([0.0, 0.01]), np.array([0.14, -0.1])
    scenario = Scenario(t[0], q, v, t[0], np.empty((301, 0)), given=shaken(t[0]))
    result = simulate(machine, scenario)
    assert np.ptp(result.q[:, 1]) > 0.02
    assert x[0] == pytest.approx(np.column_stack([result.q[:, 1], result.v[:, 1]]), abs=2e-5)
    assert y[0] == pytest.approx(result.y, abs=2e-3)


def test_what_the_rig_measures_tells_about_parameters() -> None:
    """∂reaction/∂p and ∂reaction/∂(test force): where the rig holds, it takes the force away."""
    machine = build(moved_base())
    t = np.linspace(0, 0.6, 61)[None]
    windows, start = block(t, shaken(t), 2, substeps=2), np.array([[0.01, -0.1]])
    p = machine.values
    model = WindowModel(machine, (machine.column("k"), machine.column("m")))
    linear = model.differentiate(windows, start, p, forces=True)
    for column, i in enumerate(model.free):
        moved = np.eye(p.size)[i] * p[i]
        found = slope(lambda h, d=moved: model.simulate(windows, start, p + h * d)[1], 1e-3) / p[i]
        exact = linear.from_free()[..., column]
        assert exact == pytest.approx(found, rel=1e-5, abs=1e-5 * np.abs(found).max())
    held = np.zeros((1, 61, 2, 1))
    held[:, :, 0] = 1.0  # on the base alone
    response = linear.from_forces(held)[..., 0]
    assert response[..., 0] == pytest.approx(0, abs=1e-12)
    assert response[..., 1] == pytest.approx(-1, abs=1e-9)


def test_a_machine_that_is_moved_altogether_has_outputs_and_no_states() -> None:
    machine = build(moved_base(block_free=False))
    t = np.linspace(0, 0.6, 61)[None]
    base, still = shaken(t), np.zeros((1, 61, 3))
    drive = np.stack([base, still], axis=-1).reshape(1, 61, 6)  # (q, v, a) of base and x in turn
    windows, start = block(t, drive, 2), np.zeros((1, 0))
    model = WindowModel(machine, (machine.column("k"),))
    x, y = model.simulate(windows, start, machine.values)
    assert x.shape == (1, 61, 0)
    place, speed, pull = np.moveaxis(base, -1, 0)
    assert y[..., 0] == pytest.approx(0)
    assert y[..., 1] == pytest.approx(1.2 * pull + 90 * place + 2 * speed)
    linear = model.differentiate(windows, start, machine.values, forces=True)
    assert linear.from_start().shape == (1, 61, 2, 0)
    assert linear.from_free()[..., 1, 0] == pytest.approx(place)
    forces = np.zeros((1, 61, 2, 1))
    forces[..., 0, 0] = 3.0
    assert linear.from_forces(forces)[..., 1, 0] == pytest.approx(-3)
    assert linear.from_defect() == pytest.approx(0)


# --- delays ----------------------------------------------------------------------------------


def late() -> tuple[Machine, Block, Array]:
    """The driven mass in friction whose channels state a delay of zero, with its whole record."""
    stated = {"unit": "s", "value": 0.0}
    model = oscillator(
        {
            "hold": spring("k"),
            "rail": {"kind": "friction", "on": "x", "coulomb": "c", "transition": "w"},
            "motor": push("f"),
        },
        {"k": (120.0, "N/m"), "c": (1.5, "N"), "w": (0.2, "m/s")},
        sensors={
            "place": {"measures": "x", "unit": "m", "delay": stated},
            "speed": {"measures": "x'", "unit": "m/s", "delay": stated},
        },
        inputs={"f": {"unit": "N", "delay": stated}},
    )
    machine = build(model)
    record = np.linspace(-1, 3, 4001)
    t = np.linspace(0, 1, 101)[None] + np.array([[0.2], [1.4]])
    windows = block(t, force(t)[..., None], 2, substeps=2)
    whole = replace(windows, record=(record, force(record)[:, None]))
    return machine, whole, np.array([[0.01, 0.4], [-0.02, 0.3]])


def force(t: Array) -> Array:
    return 6 * np.sin(8 * t) + 2 * np.cos(13 * t)


def test_an_input_that_acts_late_is_the_earlier_input() -> None:
    machine, windows, start = late()
    column, p = machine.column("f.delay"), machine.values.copy()
    p[column] = 0.03
    _, y = WindowModel(machine, (column,)).simulate(windows, start, p)
    shifted = replace(windows, d=force(windows.t - 0.03)[..., None])
    _, expected = WindowModel(machine).simulate(shifted, start, machine.values)
    _, punctual = WindowModel(machine).simulate(windows, start, machine.values)
    size = np.abs(expected - punctual).max(axis=(0, 1))
    assert np.all(size > [1e-3, 3e-2])
    assert y / size == pytest.approx(expected / size, abs=0.01)


def test_a_sensor_that_records_late_shows_what_was() -> None:
    """q(t − δ) = q − δ q' + δ²/2 q'' to within the third order."""
    machine, windows, start = late()
    column, p = machine.column("place.delay"), machine.values.copy()
    p[column] = 0.01  # one sample
    x, y = WindowModel(machine, (column,)).simulate(windows, start, p)
    assert y[:, 1:, 0] == pytest.approx(x[:, :-1, 0], abs=4e-5)
    assert np.abs(y[:, 1:, 0] - x[:, 1:, 0]).max() > 3e-3
    assert y[..., 1] == pytest.approx(x[..., 1])


def test_a_rate_that_is_recorded_late_is_of_second_order_too() -> None:
    machine, windows, start = late()
    column, p = machine.column("speed.delay"), machine.values.copy()
    p[column] = 0.01  # one sample
    x, y = WindowModel(machine, (column,)).simulate(windows, start, p)
    error = np.abs(y[:, 1:, 1] - x[:, :-1, 1])
    assert np.median(error) < 1e-3
    assert np.median(np.abs(y[:, 1:, 1] - x[:, 1:, 1])) > 0.03


@pytest.mark.parametrize("name", ["f", "place", "speed"])
def test_derivatives_by_delays(name: str) -> None:
    machine, windows, start = late()
    column = machine.column(f"{name}.delay")
    model, p = WindowModel(machine, (column,)), machine.values
    exact = model.differentiate(windows, start, p).from_free()[..., 0]
    moved = np.eye(p.size)[column]
    found = slope(lambda h: model.simulate(windows, start, p + h * moved)[1], 2e-3)
    assert np.abs(found).max() > 0.05
    scale = np.maximum(np.abs(found).max(axis=(0, 1)), 1e-12)
    assert exact / scale == pytest.approx(found / scale, abs=0.02)
