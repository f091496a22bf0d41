"""A table of known values: columns, units, and every mistake at once."""

import pytest

from symhyb.data.known_table import read_known, table_of_known
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from tests.known_weights import PENDULUM


@pytest.fixture(scope="module")
def pendulum():
    return parse_model(PENDULUM)


@pytest.fixture
def table(tmp_path):
    def made(text: str):
        file = tmp_path / "known.csv"
        file.write_text(text, encoding="utf-8")
        return file

    return made


def refused(file, model) -> list[str]:
    with pytest.raises(InputError) as caught:
        read_known(file, model)
    return [str(problem) for problem in caught.value.problems]


def test_values_are_in_the_unit_of_the_header_else_of_the_model(pendulum, table):
    file = table("recording, m [kg], l\nfall-1.csv, 0.535, 0.1\n\nfall-2.csv, 1.168, 0.15\n")
    known = read_known(file, pendulum)
    assert known.of("falls/fall-1.csv") == {"m": pytest.approx(535), "l": 0.1}
    assert known.of("fall-2.csv") == {"m": pytest.approx(1168), "l": 0.15}


def test_the_longest_name_that_ends_a_path_is_the_row(pendulum, table):
    known = read_known(table("m;recording\n500;run.csv\n700;second/run.csv\n"), pendulum)
    assert known.of("first/run.csv") == {"m": 500}
    assert known.of("rig/second/run.csv") == {"m": 700}
    with pytest.raises(InputError, match="has no row for the recording"):
        known.of("another.csv")
    with pytest.raises(InputError, match="has no row"):
        known.of("my-run.csv")  # a name is whole


def test_without_a_table_nothing_is_known(pendulum):
    assert table_of_known(None, pendulum) is None


def test_everything_that_is_wrong_is_said_at_once_with_its_line(pendulum, table):
    head = "name, m [kg], m, l [kg], k, c\n"
    said = refused(table(head + "a.csv, 1, 1, 1, 1, 1\n"), pendulum)
    assert [line.partition("known.csv")[2].split(":")[1] for line in said] == ["1"] * len(said)
    text = "\n".join(said)
    assert "a column 'recording' with the names of the recordings is missing" in text
    assert "m: has two columns" in text
    assert "l: is given in kg, but the model has it in m" in text
    assert "there is no parameter 'k' in the model" in text
    assert "c: states an sd in the model" in text


def test_cells_that_are_no_numbers_and_rows_twice_are_refused(pendulum, table):
    text = "recording,m,l\na.csv,heavy,0.1\na.csv,1,nan\n,1,1\nb.csv,1\n"
    said = refused(table(text), pendulum)
    assert [line.partition("known.csv")[2] for line in said] == [
        ":2: m: must be a finite number, not 'heavy'",
        ":3: recording: 'a.csv' stands in line 2 already",
        ":3: l: must be a finite number, not 'nan'",
        ":4: recording: names no recording",
        ":5: has 2 cells below a header of 3",
    ]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "the file is empty"),
        ("recording,m\n", "there is a header but no row below it"),
        ("recording\na.csv\n", "has no column of a parameter"),
        ("recording,m [furlong]\na.csv,1\n", "furlong"),
    ],
)
def test_a_table_that_says_nothing_is_refused(pendulum, table, text, said):
    assert any(said in line for line in refused(table(text), pendulum))
