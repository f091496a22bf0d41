"""Curves in exported code: C and an FMU give what symhyb gives, slopes among it."""

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
def strut(whole: bool) -> Spec:
    """A mass on a spring with a progressive stop and a strut, each by points."""
    model = model_of(
        coordinates={"x": {"unit": "m", "start": 0.1}},
        parameters={"m": (1.2, "kg"), "k": (40.0, "N/m"), "n": (2.0, "1")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "hold": spring("k"),
            "stop": {
                "kind": "curve",
                "on": "x",
                "over": "stretch",
                "units": ["m", "N"],
                "points": [[-1.0, -90.0], [-0.5, 0.0], [0.5, 0.0], [0.8, 10.0], [1.0, 40.0]],
            },
            "brake": {
                "kind": "curve",
                "on": "x",
                "over": "stretch",
                "times": "square",
                "units": ["m", "N*s^2/m^2"],
                "points": [[-1.0, 0.0], [0.0, 3.0], [1.0, 0.5]],
            },
            "strut": {
                "kind": "curve",
                "on": "x",
                "over": "rate",
                "scale": "n",
                "units": ["m/s", "N"],
                "points": [[-1.0, -9.0], [-0.2, -6.0], [0.0, 0.0], [0.2, 2.0], [1.0, 4.0]],
                "interpolation": "linear",
                "extrapolation": "hold",
            },
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )
    return spec_of(model, "machine", whole=True) if whole else spec_of(model, "law", ("strut",))


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_finds_no_difference(whole: bool, tmp_path: Path) -> None:
    spec = strut(whole)
    put_files(tmp_path, c_files(spec))
    reported = compiled(tmp_path, f"{spec.identifier}.c", f"{spec.identifier}_check.c")
    assert reported == f"0 {spec.identifier}: {SAMPLES} samples, largest relative difference 0\n"


def test_the_force_added_is_that_of_the_curve() -> None:
    """dF acts: it is minus the law, which resists."""
    e = strut(False).exported
    for speed, force in ((-3.0, 18.0), (-0.1, 6.0), (0.1, -2.0), (0.6, -6.0), (3.0, -8.0)):
        _, made = e.evaluate(0.0, e.x, np.array([speed]), e.p)
        assert made == pytest.approx([force])


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_gives_the_same_bit_by_bit(fmi: int, tmp_path: Path) -> None:
    spec = strut(False)
    e, at = spec.exported, places(spec)
    _, _, u = samples(spec, 200, seed=3)
    with loaded(written(tmp_path, spec, fmi), fmi) as instance:
        started(instance, fmi)
        for row in u:
            put(instance, fmi, at.input, list(row))
            assert get(instance, fmi, at.output) == list(e.evaluate(0.0, e.x, row, e.p)[1])
        if fmi == 2:
            put(instance, fmi, at.input, [0.1])
            assert instance.getDirectionalDerivative(at.output, at.input, [1.0]) == [-20.0]
