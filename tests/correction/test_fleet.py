"""One recording held against the others, by the values that a fit to each alone gives."""

import numpy as np
import pytest

from symhyb.correction.search.fleet import Outlier, _against, _Estimate, _Number, _numbers, widened
from symhyb.correction.search.trajectory import Refined, shared_out
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from symhyb.numeric.lowered.machine import build
from tests.rigs import spring_model


def estimate(*numbers: tuple[float, float]) -> _Estimate:
    """Values with their deviations, independent of each other."""
    return _Estimate(
        np.array([value for value, _ in numbers]), np.diag([sd**2 for _, sd in numbers])
    )


def test_numbers_that_recordings_have_of_their_own_are_compared_too_but_no_phases() -> None:
    """Two recordings: drag of each, a phase of each, and an amplitude that both share."""
    drag = Hypothesis("drag", On("x"), ("drag",), (True,), own=("drag",))
    tone = Hypothesis("harmonic", On("x"), ("sine", "cosine"), (False, False), own=("phase",))
    machine, t, nothing = build(spring_model()), np.linspace(0, 1, 5), np.zeros(0)
    runs = [Recording(name, t, {}, {}, (), "") for name in ("a", "b")]
    fit = Fit(np.zeros(5), np.eye(5), nothing, nothing.astype(int), nothing > 0, 1.0, ())
    owned = shared_out([drag, tone], runs)
    each = tuple((run, machine.values) for run in runs)
    final = Refined((drag, tone), machine, ("", "", ""), machine.values, fit, 0.0, each, owned)
    assert [*_numbers(final)] == [(1, 1, "amplitude", ""), (0, 0, "drag", "a"), (3, 0, "drag", "b")]


def test_a_number_that_differs_is_told_with_both_values() -> None:
    keys = [_Number(0, 0, "stiffness"), _Number(1, 1, "damping")]
    known = {0: estimate((2.0, 0.1), (5.0, 0.1)), 1: estimate((2.1, 0.1), (9.0, 0.1))}
    found = _against(1, known, keys, 1)
    assert found is not None
    assert (found.cause, found.key) == (1, "damping")
    assert found.value == pytest.approx((9.0, 0.1))
    assert found.others == pytest.approx((5.0, 0.1))


def test_what_differs_by_less_than_a_tenth_is_one_number() -> None:
    known = {0: estimate((5.0, 0.01)), 1: estimate((5.4, 0.01))}
    assert _against(1, known, [_Number(0, 0, "damping")], 1) is None


@pytest.mark.parametrize("other", [0.4 + 2 * np.pi, 0.4 - 4 * np.pi])
def test_whole_turns_of_a_phase_do_not_count(other: float) -> None:
    known = {0: estimate((0.4, 0.01)), 1: estimate((other, 0.01))}
    assert _against(1, known, [_Number(0, 0, "phase")], 1) is None
    assert _against(1, known, [_Number(0, 0, "stiffness")], 1) is not None


def test_a_phase_that_nothing_held_is_no_change() -> None:
    """A wave that does not act in one half has any phase there, as a fit left it."""
    known = {0: estimate((-5.2e138, 1e137)), 1: estimate((1.91, 0.05))}
    assert _against(1, known, [_Number(0, 0, "phase")], 1) is None


def test_a_phase_that_differs_is_told() -> None:
    known = {0: estimate((3.0, 0.01)), 1: estimate((-2.0, 0.01))}
    found = _against(1, known, [_Number(0, 0, "phase")], 1)
    assert found is not None
    assert found.value[0] - found.others[0] == pytest.approx(2 * np.pi - 5.0)


@pytest.mark.parametrize(
    ("first", "second", "sd"),
    [
        ((4.0, 0.1), (6.0, 0.1), 1.0),
        ((4.0, 0.1), (60.0, 9.9), 0.5656),
        ((4.0, 2.0), (4.1, 2.0), 0.5),
    ],
    ids=["alike", "one_hardly_tells", "no_wider"],
)
def test_a_number_that_changes_is_as_uncertain_as_its_halves_lie_apart(
    first: tuple[float, float], second: tuple[float, float], sd: float
) -> None:
    """w (1 − w) d² for values d apart with the weights w and 1 − w; no less than before."""
    machine = build(spring_model())
    drag = Hypothesis("drag", On("x"), ("drag",), (True,))
    nothing = np.zeros(0)
    fit = Fit(
        np.array([5.0]), np.array([[0.25]]), nothing, nothing.astype(int), nothing > 0, 1.0, ()
    )
    final = Refined((drag,), machine, ("cause0.drag",), machine.values, fit)
    found = widened(final, Outlier(1, 0, "drag", second, first, 30.0, 1e-6, 0))
    assert np.sqrt(found.fit.covariance[0, 0]) == pytest.approx(sd, rel=1e-3)
