"""The smooth remainder: what named laws leave, beside them and not in their place."""

import numpy as np
import pytest
from builders import DRIVEN_MASS

from symhyb.correction.learning.orthogonal import named_forces
from symhyb.correction.learning.remainder import Remainder, remainder
from symhyb.correction.search.preparing import prepare
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.judge import judge
from symhyb.discrepancy.recorded.course import course_of
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.model.write import append_elements
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.integrate import simulate
from symhyb.numeric.runs.scenario import Scenario

NOISE = 2e-4  # m, of an amplitude of some 0.3 m
ON_LINES = DRIVEN_MASS.replace('f = { unit = "N"', 'f = { unit = "N", between = "line"')
TEXT = f"""{ON_LINES}[elements.found_spring]
kind = "spring"
on = "x"
cubic = "c"
found = {{ by = "sparse", from = "bench.csv", nrmse = [0.2, 0.01] }}
[elements.found_spring.parameters]
c = {{ value = 30.0, unit = "N/m^3", sd = 1.0 }}
"""
MORE = """[elements.more]
kind = "law"
on = "x"
force = "-a*x**2*x'"
[elements.more.parameters]
a = { value = 4.0, unit = "N*s/m^3" }
"""


@pytest.fixture(scope="module")
def model() -> Model:
    return parse_model(TEXT)


def recorded(truth: str, seed: int, size: float = 3.0) -> Recording:
    t = np.arange(0, 30, 0.03)
    rng = np.random.default_rng(seed)
    phases, lines = rng.uniform(0, 2 * np.pi, 12), np.linspace(0.2, 1.8, 12)
    f = size * np.mean(np.sin(2 * np.pi * lines * t[:, None] + phases), axis=1) * 2
    run = simulate(build(parse_model(truth)), Scenario(t, np.zeros(1), np.zeros(1), t, f[:, None]))
    x = run.q[:, 0] + NOISE * rng.standard_normal(t.size)
    return Recording(f"run{seed}", t, {"f": f}, {"laser": x}, (), str(seed))


@pytest.fixture(scope="module")
def found(model: Model) -> Remainder:
    left = remainder(model, recorded(TEXT + MORE, 1))
    assert left is not None
    return left


def test_it_takes_what_is_left_of_an_unseen_run(model: Model, found: Remainder) -> None:
    verdict = judge(model, found.model, recorded(TEXT + MORE, 2))
    assert verdict.holdout is not None
    before = verdict.holdout.before.free_run_rmse["laser"]
    after = verdict.holdout.after.free_run_rmse["laser"]
    assert before is not None
    assert after is not None
    assert before > 10 * NOISE
    assert after < before / 5  # what the named values could do is left to them
    assert found.degree == 3
    assert found.held[3] < 1.2 < found.held[0]


def test_the_named_laws_stay_as_they_are(model: Model, found: Remainder) -> None:
    assert found.model.text.startswith(model.text)
    named = {item.path: item.value for item in found.model.all_parameters()}
    assert all(named[item.path] == item.value for item in model.all_parameters())


def test_it_does_nothing_that_a_change_of_a_named_value_would_do(
    model: Model, found: Remainder
) -> None:
    run = prepare(model, recorded(TEXT + MORE, 1)).runs[0]
    machines = build(model), build(found.model)
    course, other = (course_of(run.recording, m, run.motion) for m in machines)
    force = discrepancy(machines[0], course, machines[0].values)
    force = force - discrepancy(machines[1], other, machines[1].values)
    laws = named_forces(machines[0], course)[:, 0]
    cosine = force[:, 0] @ laws / np.linalg.norm(force) / np.linalg.norm(laws, axis=0)
    assert laws.shape[1] == 2  # k, which states an sd, and the found cubic
    assert np.abs(cosine).max() < 1e-6


def test_beyond_the_training_it_holds_its_last_value(found: Remainder) -> None:
    machine = build(found.model)
    box = {p.name: p.value for p in found.element.parameters}

    def force(q: float) -> float:
        given = np.array([q]), np.zeros(1), np.empty(0), np.zeros(1), 0.0, machine.values
        linear = 25.0 * q + 30.0 * q**3
        return float(call(machine.k_e, given)[0].ravel()[0]) + linear

    assert force(3 * box["s_high"]) == pytest.approx(force(box["s_high"]), abs=1e-6)


def test_where_nothing_is_left_there_is_none(model: Model) -> None:
    assert remainder(model, recorded(TEXT, 3)) is None


def test_what_cannot_be_is_refused(model: Model, found: Remainder) -> None:
    with pytest.raises(InputError, match="'y' is no free coordinate; there are: x"):
        remainder(model, recorded(TEXT, 3), on="y")
    with pytest.raises(InputError, match="has a remainder already"):
        remainder(found.model, recorded(TEXT, 3))
    with pytest.raises(InputError, match="already an element 'remainder'"):
        append_elements(found.model, [found.element])
