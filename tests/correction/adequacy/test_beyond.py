"""What acts beyond the causes: a planted force that was not recorded, and nothing where none is."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.adequacy.beyond import Beyond, beyond
from symhyb.correction.adequacy.classes.law import law
from symhyb.correction.adequacy.classes.worth import around
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.discrepancy.likelihood.fit import FAILED
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import CERTAIN, NEGLIGIBLE
from symhyb.model.types import On
from tests.pushed import NOISE, markov, pushed, pushed_model, setting_of

SAMPLES = 1500


def unexplained(setting: Recorded) -> Fitted:
    """The model as it is, fitted."""
    return fitted(setting, (), (), setting.first_noise())


@pytest.mark.parametrize(("seed", "rms", "memory_s"), [(1, 1.0, 0.2), (2, 0.4, 0.3), (3, 2.0, 0.1)])
def test_an_unmeasured_force_acts_with_its_size(seed: int, rms: float, memory_s: float) -> None:
    planted = markov(np.random.default_rng(seed), SAMPLES, rms, memory_s)
    setting = setting_of(pushed_model(), pushed(seed, samples=SAMPLES, beside=planted))
    found = beyond(setting, unexplained(setting))
    assert found.acts
    assert found.evidence > 100
    assert found.force[0] == pytest.approx(float(np.sqrt(np.mean(planted**2))), rel=0.2)
    assert found.share[0] == pytest.approx(found.force[0] / setting.scale[0])
    assert memory_s / 2.5 < found.memory_s < memory_s * 2.5


@pytest.mark.parametrize("seed", [4, 5, 6])
def test_nothing_acts_where_nothing_was_planted(seed: int) -> None:
    setting = setting_of(pushed_model(), pushed(seed, samples=SAMPLES))
    found = beyond(setting, unexplained(setting))
    assert not found.acts
    assert found.share[0] < NEGLIGIBLE


def test_a_coloured_sensor_is_no_force() -> None:
    recording = pushed(7, samples=SAMPLES, colour=(5 * NOISE, 0.05))
    setting = setting_of(pushed_model(), recording)
    assert not beyond(setting, unexplained(setting)).acts


def test_a_cause_that_explains_the_force_leaves_none() -> None:
    recording = pushed(8, samples=SAMPLES, damping=1.6)
    setting = setting_of(pushed_model(), recording)
    assert beyond(setting, unexplained(setting)).acts
    cause = Hypothesis("damper", On("x"), ("damping",), (True,))
    named = fitted(setting, (cause,), ({"damping": 0.5},), setting.first_noise())
    assert not beyond(setting, named).acts


def test_what_a_class_takes_counts_as_not_explained() -> None:
    """A class stands beside the causes: its force is none that a cause explains."""
    recording = pushed(9, samples=SAMPLES, damping=2.6)
    setting = setting_of(pushed_model(), recording)
    base = unexplained(setting)
    curve = law(around(setting, base), 0)
    found = fitted(setting, (), (), setting.revived(base.fit.noise), base.fit.states, extra=curve)
    (item,) = setting.items
    speed = item.course(setting.windows.machine).v[:, 0]
    expected = 2.0 * float(np.sqrt(np.mean(speed**2)))
    assert beyond(setting, found).force[0] == pytest.approx(expected, rel=0.2)


def test_a_fit_that_failed_tells_of_no_force() -> None:
    planted = markov(np.random.default_rng(1), 600, 1.0, 0.2)
    setting = setting_of(pushed_model(), pushed(1, beside=planted))
    one = unexplained(setting)
    assert beyond(setting, one).acts
    failed = beyond(setting, replace(one, fit=replace(one.fit, reason=FAILED)))
    assert not failed.acts
    assert failed.evidence == 0


def test_a_force_acts_if_it_is_certain_and_large_enough() -> None:
    def reported(share: float, evidence: float) -> Beyond:
        return Beyond(np.array([1.0]), np.array([share]), 0.1, evidence)

    assert reported(0.1, CERTAIN + 0.1).acts
    assert not reported(0.1, CERTAIN - 0.1).acts
    assert not reported(1e-4, 1e3).acts
    assert reported(0.1, CERTAIN).probability == pytest.approx(1 / (1 + np.exp(-CERTAIN)))
    assert reported(0.1, 1e6).probability == 1.0


def test_numbers_of_each_recording_leave_the_force_that_acts_beyond_them() -> None:
    """A damping of its own in each recording, and the same force pushes unseen in both."""
    planted = markov(np.random.default_rng(2), SAMPLES, 1.0, 0.2)
    recordings = [
        pushed(seed, samples=SAMPLES, damping=damping, beside=planted, name=f"{seed}.csv")
        for seed, damping in ((10, 1.6), (11, 2.6))
    ]
    setting = setting_of(pushed_model(), *recordings, own=("damping",))
    cause = Hypothesis("damper", On("x"), ("damping",), (True,), own=("damping",))
    found = fitted(setting, (cause,), ({"damping": 1.0},), setting.first_noise())
    assert found.numbers > len(found.paths)
    assert beyond(setting, found).force[0] == pytest.approx(1.0, rel=0.2)


@pytest.mark.parametrize("keeps", [0.0, 0.3, 0.95])
def test_the_part_below_a_frequency_is_that_of_its_spectrum(keeps: float) -> None:
    memory = -1e-3 / np.log(keeps) if keeps else 1e-9
    force = Beyond(np.array([2.0]), np.array([0.5]), memory, 10.0)
    turns = np.linspace(0, np.pi, 200_001)  # rad per sample
    power = 1 / (1 - 2 * keeps * np.cos(turns) + keeps**2)
    for frequency in (5.0, 120.0):
        inside = turns <= 2 * np.pi * frequency * 1e-3
        share = np.sqrt(power[inside].sum() / power.sum())
        left = force.below(frequency, 1e-3)
        assert left.force[0] == pytest.approx(2.0 * share, rel=1e-3)
        assert left.share[0] == pytest.approx(0.5 * share, rel=1e-3)
    assert force.below(1e4, 1e-3).force[0] == pytest.approx(2.0)
