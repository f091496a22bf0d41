"""Sentences of the page: scores before and after, rivals, remainder."""

import math
from collections.abc import Callable
from dataclasses import replace

import pytest

from symhyb.discrepancy.results import Alternative, Comparison, Diagnosis, Estimate, Verdict
from symhyb.model.types import On
from symhyb.report.sentences import (
    alternative_sentence,
    error_text,
    method_sentences,
    remainder_sentence,
    score_sentences,
    typeset,
)

Cases = dict[str, Callable[[], tuple[Diagnosis, Verdict]]]


def test_scores_are_said_on_unseen_recordings_in_the_unit_of_the_sensor(cases: Cases) -> None:
    windows, run, force = score_sentences(cases["missing"]()[1], {"encoder": "m"})
    assert windows == (
        "Over windows of 0.25 s on unseen recordings, the error of encoder falls from 2.4 % to "
        "0.052 % of its range (5.04 mm to 0.109 mm)."
    )
    assert run.startswith("In a free run on unseen recordings, the error of encoder falls from")
    assert force == (
        "On unseen recordings, the force left over on q falls from 7.2 % to 0.16 % of the applied "
        "force."
    )


def test_without_a_correction_there_is_no_before(cases: Cases) -> None:
    windows = score_sentences(cases["null"]()[1], {"encoder": "m"})[0]
    assert windows == (
        "Over windows of 0.25 s on the training recordings, the error of encoder is 0.4 % of its "
        "range (4 mm)."
    )


def test_what_could_not_be_computed_is_said(cases: Cases) -> None:
    verdict = cases["missing"]()[1]
    good, bad = verdict.train.after, replace(verdict.train.after, window_nrmse={"encoder": None})
    said = {
        name: score_sentences(replace(verdict, holdout=Comparison(*scores)), {})[0]
        for name, scores in (("before", (bad, good)), ("after", (good, bad)), ("both", (bad, bad)))
    }
    assert "could not be computed before the correction; after it, it is 0.04 %" in said["before"]
    assert "was 0.04 % of its range and could not be computed after" in said["after"]
    assert said["both"].endswith("the error of encoder could not be computed.")


def test_a_worse_score_is_not_called_better(cases: Cases) -> None:
    verdict = cases["missing"]()[1]
    worse = replace(verdict, holdout=Comparison(verdict.train.after, verdict.train.before))
    assert "rises from 0.04 % to 2.1 %" in score_sentences(worse, {})[0]


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (9.4e-4, "m", "0.94 mm"),
        (5.2e-5, "m", "52 µm"),
        (0.0123, "mm", "0.0123 mm"),
        (8.4e-5, "mm", "8.4·10⁻⁵ mm"),
        (0.25, "m/s^2", "0.25 m/s²"),
        (2.5e-3, "m/s^2", "2.5 mm/s²"),
        (0.004, "1", "0.004"),
        (0.0, "m", "0 m"),
        (math.nan, "m", "not known"),
        (None, "m", "not known"),
    ],
)
def test_errors_take_the_prefix_that_reads_best(value: float | None, unit: str, text: str) -> None:
    assert error_text(value, unit) == text


def test_rivals_say_what_they_replace_and_how_much_worse_they_are() -> None:
    rival = Alternative(
        "found_damper", "delay", (Estimate("t", 2e-3, 3e-4, "s", "delay"),), 0.0, channel="laser"
    )
    opening = "A delay of 2.0 ± 0.3 ms in channel laser"
    assert alternative_sentence(rival) == (
        f"{opening}, instead of found_damper: it explains the recordings equally well."
    )
    doubted = alternative_sentence(replace(rival, instead_of=None))
    assert doubted == f"{opening}: a part of what fits best, and in doubt."
    alone = replace(rival, instead_of=None, evidence=12.34)
    assert (
        alternative_sentence(alone)
        == f"{opening}: worse by 12.3 in the criterion, odds of 480 to 1 against it."
    )
    assert alternative_sentence(replace(alone, evidence=math.inf)) == f"{opening}."
    on_place = replace(alone, channel=None, place=On("x"), kind="damper", estimates=())
    assert alternative_sentence(on_place).startswith("Viscous damping on x: worse")
    both = alternative_sentence(on_place, on_place)
    assert both.startswith("Viscous damping on x and viscous damping on x together: worse")


def test_the_remainder_is_said_or_its_absence() -> None:
    none = "Over windows nothing is left of the mismatch beyond the noise."
    assert remainder_sentence(0.0) == none
    assert remainder_sentence(0.0043) == "Over windows 0.43 % of the mismatch is still unexplained."
    assert remainder_sentence(None).startswith("Nothing was claimed of which")
    assert remainder_sentence(math.nan) == remainder_sentence(None)


def test_methods_say_windows_band_and_initial_states(cases: Cases) -> None:
    verdict = cases["missing"]()[1]
    said = " ".join(method_sentences(verdict))
    assert "windows of 0.25 s" in said
    assert "low-pass at 60 Hz" in said
    assert "Initial states: fitted in every window" in said
    assert "low-pass." in " ".join(method_sentences(replace(verdict, force_band_hz=None)))


def test_units_stay_on_the_line_of_their_number() -> None:
    hard = "20.4\u00a0±\u00a00.1\u00a0N on x, 2.4\u00a0%, 3\u00a0windows"
    assert typeset("20.4 ± 0.1 N on x, 2.4 %, 3 windows") == hard.replace("3\u00a0w", "3 w")
    assert typeset("it begins at t = 3 s") == "it begins at t\u00a0=\u00a03\u00a0s"
