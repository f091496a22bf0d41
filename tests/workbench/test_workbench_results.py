"""Results in folders, read again; what is none is refused by sentences."""

from collections.abc import Callable
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.workbench.results import read_result, read_results, result_folders

Write = Callable[..., Path]


def test_a_result_is_read(write_result: Write) -> None:
    result = read_result(write_result("one"))
    assert result.verdict == "missing physics"
    (law,) = result.laws
    assert [(n.of, n.term, n.value, n.sd, n.unit) for n in law.numbers] == [
        ("found_friction", "coulomb", 1.5, 0.1, "N")
    ]
    assert [n.key for n in result.all_numbers()][1] == ("k", "value")
    free, window = result.errors
    assert (free.key, free.before, free.after) == (("training", "free run", "laser"), None, 0.02)
    assert (window.before, window.after) == (0.2, 0.01)
    assert result.report is None
    (result.folder / "report.html").write_text("<p>", encoding="utf-8")
    assert result.report == result.folder / "report.html"


def test_folders_of_results_are_found_in_a_folder(write_result: Write, tmp_path: Path) -> None:
    one, two = write_result("all/1"), write_result("all/2")
    (tmp_path / "all" / "empty").mkdir()
    assert result_folders([tmp_path / "all"]) == (one, two)
    assert result_folders([one, tmp_path / "all"]) == (one, two)
    with pytest.raises(InputError, match="and no folder in it does"):
        result_folders([one, tmp_path / "all" / "empty"])


def test_every_departure_is_said_with_its_place(write_result: Write) -> None:
    folder = write_result(
        "wrong",
        verdict=7,
        parameters=[{"name": "k", "was": True, "value": 1.0, "sd": 1.0}],
        scores={"train": None, "holdout": None},
        measurement={},
    )
    with pytest.raises(InputError) as refused:
        read_result(folder)
    places = {(one.place, one.text) for one in refused.value.problems}
    assert ("verdict", "must be text") in places
    assert ("parameters[0].was", "must be a number") in places
    assert ("parameters[0].unit", "is missing") in places
    assert ("scores.train", "must be a mapping") in places
    assert ("measurement", "must be a list") in places


@pytest.mark.parametrize(
    "content", ["", "[1,", "[" * 100_000, '{"verdict": NaN}', "\ud800", "[]", "7"]
)
def test_what_is_no_diagnosis_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "diagnosis.json").write_bytes(content.encode("utf-8", "surrogatepass"))
    with pytest.raises(InputError, match=r"diagnosis\.json"):
        read_result(tmp_path)


def test_problems_of_all_results_come_at_once(write_result: Write) -> None:
    folders = [write_result("a", verdict=1), write_result("b", sentence=2)]
    with pytest.raises(InputError) as refused:
        read_results(folders)
    assert len(refused.value.problems) == 2
