"""Numbers, trajectory and noise fitted together: planted values come back, with honest spreads."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lsim

import symhyb.discrepancy.likelihood.fit as likelihood_fit
from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.fit import FAILED, Fit, Task, fit
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.windows import WindowModel
from tests.builders import DRIVEN_MASS
from tests.pushed import (
    DAMPING,
    NOISE,
    STEP,
    STIFFNESS,
    lowered,
    markov,
    pushed,
    pushed_model,
    pushing,
    task_of,
)

MACHINE = lowered()
BEGIN = NoiseModel(np.array([0.4]), 0.4, np.array([NOISE]), np.array([0.5 * NOISE]), 0.4)
QUIET = BEGIN.without_force().without_colour()


def fitted(
    machine: Machine, task: Task, *paths: str, noise: NoiseModel = BEGIN, known: bool = False
) -> Fit:
    """The numbers at ``paths`` fitted from what the model states."""
    free = tuple(machine.column(path) for path in paths)
    return fit(WindowModel(machine, free), task, machine.values, noise, known_noise=known)


def off(found: Fit, truth: list[float]) -> np.ndarray:
    """Errors (F,) in standard deviations."""
    return (found.values - truth) / np.sqrt(np.diag(found.covariance))


def test_a_planted_damping_is_found() -> None:
    recording = pushed(1, damping=1.4)
    found = fitted(MACHINE, task_of(MACHINE, recording, count=2), "d", "k")
    assert found.reason == ""
    assert np.abs(off(found, [1.4, STIFFNESS])).max() < 3
    assert abs(found.values[0] - DAMPING) > 20 * np.sqrt(found.covariance[0, 0])
    assert found.noise.force[0] == 0
    assert found.noise.white[0] == pytest.approx(NOISE, rel=0.1)
    assert found.count == recording.t.size


def test_spreads_are_those_of_the_errors() -> None:
    """Of 20 z-values the standard deviation lies between 0.6 and 1.5 in 99 % of all cases."""
    errors = []
    for seed in range(20):
        task = task_of(MACHINE, pushed(seed, samples=300), count=2)
        errors.append(off(fitted(MACHINE, task, "d", "k", noise=QUIET), [DAMPING, STIFFNESS]))
    spread = np.std(errors, axis=0)
    assert np.all((spread > 0.6) & (spread < 1.5))
    assert np.all(np.abs(np.mean(errors, axis=0)) < 3 / np.sqrt(20))


def test_spreads_under_an_unknown_force_are_those_of_the_errors() -> None:
    errors, alone = [], []
    for seed in range(12):
        beside = markov(np.random.default_rng(500 + seed), 600, 0.7, 0.3)
        task = task_of(MACHINE, pushed(seed, beside=beside), count=2)
        errors.append(off(fitted(MACHINE, task, "d", "k"), [DAMPING, STIFFNESS]))
        alone.append(off(fitted(MACHINE, task, "d", "k", noise=QUIET), [DAMPING, STIFFNESS]))
    assert 0.5 < np.std(errors) < 1.5
    assert np.std(alone) > 2  # what takes the force for noise of the sensor is far too sure


def test_the_covariance_is_that_of_the_information() -> None:
    found = fitted(MACHINE, task_of(MACHINE, pushed(3), count=2), "d", "k")
    np.testing.assert_allclose(found.covariance @ found.information, np.eye(2), atol=1e-8)


def test_a_prior_draws_by_its_weight() -> None:
    """A Gaussian posterior is the mean of data and prior, each with its information."""
    task = task_of(MACHINE, pushed(4), count=1)
    free = fitted(MACHINE, task, "d", noise=QUIET, known=True)
    spread = float(np.sqrt(free.covariance[0, 0]))
    mean = free.values[0] + 10 * spread
    drawn = replace(task, mean=np.array([mean]), spread=np.array([spread]))
    found = fitted(MACHINE, drawn, "d", noise=QUIET, known=True)
    assert found.values[0] == pytest.approx(free.values[0] + 5 * spread, abs=0.2 * spread)
    assert found.covariance[0, 0] == pytest.approx(spread**2 / 2, rel=0.05)
    assert found.prior == pytest.approx(((found.values[0] - mean) / spread) ** 2)
    assert found.logl < free.logl


def test_bounds_are_kept() -> None:
    task = task_of(MACHINE, pushed(5), count=2)
    held = replace(task, lower=np.array([0.9, -np.inf]), upper=np.array([2.0, np.inf]))
    found = fitted(MACHINE, held, "d", "k")
    assert found.values[0] == pytest.approx(0.9)
    assert found.values[1] == pytest.approx(STIFFNESS, rel=0.05)


def test_a_known_noise_is_not_fitted() -> None:
    task = task_of(MACHINE, pushed(6), count=1)
    given = replace(QUIET, white=np.array([3 * NOISE]))
    found = fitted(MACHINE, task, "d", noise=given, known=True)
    assert found.noise is given
    free = fitted(MACHINE, task, "d", noise=given)
    assert free.noise.white[0] == pytest.approx(NOISE, rel=0.1)
    assert free.logl > found.logl


def test_two_recordings_with_a_value_of_their_own_each() -> None:
    made = pushed(7, damping=0.6, name="a.csv"), pushed(8, damping=1.2, name="b.csv")
    shared = task_of(MACHINE, *made, count=3, own=((0, 1), (2, 1)))
    free = tuple(MACHINE.column(path) for path in ("d", "k"))
    first = np.array([DAMPING, STIFFNESS, DAMPING])
    found = fit(WindowModel(MACHINE, free), shared, MACHINE.values, BEGIN, first)
    assert np.abs(off(found, [0.6, STIFFNESS, 1.2])).max() < 3.5
    one = fitted(MACHINE, task_of(MACHINE, *made, count=2), "d", "k")
    assert found.logl > one.logl + 50
    for which, damping in enumerate((0.6, 1.2)):
        p = shared.filled(which, MACHINE.values, free, found.values)
        assert p[free[0]] == pytest.approx(damping, rel=0.1)


def test_recordings_together_know_more_than_each() -> None:
    made = [pushed(seed) for seed in (9, 10)]
    each = [fitted(MACHINE, task_of(MACHINE, one, count=1), "d", noise=QUIET) for one in made]
    both = fitted(MACHINE, task_of(MACHINE, *made, count=1), "d", noise=QUIET)
    information = sum(one.information[0, 0] for one in each)
    assert both.information[0, 0] == pytest.approx(information, rel=0.1)


def test_a_machine_that_falls_over_alone_is_fitted_under_its_controller() -> None:
    """Its stiffness is negative: a run of 12 s would grow by 25 decades."""
    random = np.random.default_rng(11)
    text = DRIVEN_MASS.replace("value = 25.0", "value = -20.0")
    machine = lowered(pushed_model(text))
    t = STEP * np.arange(600)
    reference = pushing(random, t)
    held, lead = 60.0, 9.0
    _, _, states = lsim(
        ([[0, 1], [25.0 - held, -0.6 - lead]], [[0], [1]], np.eye(2), np.zeros((2, 1))),
        reference,
        t,
    )
    x, v = states.T
    force = reference - held * x - lead * v
    seen = x + NOISE * random.standard_normal(t.size)
    recording = Recording("held.csv", t, {"f": force}, {"laser": seen}, (), "")
    found = fitted(machine, task_of(machine, recording, count=2), "d", "k")
    assert found.reason == ""
    assert np.abs(off(found, [0.6, -25.0])).max() < 3.5
    assert abs(found.values[1] + 20.0) > 5 * np.sqrt(found.covariance[1, 1])
    assert np.abs(found.states[0][:, 0] - x).max() < 6 * NOISE


def test_a_fit_that_cannot_be_finite_states_its_reason() -> None:
    text = DRIVEN_MASS.replace('force = "f"', 'force = "f*sqrt(1 - 100*x/xs)"')
    text = text.replace("[inputs]", 'xs = { value = 1.0, unit = "m" }\n[inputs]')
    machine = lowered(pushed_model(text))
    found = fitted(machine, task_of(machine, pushed(12, samples=100), count=1), "d")
    assert found.reason == FAILED
    assert found.logl == -np.inf
    assert found.values == pytest.approx([DAMPING])
    assert np.all(np.isinf(found.covariance))


def test_a_fit_begins_with_the_likelier_of_several_noises(monkeypatch: pytest.MonkeyPatch) -> None:
    beside = markov(np.random.default_rng(7), 600, 0.7, 30 * STEP)
    task = task_of(MACHINE, pushed(5, beside=beside), count=1)
    brief = NoiseModel(BEGIN.force, 0.5 * STEP, BEGIN.white, BEGIN.colour, BEGIN.colour_s)
    slow = replace(brief, memory_s=30 * STEP)
    model, p = WindowModel(MACHINE, (MACHINE.column("d"),)), MACHINE.values
    either = fit(model, task, p, brief, others=[slow])
    assert fit(model, task, p, slow, others=[brief]).logl == pytest.approx(either.logl, abs=1e-6)
    monkeypatch.setattr(likelihood_fit, "ITERATIONS", 0)
    begun = fit(model, task, p, brief, others=[slow])
    assert begun.noise.memory_s == slow.memory_s
    assert begun.logl > fit(model, task, p, brief).logl
