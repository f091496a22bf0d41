"""What is fitted as something that lags: only what could be the answer."""

import numpy as np
from pushed import markov, setting_of

import symhyb as sh
from symhyb.correction.adequacy.classes.worth import around
from symhyb.correction.adequacy.followed import likeliest
from symhyb.correction.adequacy.late import lagging_sensors, with_lags, with_late_sensors

PAIR = """
symhyb = 1
title  = "Two masses by themselves, each with its push"
[coordinates]
a = { unit = "m" }
b = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
k = { value = 25.0, unit = "N/m" }
d = { value = 1.0, unit = "N*s/m" }
[inputs]
f = { unit = "N" }
g = { unit = "N" }
[bodies.first]
mass = "m"
at   = ["a", "0"]
[bodies.second]
mass = "m"
at   = ["0", "b"]
[elements]
hold_a = { kind = "spring", on = "a", stiffness = "k" }
hold_b = { kind = "spring", on = "b", stiffness = "k" }
slow_a = { kind = "damper", on = "a", damping = "d" }
slow_b = { kind = "damper", on = "b", damping = "d" }
push_a = { kind = "force", on = "a", force = "f" }
push_b = { kind = "force", on = "b", force = "g" }
[sensors]
at_a = { measures = "a", unit = "m" }
at_b = { measures = "b", unit = "m" }
"""
RIG = """
symhyb = 1
title  = "A mass on a spring whose base a rig moves"
[coordinates]
x = { unit = "m" }
y = { unit = "m", imposed = true }
[parameters]
m = { value = 1.0, unit = "kg" }
k = { value = 25.0, unit = "N/m" }
d = { value = 1.0, unit = "N*s/m" }
[bodies.mass]
mass = "m"
at   = ["x", "0"]
[elements]
spring = { kind = "spring", on = "x - y", stiffness = "k" }
damper = { kind = "damper", on = "x - y", damping = "d" }
[sensors]
place = { measures = "x", unit = "m" }
y     = { measures = "y", unit = "m" }
"""


def drives(seed: int, t: np.ndarray) -> np.ndarray:
    """Two smooth signals (N, 2)."""
    random = np.random.default_rng(seed)
    phases = random.uniform(0, 2 * np.pi, (2, 8))
    waves = np.sin(np.arange(1, 9)[:, None] * 0.9 * t + phases[..., None])
    return waves.sum(axis=1).T


def test_an_input_that_pushes_where_little_acts_is_not_fitted_as_late() -> None:
    random, t = np.random.default_rng(3), np.arange(0, 12, 0.02)
    pushes = drives(1, t)
    unknown = markov(random, t.size, 1.0, 0.3)  # on the first mass, which nobody recorded
    model = sh.parse_model(PAIR)
    acting = pushes + np.column_stack([unknown, np.zeros_like(unknown)])
    run = sh.simulate(model, sh.Scenario(t, np.zeros(2), np.zeros(2), t, acting))
    shown = run.y + 1e-3 * random.standard_normal(run.y.shape)
    columns = {"t": t, "f": pushes[:, 0], "g": pushes[:, 1], "at_a": shown[:, 0]}
    recording = sh.Recording.from_frame({**columns, "at_b": shown[:, 1]}, model)
    ground = setting_of(model, recording)
    start = likeliest(ground, [], [])
    raced = with_lags(ground, around(ground, start), start, [])
    assert {trial.extra.where for trial in raced if trial.extra} == {"f", "at_a", "at_b"}


def test_the_sensor_of_a_motion_that_is_given_cannot_lag() -> None:
    random, t = np.random.default_rng(4), np.arange(0, 12, 0.02)
    base = 0.05 * drives(2, t)[:, 0]
    model = sh.parse_model(RIG)
    given = sh.Recording.from_frame({"t": t, "y": base, "place": base}, model)
    run = sh.simulate(model, given)
    shown = run.y[:, 0] + 1e-4 * random.standard_normal(t.size)
    recording = sh.Recording.from_frame({"t": t, "y": base, "place": shown}, model)
    ground = setting_of(model, recording)
    start = likeliest(ground, [], [])
    raced = with_late_sensors(ground, around(ground, start), start)
    assert [lagging_sensors(trial) for trial in raced] == [("place",)]
