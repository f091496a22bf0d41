"""Curves along windows: their values, whether they stand out, and when a choice with one holds."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symhyb.correction.adequacy.agreement import disputed
from symhyb.correction.adequacy.beyond import NOTHING
from symhyb.correction.adequacy.curves.fitted_curve import restated, values_of
from symhyb.correction.adequacy.explained import Decided
from symhyb.correction.adequacy.judge import Adequacy, _is_curve
from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.score import standing, weak, weak_together
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.correction.verdict.in_place_of_class import holds
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.laws.curve import value_name
from symhyb.model.types import On
from tests.pushed import pushed, pushed_model

PLACE = On("x")
SPEEDS = (-1.5, -0.5, 0.0, 0.5, 1.5)


def curve(slope: float) -> Hypothesis:
    points = tuple((v, slope * v, 0.0) for v in SPEEDS)
    terms = tuple(map(value_name, range(len(points))))
    options = (("over", "rate"),)
    return Hypothesis("curve", PLACE, terms, (False,) * 5, options=options, points=points)


def fitted(more: float, begin: float) -> Refined:
    """A curve over the rate fitted to a machine with so much more damping, N·s/m."""
    prepared = prepare(pushed_model(), pushed(3, samples=800, damping=0.6 + more))
    setting = settle(prepared)
    cause = curve(begin)
    cuts = setting.stages[-1].cuts
    return refine(prepared.model, (cause,), [values_of(cause)], cuts, setting.sd)


def test_values_are_fitted_to_windows_and_stand_out_together() -> None:
    found = fitted(0.8, 0.5)
    spread = np.sqrt(np.diag(found.fit.covariance))
    assert np.all(np.abs(found.fit.values - 0.8 * np.array(SPEEDS)) < 4 * spread)
    assert abs(found.fit.values[2]) < 3 * spread[2]  # the one at rest does not, by itself
    assert weak(found) == ()
    assert standing(found, 0) > 1000
    trial: Any = replace_extra(found)
    assert disputed(found, [trial]) == ()


def test_without_a_force_its_values_do_not_stand_out() -> None:
    found = fitted(0.0, 0.1)
    assert weak(found) == weak_together(found) == (0,)
    assert standing(found, 0) < 30


def test_a_curve_is_stated_again_at_its_points() -> None:
    again = restated(curve(1.0), {value_name(i): float(i) for i in range(5)})
    assert [x for x, _, _ in again.points] == list(SPEEDS)
    assert values_of(again) == {value_name(i): float(i) for i in range(5)}


def replace_extra(found: Refined) -> Any:
    """A structure as another estimator has it, without a class."""
    return SimpleNamespace(causes=found.causes, fit=found.fit, extra=None)


def generic(kind: Any) -> Generic:
    return Generic(kind, PLACE, (), np.ones(1))


def test_a_force_of_stretch_and_rate_is_no_rival_of_a_curve_there() -> None:
    assert _is_curve(generic("law"), [curve(1.0)])
    assert not _is_curve(generic("hidden mode"), [curve(1.0)])
    assert not _is_curve(generic("law"), [Hypothesis("drag", PLACE, ("drag",), (True,))])


def test_a_choice_with_a_curve_holds_where_nothing_of_it_is_in_doubt() -> None:
    before = Adequacy(NOTHING, (Likely(generic("law"), 0.99),))
    choice: Any = SimpleNamespace(
        decision=SimpleNamespace(selected=SimpleNamespace(causes=(curve(1.0),)))
    )
    assert holds(choice, Adequacy(NOTHING), before)
    assert not holds(choice, Adequacy(NOTHING, doubt=frozenset({curve(1.0)})), before)
    assert not holds(choice, Adequacy(NOTHING, unjudged="too short"), before)
    assert not holds(choice, before, before)
    none: Any = SimpleNamespace(decision=SimpleNamespace(selected=SimpleNamespace(causes=())))
    assert not holds(none, Adequacy(NOTHING), before)


@pytest.mark.parametrize(("acts", "share", "left"), [(True, 0.1, 0.04), (False, 0.1, 0.4)])
def test_how_much_a_structure_may_leave(acts: bool, share: float, left: float) -> None:
    damper = Hypothesis("damper", PLACE, ("damping",), (True,))
    base: Any = SimpleNamespace(causes=(damper,))
    fewer: Any = SimpleNamespace(causes=())
    assert Decided(base, 0.4, acts).may_leave(fewer, share) == pytest.approx(left)
