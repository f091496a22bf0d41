"""By which method a run is integrated, and how soon a vain attempt ends."""

import time

import numpy as np
import pytest
from builders import cart_pole, damper, oscillator, pendulum, push, run, spring

from symhyb.model.types import Model

INPUT = {"f": {"unit": "N"}}
METHODS = {
    "a swing": (pendulum(), "adams"),
    "dry friction": (cart_pole(), "bdf"),
    "a fast decay": (oscillator({"oil": damper("d")}, {"d": (1e4, "N*s/m")}), "bdf"),
    "a slow decay": (oscillator({"oil": damper("d")}, {"d": (0.5, "N*s/m")}), "adams"),
    "a spring that relaxes": (
        oscillator(
            {"it": {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"}},
            {"k": (60.0, "N/m"), "d": (6.0, "N*s/m")},
        ),
        "bdf",
    ),
    "a law that switches": (
        oscillator({"odd": push("-c*sign(x')")}, {"c": (0.1, "N")}),
        "bdf",
    ),
}


@pytest.fixture
def interpreted(monkeypatch: pytest.MonkeyPatch) -> None:
    """No compiler."""
    monkeypatch.setattr("symhyb.numeric.runs.integrate.field", lambda form: None)


@pytest.mark.usefixtures("interpreted")
@pytest.mark.parametrize(("model", "method"), METHODS.values(), ids=METHODS)
def test_the_run_says_by_which_method_it_was_integrated(model: Model, method: str) -> None:
    """BDF where a law is steep, remembers or switches, or where a decay is fast; else Adams."""
    t = np.linspace(0, 1, 11)
    result = run(model, t, 0.3, 0.5, np.zeros((11, len(model.inputs))))
    assert (result.method, result.reason) == (method, "")


@pytest.mark.usefixtures("interpreted")
def test_both_methods_give_the_same_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    t = np.linspace(0, 3, 61)
    by_adams = run(pendulum(), t, 1.0)
    monkeypatch.setattr("symhyb.numeric.runs.implicit_run.is_stiff", lambda *_: True)
    by_bdf = run(pendulum(), t, 1.0)
    assert (by_adams.method, by_bdf.method) == ("adams", "bdf")
    assert by_bdf.q == pytest.approx(by_adams.q, abs=2e-6)


def test_a_friction_law_that_chatters_ends_with_a_reason_and_not_never() -> None:
    """An exact sign has no solution once the mass sticks; a solver can only chatter around it."""
    law = {"kind": "law", "on": "x", "force": "-c*sign(x')"}
    model = oscillator({"odd": law, "motor": push("f")}, {"c": (2.0, "N")}, inputs=INPUT)
    t = np.linspace(0, 4, 41)
    begin = time.process_time()
    result = run(model, t, 0.0, 0.5, np.sin(t))
    assert not result.complete
    assert "stiff or chatter" in result.reason or "tolerance" in result.reason
    assert "elements.odd switches with sign(...), which chatters" in result.reason
    assert "write it as kind 'friction'" in result.reason
    assert time.process_time() - begin < 10


CHATTER = {
    "sign, two outputs": ("-c*sign(x')", 2, "switches with sign(...)"),
    "steep, many outputs": ("-c*x'/sqrt(x'*x' + w*w)", 41, "stiff or chatter"),
}


@pytest.mark.slow
@pytest.mark.parametrize(("text", "outputs", "sentence"), CHATTER.values(), ids=CHATTER)
def test_the_longest_vain_attempts_end_within_a_minute(
    text: str, outputs: int, sentence: str
) -> None:
    """A mass on a spring that sticks in a law of no width (1e-12 m/s): every retry is counted."""
    model = oscillator(
        {"odd": push(text), "hold": spring("k"), "motor": push("f")},
        {"c": (2.0, "N"), "w": (1e-12, "m/s"), "k": (100.0, "N/m")},
        inputs=INPUT,
    )
    t_u, begin = np.linspace(0, 4, 6001), time.process_time()
    result = run(model, np.linspace(0, 4, outputs), 0.0, 0.5, 3 * np.sin(5 * t_u), t_u)
    assert time.process_time() - begin < 60
    assert not result.complete
    assert sentence in result.reason
