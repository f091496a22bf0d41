"""How much of what acts beyond a structure another one explains, as modelled and as shown."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.adequacy.beyond import beyond
from symhyb.correction.adequacy.explained import decided, forces_left, remainder
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted
from symhyb.judgement import MOST
from tests.pushed import NOISE, markov, pushed, pushed_model, setting_of

SAMPLES = 800


@pytest.fixture(scope="module")
def beside_force() -> tuple[Recorded, Fitted]:
    """The model beside an unmeasured force of 0.8 N."""
    planted = markov(np.random.default_rng(51), SAMPLES, 0.8, 0.2)
    ground = setting_of(pushed_model(), pushed(51, samples=SAMPLES, beside=planted))
    return ground, fitted(ground, (), (), ground.first_noise(slow=True))


def left_as(trial: Fitted, modelled: float, shown: float) -> Fitted:
    """The same with other shares of its unknown force: as modelled, and as the sensors show it."""
    fit = trial.fit
    noise = replace(fit.noise, force=modelled * fit.noise.force)
    return replace(trial, fit=replace(fit, noise=noise, force=shown * fit.force))


def test_what_is_left_is_the_power_of_the_force_as_modelled_and_as_shown(
    beside_force: tuple[Recorded, Fitted],
) -> None:
    ground, base = beside_force
    modelled, shown = remainder(ground, base)
    assert np.sqrt(modelled) * ground.scale[0] == pytest.approx(0.8, rel=0.2)
    assert np.sqrt(shown) == pytest.approx(beyond(ground, base).share[0], rel=1e-3)
    assert shown < modelled
    assert forces_left(ground, base) == pytest.approx(modelled, rel=1e-6)


def test_what_is_left_of_a_sensor_is_its_colour() -> None:
    made = pushed(52, samples=SAMPLES, colour=(5 * NOISE, 0.1))
    ground = setting_of(pushed_model(), made)
    noise = replace(ground.first_noise(), force=np.zeros(1))
    modelled, shown = remainder(ground, fitted(ground, (), (), noise))
    size = 5 * NOISE / ground.shown[0]
    assert np.sqrt(modelled) == pytest.approx(size, rel=0.2)
    assert np.sqrt(shown) == pytest.approx(size, rel=0.2)
    assert shown < modelled


@pytest.mark.parametrize(
    ("modelled", "shown", "explains"),
    [(0.6, 0.6, True), (0.6, 0.9, False), (0.9, 0.6, False), (0.6, 1.2, False)],
)
def test_a_structure_explains_what_it_takes_by_both(
    beside_force: tuple[Recorded, Fitted], modelled: float, shown: float, explains: bool
) -> None:
    """A force without memory that gives way to a slow one of 60 % of its size, of which sensors
    show 120 % of what they did, is explained by nothing."""
    ground, base = beside_force
    trial = left_as(base, modelled, shown)
    assert decided(ground, base, acts=True).explained_by(ground, trial, MOST) == explains


def test_a_fit_that_failed_explains_nothing(beside_force: tuple[Recorded, Fitted]) -> None:
    ground, base = beside_force
    failed = replace(base, fit=replace(base.fit, reason="diverged"))
    assert not decided(ground, base, acts=True).explained_by(ground, failed, 1.0)
