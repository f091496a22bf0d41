"""A hydromount in exported code: two inner states, quadratic loss and the play of its decoupler."""

from pathlib import Path

import numpy as np
import pytest
from builders import oscillator
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import Spec, spec_of
from symhyb.numeric.kernels.buffers import call

CHAMBER, FLUID, LOSS, SQUARE, PLAY = 600.0, 0.4, 2.5, 6.0, 0.002


def rig(name: str, whole: bool) -> Spec:
    """A mass with a hydromount, as a machine or the mount alone."""
    track = {"kind": "hydromount", "on": "x", "stiffness": "k_b", "mass": "m_f"}
    track |= {"damping": "d_f", "drag": "b_f", "clearance": "c_f"}
    numbers = {
        "k_b": (CHAMBER, "N/m"),
        "m_f": (FLUID, "kg"),
        "d_f": (LOSS, "N*s/m"),
        "b_f": (SQUARE, "N*s^2/m^2"),
        "c_f": (PLAY, "m"),
    }
    model = oscillator({"track": track}, numbers)
    return spec_of(model, name, () if whole else ("track",), whole=whole)


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_finds_no_difference(whole: bool, tmp_path: Path) -> None:
    spec = rig("made", whole)
    inner = {variable.name: variable.unit.text for variable in spec.inner}
    assert inner == {"z.track.z": "m", "z.track.w": "m/s"}
    put_files(tmp_path, c_files(spec))
    assert compiled(tmp_path, "made.c", "made_check.c") == (
        f"0 made: {SAMPLES} samples, largest relative difference 0\n"
    )


def test_alone_it_is_exported_as_a_force_that_resists() -> None:
    e = rig("track", False).exported
    assert e.inputs == (("q", "x"), ("v", "x"))
    (rest,) = call(e.rest, (0.0, e.x, np.array([0.02, 0.7]), e.p))
    assert rest.ravel() == pytest.approx([0.02, 0.7])
    z, w = 0.01, -0.3
    rates, force = e.evaluate(0.0, np.array([z, w]), np.array([0.02, 0.7]), e.p)
    pressed = CHAMBER * (0.02 - z - PLAY)
    assert force == pytest.approx([-pressed])
    assert rates == pytest.approx([w, (pressed - LOSS * w + SQUARE * w**2) / FLUID])
