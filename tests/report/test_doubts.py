"""What a sceptic reads: headline, worth, whiteness, trade-offs."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from symhyb.discrepancy.evidence import Correlations, Whiteness, Without, Worth
from symhyb.discrepancy.posterior import Posterior
from symhyb.discrepancy.results import Comparison, Diagnosis, Score, Verdict
from symhyb.report import render_page, to_json
from symhyb.report.doubts import correlations_sentence, whiteness_sentences
from symhyb.report.worth import certainty, headline, pair_text, worth_sentence

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]
LAGS = np.arange(-5, 6) * 0.1
BOUNDS = {"": np.full(11, 0.1), "f": np.full(11, 0.1)}


def white(itself: float, with_input: float) -> Whiteness:
    auto, cross = np.zeros(11), np.zeros(11)
    auto[5], auto[7], auto[3] = 1.0, itself, itself
    cross[2] = with_input
    return Whiteness("a.csv", "laser", LAGS, auto, {"f": cross}, BOUNDS)


@pytest.mark.parametrize(
    ("itself", "with_input", "said"),
    [
        (0.11, -0.11, "are as white as noise and independent of f."),
        (0.4, 0.0, "are correlated in time (at most 0.4) and independent of f."),
        (0.0, -0.3, "are as white as noise and correlated with f (at most −0.3)."),
    ],
)
def test_one_value_just_beyond_its_bound_is_no_structure(
    itself: float, with_input: float, said: str
) -> None:
    (sentence,) = whiteness_sentences([white(itself, with_input)])
    assert sentence == f"The residuals of laser {said}"


def scores(window: float, free: float) -> Score:
    return Score({}, {}, {"s": window}, {"s": window}, {"s": free}, {"s": free})


def test_the_headline_is_of_the_score_that_changes_most(cases: Cases) -> None:
    _, verdict = cases["missing"]()
    told = replace(
        verdict, holdout=Comparison(scores(0.012, 5.66), scores(0.011, 0.06)), train=verdict.train
    )
    assert headline(told, {"s": "m"}) == (
        "On unseen recordings the error of s falls from 5.66 m to 0.06 m in a free run from start "
        "to end and falls from 12 mm to 11 mm over short windows."
    )
    worse = replace(verdict, holdout=Comparison(scores(0.01, 0.2), scores(0.001, 0.4)))
    assert "falls from 10 mm to 1 mm over short windows" in headline(worse, {"s": "m"})
    assert "rises from 0.2 m to 0.4 m in a free run" in headline(worse, {"s": "m"})
    assert headline(cases["null"]()[1], {}) == ""
    assert headline(cases["failed"]()[1], {}) == ""


def test_errors_are_told_in_one_unit() -> None:
    assert pair_text(2.21, 0.025, "m/s") == ("2.21 m/s", "0.025 m/s")
    assert pair_text(3e-5, 1e-3, "m") == ("0.03 mm", "1 mm")


def test_what_an_effect_is_worth_is_said_in_quantities_that_one_weighs(cases: Cases) -> None:
    diagnosis, verdict = cases["missing"]()
    effect = replace(diagnosis.found[0], worth=Worth(0.3, 0.029))
    name = effect.element.name
    after = (verdict.holdout or verdict.train).after.free_run_rmse["encoder"] or 0.0
    told = replace(verdict, without=(Without(name, {"encoder": 50 * after}),))
    said = worth_sentence(effect, told, {"encoder": "mm"})
    assert "It takes 30 % of the energy that all elements dissipate" in said
    assert "its peak is 2.9 % of the largest force that acts on q" in said
    assert "without it a free run misses encoder by " in said
    same = replace(verdict, without=(Without(name, {"encoder": after, "other": None}),))
    assert "misses" not in worth_sentence(effect, same, {})
    assert worth_sentence(replace(effect, worth=None), verdict, {}) == ""


def test_the_probability_is_of_the_least_probable(cases: Cases) -> None:
    diagnosis, _ = cases["missing"]()
    found = [
        replace(one, probability=chance)
        for one, chance in zip(diagnosis.found, (0.999999, 0.97), strict=False)
    ]
    assert "at least 97 %" in certainty(replace(diagnosis, found=tuple(found)))
    assert "more than 99.9 %" in certainty(replace(diagnosis, found=tuple(found[:1])))
    assert certainty(cases["null"]()[0]) == ""


def test_numbers_that_trade_off_are_told_drawn_and_kept(cases: Cases) -> None:
    known = Correlations(
        ("a.b", "k", "<m>"), np.array([[1, 0.2, 0], [0.2, 1, -0.97], [0, -0.97, 1]])
    )
    assert correlations_sentence(known) == (
        "The most correlated are <m> and k, with −0.97: these recordings hardly determine them "
        "apart."
    )
    diagnosis, verdict = cases["missing"]()
    joint = Posterior(known.names, np.ones(3), known.matrix, ("1",) * 3, known.names)
    diagnosis = replace(diagnosis, posterior=joint)
    verdict = replace(verdict, whiteness=(white(0.4, 0.0),))
    page = render_page("t", diagnosis, verdict)
    assert "How the fitted numbers trade off" in page
    assert "Is what is left noise?" in page
    assert "&lt;m&gt;" in page
    content = to_json(diagnosis, verdict)
    assert content["correlations"] == {"names": [*known.names], "matrix": known.matrix.tolist()}
    (entry,) = content["whiteness"]
    assert entry["itself"] == {"largest": 0.4, "noise": False}
    assert entry["inputs"]["f"]["noise"] is True
