"""What a search ends with: how far behind its structures are, by windows or by whole recordings."""

from dataclasses import replace
from functools import cache
from math import inf

import pytest

from symhyb.correction.search.decide import decide
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.score import choice_of
from symhyb.correction.search.setting import Setting
from tests.pushed import pushed, pushed_model


@cache
def setting() -> Setting:
    """A damping that is a sixth larger than stated, beside a stiffness that states an sd."""
    return settle(prepare(pushed_model(), (pushed(3, samples=400, damping=0.7),)))


@cache
def decided() -> Decision:
    return decide(setting(), None, str)


def test_others_are_behind_and_the_closest_comes_first() -> None:
    decision = decided()
    assert decision.behind(decision.best or decision.selected) == 0
    near = decision.near(inf)
    worse = [decision.behind(trial) for trial in near]
    assert worse == sorted(worse)
    assert decision.selected not in near
    assert not any(trial.fit.reason for trial in near)
    middle = worse[len(worse) // 2]
    assert decision.near(middle) == [t for t in near if decision.behind(t) < middle]


def test_what_whole_recordings_say_stands_before_the_score_of_windows() -> None:
    decision = decided()
    last = decision.near(inf)[-1]
    judged = replace(decision, judged=((last, 2.5),))
    assert judged.behind(last) == judged.against(last) == 2.5
    assert judged.near(3.0)[-1] is last
    others = [trial for trial in decision.near(inf) if trial is not last]
    assert [judged.behind(one) for one in others] == [decision.behind(one) for one in others]


def test_a_parameter_that_states_an_sd_and_a_law_meet_at_even_odds() -> None:
    decision = decided()
    law = decision.selected
    assert [cause.kind for cause in law.causes] == ["damper"]
    assert decision.against(law) == decision.behind(law)
    (stiffness,) = (h for h in setting().parametric if h.kind == "parameter" and h.path == "k")
    number = replace(law, causes=(stiffness,))  # what a fit of it would be
    ahead = decision.against(number) - decision.behind(number)
    assert ahead == pytest.approx(choice_of(decision.count))
