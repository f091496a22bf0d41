"""Beside dry friction a cause must stand along whole recordings too."""

from dataclasses import replace

import pytest

from symhyb.correction.adequacy import finalists
from symhyb.correction.adequacy.finalists import settled
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined, refine
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.model.types import On
from tests.correction.adequacy.test_followed import COULOMB, FRICTION, rubbing
from tests.pushed import pushed_model

CONSTANT = Hypothesis("constant", On("x"), ("constant",), (False,))


def decided() -> tuple[Prepared, Setting, Decision]:
    """Friction that acts and a constant force that does not, as the windows' choice."""
    prepared = prepare(pushed_model(), rubbing(1, 0.2))
    setting = settle(prepared)

    def fitted(*causes: tuple[Hypothesis, dict[str, float]]) -> Refined:
        chosen, rows = [cause for cause, _ in causes], [row for _, row in causes]
        return refine(prepared.model, chosen, rows, setting.stages[-1].cuts, setting.sd)

    friction, constant = (FRICTION, {"coulomb": COULOMB}), (CONSTANT, {"constant": 0.01})
    both = fitted(friction, constant)
    trials = (both, fitted(friction), fitted(constant))
    return prepared, setting, Decision(both, fitted(), trials, (), (), 30, both)


def test_what_whole_recordings_speak_against_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    prepared, setting, decision = decided()
    monkeypatch.setattr(finalists, "_finalists", lambda *_: [decision.selected])
    found, along = settled(prepared, setting, decision)
    assert found.selected is decision.trials[1]
    assert along is not None
    assert along.causes == found.selected.causes
    assert found.behind(found.selected) == 0
    assert found.behind(decision.selected) > 0
    assert "of ln evidence before" in found.log[-1]


def test_of_a_parameter_that_states_an_sd_they_say_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    prepared, setting, decision = decided()
    (stiffness,) = (one for one in setting.parametric if one.path == "k")
    causes, rows = [FRICTION, stiffness], [{"coulomb": COULOMB}, {"value": 0.1}]
    both = refine(prepared.model, causes, rows, setting.stages[-1].cuts, setting.sd)
    named = replace(decision, selected=both, trials=(both, decision.trials[1]), best=both)
    monkeypatch.setattr(finalists, "_finalists", lambda *_: [both])
    assert settled(prepared, setting, named)[0] is named


def test_what_they_ask_for_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    prepared, setting, decision = decided()
    monkeypatch.setattr(finalists, "_finalists", lambda *_: [decision.trials[1]])
    alone = Decision(decision.trials[1], decision.nothing, decision.trials, (), ())
    found, along = settled(prepared, setting, alone)
    assert found is alone
    assert along is None
