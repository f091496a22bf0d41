"""What effects are worth: a mass pushed by a constant force against a damper."""

import numpy as np
import pytest

from symhyb.correction.naming.findings import named
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.strength import element_forces
from symhyb.correction.search.trajectory import refine
from symhyb.correction.verdict.worth import correlation_matrix, law_spread, worth_of
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.read import parse_model
from symhyb.model.types import On

MODEL = """
symhyb = 1
[coordinates]
x = { unit = "m", start = 0.0 }
[parameters]
m = { value = 2.0, unit = "kg" }
[bodies.slide]
mass = "m"
at = ["x", "0"]
[sensors]
tape = { measures = "x", unit = "m", sd = 1e-4 }
"""
PUSH = Hypothesis("constant", On("x"), ("constant",), (False,))
DAMPER = Hypothesis("damper", On("x"), ("damping",), (False,))
M, C, F = 2.0, 1.5, 3.0


def test_worth_correlation_and_spread_of_two_effects() -> None:
    t = np.arange(0, 4, 0.01)
    x = F / C * (t - M / C * (1 - np.exp(-C / M * t)))
    noise = 1e-4 * np.random.default_rng(1).standard_normal(t.size)
    model = parse_model(MODEL, "slide.toml")
    prepared = prepare(model, Recording("push.csv", t, {}, {"tape": x + noise}, (), ""))
    setting = settle(prepared)
    causes, start = (PUSH, DAMPER), [{"constant": 2.5}, {"damping": 1.0}]
    cuts = setting.stages[-1].cuts
    final = refine(prepared.model, causes, start, cuts, setting.sd, everything=True, careful=True)
    items = named(final)
    by_kind = dict(zip([i.kind for i in items], worth_of(final, items, prepared.runs), strict=True))
    assert by_kind["constant"].energy is None  # it drives
    assert by_kind["constant"].force == pytest.approx(1.0)
    assert by_kind["damper"].energy == pytest.approx(1.0)
    fastest = F / C * (1 - np.exp(-C / M * t[-1]))
    assert by_kind["damper"].force == pytest.approx(C * fastest / F, rel=0.02)

    matrix = correlation_matrix(final)
    np.testing.assert_allclose(np.diag(matrix), 1.0)
    assert 0.5 < matrix[0, 1] < 1.0  # a larger push against a larger damper

    run = prepared.runs[0]
    law = element_forces(final, run.recording, run.motion)[0].sum(axis=2)
    spread = law_spread(final, run, 0, law)
    assert spread is not None
    push, damping = (final.value(path)[1] for path in final.paths)
    speed = np.abs(prepared.runs[0].motion.v[:, 0])
    rho = matrix[0, 1]
    wanted = np.sqrt(push**2 + (damping * speed) ** 2 - 2 * rho * push * damping * speed)
    np.testing.assert_allclose(spread[:, 0], wanted, rtol=0.02, atol=0.02 * push)


def test_what_is_stored_at_the_end_is_not_dissipated() -> None:
    """A spring is stretched by a quarter of its period, and not let go."""
    rate = 2.0  # rad/s
    t = np.arange(0, np.pi / 2 / rate, 0.002)
    model = parse_model(MODEL, "slide.toml")
    noise = 1e-4 * np.random.default_rng(2).standard_normal(t.size)
    prepared = prepare(model, Recording("swing.csv", t, {}, {"tape": np.sin(rate * t) + noise}))
    setting = settle(prepared)
    spring = Hypothesis("spring", On("x"), ("stiffness",), (False,))
    cuts, start = setting.stages[-1].cuts, [{"stiffness": 7.0}]
    final = refine(prepared.model, (spring,), start, cuts, setting.sd, everything=True)
    assert final.fit.values[0] == pytest.approx(M * rate**2, rel=0.02)
    (worth,) = worth_of(final, named(final), prepared.runs)
    assert worth.energy is None
    assert worth.force == pytest.approx(1.0)
