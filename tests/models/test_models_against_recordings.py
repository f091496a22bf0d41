"""Shipped models whose numbers stem from public recordings, run beside those recordings.

What is left is the physics that each file says it leaves out.
"""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.io import loadmat
from scipy.signal import find_peaks
from shipped import machine_of
from textbook import Array

from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Public = Callable[..., Path]
NOTHING = np.zeros((2, 0))


def simulated(name: str, scenario: Scenario) -> Trajectory:
    run = simulate(machine_of(name), scenario)
    assert run.complete, run.reason
    return run


def rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def test_the_double_pendulum_follows_its_recording_for_a_swing(public_file: Public) -> None:
    file = public_file("pendulum", "DoublePendulumDataForParameterEstimation.mat")
    swings = loadmat(file)["Y_id"].ravel()
    t = np.arange(800) * 1e-3
    for swing in (swings[0], swings[5], swings[10]):
        upper, lower, upper_rate, lower_rate = swing[:, :800]  # from the vertical, pi: hanging
        q = np.array([upper - np.pi, lower - upper])
        v = np.array([upper_rate, lower_rate - upper_rate])
        scenario = Scenario(t, q[:, 0], v[:, 0], t[[0, -1]], NOTHING)
        run = simulated("double_pendulum", scenario)
        assert np.ptp(q[0]) > 1
        assert rms(run.q[:, 0] - q[0]) < 0.012
        assert rms(run.q[:, 1] - q[1]) < 0.015


def test_the_pendulum_follows_its_recording_for_a_swing(public_file: Public) -> None:
    file = public_file("pendulum", "SinglePendulumDataForParameterEstimation.mat")
    t = np.arange(800) * 1e-3
    for swing in loadmat(file)["Y_id"].ravel():
        phi, rate = swing[0, :800] - np.pi, swing[1, 0]  # pi: hanging
        scenario = Scenario(t, phi[:1], np.array([rate]), t[[0, -1]], NOTHING)
        run = simulated("pendulum", scenario)
        assert np.ptp(phi) > 1
        assert rms(run.q[:, 0] - phi) < 0.02


def test_the_silverbox_is_linear_as_long_as_it_is_weak(public_file: Public) -> None:
    recorded = np.genfromtxt(public_file("silverbox", "SNLS80mV.csv"), delimiter=",", skip_header=1)
    u, y = recorded[:, 0], recorded[:, 1]
    t = np.arange(u.size) * 2**14 / 1e7

    def missed(rows: slice) -> float:
        """The share of the swing of the output that is not explained, its offset aside."""
        scenario = Scenario(t[rows], y[rows][:1], np.zeros(1), t[rows], u[rows, None])
        run = simulated("silverbox", scenario)
        left, whole = (run.q[:, 0] - y[rows])[150:], y[rows][150:]
        return float(left.std() / whole.std())

    assert missed(slice(3000, 7000)) < 0.05
    assert missed(slice(36000, 40000)) > 0.3  # the arrow has grown, and the circuit hardens


def test_the_ship_rolls_with_the_recorded_period(public_file: Public) -> None:
    file = public_file("kvlcc2_rolldecay", "model_test_21338.csv")
    recorded = np.genfromtxt(file, delimiter=",", names=True)
    free = (recorded["time"] > 20) & (recorded["time"] < 89)
    t, phi = recorded["time"][free], recorded["phi"][free]
    tops = t[find_peaks(phi, height=0.005, distance=150)[0]]
    recorded_period = float(np.polyfit(np.arange(tops.size), tops, 1)[0])
    span, start = np.linspace(0, 60, 6001), np.array([0.1])
    run = simulated("ship_roll", Scenario(span, start, np.zeros(1), span[[0, -1]], NOTHING))
    falls = span[1:][(run.q[1:, 0] <= 0) & (run.q[:-1, 0] > 0)]
    assert falls.size > 20
    period = float(np.polyfit(np.arange(falls.size), falls, 1)[0])
    assert abs(period / recorded_period - 1) < 2e-3


def test_the_damper_on_the_rig_shows_the_recorded_loop(public_file: Public) -> None:
    file = public_file("brfd", "0.5Hz30lbtension1amplitude.json")
    columns = np.array(json.loads(file.read_text())["data"]).T
    t, x, force, speed = columns[:4]
    given = np.column_stack([x * 0.0254, speed * 0.0254, np.zeros(t.size)])  # inches
    scenario = Scenario(t, given[0, :1], given[0, 1:2], t, np.zeros((t.size, 0)), given=given)
    run = simulated("damper_rig", scenario)
    force *= 4448.2216  # thousand pounds
    settled = t > 1
    assert rms((run.y[:, 0] - force)[settled]) < 0.15 * rms(force[settled])
