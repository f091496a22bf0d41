"""A law of a pair in exported code: in a machine, and alone, where it pushes two coordinates."""

from pathlib import Path

import numpy as np
import pytest
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import Spec, spec_of
from symhyb.model.read import parse_model

G = 0.35


def rig(name: str, whole: bool) -> Spec:
    """Two tilts of a plate on springs, with a rotor."""
    model = parse_model(
        """\
symhyb = 1
[coordinates]
a = { unit = "rad", start = 0.1 }
b = { unit = "rad" }
[parameters]
J = { value = 0.02, unit = "kg*m^2" }
c = { value = 3.0, unit = "N*m/rad" }
g = { value = 0.35, unit = "N*m*s/rad" }
[energy]
kinetic = "J*(a'**2 + b'**2)/2"
potential = "c*(a**2 + b**2)/2"
[elements.rotor]
kind = "gyroscopic"
pair = ["a", "b"]
coefficient = "g"
[sensors]
tilt = { measures = "a", unit = "rad" }
"""
    )
    return spec_of(model, name, () if whole else ("rotor",), whole=whole)


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_finds_no_difference(whole: bool, tmp_path: Path) -> None:
    spec = rig("made", whole)
    put_files(tmp_path, c_files(spec))
    assert compiled(tmp_path, "made.c", "made_check.c") == (
        f"0 made: {SAMPLES} samples, largest relative difference 0\n"
    )


def test_alone_it_is_a_force_of_both_speeds_on_both_coordinates() -> None:
    e = rig("rotor", False).exported
    assert e.inputs == (("v", "a"), ("v", "b"))
    _, force = e.evaluate(0.0, np.zeros(0), np.array([0.7, -0.2]), e.p)
    assert force == pytest.approx([-0.2 * G, -0.7 * G])
