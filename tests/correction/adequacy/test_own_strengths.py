"""A cause with strengths of its own has to be likelier than an unknown force alone."""

from dataclasses import replace

import numpy as np
import pytest

from symhyb.correction.adequacy.followed import likeliest
from symhyb.correction.adequacy.judge import adequacy
from symhyb.correction.adequacy.own_strengths import by_recording, without_own
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from tests.pushed import markov, pushed, pushed_model, setting_of

SAMPLES = 600
OWN = Hypothesis("damper", On("x"), ("damping",), (True,), own=("damping",))


def recordings(damping: float) -> list:
    """Two with another unmeasured force each; the model has a damping of 0.6 N·s/m."""
    return [
        pushed(
            seed,
            samples=SAMPLES,
            damping=damping,
            beside=markov(np.random.default_rng(seed), SAMPLES, 0.5, 0.2),
            name=f"{seed}.csv",
        )
        for seed in (3, 4)
    ]


@pytest.mark.parametrize(("damping", "acts"), [(0.6, False), (2.6, True)])
def test_what_an_unknown_force_explains_has_no_strengths_of_its_own(damping, acts) -> None:
    ground = setting_of(pushed_model(), *recordings(damping), own=("damping",))
    base = likeliest(ground, [OWN], [{"damping": 0.5}])
    (rest,) = without_own(ground, base, [{"damping": 0.5}])
    assert rest.causes == ()
    assert len(base.owned) == 2
    assert (base.evidence > rest.evidence) == acts


def test_only_strengths_count() -> None:
    assert by_recording(OWN)
    assert not by_recording(replace(OWN, own=()))
    tone = Hypothesis("harmonic", On("x"), ("sine", "cosine"), (False, False), own=("phase",))
    assert not by_recording(tone)


def test_such_a_cause_is_in_doubt_where_an_unknown_force_acts_and_explains_it() -> None:
    runs = recordings(0.6)
    prepared = prepare(pushed_model(), runs, own=("damping",))
    setting = settle(prepared, ("damping",))
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, [OWN], [{"damping": 0.5}], cuts, setting.sd)
    found = adequacy(prepared, setting, final, (final, cuts))
    assert found.beyond.acts
    assert OWN in found.doubt
