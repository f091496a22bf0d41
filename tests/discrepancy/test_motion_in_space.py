"""The motion of a body by a quaternion, from an inertial unit and a camera."""

from pathlib import Path

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.model.read import read_model
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

MODEL = Path(__file__).parents[2] / "models" / "quadrotor.toml"


def turned(q: Array) -> Array:
    """The direction of a quaternion (N, 4), its first part positive: q and −q are one rotation."""
    return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True) * np.sign(q[:, :1]))


def test_the_attitude_of_a_quadrotor_follows_from_its_inertial_unit_and_a_camera() -> None:
    model = read_model(MODEL)
    machine, random = build(model), np.random.default_rng(3)
    t = np.arange(0, 3, 0.02)
    swing = np.sin(2 * np.pi * 1.2 * t + random.uniform(0, 6, 4)[:, None]).T
    u = 1.6 + swing @ np.array(
        [[0.2, 0, -0.2, 0], [0, 0.15, 0, -0.15], [0.1, -0.1, 0.1, -0.1], [0.2, 0.2, 0.2, 0.2]]
    )
    start = np.array([c.start for c in model.coordinates])
    run = simulate(machine, Scenario(t, start, 0 * start, t, u))
    assert run.complete, run.reason
    sd = np.array([sensor.sd or 0.1 for sensor in model.sensors])
    y = run.y + sd * random.standard_normal(run.y.shape)
    sensors = {s.name: column for s, column in zip(model.sensors, y.T, strict=True)}
    inputs = {item.name: column for item, column in zip(model.inputs, u.T, strict=True)}
    flight = Recording("flight.csv", t, inputs, sensors, (), "")
    motion = motion_of(flight, machine, spacings_s=(0.08, 0.12))
    assert np.ptp(run.q[:, 3:]) > 0.5  # it turned
    error = turned(motion.q[:, 3:]) - turned(run.q[:, 3:])
    assert np.sqrt(np.mean(error**2)) < 5e-3
    assert np.all(np.abs(np.linalg.norm(motion.q[:, 3:], axis=1) - 1) < 0.2)
    assert np.all(np.abs(motion.sd / sd - 1) < 0.25)
