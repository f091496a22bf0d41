"""What is advised stays within what the machine did, or what the model file permits."""

import numpy as np
import pytest
from builders import model_of
from scipy.integrate import solve_ivp

from symhyb.correction.advice.manoeuvre import played
from symhyb.correction.advice.offers import offers
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.results import Manoeuvre
from symhyb.model.types import Model

UPPER, LOWER, SPRING, FOOT, LOSS = 2.0, 1.0, 300.0, 900.0, 3.0


def two_on_a_post() -> Model:
    """Two masses above each other on a post that is moved; an input pushes the upper one."""
    spring = {"kind": "spring"}
    return model_of(
        coordinates={"y": {"unit": "m"}, "x": {"unit": "m"}, "h": {"unit": "mm", "imposed": True}},
        parameters={
            "m": (UPPER, "kg"),
            "n": (LOWER, "kg"),
            "k": (SPRING, "N/m"),
            "c": (FOOT, "N/m"),
            "d": (LOSS, "N*s/m"),
            "l": (1.0, "m"),
        },
        inputs={"f": {"unit": "N"}},
        points={"post": ["h", "0"], "low": ["l + x", "0"], "top": ["2*l + y", "0"]},
        bodies={"upper": {"mass": "m", "at": "top"}, "lower": {"mass": "n", "at": "low"}},
        elements={
            "foot": {**spring, "between": ["post", "low"], "stiffness": "c", "length": "l"},
            "link": {**spring, "between": ["low", "top"], "stiffness": "k", "length": "l"},
            "loss": {"kind": "damper", "between": ["low", "top"], "damping": "d"},
            "push": {"kind": "force", "on": "y", "force": "f"},
        },
        sensors={
            "upper": {"measures": "y", "unit": "m"},
            "lower": {"measures": "x", "unit": "m"},
        },
    )


def motion(t, post, push):  # type: ignore[no-untyped-def]
    """Places of both masses (N, 2) by SciPy, from rest; ``post`` and ``push`` are functions of t,
    SI."""

    def rate(time, state):  # type: ignore[no-untyped-def]
        y, x, v, w = state
        link = SPRING * (y - x) + LOSS * (v - w)
        return [v, w, (push(time) - link) / UPPER, (link - FOOT * (x - post(time))) / LOWER]

    run = solve_ivp(rate, (0, t[-1]), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-12, max_step=0.02)
    return run.y[:2].T


@pytest.fixture(scope="module")
def rig() -> tuple[Prepared, Refined]:
    """The rig as recorded with both drives, and the model as it is, as an explanation."""
    random, t = np.random.default_rng(3), np.arange(0, 8, 0.01)
    lines, phases = np.linspace(0.5, 4, 9), random.uniform(0, 2 * np.pi, (2, 9))

    def wave(which: int, size: float):  # type: ignore[no-untyped-def]
        return lambda s: size * np.sin(2 * np.pi * lines * s + phases[which]).sum() / 3

    post, push = wave(0, 0.004), wave(1, 3.0)
    x = motion(t, post, push) + 2e-5 * random.standard_normal((t.size, 2))
    inputs = {"f": np.array([push(s) for s in t]), "h": np.array([post(s) for s in t])}
    recording = Recording("rig.csv", t, inputs, {"upper": x[:, 0], "lower": x[:, 1]}, (), "")
    prepared = prepare(two_on_a_post(), recording)
    setting = settle(prepared)
    return prepared, refine(prepared.model, (), (), setting.stages[0].laid, setting.sd)


def test_a_manoeuvre_of_an_imposed_coordinate_is_played(rig: tuple[Prepared, Refined]) -> None:
    prepared, truth = rig
    plan = Manoeuvre("h", "sine", 1.0, "mm", 4.0, 0.01, (1.0, 1.0))
    made = played(prepared, truth, plan)
    assert made is not None
    recording, moved = made
    assert recording.inputs["h"] == pytest.approx(1e-3 * np.sin(2 * np.pi * recording.t))
    exact = motion(recording.t, lambda s: 1e-3 * np.sin(2 * np.pi * s), lambda s: 0.0)
    level = np.median(np.concatenate([run.motion.q for run in prepared.runs]), axis=0)
    # it starts where the machine was on the whole, a little away from rest
    assert moved.q[:, :2] == pytest.approx(exact, abs=5 * np.abs(level).max() + 2e-5)
    assert np.abs(exact).max() > 1e-3


def test_every_channel_of_such_a_machine_is_offered(rig: tuple[Prepared, Refined]) -> None:
    prepared, truth = rig
    plans = offers(prepared, truth.machine)
    assert {plan.channel for plan in plans} == {"f", "h", "x", "y"}
    for channel in ("f", "h", "x", "y"):
        least = min((p for p in plans if p.channel == channel), key=lambda p: p.amplitude)
        assert played(prepared, truth, least) is not None
