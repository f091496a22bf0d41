"""A law between two coordinates, exported alone and whole, gives what symhyb gives."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import model_of, spring
from fmus import get, loaded, places, put, started, written
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files, samples
from symhyb.export.spec import Spec, spec_of


@cache
def shaft(whole: bool) -> Spec:
    """Two inertias, tied by a cubic spring, play and a Maxwell element on their difference."""
    model = model_of(
        coordinates={"q1": {"unit": "rad", "start": 0.3}, "q2": {"unit": "deg"}},
        parameters={
            "m": (1.0, "kg"),
            "J": (0.8, "kg*m^2"),
            "c": (50.0, "N*m/rad"),
            "c3": (9.0, "N*m/rad^3"),
            "d": (2.0, "N*m*s/rad"),
            "p": (3.0, "deg"),
            "n": (3.0, "1"),
        },
        inputs={"u": {"unit": "N*m"}},
        bodies={
            "one": {"mass": "m", "at": ["0", "0"], "inertia": "J", "angle": "q1"},
            "two": {"mass": "m", "at": ["0", "0"], "inertia": "2*J", "angle": "q2"},
        },
        elements={
            "motor": {"kind": "torque", "on": "q1", "torque": "u"},
            "shaft": spring("c", on="q1 - n*q2", cubic="c3"),
            "relax": {"kind": "relaxation", "on": "q1 - q2", "stiffness": "c", "damping": "d"},
            "play": {"kind": "gap", "on": "q1 - q2", "stiffness": "c", "clearance": "p"},
        },
        sensors={"first": {"measures": "q1", "unit": "deg"}},
    )
    if whole:
        return spec_of(model, "machine", whole=True)
    return spec_of(model, "law", ("shaft", "relax", "play"))


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_finds_no_difference(whole: bool, tmp_path: Path) -> None:
    spec = shaft(whole)
    put_files(tmp_path, c_files(spec))
    reported = compiled(tmp_path, f"{spec.identifier}.c", f"{spec.identifier}_check.c")
    assert reported == f"0 {spec.identifier}: {SAMPLES} samples, largest relative difference 0\n"


def test_elements_alone_take_both_coordinates_and_push_on_both() -> None:
    spec = shaft(False)
    names = {role: [v.name for v in spec.of_role(role)] for role in ("input", "output", "state")}
    assert names["input"] == ["q.q1", "q.q2"]
    assert [name for name in names["output"] if name.startswith("dF")] == ["dF.q1", "dF.q2"]
    assert names["state"] == ["z.relax"]
    unit = next(v.unit for v in spec.variables if v.name == "z.relax")
    assert unit.text == "rad"
    q, z, c = np.array([0.4, 0.1]), 0.25, 50.0
    _, forces = spec.exported.evaluate(0.0, np.array([z]), q, spec.exported.p)
    gear, twist = q[0] - 3 * q[1], q[0] - q[1]
    torque = c * gear + 9.0 * gear**3
    pair = c * (twist - z) + c * (twist - np.deg2rad(3.0))
    assert forces[:2] == pytest.approx([-torque - pair, 3 * torque + pair], rel=1e-13)


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_gives_the_same_bit_by_bit(fmi: int, tmp_path: Path) -> None:
    from fmpy.validation import validate_fmu

    spec = shaft(False)
    path, at = written(tmp_path, spec, fmi), places(spec)
    assert validate_fmu(str(path)) == []
    t, x, u = samples(spec, 200, seed=3)
    with loaded(path, fmi, "me") as instance:
        started(instance, fmi)
        if fmi == 2:
            instance.enterContinuousTimeMode()
        for i in range(t.size):
            put(instance, fmi, at.input, list(u[i]))
            put(instance, fmi, at.state, list(x[i]))
            rates, y = spec.exported.evaluate(t[i], x[i], u[i], spec.exported.p)
            assert get(instance, fmi, at.output) == list(y)
            assert get(instance, fmi, at.rate) == list(rates)
