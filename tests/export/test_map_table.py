"""Laws of stretch and rate together as the file of a map: bilinear between its places, and read
back."""

from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from symhyb.errors import InputError
from symhyb.export.curve_table import curve_tables
from symhyb.export.deliver import Order, deliver
from symhyb.export.map_table import ACCURACY, MapTable, gridded
from symhyb.limits import MAP_PLACES
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array
from tests.builders import model_of

SPANS = {"stretch": (-0.35, 0.45), "rate": (-1.0, 2.0)}
MODEL = """
symhyb = 1
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.stop]
kind = "map"
on = "x"
file = "tables/on-x-map.csv"
units = ["m", "m/s", "N"]
"""


def machine() -> Model:
    """A mass with a stop that has damping, and a damper beside it."""
    found = {"by": "sparse", "from": "train.csv", "nrmse": [0.2, 0.02]}
    stop = {"kind": "gap", "stiffness": "k", "clearance": "c", "damping": "d"}
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (10.0, "N/m"), "c": (0.2, "m"), "d": (3.0, "N*s/m")},
        energy={"kinetic": "m*x'**2/2"},
        elements={
            "stop": {"on": "x", "found": found, **stop},
            "oil": {"kind": "damper", "on": "x", "damping": "d", "found": found},
        },
        sensors={"y": {"measures": "x", "unit": "m"}},
    )


def bent(s: Array, r: Array) -> Array:
    return np.asarray(np.tanh(8 * s) * (1 + r**2))


def test_places_are_added_where_the_law_bends() -> None:
    x, y, force, missed = gridded(bent, np.linspace(-1, 1, 9), np.linspace(0, 1, 9))
    table = RegularGridInterpolator((x, y), force)
    s, r = np.meshgrid(np.linspace(-1, 1, 301), np.linspace(0, 1, 101), indexing="ij")
    off = np.abs(table((s, r)) - bent(s, r)).max() / 2
    assert missed <= 3 * ACCURACY
    assert off < 2 * missed
    assert x.size <= MAP_PLACES
    inner = np.diff(x)[np.abs(x[:-1]) < 0.3].mean()
    assert inner < np.diff(x)[np.abs(x[:-1]) > 0.5].mean() / 2


def test_a_law_that_is_bilinear_needs_no_more_places() -> None:
    x, _, force, missed = gridded(lambda s, r: s * r + 2 * s, np.array([0.0, 1.0]), np.ones(2))
    assert x.size == 2
    assert missed < 1e-12
    assert force[1, 0] == 3.0


def test_a_stop_with_damping_is_read_back(tmp_path: Path) -> None:
    head, *said = deliver(machine(), Order("curve", spans=SPANS), tmp_path / "tables")
    assert head.endswith("tables:")
    assert said[0].startswith("  on-x-map.csv: force over stretch and rate on x of stop, ")
    assert said[0].endswith('F > 0 resists, units = ["m", "m/s", "N"]')
    assert said[1].startswith("  on-x-rate.csv: force over rate on x of oil")
    first = (tmp_path / "tables" / "on-x-map.csv").read_text(encoding="utf-8").split(",")[0]
    assert first == "m \\ m/s: N"
    (tmp_path / "model.toml").write_text(MODEL, encoding="utf-8")
    (element,) = read_model(tmp_path / "model.toml").elements
    assert element.map is not None
    (table,) = (t for t in curve_tables(machine(), ("stop",), SPANS))
    assert isinstance(table, MapTable)
    np.testing.assert_allclose(element.map.values, table.force, rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(element.map.x, table.x, rtol=1e-8)
    assert (table.x[0], table.x[-1], table.y[0], table.y[-1]) == (-0.35, 0.45, -1.0, 2.0)


def test_a_range_that_is_missing_is_said() -> None:
    with pytest.raises(InputError, match="a table of stop needs a range: --rate LOW:HIGH, in SI"):
        curve_tables(machine(), ("stop",), {"stretch": (-0.35, 0.45)})
