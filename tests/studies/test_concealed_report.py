"""The reports of the bench: bounds, bars, tables, the file they come from; runs of its subset."""

import argparse
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from scipy.stats import binom

from tests.concealed_bench import Study, answer_of, modules, reported, run


@pytest.fixture(scope="module")
def study() -> Iterator[Study]:
    """The modules of the bench."""
    with modules() as found:
        yield found


def rows_of(study: Study) -> tuple[Any, ...]:
    """A hit, a refusal, a wrong name and a null case with a wrong claim."""
    score = study["claims"].score_case
    hit = score("00002-duffing", reported("drag", "x", "drag", 0.81, 0.01), answer_of(), 1)
    nothing = reported("drag", "x", "drag", 0.8, 0.01)
    nothing["diagnosis"] |= {"found": [], "verdict": "nothing missing"}
    refusal = score("00034-duffing", nothing, answer_of(), 1)
    wrong = score("00066-duffing", reported("damper", "x", "damping", 0.8, 0.01), answer_of(), 1)
    alarm = reported("drag", "x", "drag", 0.8, 0.01) | {"cpu_seconds": 2.0}
    null = score("00003-duffing", alarm, answer_of(effects=[], kind="null.white"), 1)
    return replace(hit, error=1.02), refusal, wrong, null


def test_the_bound_is_where_so_few_have_a_probability_of_five_percent(study: Study) -> None:
    bound = study["bars"].bound
    assert bound(0, 300) == pytest.approx(1 - 0.05 ** (1 / 300), rel=1e-9)
    assert bound(0, 300) < 0.01 < bound(1, 300)
    assert binom.cdf(3, 120, bound(3, 120)) == pytest.approx(0.05, rel=1e-6)
    assert bound(7, 7) == 1.0


def test_bars_pass_and_fail(study: Study) -> None:
    hit, refusal, wrong, null = rows_of(study)
    bars = study["bars"].bars
    good = bars([hit] * 20)
    assert "| name, 1 % noise | ≥ 95% | 100.0% (20 of 20) | pass |" in good
    assert "median, 1 % noise | ≤ 1.1 | 1.020 (20 of 20 within) | pass |" in good
    assert "wrong claims on null cases, all noise | ≤ 1 % | – | not measured" in good
    bad = bars([hit, refusal, wrong, wrong, null])
    assert "| name, 1 % noise | ≥ 95% | 25.0% (1 of 4) | fail |" in bad
    assert "| a miss is a refusal, all noise | ≥ 80% | 33.3% (1 of 3) | fail |" in bad
    partly = replace(refusal, wanted=2, name=1, hits=(2, 0))
    assert "| a miss is a refusal, all noise | ≥ 80% | 50.0% (1 of 2) |" in bars([refusal, partly])
    assert "1 of 1, at most 100.0% (95 %) | fail" in bad
    quiet = replace(null, wrong=())
    assert "too few cases" in bars([quiet] * 299)
    assert "0 of 300, at most 1.0% (95 %) | pass" in bars([quiet] * 300)


def test_scored_cases_come_back_from_their_file(study: Study, tmp_path: Path) -> None:
    rows, results = rows_of(study), study["results"]
    peer = tuple(replace(row, cpu=0.1, fit=0.5, wrong=()) for row in rows)
    scored = results.Scored("2-3", rows, {"deltaf": peer}, 4, 1, {"commits": ["abc"]})
    path = tmp_path / "set.json"
    results.write(path, scored)
    assert len(path.read_text().splitlines()[-6:]) == 6
    again = results.read(path)
    assert again.rows == rows
    assert (again.discarded, again.given_up, again.about) == (4, 1, {"commits": ["abc"]})
    assert [row.name for row in again.peers["deltaf"]] == [row.name for row in rows]
    assert study["report"].section(again) == study["report"].section(scored)


def test_a_file_without_the_newer_columns_is_read(study: Study, tmp_path: Path) -> None:
    rows, results = rows_of(study), study["results"]
    path = tmp_path / "set.json"
    results.write(path, results.Scored("2-3", rows, {"deltaf": rows}))
    whole = json.loads(path.read_text())
    count = len(whole["columns"])
    assert whole["columns"][-2:] == ["may_refuse", "hardship"]
    whole["columns"] = whole["columns"][:-2]
    whole["cases"] = [line[: count - 2] + line[count:] for line in whole["cases"]]
    path.write_text(json.dumps(whole))
    assert results.read(path).rows == rows


def test_incomplete_draws_are_counted_apart(study: Study) -> None:
    hit, refusal, wrong, null = rows_of(study)
    hard = tuple(replace(row, may_refuse=True) for row in (refusal, wrong))
    results, report = study["results"], study["report"]
    peers = {"deltaf": (hit, null, *hard)}
    text = report.section(results.Scored("2-3", (hit, null, *hard), peers))
    assert "| name, 1 % noise | ≥ 95% | 100.0% (1 of 1) | pass |" in text
    assert (
        "Of 2 draws that are not complete and may be refused 1 were refused, 1 had a wrong claim, "
        "and in 0 some or all of what is concealed was named and nothing else; 0 were complete."
    ) in text
    assert "What may be refused" not in report.section(results.Scored("2-3", (hit, null)))


def test_harder_recordings_have_a_table_of_their_own(study: Study) -> None:
    score, results = study["claims"].score_case, study["results"]
    said = reported("drag", "x", "drag", 0.81, 0.01)
    row = score("00002-duffing", said, answer_of(hardship={"sort": "held"}), 1)
    assert row.hardship == "held"
    text = study["report"].section(results.Scored("2", (row,)))
    assert "| held | 1 | 100 % | 100 % | 100 % |" in text


def test_a_picture_is_drawn_of_the_same_rows(study: Study, tmp_path: Path) -> None:
    rows, figure = rows_of(study), study["figure"]
    hidden = [row for row in rows if row.wanted]
    middle, spread, count = figure.rates(hidden)
    assert count == [0, 0, 0, 0, 3, 0]
    assert middle[4] == pytest.approx(1 / 3)
    low, high = spread[4]
    assert binom.sf(0, 3, low) == pytest.approx(0.05)
    assert binom.cdf(1, 3, high) == pytest.approx(0.05)
    peer = tuple(replace(row, cpu=0.1, wrong=()) for row in rows)
    study["results"].write(
        tmp_path / "set.json", study["results"].Scored("2", rows, {"weak": peer})
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(
            "sys.argv",
            [
                "figure.py",
                "--of",
                "set",
                "--from",
                str(tmp_path),
                "-o",
                str(tmp_path / "picture.png"),
            ],
        )
        figure.main()
    assert (tmp_path / "picture.png").stat().st_size > 10_000


def test_tables_count_by_effect_size_and_say_how_misses_end(study: Study) -> None:
    rows, tables = rows_of(study), study["tables"]
    hidden = [row for row in rows if row.wanted]
    partly = replace(hidden[1], wanted=2, name=1, hits=(2, 0))
    assert tables.refusals([*hidden, partly]) == (
        "Of 3 cases in which a concealed cause was not named 1 were refused, 1 named another "
        "concealed cause and nothing else, and 1 had a wrong claim."
    )
    faint = replace(hidden[1], shares=(0.02,))
    text = tables.detection([hidden[0], faint, hidden[2]], {})
    assert "| 1 to 3 % | 1 | 0 % | 0 % |" in text
    assert "| 10 to 30 % | 2 | 100 % | 50 % |" in text
    assert "| null.white | 1 | 1 | 100.0 % | missing physics 1 |" in tables.nothing(rows[3:])
    assert "| 1 % | 3 | 67 % | 33 % | 33 % | 33 % | 33 % |" in tables.table(
        hidden, "noise", tables.by_noise
    )


def test_the_page_holds_what_the_files_say(study: Study) -> None:
    """Nothing in the section of results is typed by hand."""
    report = study["report"]
    page = report.DOCS.read_text(encoding="utf-8")
    assert report.between_marks(page, report.docs_text()) == page


def test_runs_choose_by_counts_and_turns(study: Study, tmp_path: Path) -> None:
    options = argparse.Namespace(
        seeds="0-199",
        systems="",
        kinds="",
        concealed=5,
        nulls=3,
        turns="1,1,1",
        limit=0,
        output=tmp_path,
        results=tmp_path,
    )
    wanted = study["run"].wanted
    assert wanted(options) == [0, 1, 2, 3, 4, 5, 6, 8]
    given_up = study["plans"].folder_of(2, tmp_path)
    given_up.mkdir()
    (given_up / "discarded.json").write_text("{}")
    assert wanted(options) == [0, 1, 3, 4, 5, 6, 8, 10]
    options.turns, options.nulls, options.concealed = "1,0.5,0.25", None, 0
    names = [study["plans"].plan_of(seed).system.name for seed in wanted(options)]
    assert (names.count("sled"), names.count("table"), names.count("six_masses")) == (6, 3, 1)
    (tmp_path / f"{study['plans'].folder_of(1, tmp_path).name}.json").write_text("{}")
    assert study["run"].waiting(options) == wanted(options)[1:]


@pytest.mark.slow
def test_tiny_cases_are_drawn_diagnosed_and_scored(
    study: Study, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Ripple in a rig that runs for 5 s, and the same rig with nothing concealed."""
    short = tuple(replace(system, duration=5.0) for system in study["plans"].SYSTEMS)
    monkeypatch.setattr(study["plans"], "SYSTEMS", short)
    scored = run(study, (10, 11), tmp_path)
    hidden, null = scored.rows
    assert (hidden.kind, null.wanted) == ("ripple", 0)
    assert hidden.structure
    assert not null.wrong
    assert hidden.cpu > 0
    said = json.loads((tmp_path / "results" / "00010-rig.json").read_text())
    assert len(said["commit"]) >= 7
    assert "ripple" in study["report"].section(scored)


def simple(study: Study) -> list[int]:
    """Development seeds of machines with one coordinate and at most 1 % noise."""
    plan_of = study["plans"].plan_of
    return [s for s in range(200) if plan_of(s).system.n == 1 and plan_of(s).noise <= 0.01]


@pytest.mark.thorough
def test_concealed_cases_of_the_subset_are_named(study: Study, tmp_path: Path) -> None:
    """The first five of the simple seeds with one concealed force that is not masked."""
    plan_of, forces = study["plans"].plan_of, study["effects"].FORCES
    single = [s for s in simple(study) if plan_of(s).kind in forces and not plan_of(s).masked]
    scored = run(study, single[:5], tmp_path)
    assert len(scored.rows) >= 4
    missed = [(row.case, row.missed) for row in scored.rows if row.missed]
    assert len(missed) <= 1, missed
    assert sum(bool(row.wrong) for row in scored.rows) <= 1, [row.wrong for row in scored.rows]


@pytest.mark.slow
def test_nothing_is_claimed_on_null_cases_of_the_subset(study: Study, tmp_path: Path) -> None:
    """The first five of the simple seeds with nothing concealed."""
    scored = run(study, [s for s in simple(study) if s % 2][:5], tmp_path)
    assert len(scored.rows) == 5
    assert [(row.case, row.wrong) for row in scored.rows if row.wrong] == []
    assert [row.failed for row in scored.rows if row.failed] == []
