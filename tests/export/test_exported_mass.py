"""A mass that changes with time and an inertia that changes with place in exported code."""

from pathlib import Path

import numpy as np
import pytest
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import spec_of
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from tests.builders import DRIVEN_MASS


def emptied() -> Model:
    return parse_model(DRIVEN_MASS.replace('mass = "m"', 'mass = "m - 0.1 kg/s * t"'))


def test_the_acceleration_is_that_of_the_mass_that_is_left() -> None:
    e = spec_of(emptied(), "tank", whole=True).exported
    given = np.array([{"f": 2.0}.get(name, 0.0) for _, name in e.inputs])
    rates, _ = e.evaluate(3.0, np.array([0.1, 1.0]), given, e.p)
    assert rates == pytest.approx([1.0, (2.0 - 25 * 0.1 - 0.6) / 0.7])


def test_the_c_program_sees_no_difference(tmp_path: Path) -> None:
    spec = spec_of(emptied(), "tank", whole=True)
    put_files(tmp_path, c_files(spec))
    reported = compiled(tmp_path, "tank.c", "tank_check.c")
    assert reported == f"0 tank: {SAMPLES} samples, largest relative difference 0\n"
