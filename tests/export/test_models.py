"""Every model that ships can be exported, and says the same as the machine itself."""

from pathlib import Path

import numpy as np
import pytest

from symhyb.export.c_code import c_files, samples
from symhyb.export.description import model_description
from symhyb.export.spec import spec_of
from symhyb.model.read import read_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import build

MODELS = sorted((Path(__file__).parents[2] / "models").glob("*.toml"))
QUICK = ("damper_rig", "rig_alone", "quarter_car")  # all imposed; no element; several coordinates


@pytest.mark.parametrize(
    "file",
    [
        pytest.param(file, marks=() if file.stem in QUICK else pytest.mark.slow, id=file.stem)
        for file in MODELS
    ],
)
def test_the_exported_machine_has_the_rates_of_the_machine(file: Path) -> None:
    model = read_model(file)
    machine, spec = build(model), spec_of(model, file.stem, whole=True)
    e, form = spec.exported, state_form(machine)
    assert len(e.states) == form.size
    (t, x, u), f = samples(spec, 1, seed=23), len(form.free)
    rates, y = e.evaluate(float(t[0]), x[0], u[0], e.p)
    drive = (x[0], u[0], float(t[0]), machine.values, np.zeros(machine.n))
    (reported,) = call(form.rates(), drive)
    outputs, _ = call(form.outputs(), drive)
    smooth = {"rel": 1e-9, "abs": 1e-9}  # a jump of sgn is passed over 1e-3
    assert rates[:f] == pytest.approx(x[0][f : 2 * f])
    assert rates[f:] == pytest.approx(reported.reshape(-1), **smooth)
    assert y == pytest.approx(outputs.reshape(-1), **smooth)
    for fmi in (2, 3):
        assert f'fmiVersion="{fmi}.0"' in model_description(spec, fmi, "{}", ("cs", "me"))
    assert f"#define {file.stem.upper()}_NX {form.size}" in c_files(spec)[f"{file.stem}.h"]
