"""Exact stick-slip and contact: against a hand-written automaton, closed forms, and smoothing."""

from pathlib import Path

import numpy as np
import pytest
from automaton import Oscillator, automaton
from builders import Entries, model_of, push, spring
from numpy.typing import NDArray

from symhyb.errors import InputError
from symhyb.exact.leaping import Leap
from symhyb.exact.simulation import simulate
from symhyb.model.read import read_model
from symhyb.model.switching import left_smooth
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
MODELS = Path(__file__).parents[2] / "models"
WAYS = {"sticks": 0, "slides +": 1, "slides -": -1}


def free(model: Model, t: Array, q: list[float], v: list[float], exact: bool = True) -> Trajectory:
    """A run without recorded inputs."""
    scenario = Scenario(t, np.array(q), np.array(v), t[[0, -1]], np.empty((2, 0)))
    return simulate(build(model), scenario, exact=exact)


def rig(o: Oscillator, rail: Entries | None = None, **more: Entries) -> Model:
    """The oscillator of the automaton as a model."""
    values = {
        "m": (o.m, "kg"),
        "c": (o.c, "N/m"),
        "d": (o.d, "N*s/m"),
        "R": (o.R, "N"),
        "P": (o.P, "N"),
        "f": (o.f, "Hz"),
        "R0": (o.R0, "N"),
        "vs": (o.vs or 1.0, "m/s"),
        "e": (o.e, "1"),
    }
    elements = {
        "spring": spring("c"),
        "damper": {"kind": "damper", "on": "x", "damping": "d"},
        "rail": rail or {"kind": "friction", "on": "x", "coulomb": "R"},
        "shaker": push("pull")
        if o.force
        else {"kind": "harmonic", "on": "x", "amplitude": "P", "frequency": "f"},
    }
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters=values,
        inputs={"pull": {"unit": "N"}} if o.force else {},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={**elements, **more},
        sensors={
            "place": {"measures": "x", "unit": "m", "sd": 1e-6},
            "held": {"measures": "force(rail)", "unit": "N", "sd": 1e-3},
            "accel": {"measures": "x''", "unit": "m/s^2", "sd": 1e-3},
        },
    )


def nrmse(found: Array, truth: Array) -> float:
    return float(np.sqrt(np.mean((found - truth) ** 2)) / np.ptp(truth))


def agree(run: Trajectory, o: Oscillator, longest: float = 0.02, near: float = 1e-6) -> None:
    """The same transitions at the same times, and the same motion."""
    assert run.complete, run.reason
    truth, events = automaton(o, run.t, longest)
    assert [WAYS[event.transition] for event in run.events] == [way for _, way in events]
    times = np.array([time for time, _ in events])
    assert [event.time for event in run.events] == pytest.approx(times, abs=near)
    assert nrmse(run.q[:, 0], truth[:, 0]) < 1e-6
    assert nrmse(run.v[:, 0], truth[:, 1]) < 1e-6


@pytest.mark.parametrize("push", [5.0, 0.9])
def test_stick_slip_against_an_automaton(push: float) -> None:
    o = Oscillator(P=push)
    agree(free(rig(o), np.linspace(0, 5, 2501), [0.0], [0.0]), o)


@pytest.mark.slow
@pytest.mark.parametrize(("push", "turns"), [(5.0, 122), (0.9, 121)])
def test_all_transitions_of_a_minute(push: float, turns: int) -> None:
    """The bar: every transition of 60 s, NRMSE < 1e-6; here far below."""
    o = Oscillator(P=push)
    run = free(rig(o), np.linspace(0, 60, 60_001), [0.0], [0.0])
    agree(run, o)
    assert len(run.events) == turns
    assert nrmse(run.q[:, 0], automaton(o, run.t)[0][:, 0]) < 1e-8


STRIBECK = {"kind": "friction", "on": "x", "coulomb": "R", "static": "R0", "stribeck": "vs"}


@pytest.mark.parametrize(
    ("o", "rail"),
    [
        (Oscillator(P=2.0, R0=0.8, vs=0.05), STRIBECK),
        (Oscillator(P=2.0, R0=0.8, vs=0.002), STRIBECK),
        (
            Oscillator(P=1.2, e=0.3),
            {"kind": "friction", "on": "x", "coulomb": "R", "asymmetry": "e"},
        ),
    ],
    ids=["Stribeck", "breakaway", "asymmetry"],
)
def test_levels_of_friction(o: Oscillator, rail: Entries) -> None:
    agree(free(rig(o, rail), np.linspace(0, 4, 1001), [0.0], [0.0]), o)


def test_inputs_act_by_first_order_hold() -> None:
    """A recorded force with steps, held straight between its samples."""
    t_u = np.linspace(0, 2, 201)
    u = 0.8 * np.sign(np.sin(3 * t_u)) + 0.4 * np.sin(11 * t_u)
    o = Oscillator(force=lambda s: float(np.interp(s, t_u, u)))
    t = np.linspace(0, 2, 801)
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t_u, u[:, None])
    agree(simulate(build(rig(o)), scenario, exact=True), o, longest=0.005)


def test_a_machine_that_sticks_is_at_rest() -> None:
    """No creep, to the last bit; the sensor of the force shows what holds."""
    o = Oscillator(P=0.9)
    run = free(rig(o), np.linspace(0, 6, 6001), [0.0], [0.0])
    ends = [*(event.time for event in run.events), 6.0]
    stuck = 0
    for event, end in zip(run.events, ends[1:], strict=True):
        rows = (run.t > event.time) & (run.t < end)
        if event.transition == "sticks" and rows.any():
            assert np.ptp(run.q[rows, 0]) == 0.0
            assert not run.v[rows].any()
            assert not run.a[rows].any()
            held = 0.9 * np.sin(np.pi * run.t[rows]) - 100 * run.q[rows, 0]
            assert run.y[rows, 1] == pytest.approx(held, abs=1e-12)
            stuck += 1
    assert stuck >= 5
    smooth = free(rig(o), run.t, [0.0], [0.0], exact=False)
    assert np.abs(run.q - smooth.q).max() > 1e-8  # it creeps there


def stacked(rub: str, ground: str, ramp: str) -> Model:
    """A block y on a block x on the ground, pulled by a force that grows with time."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={
            "m1": (2.0, "kg"),
            "m2": (0.5, "kg"),
            "far": (9.0, "m"),
            "R": (rub, "N"),
            "G": (ground, "N"),
            "s": (ramp, "N/s"),
        },
        points={"lower": ["x", "0"], "upper": ["y + far", "0"]},
        bodies={"one": {"mass": "m1", "at": "lower"}, "two": {"mass": "m2", "at": "upper"}},
        elements={
            "between": {"kind": "friction", "between": ["lower", "upper"], "coulomb": "R"},
            "ground": {"kind": "friction", "on": "x", "coulomb": "G"},
            "pull": push("s*t"),
        },
    )


def test_stacked_blocks_against_their_closed_form() -> None:
    """Both rest until s t = G; then move as one with (s t − G)/(m1 + m2), until the upper needs
    more than R: s t − G = R (m1 + m2)/m2."""
    model = stacked(0.5, 1.0, 2.0)  # type: ignore[arg-type]
    run = free(model, t := np.linspace(0, 4, 401), [0.0, 0.0], [0.0, 0.0])
    assert run.complete
    first, second = 1.0 / 2.0, (1.0 + 0.5 * 2.5 / 0.5) / 2.0
    reported = [(event.element, event.transition) for event in run.events]
    assert reported == [("ground", "slides +"), ("between", "slides -")]
    assert [event.time for event in run.events] == pytest.approx([first, second], abs=1e-9)
    together, apart = (t > first) & (t < second), t > second
    assert run.a[together, 0] == pytest.approx((2 * t[together] - 1) / 2.5, abs=1e-9)
    assert run.a[together, 1] == pytest.approx(run.a[together, 0], abs=1e-12)
    assert run.a[apart, 0] == pytest.approx((2 * t[apart] - 1.5) / 2.0, abs=1e-9)
    assert run.a[apart, 1] == pytest.approx(1.0, abs=1e-9)
    gap = run.q[together, 1] - run.q[together, 0]
    assert np.abs(gap).max() < 1e-12


def coupled(**levels: float) -> Model:
    """Two masses on springs, each on a rail, with friction between them: three frictions."""
    rails = {
        name: {"kind": "friction", "on": on, "coulomb": name, "transition": "w"}
        for name, on in (("R1", "x"), ("R2", "y"))
    }
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={
            "m1": (1.3, "kg"),
            "m2": (0.6, "kg"),
            "w": (1e-6, "m/s"),
            "k": (40.0, "N/m"),
            "l": (60.0, "N/m"),
            "F": (2.0, "N"),
            "f": (0.7, "Hz"),
            "far": (1.0, "m"),
            **{name: (value, "N") for name, value in levels.items()},
        },
        points={"one": ["x", "0"], "two": ["y + far", "0"]},
        bodies={"u": {"mass": "m1", "at": "one"}, "l": {"mass": "m2", "at": "two"}},
        elements={
            **rails,
            "R3": {
                "kind": "friction",
                "between": ["one", "two"],
                "coulomb": "R3",
                "transition": "w",
            },
            "s": spring("k"),
            "r": spring("l", on="y"),
            "h": {"kind": "harmonic", "on": "x", "amplitude": "F", "frequency": "f"},
        },
    )


def test_frictions_on_and_between_against_smoothing() -> None:
    """CVODES with tanh over 1e-6 m/s, which shares nothing with the automaton."""
    model = coupled(R1=0.5, R2=0.3, R3=0.4)
    t = np.linspace(0, 6, 601)
    run, smooth = (free(model, t, [0.0, 0.0], [0.0, 0.0], exact) for exact in (True, False))
    assert run.complete
    assert {event.element for event in run.events} == {"R1", "R2", "R3"}
    assert run.q == pytest.approx(smooth.q, abs=1e-5 * np.ptp(smooth.q))


def test_frictions_on_one_place_share_it() -> None:
    """Two on one coordinate hold as much as one of their sum, whichever is at its level first."""
    o = Oscillator(P=0.9, R=0.2, R0=0.2)
    more = {"other": {"kind": "friction", "on": "x", "coulomb": "0.4525*R + R"}}
    both = free(rig(o, **more), t := np.linspace(0, 4, 801), [0.0], [0.0])
    total = Oscillator(P=0.9, R=0.4905, R0=0.4905)
    one = free(rig(total), t, [0.0], [0.0])
    assert both.complete
    assert both.q == pytest.approx(one.q, abs=1e-10)
    rail = [event for event in both.events if event.element == "rail"]
    assert [e.time for e in rail] == pytest.approx([e.time for e in one.events], abs=1e-9)


def test_a_held_distance_does_not_drift() -> None:
    """A double pendulum whose hand slides and sticks along a rod to a post."""
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"a": {"unit": "rad"}, "b": {"unit": "rad"}},
        parameters={
            "g": (9.81, "m/s^2"),
            "l1": (0.7, "m"),
            "l2": (0.4, "m"),
            "m1": (1.3, "kg"),
            "m2": (0.6, "kg"),
            "R": (3.0, "N"),
            "w": (1e-6, "m/s"),
            "px": (1.0, "m"),
            "py": (0.2, "m"),
        },
        points={
            "elbow": ["l1*sin(a)", "-l1*cos(a)"],
            "post": ["px", "py"],
            "hand": ["l1*sin(a) + l2*sin(b)", "-l1*cos(a) - l2*cos(b)"],
        },
        bodies={"u": {"mass": "m1", "at": "elbow"}, "l": {"mass": "m2", "at": "hand"}},
        elements={
            "rod": {
                "kind": "friction",
                "between": ["post", "hand"],
                "coulomb": "R",
                "transition": "w",
            }
        },
        sensors={"d": {"measures": "distance(post, hand)", "unit": "m", "sd": 1e-3}},
    )
    t = np.linspace(0, 5, 501)
    run, smooth = (free(model, t, [1.2, 0.3], [0.0, 0.0], exact) for exact in (True, False))
    assert run.complete
    assert run.q == pytest.approx(smooth.q, abs=1e-4)
    times = [event.time for event in run.events] + [5.0]
    stretches = [
        run.y[(t > event.time) & (t < end), 0]
        for event, end in zip(run.events, times[1:], strict=True)
        if event.transition == "sticks"
    ]
    long = [one for one in stretches if one.size > 20]
    assert long
    assert max(np.ptp(one) for one in long) < 1e-12


def stop(damping: float | None = None, side: str = "both") -> Model:
    gap: dict[str, object] = {
        "kind": "gap",
        "on": "x",
        "stiffness": "k",
        "clearance": "c",
        "side": side,
    }
    if damping is not None:
        gap["damping"] = "d"
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={
            "m": (2.0, "kg"),
            "k": (800.0, "N/m"),
            "c": (0.1, "m"),
            "d": (damping or 0.0, "N*s/m"),
        },
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"stop": gap},
    )


def test_a_mass_between_two_stops_against_its_closed_form() -> None:
    """Flight c/v, half a swing π/ω on the stop, flight 2c/v, …"""
    run = free(stop(), t := np.linspace(0, 1.2, 601), [0.0], [0.5])
    swing, flight = np.pi / 20.0, 0.2 / 0.5
    times = [0.2, 0.2 + swing, 0.2 + swing + flight, 0.2 + 2 * swing + flight]
    assert [event.time for event in run.events] == pytest.approx(times, abs=1e-9)
    assert [(event.element, event.transition) for event in run.events] == [
        ("stop.upper", "touches"),
        ("stop.upper", "leaves"),
        ("stop.lower", "touches"),
        ("stop.lower", "leaves"),
    ]
    pressed = (t > times[0]) & (t < times[1])
    depth = 0.5 / 20 * np.sin(20 * (t[pressed] - times[0]))
    assert run.q[pressed, 0] == pytest.approx(0.1 + depth, abs=1e-9)


def test_a_damped_stop_never_pulls() -> None:
    """It lets go while it is still entered, where k depth + d depth' = 0, and a mass that flies
    out of it keeps its speed; from the closed form of the damped swing."""
    d, m, k = 16.0, 2.0, 800.0
    run = free(stop(d, "upper"), t := np.linspace(0, 0.6, 601), [0.0], [0.5])
    decay = d / (2 * m)
    omega = np.sqrt(k / m - decay**2)
    s = np.linspace(1e-6, np.pi / omega, 200_001)
    speed = 0.5 * np.exp(-decay * s) * (np.cos(omega * s) - decay / omega * np.sin(omega * s))
    depth = 0.5 / omega * np.exp(-decay * s) * np.sin(omega * s)
    out = int(np.flatnonzero(k * depth + d * speed <= 0)[0])
    reported = [(event.transition, event.time) for event in run.events]
    assert [word for word, _ in reported] == ["touches", "lets go", "leaves"]
    assert reported[1][1] == pytest.approx(0.2 + s[out], abs=2e-6)
    assert reported[2][1] == pytest.approx(0.2 + s[out] + depth[out] / -speed[out], abs=1e-5)
    assert run.v[t > reported[1][1], 0] == pytest.approx(speed[out], abs=1e-5)


@pytest.mark.parametrize(
    ("model", "q", "v"),
    [
        (rig(Oscillator(P=0.9, R0=0.8, vs=0.05), STRIBECK), [0.0], [0.0]),
        (coupled(R1=0.5, R2=0.3, R3=0.4), [0.0, 0.0], [0.0, 0.0]),
        (stop(16.0), [0.0], [0.5]),
    ],
    ids=["Stribeck", "three frictions", "stops"],
)
def test_leaps_in_machine_code_find_what_single_steps_find(
    model: Model, q: list[float], v: list[float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """With a compiler many steps are taken at once, and only some are looked into from Python."""
    leaps = []
    step = Leap.step
    monkeypatch.setattr(Leap, "step", lambda self: leaps.append(self) or step(self))
    fast = free(model, t := np.linspace(0, 4, 2001), q, v)
    assert len(leaps) > 0
    count = len(leaps)
    monkeypatch.setattr("symhyb.exact.events.fields", lambda machine, held: None)
    slow = free(model, t, q, v)
    assert len(leaps) == count
    reported = [(event.element, event.transition) for event in fast.events]
    assert reported == [(event.element, event.transition) for event in slow.events]
    assert len(reported) > 2
    assert [e.time for e in fast.events] == pytest.approx([e.time for e in slow.events], abs=1e-7)
    for one, other in ((fast.q, slow.q), (fast.v, slow.v), (fast.y, slow.y)):
        assert one == pytest.approx(other, abs=1e-7 * np.abs(other).max(initial=1e-3))


def test_a_stiff_machine_is_run_implicitly() -> None:
    """A decay a million times faster than the run, beside stick and slip."""
    o = Oscillator(P=2.0)
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={
            "m": (1.0, "kg"),
            "c": (100.0, "N/m"),
            "d": (0.5, "N*s/m"),
            "R": (0.4905, "N"),
            "P": (2.0, "N"),
            "f": (0.5, "Hz"),
            "big": (1e6, "N*s/m"),
        },
        bodies={"one": {"mass": "m", "at": ["x", "0"]}, "two": {"mass": "m", "at": ["y", "0"]}},
        elements={
            "spring": spring("c"),
            "damper": {"kind": "damper", "on": "x", "damping": "d"},
            "rail": {"kind": "friction", "on": "x", "coulomb": "R"},
            "shaker": {"kind": "harmonic", "on": "x", "amplitude": "P", "frequency": "f"},
            "oil": {"kind": "damper", "on": "y", "damping": "big"},
        },
    )
    run = free(model, t := np.linspace(0, 3, 301), [0.0, 0.0], [0.0, 1.0])
    assert (run.reason, run.method) == ("", "radau")
    assert nrmse(run.q[:, 0], automaton(o, t)[0][:, 0]) < 1e-6
    assert run.q[-1, 1] == pytest.approx(1e-6, rel=1e-3)


def test_a_run_without_anything_that_switches() -> None:
    """x = x0 cos ωt."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (2.0, "kg"), "k": (50.0, "N/m")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"spring": spring("k")},
    )
    run = free(model, t := np.linspace(0, 4, 101), [0.3], [0.0])
    assert run.events == ()
    assert run.q[:, 0] == pytest.approx(0.3 * np.cos(5 * t), abs=1e-8)


def test_quaternions_keep_their_length() -> None:
    """A tumbling quadrotor: the same motion as the smooth run, whose method is another."""
    model = read_model(MODELS / "quadrotor.toml")
    names = [coordinate.name for coordinate in model.coordinates]
    t, v = np.linspace(0, 2, 201), np.zeros(7)
    v[[names.index(part) for part in ("qx", "qy", "qz")]] = 1.0, 2.0, 0.5
    q = np.array([coordinate.start for coordinate in model.coordinates])
    scenario = Scenario(t, q, v, t[[0, -1]], np.zeros((2, 4)))
    exact, smooth = (simulate(build(model), scenario, exact=way) for way in (True, False))
    turned = exact.q[:, [names.index(part) for part in ("qw", "qx", "qy", "qz")]]
    assert np.linalg.norm(turned, axis=1) == pytest.approx(np.ones(t.size), abs=1e-15)
    assert exact.q == pytest.approx(smooth.q, abs=1e-6)
    assert exact.v == pytest.approx(smooth.v, abs=1e-6)


def test_an_exact_run_of_a_loop_is_refused() -> None:
    model = read_model(MODELS / "four_bar.toml")
    with pytest.raises(InputError, match="an exact run knows no constraints; leave out 'exact'"):
        free(model, np.linspace(0, 1, 11), [0.9, -0.4432, 1.2317], [4.0, 0.0, 0.0])


def test_chatter_ends_with_a_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    """As soon as so many transitions count as one instant, the element is named."""
    monkeypatch.setattr("symhyb.exact.events.APART", 1.0)
    monkeypatch.setattr("symhyb.exact.events.AT_ONCE", 6)
    run = free(rig(Oscillator()), np.linspace(0, 8, 81), [0.0], [0.0])
    assert not run.complete
    assert run.reason.startswith("elements.rail changed between sliding, holding, touching ")
    assert "Zeno" in run.reason
    assert np.isnan(run.q[-1]).all()
    assert np.isfinite(run.q[0]).all()


def test_growth_without_bound_is_reported() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (-50.0, "N/m^3"), "R": (0.1, "N")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "spring": {"kind": "spring", "on": "x", "cubic": "k"},
            "rail": {"kind": "friction", "on": "x", "coulomb": "R"},
        },
    )
    run = free(model, np.linspace(0, 10, 101), [1.0], [0.0])
    assert "without bound" in run.reason
    assert [event.transition for event in run.events] == ["slides +"] or run.events == ()


def test_laws_that_stay_as_written_are_reported() -> None:
    """Hysteresis, LuGre, friction at a point and on an imposed motion; sign(...) by hand is
    located."""
    model = model_of(
        coordinates={"x": {"unit": "m"}, "b": {"unit": "m", "imposed": True}},
        parameters={"m": (1.0, "kg"), "R": (0.1, "N"), "k": (1e3, "N/m")},
        points={"tip": ["x", "0"]},
        bodies={"block": {"mass": "m", "at": "tip"}},
        elements={
            "hand": push("-R*sign(x')"),
            "wire": {"kind": "hysteresis", "on": "x", "stiffness": "k"},
            "bristle": {"kind": "friction_dynamic", "on": "x", "coulomb": "R", "stiffness": "k"},
            "floor": {"kind": "friction", "at": "tip", "coulomb": "R"},
            "belt": {"kind": "friction", "on": "b", "coulomb": "R"},
            "rail": {"kind": "friction", "on": "x", "coulomb": "R"},
        },
    )
    reported = left_smooth(model)
    assert [sentence.split(" ")[0] for sentence in reported] == [
        "elements.wire",
        "elements.bristle",
        "elements.floor",
        "elements.belt",
    ]
