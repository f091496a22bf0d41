"""A mode in exported code: two inner states, which begin settled against a place that moves on."""

from pathlib import Path

import numpy as np
import pytest
from builders import oscillator
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import Spec, spec_of
from symhyb.numeric.kernels.buffers import call

HIDDEN, FREQUENCY, RATIO = 0.2, 7.0, 0.04
PACE = 2 * np.pi * FREQUENCY


def rig(name: str, whole: bool) -> Spec:
    """A mass with a mode, as a machine or the mode alone."""
    load = {"kind": "mode", "on": "x", "mass": "m_h", "frequency": "f_h", "damping_ratio": "zeta"}
    model = oscillator(
        {"load": load},
        {"m_h": (HIDDEN, "kg"), "f_h": (FREQUENCY, "Hz"), "zeta": (RATIO, "1")},
    )
    return spec_of(model, name, () if whole else ("load",), whole=whole)


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_finds_no_difference(whole: bool, tmp_path: Path) -> None:
    spec = rig("made", whole)
    inner = {variable.name: variable.unit.text for variable in spec.inner}
    assert inner == {"z.load.e": "m", "z.load.w": "m/s"}
    put_files(tmp_path, c_files(spec))
    assert compiled(tmp_path, "made.c", "made_check.c") == (
        f"0 made: {SAMPLES} samples, largest relative difference 0\n"
    )


def test_alone_it_is_exported_as_a_force_of_the_speed_that_begins_settled() -> None:
    e = rig("load", False).exported
    assert e.inputs == (("v", "x"),)
    (rest,) = call(e.rest, (0.0, e.x, np.array([0.7]), e.p))
    assert rest.ravel() == pytest.approx([0.0, 0.7])
    rates, force = e.evaluate(0.0, np.array([0.01, 0.2]), np.array([0.7]), e.p)
    pull = PACE**2 * 0.01 + 2 * RATIO * PACE * 0.5
    assert force == pytest.approx([-HIDDEN * pull])
    assert rates == pytest.approx([0.5, pull])
