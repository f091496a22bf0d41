"""Bad input and bad luck: each ends in a sentence with the cause, not in a wrong name."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.correction.search.clocks import drifting
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.selection import Problem, best_subsets, solve
from symhyb.correction.verdict.refusal import runs_away
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.runs import Run
from symhyb.discrepancy.results import RecordingFault
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On
from symhyb.numeric.lowered.machine import build
from tests.builders import double_pendulum
from tests.liars import chain_model, chain_recording, pendulum_model, pendulum_recording
from tests.rigs import spring_model, spring_recording

Array = NDArray[np.float64]


def laser(values: Array, run: Recording) -> Recording:
    return replace(run, sensors={"laser": values})


@pytest.mark.parametrize(
    "fault",
    [
        "spikes",
        pytest.param("saturated", marks=pytest.mark.thorough),
        pytest.param("drops out", marks=pytest.mark.thorough),
    ],
)
def test_samples_that_a_sensor_got_wrong_are_left_out_with_a_note(fault: str) -> None:
    run, random = spring_recording(1, {}, duration=8.0), np.random.default_rng(0)
    x = run.sensors["laser"].copy()
    places = np.sort(random.choice(x.size, 25, replace=False))
    if fault == "saturated":
        limit = float(np.quantile(np.abs(x), 0.8))
        x = np.clip(x, -limit, limit)
    elif fault == "spikes":
        x[places] += 5 * x.std() * random.standard_normal(places.size)
    else:
        x[places] = 0.0
    diagnosis = sh.diagnose(spring_model(), laser(x, run))
    assert diagnosis.verdict == "nothing missing"
    assert any(fault in note and "left out" in note for note in diagnosis.notes)


def test_one_outlier_does_not_hide_friction() -> None:
    run = spring_recording(2, {"coulomb": 1.0}, duration=8.0)
    x = run.sensors["laser"].copy()
    x[777] += 20 * x.std()
    diagnosis = sh.diagnose(spring_model(), laser(x, run))
    assert [found.element.kind for found in diagnosis.found] == ["friction"]
    assert any("1 of 1600 samples" in note for note in diagnosis.notes)


def test_dead_sensors_are_left_out_or_leave_nothing_to_say() -> None:
    run = pendulum_recording(2, gyro=True)
    dead = replace(run, sensors={**run.sensors, "gyro": 0 * run.t})
    diagnosis = sh.diagnose(pendulum_model(gyro=True), dead)
    assert diagnosis.verdict == "nothing missing"
    assert any("gyro is constant while others move" in note for note in diagnosis.notes)
    alone = spring_recording(1, {}, duration=8.0)
    nothing = sh.diagnose(spring_model(), laser(0 * alone.t + 0.3, alone))
    assert nothing.verdict == "undecided"
    assert "no sensor changes" in nothing.sentence


ROW = """symhyb = 1
[coordinates]
x1 = { unit = "m" }
x2 = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
k = { value = 90.0, unit = "N/m" }
d = { value = 0.8, unit = "N*s/m" }
l = { value = 0.5, unit = "m" }
[inputs]
f = { unit = "N" }
[points]
p1 = ["x1", "0"]
p2 = ["l + x2", "0"]
[bodies.b1]
mass = "m"
at = "p1"
[bodies.b2]
mass = "m"
at = "p2"
[elements]
wall = { kind = "spring", on = "x1", stiffness = "k" }
link = { kind = "spring", between = ["p1", "p2"], stiffness = "k", length = "l" }
first = { kind = "damper", on = "x1", damping = "d" }
second = { kind = "damper", on = "x2", damping = "d" }
motor = { kind = "force", on = "x1", force = "f" }
[sensors]
pos_x1 = { measures = "x1", unit = "m" }
pos_x2 = { measures = "x2", unit = "m" }
"""


@pytest.mark.parametrize(
    "size",
    [pytest.param(3.0, marks=pytest.mark.slow), pytest.param(24.0, marks=pytest.mark.thorough)],
)
def test_masses_that_overtake_each_other_tell_no_physics(size: float) -> None:
    """Equations without lengths let two masses pass through each other; points cannot."""

    def push(t: Array | float) -> Array:
        at = np.asarray(t)
        return np.asarray(size * (np.sin(3 * at) + np.sin(5.2 * at) + np.sin(13.0 * at)))

    def rates(t: float, y: Array) -> Array:
        pull = 90 * (y[1] - y[0])
        forces = push(t) - 90 * y[0] + pull - 0.8 * y[2], -pull - 0.8 * y[3]
        return np.array([y[2], y[3], *forces])

    t = np.arange(1401) / 200
    run = solve_ivp(rates, (0, 7), np.zeros(4), t_eval=t, rtol=1e-9, atol=1e-12)
    noise = np.random.default_rng(3).standard_normal((2, t.size))
    x1, x2 = run.y[:2] + 0.005 * run.y[:2].std() * noise
    passes = bool((run.y[1] - run.y[0]).min() < -0.5)
    recording = Recording("row", t, {"f": push(t)}, {"pos_x1": x1, "pos_x2": x2}, (), "")
    diagnosis = sh.diagnose(parse_model(ROW, "row.toml"), recording)
    assert passes is (size > 10)
    assert diagnosis.verdict == ("undecided" if passes else "nothing missing")
    assert ("p1 and p2 pass through each other in row at" in diagnosis.sentence) is passes
    assert diagnosis.found == diagnosis.parameters == diagnosis.measurement == ()


def test_a_constant_input_at_rest_tells_nothing() -> None:
    run, random = spring_recording(1, {}, duration=8.0), np.random.default_rng(0)
    still = 5 / 200 + 3e-4 * random.standard_normal(run.t.size)
    diagnosis = sh.diagnose(spring_model(), replace(laser(still, run), inputs={"f": 0 * run.t + 5}))
    assert diagnosis.verdict == "undecided"
    assert "cannot tell" in diagnosis.sentence


def test_less_than_a_period_is_said_and_names_nothing() -> None:
    run = spring_recording(3, {"coulomb": 1.0})
    rows = slice(0, 50)
    short = Recording(
        "short.csv",
        run.t[rows],
        {"f": run.inputs["f"][rows]},
        {"laser": run.sensors["laser"][rows]},
        (),
        "",
    )
    diagnosis = sh.diagnose(spring_model(), short)
    assert diagnosis.verdict == "undecided"
    assert diagnosis.found == ()
    assert "cannot tell" in diagnosis.sentence


@pytest.mark.thorough
def test_a_machine_at_rest_half_of_the_time_still_tells_its_friction() -> None:
    run, random = spring_recording(1, {"coulomb": 1.0}, duration=10.0), np.random.default_rng(0)
    size = run.t.size
    rest = 3e-4 * random.standard_normal(size)
    both = Recording(
        "rest.csv",
        0.005 * np.arange(2 * size),
        {"f": np.concatenate([0 * run.t, run.inputs["f"]])},
        {"laser": np.concatenate([rest, run.sensors["laser"]])},
        (),
        "",
    )
    diagnosis = sh.diagnose(spring_model(), both)
    assert [found.element.kind for found in diagnosis.found] == ["friction"]


def test_one_column_for_two_sensors_is_refused_with_the_cure() -> None:
    run = chain_recording(3)
    same = replace(run, sensors={"near": run.sensors["near"], "far": run.sensors["near"].copy()})
    with pytest.raises(sh.InputError, match=r"near and far hold the same samples.*own column"):
        sh.diagnose(chain_model(), same)


def test_a_regression_with_identical_columns_takes_one_of_them() -> None:
    random = np.random.default_rng(0)
    column = random.standard_normal(200)
    rows = np.column_stack([column, column, 2 * column + 0.1 * random.standard_normal(200)])
    causes = tuple(
        Hypothesis(kind, On("x"), (term,), (False,))
        for kind, term in (("spring", "stiffness"), ("constant", "constant"))
    )
    gram = rows.T @ rows
    free = np.full(2, np.inf)
    problem = Problem(gram, gram, causes, ((0,), (1,)), (), np.zeros(2), -free, free, np.zeros(2))
    assert solve(problem, (0, 1)) is None
    sizes = best_subsets(problem)
    assert len(sizes) == 2
    assert sizes[1][0].values == pytest.approx([2.0], rel=0.02)


def test_a_correction_that_runs_away_is_seen() -> None:
    run = spring_recording(1, {}, duration=8.0)
    machine = build(spring_model())
    made = Run(run, motion_of(run, machine), np.array([1e-4]))
    assert runs_away(machine, made) is None
    loose = build(spring_model(stiffness=-40.0))
    when = runs_away(loose, made)
    assert when is not None
    assert 0 < when < 16


@pytest.mark.parametrize(
    "drift",
    [
        pytest.param(0.001, marks=pytest.mark.thorough),
        pytest.param(0.005, marks=pytest.mark.thorough),
    ],
)
def test_a_clock_that_runs_fast_is_reported(drift: float) -> None:
    model, run = chain_model(), chain_recording(3)
    t, far = run.t, run.sensors["far"]
    late = replace(run, sensors={**run.sensors, "far": np.interp(t / (1 + drift), t, far)})
    fault = _clock(model, late)
    assert fault is not None
    assert (fault.kind, fault.channels) == ("clock", ("far",))
    assert fault.factor == pytest.approx(drift, rel=0.1)
    assert "fast against all others" in fault.sentence


def test_clocks_that_keep_time_are_not_accused() -> None:
    assert _clock(chain_model(), chain_recording(3, {"coulomb": 2.0})) is None
    assert _clock(spring_model(stiffness=150.0), spring_recording(4, {})) is None


def _clock(model: Model, run: Recording) -> RecordingFault | None:
    setting = settle(prepare(model, run))
    return drifting(setting, lambda clocks: settle(prepare(model, run, (), clocks)))


@pytest.mark.thorough
def test_a_chaotic_double_pendulum_over_a_minute_ends_in_a_sentence() -> None:
    model, random = double_pendulum(), np.random.default_rng(1)
    measured = {"a": "alpha", "b": "beta"}
    text = model.text + "".join(
        f'[sensors.{name}]\nmeasures = "{what}"\nunit = "rad"\n' for name, what in measured.items()
    )
    model = parse_model(text, "double.toml")
    machine = build(model)
    t = np.arange(0, 60, 0.01)

    def rate(_: float, state: Array) -> Array:
        a, b, v, w = state
        m1, m2, l1, l2, g = 1.3, 0.6, 0.7, 0.4, 9.81
        c, s = np.cos(a - b), np.sin(a - b)
        mass = np.array([[(m1 + m2) * l1, m2 * l2 * c], [l1 * c, l2]])
        right = np.array(
            [-m2 * l2 * s * w**2 - (m1 + m2) * g * np.sin(a), l1 * s * v**2 - g * np.sin(b)]
        )
        return np.array([v, w, *np.linalg.solve(mass, right)])

    run = solve_ivp(rate, (0, 60), [2.5, 2.0, 0, 0], t_eval=t, rtol=1e-10, atol=1e-10)
    assert np.ptp(run.y[1]) > 2 * np.pi  # it goes over the top
    sensors = {
        name: q + 2e-3 * random.standard_normal(t.size)
        for name, q in zip(measured, run.y[:2], strict=True)
    }
    recording = Recording("chaos.csv", t, {}, sensors, (), "")
    assert machine.n == 2
    diagnosis = sh.diagnose(model, recording)
    assert diagnosis.verdict in ("nothing missing", "undecided")
    assert diagnosis.found == ()
