"""Declared states beside an FMU: what they add to its equations is what they add to the model's."""

from pathlib import Path

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.residual import compare
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from tests.builders import DRIVEN_MASS
from tests.fmu_rigs import as_fmu

COIL = """[states]
i = { unit = "A", rate = "(u - R*i - c*x')/L" }
[elements.coil]
kind = "force"
on = "x"
force = "c*i"
"""
NUMBERS = """R = { value = 2.0, unit = "ohm" }
L = { value = 40.0, unit = "mH" }
c = { value = 5.0, unit = "N/A" }
"""


def with_coil(text: str, file: str = "") -> Model:
    text = text.replace("[parameters]\n", f"[parameters]\n{NUMBERS}", 1)
    text = text.replace("[inputs]\n", '[inputs]\nu = { unit = "V" }\n', 1)
    return parse_model(text + COIL, file)


def test_it_lacks_what_the_model_lacks(tmp_path: Path) -> None:
    closed = as_fmu(parse_model(DRIVEN_MASS), tmp_path)
    random, t = np.random.default_rng(5), np.arange(0, 8, 0.01)
    laser = 0.6 * np.sin(1.3 * t) + 0.5 * np.cos(2.9 * t) + 1e-3 * random.normal(size=t.size)
    inputs = {"u": 3 * np.sin(2.2 * t), "f": np.cos(1.7 * t)}
    run = Recording("run.csv", t, inputs, {"laser": laser}, (), "")
    known = compare(with_coil(DRIVEN_MASS), run)
    found = compare(with_coil(closed.text, closed.file), run)
    size = np.abs(known.force).max()
    assert np.abs(found.force - known.force).max() < 1e-4 * size
    without = compare(parse_model(DRIVEN_MASS), run)
    assert np.abs(without.force - known.force).max() > 0.05 * size  # the coil counts
