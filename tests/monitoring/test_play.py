"""Play in a spring of the model is a cause of its own, of the right size and in the right unit."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import StateSpace, lsim

from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.model.types import On
from symhyb.monitoring.events import Event
from symhyb.monitoring.gauge import gauge_of
from symhyb.monitoring.play import is_play, play_of, play_phrase, plays
from symhyb.monitoring.watching import Watch, watch
from tests.pushed import DAMPING, NOISE, STEP, STIFFNESS, pushed_model, pushing

PLAY = 0.02
AT_S, SECONDS = 40.0, 60.0

TWO = """symhyb = 1
[coordinates]
a = { unit = "deg" }
b = { unit = "deg" }
[parameters]
m = { value = 1.0, unit = "kg" }
j = { value = 0.1, unit = "kg*m^2" }
k = { value = 4.0, unit = "N*m/rad" }
more = { value = 1.0, unit = "N*m/rad" }
soft = { value = 0.0, unit = "N*m/rad" }
[inputs]
u = { unit = "N*m" }
warm = { unit = "1" }
[bodies.first]
mass = "m"
at = ["0", "0"]
inertia = "j"
angle = "a"
[bodies.second]
mass = "m"
at = ["0", "0"]
inertia = "j"
angle = "b"
[elements.shaft]
kind = "spring"
on = "a - b"
stiffness = "k"
[elements.beside]
kind = "spring"
on = "a - b"
stiffness = "more"
[elements.nothing]
kind = "spring"
on = "b"
stiffness = "soft"
[elements.varying]
kind = "spring"
on = "a"
stiffness = "k*warm"
[elements.drive]
kind = "torque"
on = "a"
torque = "u"
[sensors]
first = { measures = "a", unit = "deg" }
second = { measures = "b", unit = "deg" }
"""


def test_a_place_with_springs_of_a_known_stiffness_may_have_play() -> None:
    model = parse_model(TWO, "two.toml")
    (play,) = plays(model)
    assert play.place == On("a - b")
    assert play_phrase(play) == "play in the spring on a − b"


def test_the_clearance_is_in_the_unit_of_the_stretch() -> None:
    model = parse_model(TWO, "two.toml")
    (play,) = plays(model)
    found = play_of(model, play, -5.0 * np.radians(0.5), 5.0 * np.radians(0.1))
    assert found.unit == "rad"  # of a difference of two angles
    assert (found.value, found.sd) == pytest.approx((np.radians(0.5), np.radians(0.1)))


def test_a_spring_that_is_always_stretched_shows_no_play() -> None:
    random = np.random.default_rng(4)
    t = STEP * np.arange(1500)
    force, still = pushing(random, t), 100.0
    system = StateSpace([[0, 1], [-STIFFNESS, -DAMPING]], [[0], [1]], [[1, 0]], [[0]])
    x = lsim(system, force, t)[1] + still / STIFFNESS + NOISE * random.standard_normal(t.size)
    assert x.min() > 0
    there = Recording("stretched.csv", t, {"f": force + still}, {"laser": x}, (), "")
    assert not any(map(is_play, gauge_of(pushed_model(), there).hypotheses))


@cache
def loosened() -> tuple[Event, ...]:
    """A mass whose spring has play from ``AT_S`` on."""
    random = np.random.default_rng(2)
    t = STEP * np.arange(round(SECONDS / STEP))
    force = pushing(random, t)

    def rates(now: float, state: np.ndarray) -> tuple[float, float]:
        x, v = state
        play = PLAY if now >= AT_S else 0.0
        pressed = max(x - play, 0.0) + min(x + play, 0.0)
        return v, float(np.interp(now, t, force)) - STIFFNESS * pressed - DAMPING * v

    run = solve_ivp(rates, (0, t[-1]), (0, 0), "LSODA", t, rtol=1e-8, atol=1e-10, max_step=STEP)
    x = run.y[0] + NOISE * random.standard_normal(t.size)
    rows = (f"{a:.4f},{b:.6f},{c:.8f}" for a, b, c in zip(t, force, x, strict=True))
    return tuple(watch(Watch(pushed_model(), 30.0), ["t,f,laser", *rows]))


def test_a_spring_that_gets_play_is_named_with_the_clearance() -> None:
    (said,) = (event for event in loosened() if event.kind == "named")
    assert AT_S < said.at_s < AT_S + 15
    assert said.cause == "play in the spring on x"
    (amount,) = said.amounts
    assert amount.name == "clearance"
    assert amount.value == pytest.approx(PLAY, abs=3 * amount.sd + 0.1 * PLAY)
    assert " mm" in said.sentence
