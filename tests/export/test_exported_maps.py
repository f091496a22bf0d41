"""Maps in exported code: C and an FMU give what symhyb gives, slopes among it; and no table of two
columns holds one."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from builders import model_of, spring
from fmus import get, loaded, places, put, started, written
from scipy.interpolate import RegularGridInterpolator
from test_c_code import compiled
from test_c_code import put as put_files

from symhyb.export.c_code import SAMPLES, c_files, samples
from symhyb.export.curve_table import curve_tables
from symhyb.export.map_table import MapTable
from symhyb.export.spec import Spec, spec_of
from symhyb.model.types import Model

S, R = [-0.5, 0.0, 0.5], [-1.0, 0.0, 2.0]
F = [[-9.0, -1.0, 4.0], [-4.0, 0.0, 3.0], [-8.0, 1.5, 7.0]]
KNOWN = RegularGridInterpolator((S, R), F, "linear")


@cache
def machine() -> Model:
    """A mass on a spring with a strut by a map that holds its values beyond the grid."""
    own = {"units": ["m", "m/s", "N"], "x": S, "y": R, "values": F, "extrapolation": "hold"}
    return model_of(
        coordinates={"x": {"unit": "m", "start": 0.1}},
        parameters={"m": (1.2, "kg"), "k": (40.0, "N/m"), "n": (2.0, "1")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"hold": spring("k"), "strut": {"kind": "map", "on": "x", "scale": "n", **own}},
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


def spec(whole: bool) -> Spec:
    if whole:
        return spec_of(machine(), "machine", whole=True)
    return spec_of(machine(), "law", ("strut",))


@pytest.mark.parametrize("whole", [False, True])
def test_the_c_program_finds_no_difference(whole: bool, tmp_path: Path) -> None:
    made = spec(whole)
    put_files(tmp_path, c_files(made))
    reported = compiled(tmp_path, f"{made.identifier}.c", f"{made.identifier}_check.c")
    assert reported == f"0 {made.identifier}: {SAMPLES} samples, largest relative difference 0\n"


def test_the_force_added_is_that_of_the_map() -> None:
    """dF acts: it is minus the law, which resists."""
    e = spec(False).exported
    rng = np.random.default_rng(4)
    for s, r in rng.uniform(-3, 3, (20, 2)):
        _, made = e.evaluate(0.0, e.x, np.array([s, r]), e.p)
        held = np.clip(s, S[0], S[-1]), np.clip(r, R[0], R[-1])
        assert made == pytest.approx(-2 * KNOWN(held), rel=1e-10)


@pytest.mark.parametrize("fmi", [2, 3])
def test_an_fmu_gives_the_same_bit_by_bit(fmi: int, tmp_path: Path) -> None:
    made = spec(False)
    e, at = made.exported, places(made)
    _, _, u = samples(made, 200, seed=3)
    with loaded(written(tmp_path, made, fmi), fmi) as instance:
        started(instance, fmi)
        for row in u:
            put(instance, fmi, at.input, list(row))
            assert get(instance, fmi, at.output) == list(e.evaluate(0.0, e.x, row, e.p)[1])
        if fmi == 2:
            put(instance, fmi, at.input, [0.25, 1.0])
            by_s = instance.getDirectionalDerivative(at.output, at.input, [1.0, 0.0])
            assert by_s == pytest.approx([-2 * (4.25 - 1.5) / 0.5])
            by_r = instance.getDirectionalDerivative(at.output, at.input, [0.0, 1.0])
            assert by_r == pytest.approx([-2 * (5.0 - 0.75) / 2.0])


def test_its_own_grid_is_its_table() -> None:
    (table,) = curve_tables(machine(), ("strut",), {})
    assert isinstance(table, MapTable)
    assert table.missed < 1e-12
    known = table.force[np.ix_(np.isin(table.x, S), np.isin(table.y, R))]
    np.testing.assert_allclose(known, 2.0 * np.array(F), atol=1e-12)
