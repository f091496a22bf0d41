"""What all recordings share is likelier in each: structures that some of them contradict."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.adequacy import judge
from symhyb.correction.adequacy.contradicted import contradicted, gains_of
from symhyb.correction.adequacy.judge import Adequacy, adequacy
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, fitted, tracks_of
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from symhyb.data.recording import Recording
from symhyb.discrepancy.likelihood.track import log_likelihood
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.judgement import CERTAIN
from symhyb.model.types import On
from tests.pushed import pushed, pushed_model, resisted, setting_of

SAMPLES = 500
DAMPER = Hypothesis("damper", On("x"), ("damping",), (True,))


@pytest.fixture(scope="module")
def both() -> tuple[Recorded, Fitted, Fitted]:
    """Three recordings, one of which is in two stretches, without and with the damper they lack."""
    runs = [pushed(i, samples=SAMPLES, damping=1.6, name=f"{i}.csv") for i in (31, 32, 33)]
    apart = np.where(np.arange(SAMPLES) < 200, 0.0, 1.0)
    runs[1] = replace(runs[1], t=runs[1].t + apart)
    ground = setting_of(pushed_model(), *runs)
    assert ground.recording == (0, 1, 1, 2)
    noise = ground.first_noise()
    without = fitted(ground, (), (), noise)
    return ground, without, fitted(ground, (DAMPER,), ({"damping": 0.5},), noise)


def test_gains_are_those_of_each_recording(both: tuple[Recorded, Fitted, Fitted]) -> None:
    ground, without, having = both
    wanted = np.zeros(3)
    for trial, sign in ((having, 1), (without, -1)):
        for which, one in zip(ground.recording, tracks_of(ground, trial), strict=True):
            wanted[which] += sign * log_likelihood(one, trial.fit.noise)
        assert sum(trial.fit.logls) == pytest.approx(trial.fit.logl, rel=1e-9)
    gains = gains_of(ground, having, without)
    np.testing.assert_allclose(gains, wanted, rtol=1e-6, atol=1e-3)
    assert (gains > CERTAIN).all()
    assert not contradicted(ground, having, without)
    assert contradicted(ground, without, having)


@pytest.mark.parametrize(
    ("gains", "against"),
    [
        ((300.0, 20.0, 0.0), False),
        ((300.0, 20.0, -4.0), False),  # less than 100 to 1
        ((300.0, 20.0, -10.0), False),  # less than a tenth of what the others say
        ((300.0, 20.0, -60.0), True),
        ((30.0, -20.0, -20.0), True),
        ((-60.0, -60.0, -60.0), True),
    ],
)
def test_a_recording_contradicts_by_a_hundred_to_one_and_a_tenth_of_the_others(
    both: tuple[Recorded, Fitted, Fitted], gains: Sequence[float], against: bool
) -> None:
    ground, base, _ = both
    logls = list(base.fit.logls)
    for i, gain in zip((0, 1, 3), gains, strict=True):
        logls[i] += gain
    trial = replace(base, fit=replace(base.fit, logls=tuple(logls)))
    assert contradicted(ground, trial, base) == against


def test_a_single_recording_does_not_contradict_itself() -> None:
    ground = setting_of(pushed_model(), pushed(34, samples=SAMPLES))
    base = fitted(ground, (), (), ground.first_noise())
    worse = replace(base, fit=replace(base.fit, logls=(base.fit.logls[0] - 100.0,)))
    assert not contradicted(ground, worse, base)


def judged(*runs: Recording) -> Adequacy:
    """The judgement of the model as it is."""
    prepared = prepare(pushed_model(), runs)
    setting = settle(prepared)
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, (), (), cuts, setting.sd)
    return adequacy(prepared, setting, final, (final, cuts))


@pytest.mark.slow
@pytest.mark.parametrize("same", [True, False])
def test_a_class_of_effects_that_differ_is_no_answer(
    same: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A stiffening spring, in the fourth recording as in the others or a quarter of it."""
    sizes = (60.0, 60.0, 60.0, 60.0 if same else 15.0)
    runs = [
        replace(resisted(40 + i, lambda x, _, k=size: k * x**3, SAMPLES), name=f"{i}.csv")
        for i, size in enumerate(sizes)
    ]
    found = judged(*runs)
    assert found.beyond.acts
    assert bool(found.classes) == same
    if not same:
        monkeypatch.setattr(judge, "contradicted", lambda *_: False)
        assert judged(*runs).classes
