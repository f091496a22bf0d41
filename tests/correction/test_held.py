"""What the uncertainty of a held parameter leaves open of the values that were fitted beside it."""

import numpy as np
import pytest

from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.trajectory import refine
from symhyb.correction.verdict.held import with_what_is_held
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On

MODEL = """
symhyb = 1
[coordinates]
x = {{ unit = "m", start = 0.0 }}
[parameters]
m = {{ value = 2.0, unit = "kg"{sd} }}
[bodies.slide]
mass = "m"
at = ["x", "0"]
[sensors]
tape = {{ measures = "x", unit = "m", sd = 1e-4 }}
"""
PUSH = Hypothesis("constant", On("x"), ("constant",), (False,))


def slide(sd: str) -> Model:
    return parse_model(MODEL.format(sd=sd), "slide.toml")


def pushed() -> Recording:
    """A constant 3 N on 2 kg from rest: the recording knows their ratio alone."""
    t = np.arange(0, 2, 0.01)
    x = 0.75 * t**2 + 1e-4 * np.random.default_rng(1).standard_normal(t.size)
    return Recording("push.csv", t, {}, {"tape": x}, (), "")


@pytest.mark.parametrize(("sd", "relative"), [(", sd = 0.2", 0.1), ("", None)])
def test_the_force_on_an_uncertain_mass_is_no_better_known_than_the_mass(
    sd: str, relative: float | None
) -> None:
    model = slide(sd)
    prepared = prepare(model, pushed())
    setting = settle(prepared)
    stage = setting.stages[-1]
    final = refine(
        prepared.model, (PUSH,), [{"constant": 2.5}], stage.cuts, setting.sd, everything=True
    )
    value, narrow = final.value("cause0.constant")
    wide = with_what_is_held(prepared.model, setting, final, stage)
    assert value == pytest.approx(3.0, rel=0.01)
    assert wide.value("cause0.constant")[0] == value
    if relative is None:
        assert wide is final
    else:
        assert narrow < 0.01 * value
        assert wide.value("cause0.constant")[1] == pytest.approx(relative * value, rel=0.05)
