"""Laws as tables: the law between the rows, one file for each place and variable, and what is no
function of one variable."""

from pathlib import Path

import numpy as np
import pytest

from symhyb.errors import InputError
from symhyb.export.curve_table import ROWS_FIRST, CurveTable, curve_tables, span_of
from symhyb.export.deliver import Order, deliver
from symhyb.export.map_table import ACCURACY
from symhyb.model.types import Model
from tests.builders import model_of

RATE = {"rate": (-0.5, 0.5)}
FOUND = {"by": "sparse", "from": "train.csv", "nrmse": [0.2, 0.02]}


def element(kind: str, on: str = "x", **values: object) -> dict[str, object]:
    return {"kind": kind, "on": on, "found": FOUND, **values}


def machine(**elements: dict[str, object]) -> Model:
    """A mass in x and a wheel in phi, with these elements."""
    return model_of(
        coordinates={"x": {"unit": "m"}, "phi": {"unit": "rad"}},
        parameters={"m": (1.0, "kg"), "J": (1.0, "kg*m^2"), "F": (2.0, "N"), "d": (3.0, "N*s/m")}
        | {"k": (10.0, "N/m"), "c": (0.2, "m"), "w": (1e-3, "m/s"), "T": (4.0, "N*m")}
        | {"v": (0.1, "rad/s"), "l": (50.0, "N*s/m")},
        energy={"kinetic": "m*x'**2/2 + J*phi'**2/2"},
        elements=elements,
        sensors={"y": {"measures": "x", "unit": "m"}, "z": {"measures": "phi", "unit": "rad"}},
    )


def only(model: Model, **spans: tuple[float, float]) -> CurveTable:
    (found,) = curve_tables(model, (), spans)
    assert isinstance(found, CurveTable)
    return found


def test_losses_at_one_place_are_one_table_of_their_sum() -> None:
    rub, oil = element("friction", coulomb="F", transition="w"), element("damper", damping="d")
    found = only(machine(rub=rub, oil=oil), rate=(-0.5, 0.5))
    assert (found.file, found.elements) == ("on-x-rate.csv", ("rub", "oil"))
    x = np.linspace(-0.5, 0.5, 20_001)
    law = 2.0 * np.tanh(x / 1e-3) + 3.0 * x
    assert np.abs(np.interp(x, found.x, found.force) - law).max() < 2 * ACCURACY * 3.5
    assert found.x.size < 4 * ROWS_FIRST
    assert {-0.5, 0.0, 0.5} <= set(found.x)


def test_a_stop_is_a_table_over_the_stretch() -> None:
    found = only(machine(stop=element("gap", stiffness="k", clearance="c")), stretch=(-0.35, 0.45))
    assert (found.over, found.units) == ("stretch", ("m", "N"))
    law = 10.0 * (np.maximum(found.x - 0.2, 0) - np.maximum(-found.x - 0.2, 0))
    np.testing.assert_allclose(found.force, law, atol=1e-12)


def test_an_angle_has_units_of_its_own_and_a_file_of_its_own() -> None:
    brake = element("eddy_brake", on="phi", peak="T", critical="v")
    first, second = curve_tables(
        machine(brake=brake, oil=element("damper", damping="d")), (), {"rate": (0.0, 1.0)}
    )
    assert [first.file, second.file] == ["on-phi-rate.csv", "on-x-rate.csv"]
    assert first.units == ("rad/s", "N*m")
    assert first.force.max() == pytest.approx(4.0, rel=1e-3)
    assert first.text().splitlines()[0] == "rate [rad/s],force [N*m]"


def test_points_of_an_own_curve_are_its_range_and_among_its_rows() -> None:
    points = [[-0.3, -5.0], [-0.11, -1.0], [0.0, 0.0], [0.2, 3.0]]
    curve = element("curve", over="rate", points=points, units=["m/s", "N"])
    found = only(machine(curve=curve))
    assert (found.x[0], found.x[-1]) == (-0.3, 0.2)
    at = {float(x): float(y) for x, y in zip(found.x, found.force, strict=True)}
    assert at[-0.11] == pytest.approx(-1.0)


def test_what_is_no_function_of_stretch_and_rate_is_refused_all_at_once() -> None:
    model = machine(
        soft=element("relaxation", stiffness="k", damping="l"),
        stop=element("gap", stiffness="k", clearance="c", damping="d"),
        push=element("constant", constant="F"),
        mass=element("added_mass", mass="m"),
        falling=element("friction", load="k*x", load_coefficient=0.3, transition="w"),
        oil=element("damper", damping="d"),
    )
    with pytest.raises(InputError) as caught:
        curve_tables(model, (), {})
    said = {one.place: one.text for one in caught.value.problems}
    assert "remembers" in said["elements.soft"]
    assert "needs ranges: --stretch LOW:HIGH and --rate LOW:HIGH" in said["elements.stop"]
    assert "no law of stretch or rate" in said["elements.push"]
    assert "neither" in said["elements.mass"]
    assert "'x'" in said["elements.falling"]
    assert "--rate LOW:HIGH" in said["elements.oil"]
    assert all("FMU" in said[f"elements.{name}"] for name in ("soft", "push", "mass"))


@pytest.mark.parametrize("text", ["5", "0.5:-0.5", "1:1", "a:b", "0:inf", ":"])
def test_a_range_is_two_numbers_in_their_order(text: str) -> None:
    with pytest.raises(InputError, match="LOW:HIGH"):
        span_of("rate", text)
    assert span_of("rate", "-0.5:1e-1") == (-0.5, 0.1)


def test_tables_are_written_into_a_folder(tmp_path: Path) -> None:
    model = machine(oil=element("damper", damping="d"))
    head, line = deliver(model, Order("curve", spans=RATE), tmp_path / "tables")
    assert head.endswith("tables:")
    assert line.startswith("  on-x-rate.csv: force over rate on x of oil, 33 rows from -0.5 to 0.5")
    rows = (tmp_path / "tables" / "on-x-rate.csv").read_text(encoding="utf-8").splitlines()
    assert rows[0] == "rate [m/s],force [N]"
    assert rows[-1] == "0.5,1.5"


@pytest.mark.parametrize(
    ("order", "text"),
    [
        (Order("curve", whole=True), "leave out --whole"),
        (Order("fmu", spans=RATE), "--to curve"),
    ],
)
def test_an_order_that_makes_no_sense_is_refused(order: Order, text: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=text):
        deliver(machine(oil=element("damper", damping="d")), order, tmp_path / "out")
    assert list(tmp_path.iterdir()) == []
