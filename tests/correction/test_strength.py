"""Forces of a fitted structure along a recording."""

import numpy as np
import pytest

from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.strength import changed_force
from symhyb.correction.search.trajectory import refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.numeric.lowered.machine import build
from tests.builders import DRIVEN_MASS
from tests.pushed import STIFFNESS, pushed, pushed_model

TEXT = DRIVEN_MASS.replace("sd = 0.5", "sd = 10.0")
NUMBER = Hypothesis("parameter", None, ("value",), (False,), path="k")


def test_a_softer_spring_than_stated_pulls_less() -> None:
    model, made = pushed_model(TEXT), pushed(3, stiffness=STIFFNESS - 5)
    prepared = prepare(model, made)
    setting = settle(prepared)
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, [NUMBER], [{"value": STIFFNESS - 5}], cuts, setting.sd)
    motion = motion_of(made, build(model))
    fitted = float(final.fit.values[0])
    assert fitted == pytest.approx(STIFFNESS - 5, rel=0.02)
    force = changed_force(final, "k", made, motion)
    np.testing.assert_allclose(force, (fitted - STIFFNESS) * motion.q, atol=1e-9)
    assert not changed_force(final, "f.gain", made, motion).any()
