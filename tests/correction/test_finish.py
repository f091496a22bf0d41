"""Last values, and free runs whose first samples set the initial state."""

import numpy as np
import pytest
from test_remainder import NOISE, TEXT, recorded

from symhyb.correction.finish import finished
from symhyb.discrepancy.fitting.initialised import initialised_run
from symhyb.errors import InputError
from symhyb.model.read import parse_model

OFF = TEXT.replace("value = 25.0", "value = 25.6").replace("value = 30.0", "value = 27.0")


def test_all_uncertain_numbers_come_back_and_certain_ones_stay() -> None:
    done = finished(parse_model(OFF), recorded(TEXT, 5))
    values = {item.path: item for item in done.model.all_parameters()}
    for path, truth in (("k", 25.0), ("found_spring.c", 30.0)):
        assert values[path].sd is not None
        assert abs(values[path].value - truth) < 4 * (values[path].sd or 0.0)
        assert values[path].value == pytest.approx(truth, rel=0.01)
    assert (values["m"].value, values["d"].value) == (1.0, 0.6)
    assert 0.8 < done.scale < 1.2


BEYOND = {
    "damper": ("damping", "N*s/m", "-0.2", 0.0),
    "gap": ("clearance", "m", "-0.05", 0.0),
}


@pytest.mark.parametrize("kind", BEYOND)
def test_the_last_fit_keeps_to_what_physics_allows(kind: str) -> None:
    """The truth lies beyond the bound of the key, so the fit ends at the bound."""
    key, unit, truth, bound = BEYOND[kind]
    rest = 'stiffness = "k"\nside = "upper"\n' if kind == "gap" else ""
    text = f"""{TEXT}[elements.found_{kind}]
kind = "{kind}"
on = "x"
{rest}{key} = "b"
found = {{ by = "sparse", from = "bench.csv", nrmse = [0.2, 0.01] }}
[elements.found_{kind}.parameters]
b = {{ value = NUMBER, unit = "{unit}", sd = 0.1 }}
"""
    recording = recorded(text.replace("NUMBER", truth), 5)
    done = finished(parse_model(text.replace("NUMBER", "0.05")), recording)
    values = {item.path: item.value for item in done.model.all_parameters()}
    assert values[f"found_{kind}.b"] == pytest.approx(bound, abs=1e-6)


def test_a_free_run_from_its_first_samples_leaves_the_noise() -> None:
    run = initialised_run(parse_model(TEXT), recorded(TEXT, 6))
    assert run.rmse()["laser"] == pytest.approx(NOISE, rel=0.15)
    assert run.rmse(500)["laser"] == pytest.approx(NOISE, rel=0.2)
    worse = initialised_run(parse_model(OFF), recorded(TEXT, 6))
    assert worse.rmse()["laser"] > 5 * NOISE
    assert np.isfinite(worse.error).all()


def test_the_first_samples_must_suffice() -> None:
    recording = recorded(TEXT, 6)
    for samples in (19, recording.t.size):
        with pytest.raises(InputError, match="needs 20 samples at least"):
            initialised_run(parse_model(TEXT), recording, samples)
