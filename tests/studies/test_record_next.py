"""The study that follows the advice: its generator is right, and the advice resolves."""

from collections.abc import Iterator
from types import ModuleType

import numpy as np
import pytest

from symhyb.correction.advice.signals import signal_of
from symhyb.discrepancy.results import Manoeuvre
from tests.scripts import scripts


@pytest.fixture(scope="module")
def study() -> Iterator[ModuleType]:
    """The study, a script beside its generator."""
    with scripts("record_next", ("generate", "follow")) as found:
        yield found["follow"]


def test_dry_friction_stops_the_sledge_where_it_must(study: ModuleType) -> None:
    make = study.generate
    turn = np.pi * np.sqrt(make.MASS / make.STIFFNESS)  # half a swing
    t = np.arange(2000) * turn / 50
    x = make.simulate(t, lambda s: 0.0, {"coulomb": 0.5, "damping": -make.DAMPING}, (0.05, 0.0))
    # every half swing costs 2 F/k, and it rests within F/k
    for half in range(5):
        expected = (-1) ** half * (0.05 - 2 * half * 0.5 / make.STIFFNESS)
        assert x[50 * half] == pytest.approx(expected, abs=2e-5)
    assert np.ptp(x[-100:]) == 0
    assert abs(x[-1]) <= 0.5 / make.STIFFNESS


def test_a_maxwell_branch_yields(study: ModuleType) -> None:
    t = np.arange(0, 40, 0.01)
    hidden = {"stiffness": 60.0, "time": 0.5}
    x = study.generate.simulate(t, lambda s: 2.0, hidden)
    assert x[-1] == pytest.approx(2.0 / study.generate.STIFFNESS, rel=1e-3)


@pytest.mark.parametrize("signal", ["sine", "sweep", "multisine", "steps", "triangle", "release"])
def test_the_signals_are_what_the_page_says(study: ModuleType, signal: str) -> None:
    plan = Manoeuvre("f", signal, 3.0, "N", 8.0, 0.01, (0.5, 2.0))  # type: ignore[arg-type]
    t = np.arange(801) / 100
    assert [study.signal(plan, s) for s in t] == pytest.approx(signal_of(plan, t), abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["damping", "mass", "delay"])
def test_following_the_advice_resolves_the_ambiguity(study: ModuleType, case: str) -> None:
    row = study.followed(case, 2)
    assert row["verdict"] == "undecided"
    assert row["record_next"]
    assert row["right"], row
