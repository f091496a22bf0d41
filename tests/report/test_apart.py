"""What recordings tell apart: on the page and in diagnosis.json."""

import json
from dataclasses import replace
from importlib import resources

import jsonschema
import numpy as np
import pytest
from fakes import friction, verdict

from symhyb.discrepancy.results import Diagnosis, Isolability, Manoeuvre
from symhyb.report.apart import apart_figure, apart_sentence, odds_text
from symhyb.report.contract import to_json
from symhyb.report.page import render_page

SCHEMA = json.loads(resources.files("symhyb.report").joinpath("diagnosis.schema.json").read_text())
MATRIX = Isolability(
    ("viscous damping on x", "a delay in channel f"),
    (True, False),
    np.array([[np.nan, np.log(3), 800.0], [np.log(45), np.nan, 700.0]]),
)
PLAN = Manoeuvre(
    "x", "release", 0.02, "m", 6.0, 0.01, between=MATRIX.causes, evidence=float("inf"), beyond=True
)


@pytest.fixture
def diagnosis() -> Diagnosis:
    return replace(friction(), isolability=MATRIX, manoeuvre=PLAN)


def test_a_matrix_and_a_manoeuvre_are_valid_json(diagnosis: Diagnosis) -> None:
    content = json.loads(json.dumps(to_json(diagnosis, verdict()), allow_nan=False))
    jsonschema.validate(content, SCHEMA, jsonschema.Draft202012Validator)
    assert content["isolability"]["evidence"][0] == [None, pytest.approx(np.log(3)), 800.0]
    assert content["manoeuvre"]["frequency_hz"] is None
    assert content["manoeuvre"]["duration_s"] == 6.0


def test_without_them_there_is_null() -> None:
    content = to_json(friction(), verdict())
    jsonschema.validate(content, SCHEMA, jsonschema.Draft202012Validator)
    assert content["isolability"] is None
    assert content["manoeuvre"] is None


def test_the_page_draws_the_matrix_where_there_is_one(diagnosis: Diagnosis) -> None:
    caption = "How well these recordings distinguish causes"
    assert caption in render_page("t", diagnosis, verdict())
    assert caption not in render_page("t", friction(), verdict())
    picture = apart_figure(MATRIX).decode()
    for shade in ("#f3b6ae", "#f7e0ac", "#cfe3f3"):  # in doubt, not certain, reported
        assert shade in picture


def test_a_matrix_without_doubt_is_folded() -> None:
    reported = replace(MATRIX, evidence=np.array([[np.nan, 5.0, 800.0], [5.0, np.nan, 700.0]]))
    page = render_page("t", replace(friction(), isolability=reported), verdict())
    assert "by odds of at least 150 to 1" in page.replace("\u00a0", " ")
    assert "<summary>The odds</summary>" in page
    page = render_page("t", replace(friction(), isolability=MATRIX), verdict())
    assert "<summary>The odds</summary>" not in page


@pytest.mark.parametrize(
    ("evidence", "said"),
    [(800.0, "of more than 10⁶ to 1"), (5.0, "of at least 150 to 1"), (4.0, None)],
)
def test_odds_are_said_where_nothing_is_in_doubt(evidence: float, said: str | None) -> None:
    rows = np.array([[np.nan, evidence, 800.0], [1.0, np.nan, 2.0]])
    sentence = apart_sentence(replace(MATRIX, evidence=rows))
    assert (sentence or "").endswith(f"odds {said}.") if said else sentence is None


def test_nothing_is_reported_apart_where_nothing_was_found() -> None:
    assert apart_sentence(replace(MATRIX, found=(False, False))) is None


def test_odds_in_print() -> None:
    assert [odds_text(x) for x in (0.0, np.log(45), 800.0)] == ["1", "45", "> 10⁶"]
