"""What is advised stays within what the machine did, or what the model file permits."""

from dataclasses import replace

import numpy as np
import pytest
from builders import model_of
from scipy.integrate import solve_ivp

from symhyb.correction.advice.advice import no_manoeuvre
from symhyb.correction.advice.bounds import bounds_of
from symhyb.correction.advice.manoeuvre import Rivals, design
from symhyb.correction.advice.offers import offers, peaks
from symhyb.correction.advice.playing import played, restrained
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.results import Manoeuvre
from symhyb.model.limits import Limit
from symhyb.model.types import Model
from symhyb.units import parse_unit

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
    return prepared, refine(prepared.model, (), (), setting.stages[0].cuts, setting.sd)


def test_a_manoeuvre_of_an_imposed_coordinate_is_played(rig: tuple[Prepared, Refined]) -> None:
    prepared, truth = rig
    plan = Manoeuvre("h", "sine", 1.0, "mm", 4.0, 0.01, (1.0, 1.0))
    recording, moved = played(prepared, truth, plan)
    assert recording.inputs["h"] == pytest.approx(1e-3 * np.sin(2 * np.pi * recording.t))
    exact = motion(recording.t, lambda s: 1e-3 * np.sin(2 * np.pi * s), lambda s: 0.0)
    level = np.median(np.concatenate([run.motion.q for run in prepared.runs]), axis=0)
    # it starts where the machine was on the whole, a little away from rest
    assert moved.q[:, :2] == pytest.approx(exact, abs=5 * np.abs(level).max() + 2e-5)
    assert np.abs(exact).max() > 1e-3


def test_whatever_is_advised_stays_within_what_was_recorded(rig: tuple[Prepared, Refined]) -> None:
    prepared, truth = rig
    bounds, peak = bounds_of(prepared), peaks(prepared, truth.machine)
    own = prepared.runs[0].motion
    plans = offers(prepared, truth.machine)
    assert {plan.channel for plan in plans} == {"f", "h", "x", "y"} == set(peak)
    kept = {True: 0, False: 0}
    for plan in plans[::7]:
        within, exceeded = restrained(prepared, [truth], plan, bounds)
        if within is None:
            assert exceeded
            continue
        assert (within.amplitude < plan.amplitude) == bool(exceeded)
        assert within.beyond == (within.amplitude > peak[plan.channel])
        kept[bool(exceeded)] += 1
        _, moved = played(prepared, truth, within)
        for part in ("q", "v", "a"):
            recorded, asked = getattr(own, part), getattr(moved, part)
            assert np.all(np.abs(asked).max(axis=0) <= np.abs(recorded).max(axis=0))
    assert min(kept.values()) > 2  # some had to be reduced, some not


def limited(prepared: Prepared, *limits: Limit) -> Prepared:
    """The rig with limits in its model file."""
    return replace(prepared, model=replace(prepared.model, limits=limits))


def test_limits_of_the_file_take_the_place_of_what_was_recorded(
    rig: tuple[Prepared, Refined],
) -> None:
    prepared, truth = rig
    plan = Manoeuvre("f", "steps", 6.0, "N", 8.0, 0.01, (0.25, 0.25))
    recorded, exceeded = restrained(prepared, [truth], plan, bounds_of(prepared))
    assert exceeded
    wide = [Limit(name, parse_unit("m"), (-1.0, 1.0), 50.0, 5e3) for name in ("x", "y", "h")]
    free = limited(prepared, *wide)
    within, exceeded = restrained(free, [truth], plan, bounds_of(free))
    assert within == replace(plan, beyond=plan.amplitude > peaks(prepared, truth.machine)["f"])
    assert not exceeded
    assert recorded is None or recorded.amplitude < plan.amplitude
    pushed = limited(prepared, *wide, Limit("f", parse_unit("kN"), (-0.002, 0.003)))
    within, exceeded = restrained(pushed, [truth], plan, bounds_of(pushed))
    assert within is not None
    assert 1.5 <= within.amplitude <= 2.0
    assert exceeded == "the range of f"
    slow = limited(prepared, *wide[:1], Limit("y", parse_unit("mm"), rate=1e-3))
    assert restrained(slow, [truth], plan, bounds_of(slow)) == (None, "the speed of y")


def test_a_manoeuvre_that_runs_away_is_none(rig: tuple[Prepared, Refined]) -> None:
    prepared, truth = rig
    plan = Manoeuvre("y", "release", 1e30, "m", 4.0, 0.01)
    within, exceeded = restrained(prepared, [truth], plan, bounds_of(prepared))
    assert within is None
    assert exceeded


def test_where_nothing_sensible_remains_the_advice_says_why(rig: tuple[Prepared, Refined]) -> None:
    prepared, truth = rig
    tight = limited(prepared, Limit("y", parse_unit("mm"), rate=1e-3))
    pairs = [Rivals(truth, truth, ("drag on y", "dry friction on y"))]
    found = design(tight, settle(prepared), pairs)
    assert found.expected is None
    assert not found.playable
    assert found.hindered == "the speed of y"
    assert no_manoeuvre(tight, settle(prepared), pairs, found) == (
        "No manoeuvre within the limits of the model file and the travel, speed and acceleration "
        "that were recorded where it states none tells drag on y from dry friction on y: none that "
        "is worth recording stays within them. Larger ones would exceed the speed of y: if the "
        "machine may do more than that, state it under [limits] of the model file."
    )
