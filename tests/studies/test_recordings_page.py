"""docs/recordings.md: it is what its results say, and says so where there are none."""

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest
from fakes import Fake, fake_diagnosis, friction

from symhyb.study.published import Published, Reference
from symhyb.study.run import run_study
from tests.scripts import scripts

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def page() -> Iterator[ModuleType]:
    """The script that writes the page, with ``page.kept``, ``page.words`` and ``page.picture``."""
    with scripts("recordings", ("page", "kept", "words", "picture")) as found:
        found["page"].__dict__.update(found)
        yield found["page"]


@pytest.fixture
def fake(monkeypatch: pytest.MonkeyPatch) -> Fake:
    return fake_diagnosis(monkeypatch)


def test_the_page_is_what_its_results_say(page: ModuleType) -> None:
    text = page.page_text(page.cases())
    assert page.PAGE.read_text(encoding="utf-8") == text, (
        "run: python studies/recordings/page.py --docs"
    )


def test_every_result_belongs_to_a_study_and_has_a_picture(page: ModuleType) -> None:
    run = {case.name for case in page.cases() if case.kept is not None}
    assert {"bowling_ball", "emps", "friction_damper"} <= run
    assert {file.stem for file in page.RESULTS.glob("*.json")} == run
    for name in run:
        picture = page.DOCS / f"recordings-{name}.png"
        assert picture.read_bytes().startswith(b"\x89PNG")
        assert picture.stat().st_size < page.LARGEST


def test_every_number_that_was_found_stands_beside_the_published_one(page: ModuleType) -> None:
    text = page.PAGE.read_text(encoding="utf-8")
    (emps,) = (case for case in page.cases() if case.name == "emps")
    (found,) = re.findall(r"`x\.coulomb` \(Fc\) \| ([\d.]+) ± ([\d.]+) N \| 20\.3935 N", text)
    (effect,) = (one for one in emps.kept["found"] if one["kind"] == "friction")
    (number,) = (one for one in effect["parameters"].values() if one["term"] == "coulomb")
    assert float(found[0]) == pytest.approx(number["value"], rel=5e-3)
    assert float(found[1]) == pytest.approx(number["sd"], rel=0.15)
    assert abs(float(found[0]) / 20.3935 - 1) < 0.05


def test_a_study_without_a_result_was_not_run(page: ModuleType, tmp_path: Path) -> None:
    cases = page.cases(results=tmp_path)
    text = page.page_text(cases, tmp_path)
    assert text.count("| not run |") == text.count("\nNot run.") == len(cases) >= 3
    assert "Published" not in text.split("# EMPS")[0]
    assert ".png" not in text


def test_a_study_that_has_changed_since_is_called_older(page: ModuleType) -> None:
    (case,) = (case for case in page.cases() if case.name == "emps")
    before = {**case.kept, "model": {"file": "emps.toml", "sha256": "0" * 64}}
    assert page.page_text([replace(case, kept=before)]).count("**Older than its study file") == 1


def test_a_result_is_kept_and_drawn(page: ModuleType, fake: Fake, tmp_path: Path) -> None:
    fake(friction(0.4876543219))
    file = ROOT / "studies" / "null" / "study.toml"
    result = run_study(file, tmp_path / "out")
    path = page.keep("null", result, 12.34, 0.0, tmp_path)
    kept = json.loads(path.read_text(encoding="utf-8"))
    assert kept["found"][0]["parameters"]["F_c"]["value"] == 0.487654
    assert (kept["cpu_seconds"], kept["verdict"]) == (12.3, "missing physics")
    assert str(ROOT) not in path.read_text(encoding="utf-8")
    page.draw(result, tmp_path / "recordings-null.png")
    assert (tmp_path / "recordings-null.png").stat().st_size < page.LARGEST
    said = Published(
        "somebody",
        "",
        {
            "q.coulomb": Reference(491.0, "mN", 5.0, "Fc"),
            "q.drag": Reference(0.8, "N*s^2/m^2"),
        },
        {"holdout.after.window_rmse.speed": Reference(1.0, "mm/s")},
    )
    study = page.kept.read_study(file)
    expected = replace(page.kept.Expected(), published=said)
    text = page.page_text([page.Case("null", study, expected, kept)], tmp_path)
    assert "| `q.coulomb` (Fc) | 488 ± 6 mN | 491 ± 5 mN | −0.7 %, 0.4 sd |" in text
    assert "| `q.drag` | – | 0.8 N·s²/m² | not found |" in text
    assert re.search(r"speed, windows of 0\.5 s \| 0\.05 m/s \| 0\.0074 m/s \| 1 mm/s", text)
    assert "offset of f" in text
    assert "expectations are not met:** verdict: missing physics, expected nothing" in text
    assert "](recordings-null.png)" in text


def test_figures_of_a_study_s_own_script_stand_in_a_table(page: ModuleType, tmp_path: Path) -> None:
    (case,) = (case for case in page.cases() if case.name == "bowling_ball")
    file = tmp_path / "study.toml"
    file.write_text(case.file.read_text(encoding="utf-8"))
    rows = {"multisine": {"as given": 6.96, "named": 0.322}, "arrow": {"as given": 14.4}}
    figures = {"about": "simulation, RMSE", "by": "scores.py", "unit": "mV", "rows": rows}
    (tmp_path / "scores.json").write_text(json.dumps(figures))
    said = Published("somebody", "", {}, {"multisine": Reference(0.36, "mV", None, "best")})
    expected = replace(case.expected, published=said)
    study = replace(case.study, file=file)
    text = page.page_text([replace(case, study=study, expected=expected)], tmp_path)
    assert "| simulation, RMSE | as given | named | published |\n|---|---|---|---|\n" in text
    assert "| multisine | 6.96 mV | 0.322 mV | 0.36 mV (best) |" in text
    assert "| arrow | 14.4 mV | – | – |" in text


def test_a_published_number_in_another_unit_must_measure_the_same(page: ModuleType) -> None:
    with pytest.raises(ValueError, match="published in N, but found in m"):
        page.words._converted({"value": 1.0, "sd": 0.1, "unit": "m"}, "N")
