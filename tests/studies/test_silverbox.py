"""The figures of the Silverbox benchmark, from the named laws on: what values and remainder reach.

The diagnosis itself is tested with the other studies; here its structure is written down.
"""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from symhyb.correction.finish import finished
from symhyb.correction.learning.remainder import remainder
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Model

FOLDER = Path(__file__).parents[2] / "studies" / "silverbox"
NAMED = """
[elements.found_spring]
kind = "spring"
on = "y"
cubic = "k3"
found = { by = "sparse", from = "training", nrmse = [0.1, 0.01] }
[elements.found_spring.parameters]
k3 = { value = 3.0, unit = "1/V^2", sd = 1.0 }
[elements.found_constant]
kind = "constant"
on = "y"
constant = "c"
found = { by = "sparse", from = "training", nrmse = [0.1, 0.01] }
[elements.found_constant.parameters]
c = { value = -0.004, unit = "V", sd = 0.001 }
"""


@pytest.fixture(scope="module")
def study() -> ModuleType:
    spec = importlib.util.spec_from_file_location("silverbox_scores", FOLDER / "scores.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def named(study: ModuleType, public_file: Callable[..., Path]) -> Model:
    """The cubic spring and the constant with their last values, from the training part."""
    public_file("silverbox", "SNLS80mV.csv")
    known = read_model(FOLDER.parent.parent / "models" / "silverbox.toml")
    model = parse_model(known.text + NAMED, known.file)
    return finished(model, study.part(model, study.TRAIN)).model


@pytest.mark.slow
def test_two_named_terms_leave_a_third_of_a_millivolt(study: ModuleType, named: Model) -> None:
    values = {item.path: item.value for item in named.all_parameters()}
    assert values["found_spring.k3"] == pytest.approx(3.915, rel=0.005)  # of another program
    assert values["found_constant.c"] == pytest.approx(-5.345e-3, rel=0.005)
    got = study.scores(named)
    # 0.367 / 0.462 / 0.363 mV: trajectory matching of the cubic alone, when this was planned
    assert got["multisine"] < 0.367
    assert got["arrow"] < 0.462
    assert got["arrow without extrapolation"] < 0.363


@pytest.mark.slow
def test_with_a_smooth_remainder_it_is_better_than_published(
    study: ModuleType, named: Model
) -> None:
    left = remainder(named, study.part(named, study.TRAIN))
    assert left is not None
    got = study.scores(left.model)
    assert got["multisine"] < 0.30
    assert got["arrow"] < 0.40
    assert got["arrow without extrapolation"] < 0.30
