"""Lines become recordings: headers, units, preambles, and rows that are none."""

import pytest

from symhyb.errors import InputError
from symhyb.monitoring.feed import Feed
from tests.pushed import pushed_model


def fed(lines: list[str], columns: dict[str, str] | None = None) -> Feed:
    feed = Feed(pushed_model(), columns, "rig")
    for line in lines:
        feed.take(line)
    return feed


ROWS = [f"{0.01 * i:.2f},{i % 3},{0.001 * i:.4f}" for i in range(60)]


def test_rows_are_taken_piece_by_piece() -> None:
    feed = fed(["t,f,laser", *ROWS])
    assert feed.step_s(40) == pytest.approx(0.01)
    first, second = feed.piece(30), feed.piece(30)
    assert first.t[0] == 0
    assert second.t[0] == pytest.approx(0.3)
    assert second.inputs["f"][1] == 1
    assert not feed.rows


def test_units_below_the_names_and_a_preamble_are_read() -> None:
    feed = fed(["Logger 7", "started by hand", "t,f,laser", "s,kN,m", "", *ROWS])
    assert feed.piece(40).inputs["f"][1] == 1000


def test_decimal_commas_and_missing_values_are_numbers() -> None:
    rows = [row.replace(",", ";").replace(".", ",") for row in ROWS]
    rows[7] = rows[7].rsplit(";", 1)[0] + ";"
    piece = fed(["t;f;laser", *rows]).piece(60)
    assert piece.t[1] == pytest.approx(0.01)
    assert not piece.sensors["laser"][7] > -1


def test_columns_are_mapped() -> None:
    feed = fed(["t,push,laser", *ROWS], {"f": "-push"})
    assert feed.piece(40).inputs["f"][1] == -1


def test_a_row_that_cannot_be_read_is_said_and_taken_out() -> None:
    feed = fed(["t,f,laser", *ROWS[:20], "0.2,1", *ROWS[21:]])
    with pytest.raises(InputError, match="cell"):
        feed.piece(30)
    assert feed.piece(30).t[0] == pytest.approx(0.3)


def test_a_source_without_numbers_is_refused() -> None:
    with pytest.raises(InputError, match="no row of numbers"):
        fed(["all is well"] * 300)
