"""The first checks of a recording, each against an oscillator whose answer is known by hand."""

from collections.abc import Mapping

import numpy as np
import pytest
from builders import Entries, damper, model_of, oscillator, push, recording, spring

from symhyb.data.recording import Recording
from symhyb.discrepancy.checks.balance import Balance, balance_of
from symhyb.discrepancy.checks.first_checks import FirstChecks, first_checks, repeats_of
from symhyb.discrepancy.checks.modes import modes_at, rest_position
from symhyb.discrepancy.checks.split import period_of, split_of
from symhyb.discrepancy.checks.timing import hold_of
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

M, K, D = 1.2, 300.0, 1.5
OWN = np.sqrt(K / M)  # rad/s
LINEAR: Mapping[str, Entries] = {"hold": spring("k"), "pot": damper("d"), "motor": push("f")}
VALUES: Entries = {"k": (K, "N/m"), "d": (D, "N*s/m")}
FORCE: Mapping[str, Entries] = {"f": {"unit": "N"}}


def driven_model(elements: Mapping[str, Entries] = LINEAR, **more: Entries) -> Model:
    values = {**VALUES, **more.pop("parameters", {})}
    return oscillator(elements, values, inputs=FORCE, **more)  # type: ignore[arg-type]


def run_of(
    model: Model, t: np.ndarray, f: np.ndarray, sd: float = 1e-5, late: float = 0.0
) -> Recording:
    """What the sensors of a model record under a force, which acts ``late``."""
    machine = build(model)
    acting = np.interp(t - late, t, f)
    start = np.array([c.start for c in model.coordinates])
    run = simulate(machine, Scenario(t, start, 0 * start, t, acting[:, None]))
    assert run.complete
    noise = np.random.default_rng(7)
    shown = {
        s.name: y + sd * noise.standard_normal(t.size)
        for s, y in zip(model.sensors, run.y.T, strict=True)
    }
    return recording(t, {"f": f}, **shown)


def broad(t: np.ndarray, low: float, high: float, seed: int = 3) -> np.ndarray:
    """Fifty sines of random phase between two frequencies in Hz, that do not repeat."""
    chance = np.random.default_rng(seed)
    lines = np.sort(chance.uniform(low, high, 50))
    phases = chance.uniform(0, 2 * np.pi, 50)
    return np.asarray(np.sin(2 * np.pi * np.outer(t, lines) + phases).sum(axis=1))


def multisine(t: np.ndarray, period: float, orders: range) -> np.ndarray:
    chance = np.random.default_rng(5)
    phases = chance.uniform(0, 2 * np.pi, len(orders))
    return np.asarray(
        np.sin(2 * np.pi * np.outer(t, np.array(orders)) / period + phases).sum(axis=1)
    )


def said(checks: FirstChecks, name: str) -> str:
    return "\n".join(sentence for check, sentence in checks.said if check == name)


# --- rest and modes -----------------------------------------------------------------------------


def test_the_mode_of_an_oscillator() -> None:
    (mode,) = modes_at(build(driven_model()), np.zeros(1), np.zeros(1))
    assert mode.frequency == pytest.approx(OWN / (2 * np.pi), rel=1e-12)
    assert mode.damping == pytest.approx(D / (2 * np.sqrt(K * M)), rel=1e-12)
    assert mode.shape == (("x", 1.0),)


def two_masses() -> Model:
    r"""wall o--/\k/\--[m]--/\k/\--[m]"""
    return model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (2.0, "kg"), "k": (50.0, "N/m"), "far": (3.0, "m")},
        points={"a": ["x", "0"], "b": ["far + y", "0"]},
        bodies={"one": {"mass": "m", "at": "a"}, "two": {"mass": "m", "at": "b"}},
        elements={
            "first": spring("k"),
            "second": {
                "kind": "spring",
                "between": ["a", "b"],
                "stiffness": "k",
                "length": "far",
            },
        },
        sensors={"x": {"measures": "x", "unit": "m"}},
    )


def test_modes_of_two_masses_have_the_golden_shapes() -> None:
    golden = (1 + np.sqrt(5)) / 2
    slow, fast = modes_at(build(two_masses()), np.zeros(2), np.zeros(0))
    assert slow.frequency == pytest.approx(5 / golden / (2 * np.pi))
    assert fast.frequency == pytest.approx(5 * golden / (2 * np.pi))
    assert dict(slow.shape)["x"] == pytest.approx(1 / golden)
    assert dict(fast.shape)["y"] == pytest.approx(-1 / golden)


def test_a_mass_without_spring_moves_freely_and_rests_nowhere_under_a_force() -> None:
    machine = build(driven_model({"motor": push("f")}))
    (mode,) = modes_at(machine, np.zeros(1), np.zeros(1))
    assert (mode.frequency, mode.rate) == (0.0, 0.0)
    assert rest_position(machine, np.zeros(1), np.zeros(1)) == pytest.approx(0.0)
    assert rest_position(machine, np.zeros(1), np.ones(1)) is None


def test_a_spring_rests_where_it_holds_the_force() -> None:
    rest = rest_position(build(driven_model()), np.zeros(1), np.array([6.0]))
    assert rest == pytest.approx(6.0 / K)


def test_a_pendulum_upside_down_falls() -> None:
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"a": {"unit": "rad", "start": float(np.pi)}},
        parameters={"m": (1.0, "kg"), "r": (0.5, "m"), "g": (9.81, "m/s^2")},
        bodies={"bob": {"mass": "m", "at": ["r*sin(a)", "-r*cos(a)"]}},
        sensors={"a": {"measures": "a", "unit": "rad"}},
    )
    rates = sorted(mode.rate for mode in modes_at(build(model), np.array([np.pi]), np.zeros(0)))
    assert rates == pytest.approx([-np.sqrt(9.81 / 0.5), np.sqrt(9.81 / 0.5)])


def held(offset: float) -> FirstChecks:
    """An oscillator that swings, then stands still, with a sensor that is off."""
    t = np.arange(3000) / 200
    model = driven_model(parameters={"d": (12.0, "N*s/m")})
    run = run_of(model, t, np.where(t < 5, 6 * np.sin(8 * t), 0.0), sd=1e-4)
    moved = recording(t, {"f": run.inputs["f"]}, place=run.sensors["place"] + offset)
    return first_checks(build(model), moved)


def test_a_standstill_at_the_right_place_and_beside_it() -> None:
    right, wrong = held(0.0).standstill, held(0.02).standstill
    assert right is not None
    assert right.right
    assert wrong is not None
    assert not wrong.right
    assert wrong.off["x"] == pytest.approx(0.02, rel=0.02)
    assert wrong.force["x"] == pytest.approx(0.02 * K, rel=0.02)


def test_dry_friction_may_hold_a_machine_beside_its_place_of_rest() -> None:
    dry = {"kind": "friction", "on": "x", "coulomb": "c", "transition": "w"}
    more = {"c": (2.0, "N"), "w": (1e-4, "m/s")}
    model = driven_model({**LINEAR, "dry": dry}, parameters=more)
    t = np.arange(1600) / 200
    run = run_of(model, t, np.where(t < 4, 12 * np.sin(6 * t), 0.0), sd=1e-5)
    checks = first_checks(build(model), run)
    assert "without dry" in said(checks, "modes")
    (mode,) = checks.swings[0].modes
    assert mode.frequency == pytest.approx(OWN / (2 * np.pi))
    assert checks.standstill is not None
    assert checks.standstill.held


# --- energy -------------------------------------------------------------------------------------


def balanced(machine: Machine, run: Recording) -> Balance:
    motion = motion_of(run, machine)
    found = balance_of(machine, motion, course_of(run, machine, motion))
    assert isinstance(found, Balance)
    return found


T = np.arange(4000) / 400
TURN = 2 * np.pi * 2.0  # rad/s: ten seconds hold twenty turns


def turning(model: Model, size: float = 0.05) -> Recording:
    """x = size·sin(TURN t) with the force that it takes, and nothing but noise of 1e-6 m."""
    x, v = size * np.sin(TURN * T), size * TURN * np.cos(TURN * T)
    f = -M * TURN**2 * x + D * v + K * x
    noise = np.random.default_rng(7).standard_normal(T.size)
    return recording(T, {"f": f}, place=x + 1e-6 * noise)


def lost_in(found: Balance, size: float = 0.05) -> float:
    """∫ D·(size·TURN·cos)² dt over the span of a balance."""
    t = np.array(found.span)
    integral = t / 2 + np.sin(2 * TURN * t) / (4 * TURN)
    return float(D * (size * TURN) ** 2 * np.diff(integral)[0])


def test_energy_that_a_damper_dissipates() -> None:
    found = balanced(build(driven_model()), turning(driven_model()))
    lost = lost_in(found)
    assert found.dissipated["pot"] == pytest.approx(lost, rel=2e-3)
    assert found.put_in["motor"] == pytest.approx(lost, rel=2e-3)
    assert abs(found.unaccounted) < max(5 * found.sd, 1e-3 * lost)


def test_energy_that_a_model_does_not_know_of() -> None:
    model = driven_model({"hold": spring("k"), "motor": push("f")})
    found = balanced(build(model), turning(model))
    lost = lost_in(found)
    assert found.unaccounted == pytest.approx(-lost, rel=2e-3)
    assert not found.dissipated
    assert "lost beyond what the model knows" in found.sentence


def test_energy_of_a_release_goes_into_the_damper() -> None:
    model = oscillator({"hold": spring("k"), "pot": damper("d")}, VALUES, start=0.1)
    t = np.arange(2400) / 400
    run = simulate(build(model), Scenario(t, np.array([0.1]), np.zeros(1), t, np.empty((2400, 0))))
    found = balanced(build(model), recording(t, place=run.q[:, 0]))
    kept = M * run.v[:, 0] ** 2 / 2 + K * run.q[:, 0] ** 2 / 2
    first, last = np.searchsorted(t, found.span)
    assert found.stored == pytest.approx(kept[last] - kept[first], rel=2e-3)
    assert found.dissipated["pot"] == pytest.approx(-found.stored, rel=2e-3)


@pytest.mark.parametrize("measured", [True, False])
def test_work_of_a_rig(measured: bool) -> None:
    sensors: dict[str, Entries] = {"place": {"measures": "x", "unit": "m"}}
    if measured:
        sensors = {"cell": {"measures": "reaction(x)", "unit": "N"}}
    model = model_of(
        coordinates={"x": {"unit": "m", "imposed": True}},
        parameters={"m": (M, "kg"), **VALUES},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"hold": spring("k"), "pot": damper("d")},
        sensors=sensors,
    )
    x, v = 0.05 * np.sin(TURN * T), 0.05 * TURN * np.cos(TURN * T)
    force = -M * TURN**2 * x + 2 * D * v + K * x  # twice the damping that the model knows
    run = recording(T, {"x": x}, **({"cell": force} if measured else {"place": x}))
    checks = first_checks(build(model), run)
    assert checks.balance is not None
    lost = lost_in(checks.balance)
    assert checks.balance.dissipated["pot"] == pytest.approx(lost, rel=5e-3)
    assert checks.balance.rig["x"] == pytest.approx((2 if measured else 1) * lost, rel=5e-3)
    assert checks.balance.unaccounted == pytest.approx(-lost if measured else 0.0, abs=5e-3 * lost)
    assert "every coordinate is imposed" in checks.skipped["modes"]


# --- frequency responses ------------------------------------------------------------------------


def receptance(frequency: np.ndarray) -> np.ndarray:
    w = 2 * np.pi * frequency
    return np.asarray(1 / (K - M * w**2 + 1j * D * w))


def test_the_response_under_a_drive_that_does_not_repeat() -> None:
    t = np.arange(8000) / 100
    model = driven_model(parameters={"d": (12.0, "N*s/m")})
    checks = first_checks(build(model), run_of(model, t, broad(t, 0.5, 5.0), sd=1e-5))
    (found,) = checks.responses
    assert found.split is None
    assert found.apart["model"] < 1e-3
    assert np.median(found.coherence) > 0.98
    middle = (found.frequency > 1.0) & (found.frequency < 4.5)
    w = 2 * np.pi * found.frequency[middle]
    exact = 1 / (K - M * w**2 + 12j * w)
    error = np.abs(found.measured[middle, 0] - exact) / np.abs(exact)
    assert np.median(error) < 0.1


def test_a_model_that_runs_away_has_no_response() -> None:
    t = np.arange(8000) / 100
    run = run_of(driven_model(parameters={"d": (12.0, "N*s/m")}), t, broad(t, 0.5, 5.0), sd=1e-5)
    unstable = driven_model(parameters={"d": (-12.0, "N*s/m")})
    checks = first_checks(build(unstable), run)
    (found,) = checks.responses
    assert not found.apart
    said = [sentence for name, sentence in checks.said if name == "response"]
    assert said[-1].startswith("the model alone, simulated from the recorded start, is 100 times")


def test_the_response_at_the_lines_of_a_periodic_drive() -> None:
    t = np.arange(8000) / 200
    run = run_of(driven_model(), t, multisine(t, 4.0, range(1, 20)), sd=1e-5)
    (found,) = first_checks(build(driven_model()), run).responses
    assert found.frequency == pytest.approx(np.arange(1, 20) / 4)
    exact = receptance(found.frequency)
    assert np.abs(found.measured[:, 0] - exact) == pytest.approx(0, abs=0.01 * abs(exact).max())


def test_a_split_finds_each_part_and_no_other() -> None:
    period, count = 200, 20
    k = np.arange(period * count)
    u = np.sin(2 * np.pi * k / period) + np.sin(2 * np.pi * 3 * k / period)
    noise = 0.01 * np.random.default_rng(0).standard_normal(k.size)
    assert period_of(u[:, None]) == period
    plain = split_of(u[:, None], 2 * u + noise, period)
    assert plain.linear == pytest.approx(2.0, rel=1e-3)
    assert plain.noise == pytest.approx(0.01, rel=0.05)
    assert (plain.nonlinear, plain.transient) == (0.0, 0.0)
    squared = split_of(u[:, None], 2 * u + 0.1 * np.cos(2 * np.pi * 4 * k / period) + noise, period)
    assert squared.nonlinear == pytest.approx(0.1 / np.sqrt(2), rel=0.02)
    assert squared.even == pytest.approx(squared.nonlinear, rel=0.02)
    assert squared.odd == 0.0
    dying = split_of(u[:, None], 2 * u + np.exp(-k / 20.0) + noise, period)
    assert dying.transient > 0.1
    assert dying.nonlinear == 0.0


def test_what_does_not_repeat_has_no_period() -> None:
    t = np.arange(2000) / 100
    assert period_of(broad(t, 0.5, 5.0)[:, None]) is None
    assert period_of(np.sin(2 * np.pi * t / 8.0)[:, None]) is None  # only two and a half


def test_without_a_drive_there_is_no_response() -> None:
    model = oscillator({"hold": spring("k"), "pot": damper("d")}, VALUES, start=0.1)
    t = np.arange(800) / 100
    run = simulate(build(model), Scenario(t, np.array([0.1]), np.zeros(1), t, np.empty((800, 0))))
    checks = first_checks(build(model), recording(t, place=run.q[:, 0]))
    assert "nothing that changes drives" in checks.skipped["response"]
    assert not checks.responses


# --- time ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("late", [0.0, 0.02])
def test_a_force_that_is_late(late: float) -> None:
    t = np.arange(3000) / 200
    run = run_of(driven_model(), t, 5 * broad(t, 0.5, 5.0), late=late)
    model = driven_model({"hold": spring("k"), "motor": push("f")})  # its damping is not known
    (found,) = first_checks(build(model), run).timing.late
    assert found.delay == pytest.approx(late, abs=2e-3)
    assert found.claimed == (late > 0)


def test_a_sensor_that_is_late_against_another() -> None:
    sensors: Mapping[str, Entries] = {
        "place": {"measures": "x", "unit": "m"},
        "speed": {"measures": "x'", "unit": "m/s"},
    }
    model = driven_model(sensors=sensors)  # type: ignore[arg-type]
    t = np.arange(3000) / 200
    run = run_of(model, t, 5 * broad(t, 0.5, 5.0), sd=1e-4)
    shifted = {**run.sensors, "speed": np.interp(t - 0.03, t, run.sensors["speed"])}
    checks = first_checks(build(model), recording(t, {"f": run.inputs["f"]}, **shifted))
    delays = {one.channel: one for one in checks.timing.late}
    assert delays["speed"].delay == pytest.approx(0.03, abs=2e-3)
    assert delays["speed"].claimed
    assert "late against the other sensors" in delays["speed"].sentence


def test_a_single_sine_tells_no_delay_of_its_force() -> None:
    (found,) = first_checks(build(driven_model()), turning(driven_model())).timing.late
    assert found.delay is None or not found.claimed


def test_a_channel_that_is_held_between_samples() -> None:
    values = np.random.default_rng(1).standard_normal(400)
    assert hold_of(values) == 1
    assert hold_of(np.repeat(values, 5)) == 5
    assert hold_of(np.ones(400)) == 1


# --- several, and what cannot be checked --------------------------------------------------------


def test_repeated_runs_are_reported() -> None:
    t = np.arange(1500) / 100
    f = broad(t, 0.5, 3.0)
    runs = [run_of(driven_model(), t, f, sd=1e-4) for _ in range(2)]
    motions = [motion_of(run, build(driven_model())) for run in runs]
    (found,) = repeats_of(driven_model(), runs, motions)
    assert "differ by no more than their noise" in found.sentence


def test_a_model_that_depends_on_time_itself() -> None:
    shaking = {"kind": "harmonic", "on": "x", "amplitude": "a", "frequency": "w"}
    more = {"a": (2.0, "N"), "w": (1.5, "1/s")}
    shaken = {"hold": spring("k"), "motor": push("f"), "shake": shaking}
    model = driven_model(shaken, parameters=more)
    checks = first_checks(build(model), turning(model))
    assert "time itself" in checks.skipped["rest"]
    assert checks.swings[0].modes[0].frequency == pytest.approx(OWN / (2 * np.pi))
    moving = driven_model(
        {"hold": spring("k*(1 + 0.1*sin(2*pi*w*t))"), "motor": push("f")}, parameters=more
    )
    assert "time itself" in first_checks(build(moving), turning(moving)).skipped["modes"]


def test_a_motion_that_is_hardly_shown_tells_no_delay() -> None:
    t = np.arange(1500) / 200
    run = run_of(driven_model(), t, 5 * broad(t, 0.5, 5.0), sd=0.02, late=0.02)
    late = first_checks(build(driven_model()), run).timing.late
    assert not any(one.claimed for one in late)


def test_a_sensor_that_is_missing_and_one_with_holes() -> None:
    sensors: Mapping[str, Entries] = {
        "place": {"measures": "x", "unit": "m"},
        "speed": {"measures": "x'", "unit": "m/s"},
    }
    model = driven_model(sensors=sensors)  # type: ignore[arg-type]
    t = np.arange(1500) / 100
    run = run_of(model, t, 5 * broad(t, 0.5, 5.0), sd=1e-4)
    place = run.sensors["place"].copy()
    place[300:450] = np.nan
    checks = first_checks(build(model), recording(t, {"f": run.inputs["f"]}, place=place))
    assert checks.timing.missing == {"place": pytest.approx(0.1)}
    assert "10 % of the samples of place are missing" in checks.skipped["response"]
    assert [late.channel for late in checks.timing.late] == ["f"]
    assert checks.balance is not None


def test_two_drives_are_parted() -> None:
    inputs: Mapping[str, Entries] = {"f": {"unit": "N"}, "g": {"unit": "N"}}
    elements = {**LINEAR, "pot": damper("d"), "other": push("3*g")}
    model = oscillator(elements, {**VALUES, "d": (12.0, "N*s/m")}, inputs=inputs)
    t = np.arange(6000) / 100
    u = np.column_stack([broad(t, 0.5, 5.0, seed) for seed in (1, 2)])
    run = simulate(build(model), Scenario(t, np.zeros(1), np.zeros(1), t, u))
    given = recording(t, {"f": u[:, 0], "g": u[:, 1]}, place=run.q[:, 0])
    (found,) = first_checks(build(model), given).responses
    middle = (found.frequency > 1.0) & (found.frequency < 4.0)
    ratio = found.measured[middle, 1] / found.measured[middle, 0]
    assert np.median(np.abs(ratio)) == pytest.approx(3.0, rel=0.1)
    assert found.drives == ("f", "g")
