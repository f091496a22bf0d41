"""What is said of the scores."""

import pytest

from symhyb.discrepancy.fitting.judge import _carries
from symhyb.discrepancy.results import Comparison, Score


def scored(window: float) -> Score:
    one = {"q": window}
    return Score(one, one, one, one, one, one)


@pytest.mark.parametrize(
    ("after", "said"), [(0.002, "falls from 1 % to 0.2 %"), (0.02, "rises from 1 % to 2 %")]
)
def test_a_correction_that_makes_it_worse_is_not_said_to_help(after: float, said: str) -> None:
    sentence = _carries(Comparison(scored(0.01), scored(after)), 0.5, True, False)
    assert f"On unseen recordings the window NRMSE {said}." in sentence
