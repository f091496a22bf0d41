"""Laws by name in the place of a curve, in one linear problem."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symhyb.correction.adequacy.curves.courses import Line, Over, fine_points, hats
from symhyb.correction.adequacy.curves.listed import listed
from symhyb.correction.adequacy.curves.points import placed
from symhyb.discrepancy.places.candidates import in_order
from symhyb.laws import LAWS
from symhyb.laws.reach import Reach
from symhyb.model.types import On

RANDOM = np.random.default_rng(6)
SEEN = 2.5 * np.sin(RANDOM.uniform(0, 2 * np.pi, 3000)) + 0.2 * RANDOM.normal(size=3000)
PLACE = On("x")


def offered(over: Over, force: np.ndarray, noise: float = 0.1) -> tuple[Any, Line]:
    """Candidates at one place, and the line of a force (N,) over SEEN; ``noise`` over its RMS."""
    other = RANDOM.normal(size=SEEN.size)
    s, r = (SEEN, other) if over == "stretch" else (other, SEEN)
    reach = Reach(s, r, force, np.linspace(0, 30, SEEN.size))
    tried = tuple(in_order(LAWS, PLACE, reach))
    library = SimpleNamespace(places=(PLACE,), hypotheses=tried)
    x = fine_points(SEEN)
    assert x is not None
    size = float(np.sqrt(np.mean(force**2)))
    left = force + noise * size * RANDOM.standard_normal(SEEN.size)
    joined = np.column_stack([-hats(SEEN, x), left]) / (noise * size)
    line = Line(0, over, x, ((joined.T @ joined, 0.0),), size)
    return SimpleNamespace(library=library, hypotheses=tried), line


@pytest.mark.parametrize(
    ("over", "force", "kind", "key", "value"),
    [
        ("rate", 2.0 * SEEN, "damper", "damping", 2.0),
        ("rate", 3.0 * np.abs(SEEN) * SEEN, "drag", "drag", 3.0),
        ("stretch", 1.5 * SEEN**3, "spring", "cubic", 1.5),
        ("stretch", np.full(SEEN.size, 0.7), "constant", "constant", -0.7),
    ],
)
def test_a_law_by_name_comes_first(
    over: Over, force: np.ndarray, kind: str, key: str, value: float
) -> None:
    recorded, line = offered(over, force)
    best = listed(recorded, line)[0]
    assert [cause.kind for cause in best.causes] == [kind]
    assert best.rows[0][key] == pytest.approx(value, rel=0.03)


def test_two_laws_together_are_found() -> None:
    recorded, line = offered("rate", 2.0 * SEEN + 1.5 * np.abs(SEEN) * SEEN)
    best = listed(recorded, line)[0]
    assert {cause.kind for cause in best.causes} == {"damper", "drag"}


def test_a_law_of_the_other_quantity_is_not_offered() -> None:
    recorded, line = offered("stretch", SEEN)
    kinds = {cause.kind for one in listed(recorded, line) for cause in one.causes}
    assert "spring" in kinds
    assert not kinds & {"damper", "drag", "friction", "added_mass", "relaxation"}


def test_what_physics_forbids_is_not_offered() -> None:
    recorded, line = offered("rate", -2.0 * SEEN)
    assert all(row.get("damping", 1.0) >= 0 for one in listed(recorded, line) for row in one.rows)


def test_a_force_of_the_rate_that_comes_and_goes_is_worth_more_as_a_curve() -> None:
    force = np.sin(1.5 * SEEN)
    recorded, line = offered("rate", force, noise=0.03)
    assert placed(line).worth > listed(recorded, line)[0].worth + 50
