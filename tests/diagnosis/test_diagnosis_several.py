"""Several recordings at once: own values, outliers, repeats; and effects that begin half-way."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.correction.search.fleet import check_own
from symhyb.correction.search.preparing import prepare
from symhyb.data.recording import Recording
from symhyb.model.read import parse_model
from symhyb.report import to_json
from tests.rigs import DAMPING, MASS, STIFFNESS, spring_model

Law = Callable[[float, float, float], float]


def recorded(
    seed: int,
    law: Law,
    name: str,
    duration: float = 6.0,
    noise: float = 0.01,
    manoeuvre: int | None = None,
    step: float = 0.005,
) -> Recording:
    """Position under a multisine of 8 N, with a force of (t, x, v) that the model lacks; recordings
    of one ``manoeuvre`` share the input."""
    random = np.random.default_rng(seed if manoeuvre is None else manoeuvre)
    t, lines = np.arange(0, duration, step), np.linspace(0.3, 5, 14)
    phases = random.uniform(0, 2 * np.pi, 14)

    def force(time: float) -> float:
        return float(8 * np.sqrt(2 / 14) * np.sin(2 * np.pi * lines * time + phases).sum())

    def rate(time: float, state: np.ndarray) -> list[float]:
        x, v = state
        acting = force(time) - STIFFNESS * x - DAMPING * v + law(time, x, v)
        return [v, acting / MASS]

    run = solve_ivp(
        rate, (0, duration), [0, 0], t_eval=t, method="LSODA", rtol=1e-8, atol=1e-10, max_step=0.005
    )
    x = run.y[0]
    shaken = x + noise * x.std() * np.random.default_rng(seed + 500).standard_normal(t.size)
    return Recording(name, t, {"f": np.array([force(s) for s in t])}, {"laser": shaken}, (), "")


def dry(coulomb: float) -> Law:
    return lambda t, x, v: -coulomb * float(np.tanh(v / 1e-5))


def drag(coefficient: float) -> Law:
    return lambda t, x, v: -coefficient * abs(v) * v


@pytest.mark.slow
def test_every_recording_has_its_own_phase_of_an_unknown_harmonic_force() -> None:
    def hum(phase: float) -> Law:
        return lambda t, x, v: 2.0 * float(np.sin(2 * np.pi * 3.3 * t + phase))

    runs = [recorded(1, hum(0.3), "a.csv"), recorded(2, hum(2.1), "b.csv")]
    diagnosis = sh.diagnose(spring_model(), runs, recorded(3, hum(4.0), "c.csv"))
    (found,) = diagnosis.found
    assert found.element.kind == "harmonic"
    amplitude = next(e for e in found.estimates if e.term == "amplitude")
    assert amplitude.value == pytest.approx(2.0, rel=0.03)
    phases = {name: numbers[0].value for name, numbers in found.own}
    assert set(phases) == {"a.csv", "b.csv"}
    apart = (phases["b.csv"] - phases["a.csv"] - 1.8 + np.pi) % (2 * np.pi) - np.pi
    assert abs(apart) < 0.05
    assert found.share is not None
    assert found.share > 0.8  # of an unseen recording, with a phase of its own
    assert diagnosis.misfits == ()


@pytest.mark.slow
def test_a_fleet_shares_the_law_and_each_has_its_own_value() -> None:
    truth = {"a.csv": 1.0, "b.csv": 2.0, "c.csv": 4.0}
    runs = [recorded(i, drag(b), name, 5.0) for i, (name, b) in enumerate(truth.items())]
    diagnosis = sh.diagnose(spring_model(), runs, own=["drag"])
    (found,) = diagnosis.found
    assert found.element.kind == "drag"
    for name, (number,) in found.own:
        assert number.value == pytest.approx(truth[name], rel=0.03)
        assert name in found.sentence
    assert diagnosis.misfits == ()


@pytest.mark.slow
def test_a_recording_that_does_not_fit_the_others_is_named() -> None:
    levels = (1.1, 1.1, 2.1, 1.1)
    runs = [recorded(i, dry(c), f"run_{i}.csv") for i, c in enumerate(levels, 1)]
    diagnosis = sh.diagnose(spring_model(), runs)
    (odd,) = diagnosis.misfits
    assert odd.recording == "run_3.csv"
    assert odd.value == pytest.approx(2.1, rel=0.05)
    assert odd.others == pytest.approx(1.1, rel=0.05)
    assert "Coulomb friction" in odd.sentence
    assert odd.sentence in diagnosis.sentence
    (found,) = diagnosis.found  # the values are those of the others
    assert found.estimates[0].value == pytest.approx(1.1, rel=0.03)


@pytest.mark.slow
def test_of_two_that_differ_each_keeps_its_own_value() -> None:
    runs = [recorded(1, drag(1.0), "a.csv", 5.0), recorded(2, drag(2.0), "b.csv", 5.0)]
    diagnosis = sh.diagnose(spring_model(), runs)
    (found,) = diagnosis.found
    own = {name: numbers[0].value for name, numbers in found.own}
    assert own == pytest.approx({"a.csv": 1.0, "b.csv": 2.0}, rel=0.03)
    assert "do not fit each other" in diagnosis.sentence


def unsteady(seed: int, coulomb: float, size: float) -> Law:
    """A slow force that is another in every run, beside dry friction, N."""
    random = np.random.default_rng(seed)
    lines, phases = random.uniform(0.2, 2, 4), random.uniform(0, 6, 4)
    friction = dry(coulomb)

    def force(t: float, x: float, v: float) -> float:
        return size * float(np.sin(2 * np.pi * lines * t + phases).sum()) + friction(t, x, v)

    return force


@pytest.mark.parametrize(
    ("coulomb", "size", "kinds"),
    [
        pytest.param(0.03, 0.25, set(), marks=pytest.mark.slow),
        pytest.param(1.0, 0.05, {"friction"}, marks=pytest.mark.slow),
    ],
)
def test_repeated_runs_set_the_smallest_effect(
    coulomb: float, size: float, kinds: set[str]
) -> None:
    runs = [
        recorded(i, unsteady(i, coulomb, size), f"{i}.csv", noise=0.003, manoeuvre=7)
        for i in (1, 2, 3)
    ]
    diagnosis = sh.diagnose(spring_model(), runs)
    (group,) = diagnosis.repeats
    assert group.recordings == ("1.csv", "2.csv", "3.csv")
    assert group.between["laser"] > 3 * group.noise["laser"]
    assert {found.element.kind for found in diagnosis.found} == kinds
    assert group.sentence in diagnosis.notes


def test_repeats_that_differ_by_noise_alone_raise_no_floor() -> None:
    runs = [recorded(i, dry(0.0), f"{i}.csv", 4.0, manoeuvre=7) for i in (1, 2)]
    other = recorded(3, dry(0.0), "other.csv", 4.0)
    prepared = prepare(spring_model(), [*runs, other])
    (group,) = prepared.repeats
    assert group.runs == (0, 1)
    assert group.between[0] == 0.0
    assert all(run.floor == 0.0 for run in prepared.runs)


@pytest.mark.slow
def test_recordings_may_differ_in_rate_and_sensors() -> None:
    runs = [recorded(1, drag(2.0), "a.csv"), recorded(2, drag(2.0), "b.csv", step=0.008)]
    tacho = '\ntacho = { measures = "x\'", unit = "m/s" }\n'
    model = parse_model(spring_model().text + tacho, "rig.toml")
    speed = np.gradient(runs[0].sensors["laser"], runs[0].t)
    noise = 0.05 * np.random.default_rng(0).standard_normal(speed.size)
    clean = recorded(1, drag(2.0), "a.csv", noise=0.0)
    speed = np.gradient(clean.sensors["laser"], clean.t) + noise
    first = replace(runs[0], sensors={**runs[0].sensors, "tacho": speed})
    diagnosis = sh.diagnose(model, [first, runs[1]])
    (found,) = diagnosis.found
    assert found.element.kind == "drag"
    assert found.estimates[0].value == pytest.approx(2.0, rel=0.04)


@pytest.mark.parametrize("name", ["mas", "Drag", ""])
def test_an_unknown_own_name_is_one_clear_error(name: str) -> None:
    with pytest.raises(sh.InputError, match="neither a parameter of the model nor a key"):
        check_own(spring_model(), [name])


@pytest.mark.slow
def test_friction_that_begins_half_way_is_located_and_named() -> None:
    def law(t: float, x: float, v: float) -> float:
        return dry(1.0)(t, x, v) if t >= 6.2 else 0.0

    diagnosis = sh.diagnose(spring_model(), recorded(1, law, "run.csv", 12.0))
    reported = diagnosis.places[0].occurrence
    assert reported is not None
    assert reported.change is not None
    assert reported.change.kind == "begins"
    assert reported.change.time_s == pytest.approx(6.2, abs=2 * reported.change.width_s)
    assert "begins at t = " in reported.sentence
    (found,) = diagnosis.found
    assert found.element.kind == "friction"
    assert found.estimates[0].value == pytest.approx(1.0, rel=0.05)
    assert "begins at t = " in diagnosis.sentence
    assert found.stability is not None
    assert found.stability > 10 / 11


@pytest.mark.thorough
def test_friction_that_changes_half_way_is_not_said_to_be_constant() -> None:
    def law(t: float, x: float, v: float) -> float:
        return dry(1.0 if t >= 5.0 else 0.5)(t, x, v)

    diagnosis = sh.diagnose(spring_model(), recorded(1, law, "run.csv", 12.0))
    (found,) = diagnosis.found
    (level,) = found.estimates
    assert "Coulomb friction on x is not constant" in diagnosis.sentence
    assert level.sd > 0.1
    assert abs(level.value - 0.75) < 2 * level.sd


def test_json_holds_what_several_recordings_say() -> None:
    from tests.fakes import verdict  # hand-made scores, no mechanics

    runs = [recorded(i, dry(0.0), f"{i}.csv", 4.0, manoeuvre=7) for i in (1, 2)]
    diagnosis = sh.diagnose(spring_model(), runs)
    content = to_json(diagnosis, verdict())
    assert content["repeats"][0]["recordings"] == ["1.csv", "2.csv"]
    assert content["misfits"] == []


BALL = """
symhyb = 1
gravity = ["0", "-g"]
[coordinates]
y = { unit = "m", start = 40.0 }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 1.0, unit = "kg" }
[bodies.ball]
mass = "m"
at = ["0", "y"]
[sensors]
height = { measures = "y", unit = "m", sd = 0.02 }
"""


def dropped(coefficient: float, seed: int) -> Recording:
    """A ball of 1 kg that falls from 40 m for 2.6 s, with drag in N·s²/m², filmed to 2 cm."""
    t = np.arange(0, 2.6, 1 / 30)
    if coefficient:
        pace = np.sqrt(9.81 * coefficient)
        y = 40 - np.log(np.cosh(pace * t)) / coefficient
    else:
        y = 40 - 9.81 * t**2 / 2
    y = y + 0.02 * np.random.default_rng(seed).standard_normal(t.size)
    return Recording(f"ball_{seed}.csv", t, {}, {"height": y}, (), "")


@pytest.mark.slow
def test_a_fleet_of_falls_names_the_drag_and_who_shows_none() -> None:
    truth = [0.0, 0.01, 0.02, 0.03, 0.05, 0.0]
    runs = [dropped(b, seed) for seed, b in enumerate(truth)]
    diagnosis = sh.diagnose(parse_model(BALL, "ball.toml"), runs, own=["drag", "damping"])
    (found,) = diagnosis.found
    assert found.element.kind == "drag"
    for (_, (number,)), b in zip(found.own, truth, strict=True):
        assert abs(number.value - b) < 4 * number.sd + 1e-4
    assert "Of ball_0.csv and ball_5.csv it does not stand out" in found.sentence


@pytest.mark.slow
def test_one_fall_is_refused_for_its_one_speed_and_not_advised_to_last_longer() -> None:
    diagnosis = sh.diagnose(parse_model(BALL, "ball.toml"), dropped(0.03, 1))
    assert diagnosis.verdict == "undecided"
    assert diagnosis.found == ()
    assert diagnosis.record_next is not None
    assert "at other speeds" in diagnosis.record_next
    assert "period" not in diagnosis.sentence
