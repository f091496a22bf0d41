"""What a person changes on the bench, and the model that follows."""

from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.write import text_of
from symhyb.workbench.bench import (
    Bench,
    as_filed,
    current,
    open_bench,
    read_shown,
    with_column,
    with_elements,
    with_shown,
    with_value,
)


def test_an_untouched_bench_shows_the_model_of_the_file(bench: Bench) -> None:
    assert not bench.changed
    assert current(bench) is bench.model


def test_an_element_that_is_off_is_left_out_and_comes_back(bench: Bench) -> None:
    off = with_elements(bench, ["spring", "shaker"])
    assert off.changed
    assert current(off).elements.names() == ("spring", "shaker")
    assert current(with_elements(off, bench.model.elements.names())) is bench.model


def test_a_value_is_moved_in_the_unit_of_the_file_and_back(bench: Bench) -> None:
    moved = with_value(bench, "k", 180.0)
    assert current(moved).parameters["k"].value == 180.0
    assert current(moved).parameters["m"] == bench.model.parameters["m"]
    assert not with_value(moved, "k", 200.0).changed
    assert not as_filed(moved).changed


def test_values_of_elements_and_channels_are_moved_too(
    rig: dict[str, Path], tmp_path: Path
) -> None:
    text = rig["model"].read_text(encoding="utf-8").replace('damping = "d"', 'damping = "c"')
    text += '[elements.damper.parameters]\nc = { value = 0.7, unit = "N*s/m" }\n'
    text = text.replace('measures = "x"', 'measures = "x", gain = 1.0, delay = 0.0')
    file = tmp_path / "own.toml"
    file.write_text(text, encoding="utf-8")
    bench = open_bench(file, [rig["first"]])
    moved = bench
    for path, value in (("damper.c", 0.9), ("laser.gain", 1.1), ("laser.delay", 0.01)):
        moved = with_value(moved, path, value)
    values = {item.path: item.value for item in current(moved).all_parameters()}
    assert (values["damper.c"], values["laser.gain"], values["laser.delay"]) == (0.9, 1.1, 0.01)


def test_what_is_set_can_be_written_as_a_model_file(bench: Bench) -> None:
    model = current(with_value(with_elements(bench, ["spring", "shaker"]), "k", 180.0))
    again = parse_model(text_of(model))
    assert again.elements == model.elements
    assert again.parameters == model.parameters


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_value_must_be_finite(bench: Bench, value: float) -> None:
    with pytest.raises(InputError, match="finite"):
        with_value(bench, "k", value)


def test_all_problems_are_said_at_once(rig: dict[str, Path], tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.toml"
    wrong.write_text("symhyb = 1\ntitel = 'x'\n", encoding="utf-8")
    with pytest.raises(InputError) as refused:
        open_bench(wrong, [tmp_path / "none.csv", tmp_path / "none.mat"])
    said = str(refused.value)
    assert "titel" in said
    assert "none.csv" in said
    assert "none.mat" in said
    with pytest.raises(InputError, match="at least one recording"):
        open_bench(rig["model"], [])


def test_columns_are_mapped_where_names_differ(rig: dict[str, Path]) -> None:
    bench = open_bench(rig["model"], [rig["first"], rig["second"]])
    second = with_shown(bench, 1)
    with pytest.raises(InputError):
        read_shown(with_column(second, "laser", "nothing"))
    read = read_shown(with_column(second, "laser", "way [mm]"))
    assert abs(read.sensors["laser"]).max() < 1.0  # m
    assert read_shown(bench).name == "first.csv"
