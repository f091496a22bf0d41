"""How far a corrected free run may be off: against the step response of a damped oscillator."""

from dataclasses import replace

import numpy as np
import pytest
from builders import DRIVEN_MASS, recording
from numpy.typing import NDArray

from symhyb.discrepancy.evidence import Correlations
from symhyb.discrepancy.fitting.bands import _less, bands_of, without_each
from symhyb.discrepancy.fitting.judge import _runs, judge
from symhyb.discrepancy.fitting.scores import errors
from symhyb.model.expression import parse_expression
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build

M, K, D, FORCE, SD = 1.0, 25.0, 0.6, 2.0, 0.1
FOUND = f"""
[elements.found_constant]
kind = "constant"
on = "x"
constant = "F_0"
[elements.found_constant.parameters]
F_0 = {{ value = {FORCE}, sd = {SD}, unit = "N" }}
"""
KNOWN = Correlations(("found_constant.F_0",), np.eye(1))
T = np.arange(0.0, 6.0, 0.01)


def response(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """The deflection of the mass from rest under a force of 1 N."""
    omega, decay = np.sqrt(K / M), D / 2 / M
    damped = np.sqrt(omega**2 - decay**2)
    swing = np.cos(damped * t) + decay / damped * np.sin(damped * t)
    return np.asarray((1 - np.exp(-decay * t) * swing) / K)


def pushed():
    noise = 1e-4 * np.random.default_rng(0).normal(size=T.size)
    return recording(T, {"f": np.zeros(T.size)}, laser=FORCE * response(T) + noise)


def test_the_band_is_the_response_to_what_the_force_may_be_off() -> None:
    model, corrected = (
        parse_model(DRIVEN_MASS, "m.toml"),
        parse_model(DRIVEN_MASS + FOUND, "m.toml"),
    )
    runs = _runs(build(model), [pushed()])
    found = errors(build(corrected), runs, 0.5, None)
    (band,) = bands_of(build(corrected), runs, found, KNOWN)
    assert band is not None
    np.testing.assert_allclose(band[:, 0], SD * np.abs(response(T)), atol=2e-5)
    assert bands_of(build(corrected), runs, found, None) == (None,)
    (less,) = without_each(model, corrected, runs, found.scenarios)
    assert less.element == "found_constant"
    error = less.free_run_rmse["laser"]
    assert error is not None
    assert 0.1 * FORCE / K < error < 1.5 * FORCE / K
    assert without_each(model, model, runs, found.scenarios) == ()
    element = corrected.elements[-1]
    held = replace(element, values=(("constant", parse_expression(FORCE)),), parameters=())
    rebuilt = _less(build(replace(corrected, elements=(*model.elements, held))), held)
    assert [one.name for one in rebuilt.model.elements] == [one.name for one in model.elements]


def test_a_verdict_has_bands_errors_without_and_whether_the_rest_is_noise() -> None:
    model, corrected = (
        parse_model(DRIVEN_MASS, "m.toml"),
        parse_model(DRIVEN_MASS + FOUND, "m.toml"),
    )
    verdict = judge(model, corrected, train=[pushed()], correlations=KNOWN)
    (trace,) = verdict.traces
    assert trace.band["laser"].max() == pytest.approx(SD * response(T).max(), rel=0.01)
    (white,) = verdict.whiteness
    assert white.noise()
    after = verdict.train.after.free_run_rmse["laser"]
    assert after is not None
    assert after < 2e-4
    assert (verdict.without[0].free_run_rmse["laser"] or 0.0) > 20 * after
    alone = judge(model, model, train=[pushed()])
    assert (alone.without, alone.traces[0].band) == ((), {})
    assert not alone.whiteness[0].noise()  # the force that is missing


def test_a_trace_has_the_measured_motion_and_that_of_the_model_as_given() -> None:
    model, corrected = (
        parse_model(DRIVEN_MASS, "m.toml"),
        parse_model(DRIVEN_MASS + FOUND, "m.toml"),
    )
    (trace,) = judge(model, corrected, pushed()).traces
    assert trace.motion["x"] == pytest.approx(FORCE * response(T), abs=1e-3)
    assert trace.motion_before["x"] == pytest.approx(trace.before["laser"])
