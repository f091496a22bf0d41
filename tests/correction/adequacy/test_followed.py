"""Dry friction along whole recordings, from the trajectories of windows."""

import numpy as np
import pytest

from symhyb.correction.adequacy.followed import followed
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from tests.pushed import DAMPING, STEP, STIFFNESS, pushed_model, pushing, setting_of

FRICTION = Hypothesis("friction", On("x"), ("coulomb",), (True,), shape=(("transition", 1e-3),))
COULOMB, FINE, SAMPLES = 1.5, 40, 1000


def rubbing(seed: int, unseen: float) -> Recording:
    """A sensor that is almost exact; white noise of ``unseen`` N acts beside the recorded push."""
    random = np.random.default_rng(seed)
    t = STEP * np.arange(SAMPLES)
    force = pushing(random, t)
    total = force + unseen * random.standard_normal(SAMPLES)
    fine, h = STEP / FINE * np.arange(SAMPLES * FINE), STEP / FINE
    push = np.interp(fine, t, total)
    x, v, seen = 0.0, 0.0, []
    for i, f in enumerate(push):
        if i % FINE == 0:
            seen.append(x)
        v += h * (f - DAMPING * v - STIFFNESS * x)
        v = np.sign(v) * max(abs(v) - h * COULOMB, 0.0)  # implicit: it sticks where it may
        x += h * v
    noise = 1e-6 * random.standard_normal(SAMPLES)
    return Recording("rubbing.csv", t, {"f": force}, {"laser": np.array(seen) + noise}, (), "")


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_friction_beside_noise_of_the_force_is_the_same_from_wherever_it_begins(seed: int) -> None:
    recording = rubbing(seed, 0.2)
    prepared = prepare(pushed_model(), recording)
    setting, ground = settle(prepared), setting_of(pushed_model(), recording)
    cuts, found = setting.stages[-1].cuts, []
    for coulomb in (COULOMB, 1.4 * COULOMB):
        final = refine(prepared.model, [FRICTION], [{"coulomb": coulomb}], cuts, setting.sd)
        found.append(followed(ground, final, (final, cuts)))
    assert found[0].evidence == pytest.approx(found[1].evidence, abs=2.0)
    for one in found:
        assert one.fit.values[0] == pytest.approx(COULOMB, rel=0.03)
        assert one.fit.noise.force[0] == pytest.approx(0.2, rel=0.15)
