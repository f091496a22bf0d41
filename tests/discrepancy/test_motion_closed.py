"""The motion of closed loops, from whichever sensors a recording has."""

from pathlib import Path

import numpy as np
import pytest
from mechanisms import MECHANISMS
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.model.read import read_model
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.manifold import gaps_of

Array = NDArray[np.float64]
T = np.linspace(0, 4, 801)
TURNING = 0.7 + 5.0 * T + 0.4 * np.sin(2.1 * T)
SWINGING = 1.2 + 0.5 * np.sin(3.0 * T) + 0.2 * np.sin(7.1 * T)


def machine_of(name: str) -> Machine:
    return build(read_model(Path(__file__).parents[2] / "models" / f"{name}.toml"))


def truth(name: str, angle: Array) -> tuple[Array, Array]:
    """Places and speeds (N, 3) along a motion of the crank."""
    rows = [MECHANISMS[name](float(value)) for value in angle]
    rate = np.gradient(angle, T, edge_order=2)
    q = np.array([row.q for row in rows])
    return q, rate[:, None] * np.array([row.slope for row in rows])


def recorded(machine: Machine, q: Array, keep: tuple[str, ...]) -> Recording:
    columns = [c.name for c in machine.model.coordinates]
    noise = np.random.default_rng(5)
    sensors = {}
    for sensor in machine.model.sensors:
        signal = q[:, columns.index(sensor.measures.text)]
        assert sensor.sd is not None
        sd = sensor.sd * sensor.unit.factor
        if sensor.name in keep:
            sensors[sensor.name] = signal + sd * noise.standard_normal(T.size)
    return Recording("loop", T, {"tau": 0 * T}, sensors, (), "")


@pytest.mark.parametrize(
    ("name", "angle", "keep"),
    [
        ("slider_crank", TURNING, ("encoder", "scale")),
        ("slider_crank", TURNING, ("encoder",)),
        ("slider_crank", SWINGING, ("scale",)),
        ("four_bar", TURNING, ("crank", "rocker")),
        ("four_bar", SWINGING, ("rocker",)),
    ],
)
def test_constraints_tell_what_no_sensor_shows(
    name: str, angle: Array, keep: tuple[str, ...]
) -> None:
    machine = machine_of(name)
    q, v = truth(name, angle)
    motion = motion_of(recorded(machine, q, keep), machine)
    assert motion.blind == ()
    inner = slice(20, -20)
    for found, wanted, sd in ((motion.q, q, motion.q_sd), (motion.v, v, motion.v_sd)):
        error = np.sqrt(np.mean((found - wanted)[inner] ** 2, axis=0))
        assert np.all(error < 2.5 * sd)
        assert np.all(error < 0.02 * np.std(wanted, axis=0))
    gaps = gaps_of(machine, motion.q, motion.v, motion.a, T, machine.values)
    assert np.abs(gaps.gap).max() < 1e-9
    assert np.abs(gaps.rate).max() < 1e-7
    for sensor, sd in zip(machine.model.sensors, motion.sd, strict=True):
        if sensor.name in keep and sensor.sd is not None:
            assert sd == pytest.approx(sensor.sd * sensor.unit.factor, rel=0.15)


def test_a_loop_is_followed_from_far_beside_its_start() -> None:
    machine = machine_of("four_bar")
    angle = 3.9 + 0 * T + 0.3 * np.sin(2 * T)  # the model starts at 0.9
    q, _ = truth("four_bar", angle)
    motion = motion_of(recorded(machine, q, ("crank", "rocker")), machine)
    assert np.sqrt(np.mean((motion.q - q) ** 2)) < 1e-3
