"""Several structures fitted to the same windows: the one that holds is the likeliest."""

import numpy as np
import pytest
from builders import DRIVEN_MASS
from sweeps import write_sweep

import symhyb as sh
from symhyb.correction.structures import Asked, Structured, shares, structured
from symhyb.errors import InputError
from symhyb.model.types import Model

FRICTION = """
[elements.dry]
kind = "friction"
on = "x"
coulomb = "F"
transition = "0.01 m/s"
[elements.stiffening]
kind = "spring"
on = "x"
cubic = "k3"
"""
NUMBERS = """
F = { value = 0.5, unit = "N" }
k3 = { value = 0.0, unit = "N/m^3" }
[inputs]"""
VISCOUS: Asked = (("d",), {"F": 0.0})
DRY: Asked = (("d", "F"), {})
MORE: Asked = (("d", "F", "k3"), {})


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Model:
    file = tmp_path_factory.mktemp("model") / "model.toml"
    text = DRIVEN_MASS.replace("\n[inputs]", NUMBERS, 1) + FRICTION
    file.write_text(text, encoding="utf-8")
    return sh.read_model(file)


@pytest.fixture(scope="module")
def recording(model: Model, tmp_path_factory: pytest.TempPathFactory) -> sh.Recording:
    folder = tmp_path_factory.mktemp("runs")
    write_sweep(folder, recordings=1)
    return sh.read_recording(folder / "r0.csv", model)


@pytest.fixture(scope="module")
def found(model: Model, recording: sh.Recording) -> Structured:
    return structured(model, recording, [VISCOUS, DRY, MORE])


def test_the_structure_that_holds_is_the_likeliest(found: Structured) -> None:
    assert found.likeliest == 1
    assert found.ln_evidence[1] == 0.0
    assert found.ln_evidence[0] < -10
    assert -10 < found.ln_evidence[2] < -0.5
    assert found.probabilities.sum() == pytest.approx(1.0)


def test_what_a_structure_does_not_fit_is_held(found: Structured) -> None:
    viscous, dry, _ = found.fits
    assert viscous is not None
    assert dry is not None
    held = {item.name: item.value for item in viscous.model.parameters}
    assert held["F"] == 0.0
    assert [item.name for item in dry.parameters] == ["d", "F"]
    assert dry.parameters[1].value == pytest.approx(0.8, rel=0.05)
    assert dry.after < viscous.after
    assert dry.samples == viscous.samples


def test_wrong_names_are_refused(model: Model, recording: sh.Recording) -> None:
    with pytest.raises(InputError, match="there is no parameter 'G'"):
        structured(model, recording, [VISCOUS, (("d", "G"), {})])
    with pytest.raises(InputError, match="is named twice"):
        structured(model, recording, [VISCOUS, (("d", "d"), {})])


def test_one_that_cannot_be_simulated_has_no_probability() -> None:
    assert shares(np.array([0.0, -np.inf])).tolist() == [1.0, 0.0]
    assert shares(np.array([-1000.0, 0.0, 0.0])).tolist() == [0.0, 0.5, 0.5]
