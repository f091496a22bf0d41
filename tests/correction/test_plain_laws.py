"""Plain laws whose twin is a parameter of the model."""

import numpy as np
from builders import model_of, recording, spring

from symhyb.correction.search.conventions import exact_twins
from symhyb.correction.search.moves import _plain_at
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.setting import along_motion
from symhyb.correction.search.trials import Trials
from symhyb.data.recording import Recording
from symhyb.model.types import Model, On


def swing(sd: float | None = None) -> Model:
    k = (6.0, "N/m") if sd is None else (6.0, "N/m", sd)
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": k},
        energy={"kinetic": "m*x'**2/2"},
        elements={"spring": spring("k")},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


def decaying(samples: int, seed: int = 0) -> Recording:
    t = 0.05 * np.arange(samples)
    noise = 1e-3 * np.random.default_rng(seed).standard_normal(samples)
    return recording(t, place=np.exp(-0.03 * t) * np.cos(2.45 * t) + noise)


def test_a_stiffness_that_may_be_estimated_stands_for_the_spring_at_its_place() -> None:
    setting = settle(prepare(swing(sd=0.3), decaying(400)))
    twins = exact_twins(along_motion(setting, setting.stages[0]))
    trials = Trials(setting, set(), lambda line: None, twins)
    plain = [setting.hypotheses[i] for i in _plain_at(trials, On("x"))]
    assert "k" in [cause.path for cause in plain if cause.place is None]
    assert not [c for c in plain if c.kind == "spring" and "stiffness" in c.terms]
    assert {"damper", "drag", "friction"} <= {cause.kind for cause in plain}
