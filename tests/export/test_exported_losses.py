"""Losses in exported code: a power, a knee, an eddy brake, friction by a load and by place, and
drag and lift of a recorded wind."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import model_of
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files
from symhyb.export.spec import Spec, spec_of

LOSSES = {
    "fan": {"kind": "power", "coefficient": "F", "exponent": "p", "speed": "v"},
    "shock": {"kind": "damper_kinked", "damping": "d", "knee": "v", "sharpness": "p"},
    "brake": {"kind": "eddy_brake", "peak": "F", "critical": "v"},
    "rail": {"kind": "friction", "coulomb": "F", "slope": "k", "around": "x_c"},
    "sail": {"kind": "flow_drag", "drag": "b", "flow": "wind"},
    "wing": {"kind": "flow_lift", "lift": "b", "flow": "-wind"},
    "guide": {"kind": "friction", "coulomb": "F", "load_coefficient": "mu", "load": "f - k*x"},
}


@cache
def rig(name: str) -> Spec:
    """A mass with all seven losses as a machine (no ``name``), or one of them alone."""
    model = model_of(
        coordinates={"x": {"unit": "m", "start": 0.1}},
        parameters={
            "m": (1.2, "kg"),
            "k": (40.0, "N/m"),
            "F": (2.0, "N"),
            "p": (1.5, "1"),
            "v": (0.3, "m/s"),
            "d": (8.0, "N*s/m"),
            "mu": (0.2, "1"),
            "b": (0.3, "N*s^2/m^2"),
            "x_c": (0.08, "m"),
        },
        inputs={"f": {"unit": "N"}, "wind": {"unit": "m/s"}},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={key: {**loss, "on": "x"} for key, loss in LOSSES.items()},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    return spec_of(model, name, (name,)) if name else spec_of(model, "machine", whole=True)


@pytest.mark.parametrize("name", ["", "guide", "rail", "sail", "wing"])
def test_the_c_program_finds_no_difference(name: str, tmp_path: Path) -> None:
    spec = rig(name)
    put_files(tmp_path, c_files(spec))
    reported = compiled(tmp_path, f"{spec.identifier}.c", f"{spec.identifier}_check.c")
    assert reported == f"0 {spec.identifier}: {SAMPLES} samples, largest relative difference 0\n"


def test_the_host_tells_place_and_input_and_gets_the_friction_of_that_load() -> None:
    e = rig("guide").exported
    assert e.inputs == (("q", "x"), ("v", "x"), ("u", "f"))
    _, made = e.evaluate(0.0, e.x, np.array([0.05, 0.7, 12.0]), e.p)
    assert made == pytest.approx([-(2.0 + 0.2 * abs(12.0 - 40.0 * 0.05))])


def test_the_host_tells_the_place_and_gets_the_friction_of_that_place() -> None:
    e = rig("rail").exported
    for place, level in ((0.05, 0.8), (0.08, 2.0), (0.01, 0.0)):
        _, made = e.evaluate(0.0, e.x, np.array([place, -0.7]), e.p)
        assert made == pytest.approx([level])


def test_the_host_tells_the_wind_and_gets_drag_and_lift() -> None:
    e = rig("sail").exported
    assert e.inputs == (("v", "x"), ("u", "wind"))
    for wind, made in ((4.0, 0.3 * 3.3**2), (-1.0, -0.3 * 1.7**2)):
        assert e.evaluate(0.0, e.x, np.array([0.7, wind]), e.p)[1] == pytest.approx([made])
    e = rig("wing").exported
    assert e.inputs == (("u", "wind"),)
    assert e.evaluate(0.0, e.x, np.array([4.0]), e.p)[1] == pytest.approx([0.3 * 4.0**2])
