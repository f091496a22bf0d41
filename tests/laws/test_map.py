"""The law of a map: its force, its sign and what it stores."""

import numpy as np
import pytest

from symhyb.laws.map import LAW
from symhyb.laws.maths import NUMPY, Action, Motion
from symhyb.laws.surface import bilinear

S, R = [-0.1, 0.0, 0.2], [-1.0, 0.0, 2.0]
F = [[-3.0, -1.0, 1.0], [-2.0, 0.0, 4.0], [-5.0, 2.0, 9.0]]
MAP = bilinear("m", S, R, F)


def does(s: float, r: float, **values: float) -> Action:
    assert LAW.action is not None
    return LAW.action(NUMPY, Motion(s, r, (), 0.0), {"map": MAP, **values}, {})


@pytest.mark.parametrize(("i", "j"), [(0, 0), (1, 1), (2, 0), (0, 2), (2, 2)])
def test_rows_are_over_the_stretch_and_columns_over_the_rate(i: int, j: int) -> None:
    assert float(does(S[i], R[j]).force) == pytest.approx(F[i][j])
    assert float(does(S[i], R[j], scale=-2.0).force) == pytest.approx(-2 * F[i][j])


def test_it_resists_and_stores_nothing() -> None:
    assert LAW.passive
    assert does(0.1, 0.5).stored == 0
    assert np.asarray(does(0.1, 0.5).mass) == 0


def test_it_is_written_with_its_factor_where_that_is_set() -> None:
    assert LAW.text(["scale"], {}) == "scale*map(s, s')"
    assert LAW.text([], {}) == "map(s, s')"
