"""A decision once more, where the noise is another one: what was close, and nothing else."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symhyb.correction.search.decide import decide, decide_among
from symhyb.correction.search.decision import Decision
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.verdict import choice
from symhyb.correction.verdict.choice import _as_likely, _or_before
from tests.pushed import NOISE, pushed, pushed_model


def setting_of(noise: float) -> Setting:
    """A damping that is a sixth larger than stated, and a constant force of a hundredth."""
    made = pushed(3, samples=400, damping=0.7, beside=0.04 * np.ones(400), noise=noise)
    return settle(prepare(pushed_model(), (made,)))


def decided() -> tuple[Setting, Decision]:
    setting = setting_of(NOISE)
    return setting, decide(setting, None, lambda line: None)


def names(decision: Decision) -> set[str]:
    return {cause.kind for cause in decision.selected.causes}


def test_the_same_noise_gives_the_same_decision_for_less() -> None:
    setting, first = decided()
    lines: list[str] = []
    again = decide_among(setting, first, lines.append)
    assert names(first) == {"damper", "constant"}
    assert names(again) == names(first)
    assert again.count == first.count
    known = {cause for trial in first.trials for cause in trial.causes}
    assert all({*trial.causes} <= known for trial in again.trials)
    assert len(again.trials) < len(first.trials)
    assert len(lines) == len(again.trials)
    np.testing.assert_allclose(again.selected.fit.values, first.selected.fit.values, rtol=1e-3)


def test_more_noise_takes_causes_away() -> None:
    _, first = decided()
    some = decide_among(setting_of(8 * NOISE), first, lambda line: None)
    assert names(some) < names(first)
    loud = decide_among(setting_of(200 * NOISE), first, lambda line: None)
    assert loud.selected is loud.nothing
    assert len(loud.log) > len(first.log)


@pytest.mark.parametrize(
    ("reason", "causes", "stands"),
    [("it grew without bound", (), False), ("", (), True), ("", ("damper",), True)],
)
def test_a_noise_that_hides_what_a_run_needs_leaves_the_choice_as_it_was(
    reason: str, causes: tuple[str, ...], stands: bool
) -> None:
    selected = SimpleNamespace(causes=causes, fit=SimpleNamespace(reason=reason))
    before: Any = object()
    again: Any = SimpleNamespace(decision=SimpleNamespace(selected=selected))
    assert _or_before(again, before) is (again if stands else before)


@pytest.mark.parametrize(
    ("laws", "evidence", "reason", "stands"),
    [
        (("damper",), -9e9, "", True),  # the same laws: only the noise is another one
        ((), -104.0, "", True),
        ((), -105.0, "", False),
        (("spring",), -9e9, "", False),
        ((), -np.inf, "it grew without bound", False),
    ],
)
def test_what_is_as_likely_along_whole_recordings_stands_under_another_noise(
    laws: tuple[str, ...],
    evidence: float,
    reason: str,
    stands: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def chosen(laws: tuple[str, ...], evidence: float, reason: str = "") -> Any:
        selected = SimpleNamespace(
            causes=tuple(SimpleNamespace(family=law) for law in laws),
            fit=SimpleNamespace(reason=reason),
        )
        return SimpleNamespace(
            setting=SimpleNamespace(stages=(SimpleNamespace(cuts=()),)),
            decision=SimpleNamespace(selected=selected),
            along=SimpleNamespace(evidence=evidence),
        )

    before, again = chosen(("damper",), -100.0), chosen(laws, 0.0, reason)
    found = SimpleNamespace(evidence=evidence)
    monkeypatch.setattr(choice, "recorded", lambda prepared, setting: object())
    monkeypatch.setattr(choice, "followed", lambda ground, selected, along: found)
    assert _as_likely(object(), again, before) is stands  # type: ignore[arg-type]
