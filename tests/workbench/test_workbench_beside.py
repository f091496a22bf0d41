"""Tables of one result, and of two side by side."""

from collections.abc import Callable
from pathlib import Path

from symhyb.report.contract import UNBOUNDED
from symhyb.workbench.beside import compared_tables, result_tables
from symhyb.workbench.results import read_result

Write = Callable[..., Path]


def test_a_result_shows_numbers_with_deviations_and_errors(write_result: Write) -> None:
    numbers, errors = result_tables(read_result(write_result("one")))
    assert numbers.rows[0] == ("found_friction", "coulomb", "1.50 ± 0.10 N", "", "90 %")
    assert numbers.rows[1][:4] == ("k", "value", "210 ± 2 N/m", "200 N/m")
    assert errors.rows[1] == ("training", "windows", "laser", "20 %", "1 %")
    assert errors.rows[0][3] == "–"


def test_two_results_stand_side_by_side(write_result: Write) -> None:
    first = read_result(write_result("first", friction=1.5, sd=0.3))
    second = read_result(write_result("second", friction=2.0, sd=0.4, parameters=[]))
    answers, numbers, errors = compared_tables(first, second)
    assert answers.rows[0] == ("verdict", "missing physics", "missing physics")
    rows = {row[:2]: row[2:] for row in numbers.rows}
    assert rows["found_friction", "coulomb"] == ("1.5 ± 0.3 N", "2.0 ± 0.4 N", "1 deviations")
    assert rows["k", "value"] == ("210 ± 2 N/m", "–", "")
    assert errors.rows[1] == ("training", "windows", "laser", "1 %", "1 %")


def test_an_unbounded_deviation_is_no_number(write_result: Write) -> None:
    first = read_result(write_result("first", sd=UNBOUNDED))
    _, numbers, _ = compared_tables(first, first)
    assert numbers.rows[0][2:] == (*("1.5 N (deviation unbounded)",) * 2, "")
