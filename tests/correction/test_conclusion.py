"""What acts beyond a structure, in the sentence of a diagnosis."""

import numpy as np
import pytest

from symhyb.correction.adequacy.beyond import Beyond
from symhyb.correction.verdict.conclusion import _amounts
from tests.builders import model_of


@pytest.mark.parametrize(
    ("share", "said"),
    [
        (0.135, "2.5 N RMS on x (14 % of what moves it)"),
        (250.0, "2.5 N RMS on x (more than what moves it)"),
        (1e-5, ""),
    ],
)
def test_an_unknown_force_is_told_beside_what_moves_the_coordinate(share: float, said: str) -> None:
    """By a model that lacks most of an inertia, next to nothing moves what has it."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        energy={"kinetic": "m*x'**2/2"},
        sensors={"y": {"measures": "x", "unit": "m"}},
    )
    beyond = Beyond(np.array([2.5]), np.array([share]), 0.1, 50.0)
    assert _amounts(model, beyond) == said
