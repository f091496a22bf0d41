"""Points of a curve from CSV text: two columns, and every fault with its line."""

import pytest

from symhyb.model.curve_file import points_in

GOOD = "speed [m/s], force [N]\n-0.5, -610\n\n# measured twice\n0,0\n.5, 5.5e2\n"


def test_two_columns_with_units_are_read() -> None:
    found = points_in(GOOD)
    assert found.points == ((-0.5, -610.0), (0.0, 0.0), (0.5, 550.0))
    assert found.lines == (2, 5, 6)
    assert found.units == ("m/s", "N")
    assert found.faults == ()


@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_other_delimiters_and_line_ends(delimiter: str) -> None:
    found = points_in(GOOD.replace(",", delimiter).replace("\n", "\r\n"))
    assert found.points == points_in(GOOD).points
    assert found.units == ("m/s", "N")


def test_columns_are_chosen_by_name() -> None:
    text = "t [s],F,v,note\n0,1,2,a\n1,3,4,b\n"
    found = points_in(text, ("v", "F"))
    assert found.points == ((2.0, 1.0), (4.0, 3.0))
    assert found.units == (None, None)


FAULTS = {
    "no line": ("# nothing\n", (), [(0, "holds no line of numbers")]),
    "no names": ("0,1\n1,2\n", (), [(1, "the first line must name the columns")]),
    "several columns": (
        "a,b,c\n",
        (),
        [(1, "has 3 columns; 'columns' must name the two that are meant")],
    ),
    "unknown column": (
        "speed,force\n",
        ("sped", "force"),
        [(1, "has no column 'sped'; did you mean 'speed'?")],
    ),
    "one name twice": ("a,a,b\n", ("a", "b"), [(1, "has 2 columns 'a'")]),
    "every line at once": (
        "a,b\n1,x\n2\nnan,inf\n1e999,3\n,4\n",
        (),
        [
            (2, "'x' is not a number"),
            (3, "has 1 cells; the first line has 2"),
            (4, "'nan' is not a number"),
            (4, "'inf' is not a number"),
            (5, "'1e999' is not finite"),
            (6, "a cell is empty"),
        ],
    ),
    "decimal comma": ("a;b\n0,5;1\n", (), [(2, "'0,5' is not a number; write a decimal point")]),
}


@pytest.mark.parametrize(("text", "columns", "faults"), FAULTS.values(), ids=FAULTS)
def test_every_fault_is_told_with_its_line(
    text: str, columns: tuple[str, ...], faults: list[tuple[int, str]]
) -> None:
    assert list(points_in(text, columns).faults) == faults
