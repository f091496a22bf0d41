"""What acts beyond a structure, in the sentence of a diagnosis."""

from types import SimpleNamespace

import numpy as np
import pytest

from symhyb.correction.adequacy.beyond import Beyond
from symhyb.correction.verdict.conclusion import _amounts, _noise_beside
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


@pytest.mark.parametrize(("acts", "known"), [(False, [0.05, 1.0]), (True, [0.4, 1.0])])
def test_noise_is_what_an_adequate_structure_leaves_where_smoothing_took_motion_for_noise(
    acts: bool, known: list[float]
) -> None:
    """Of the first sensor that is an eighth, of the second more than half."""
    noise = SimpleNamespace(white=np.array([0.03, 0.6]), colour=np.array([0.04, 0.0]))
    beside = SimpleNamespace(fit=SimpleNamespace(noise=noise))
    judged = SimpleNamespace(adequate=not acts, structure=beside)
    found = _noise_beside(judged, np.array([0.4, 1.0]))  # type: ignore[arg-type]
    assert found == pytest.approx(known)
