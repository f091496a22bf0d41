"""What is said of the scores."""

import pytest

from symhyb.discrepancy.fitting.judge import _carries
from symhyb.discrepancy.results import Comparison, Score


def scored(window: float, free: float = 0.5, other: float = 0.001) -> Score:
    windows, runs = {"p": other, "q": window}, {"p": other, "q": free}
    return Score(windows, windows, windows, windows, runs, runs)


@pytest.mark.parametrize(
    ("after", "said"), [(0.002, "falls from 1 % to 0.2 %"), (0.02, "rises from 1 % to 2 %")]
)
def test_a_correction_that_makes_it_worse_is_not_said_to_help(after: float, said: str) -> None:
    sentence = _carries(Comparison(scored(0.01), scored(after)), 0.5, True, False)
    assert sentence.startswith("On unseen recordings the error of q over windows of 0.5 s")
    assert f" {said} of its range, in a free run" in sentence


def test_the_sentence_is_of_the_sensor_that_changes_most_and_of_its_free_run_too() -> None:
    change = Comparison(scored(0.056, 0.67), scored(0.0074, 0.0075, 0.002))
    sentence = _carries(change, 0.7, False, False)
    assert "of q over" in sentence
    assert "falls from 5.6 % to 0.74 % of its range, in a free run falls from 67 %" in sentence
    assert "no unseen one was given" in sentence
    unchanged = _carries(Comparison(scored(0.01), scored(0.01)), 0.7, True, True)
    assert "is 1 % of its range, in a free run is 50 %." in unchanged
