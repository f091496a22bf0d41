"""Laws by name in the place of a curve, in one linear problem."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symhyb.correction.adequacy.curves.courses import Form, Line, fine_points, hats
from symhyb.correction.adequacy.curves.listed import listed
from symhyb.correction.adequacy.curves.points import placed
from symhyb.discrepancy.places.candidates import in_order
from symhyb.laws import LAWS
from symhyb.laws.reach import Reach
from symhyb.model.types import On

RANDOM = np.random.default_rng(6)
SEEN = 2.5 * np.sin(RANDOM.uniform(0, 2 * np.pi, 3000)) + 0.2 * RANDOM.normal(size=3000)
PLACE = On("x")


STRETCH, RATE, DAMPING, DRAG = (
    Form("stretch"),
    Form("rate"),
    Form("stretch", "rate"),
    Form("stretch", "square"),
)


def offered(form: Form, values: np.ndarray, noise: float = 0.1) -> tuple[Any, Line]:
    """Candidates at one place, and the line of a curve (N,) over SEEN; ``noise`` over the RMS of
    its force."""
    other = RANDOM.normal(size=SEEN.size)
    s, r = (other, SEEN) if form == RATE else (SEEN, other)
    factor = form.factor(r)
    force = factor * values
    reach = Reach(s, r, force, np.linspace(0, 30, SEEN.size))
    tried = tuple(in_order(LAWS, PLACE, reach))
    library = SimpleNamespace(places=(PLACE,), hypotheses=tried)
    x = fine_points(SEEN)
    assert x is not None
    size = float(np.sqrt(np.mean(force**2)))
    left = force + noise * size * RANDOM.standard_normal(SEEN.size)
    joined = np.column_stack([-factor[:, None] * hats(SEEN, x), left]) / (noise * size)
    usual = float(np.sqrt(np.mean(factor**2)))
    line = Line(0, form, x, ((joined.T @ joined, 0.0),), size / usual, float(np.abs(r).max()))
    return SimpleNamespace(library=library, hypotheses=tried), line


@pytest.mark.parametrize(
    ("form", "values", "kind", "key", "value"),
    [
        (RATE, 2.0 * SEEN, "damper", "damping", 2.0),
        (RATE, 3.0 * np.abs(SEEN) * SEEN, "drag", "drag", 3.0),
        (STRETCH, 1.5 * SEEN**3, "spring", "cubic", 1.5),
        (STRETCH, np.full(SEEN.size, 0.7), "constant", "constant", -0.7),
        (DAMPING, np.full(SEEN.size, 0.7), "damper", "damping", 0.7),
        (DRAG, np.full(SEEN.size, 0.7), "drag", "drag", 0.7),
    ],
)
def test_a_law_by_name_comes_first(
    form: Form, values: np.ndarray, kind: str, key: str, value: float
) -> None:
    recorded, line = offered(form, values)
    best = listed(recorded, line)[0]
    assert [cause.kind for cause in best.causes] == [kind]
    assert best.rows[0][key] == pytest.approx(value, rel=0.03)


def test_two_laws_together_are_found() -> None:
    recorded, line = offered(RATE, 2.0 * SEEN + 1.5 * np.abs(SEEN) * SEEN)
    best = listed(recorded, line)[0]
    assert {cause.kind for cause in best.causes} == {"damper", "drag"}


def test_a_law_of_the_other_quantity_is_not_offered() -> None:
    recorded, line = offered(STRETCH, SEEN)
    kinds = {cause.kind for one in listed(recorded, line) for cause in one.causes}
    assert "spring" in kinds
    assert not kinds & {"damper", "drag", "friction", "added_mass", "relaxation"}


def test_beside_damping_that_changes_with_place_no_spring_is_offered() -> None:
    recorded, line = offered(DAMPING, 1.0 + SEEN**2)
    kinds = {cause.kind for one in listed(recorded, line) for cause in one.causes}
    assert kinds == {"damper"}


def test_what_physics_forbids_is_not_offered() -> None:
    recorded, line = offered(RATE, -2.0 * SEEN)
    assert all(row.get("damping", 1.0) >= 0 for one in listed(recorded, line) for row in one.rows)


def test_a_force_of_the_rate_that_comes_and_goes_is_worth_more_as_a_curve() -> None:
    force = np.sin(1.5 * SEEN)
    recorded, line = offered(RATE, force, noise=0.03)
    assert placed(line).worth > listed(recorded, line)[0].worth + 50


def test_a_bent_law_is_a_set_by_itself() -> None:
    recorded, line = offered(RATE, 2.0 * SEEN / (1 + SEEN**2) + 0.5 * np.sign(SEEN))
    sets = [one.causes for one in listed(recorded, line)]
    assert any(cause.bent for causes in sets for cause in causes)
    assert all(len(causes) == 1 for causes in sets if any(cause.bent for cause in causes))
