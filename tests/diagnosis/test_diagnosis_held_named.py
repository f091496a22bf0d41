"""An input that is held from sample to sample is named, stated in the model, and fits."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from actuated import FINE, actuated
from rigs import spring_model
from scipy.interpolate import CubicSpline

import symhyb as sh
from symhyb.correction.adequacy.structure import Generic, Likely
from symhyb.correction.verdict.hold import (
    held_inputs,
    likelier,
    samples_kept,
    with_held,
    with_holds,
)
from symhyb.discrepancy.results import Diagnosis, Measurement
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.render import render
from symhyb.model.types import Model
from symhyb.model.write import hold_inputs, text_of
from symhyb.numeric.kernels.buffers import Array

STEP_S = 0.005


def staircase(t: Array, command: Array) -> Array:
    """Each sample of the command until the next; ``t`` are the middles of fine steps."""
    begins = t[::FINE] - 0.5 * (t[1] - t[0])
    return np.repeat(CubicSpline(t, command)(begins), FINE)


def judged(figure: float, probability: float = 0.99, does: str = "holds") -> Any:
    generic = Generic("input", "f", (), np.ones(1), figure=figure, does=cast(Any, does))
    return SimpleNamespace(classes=(Likely(generic, probability),), structure=None)


def late(adequate: bool = True, evidence: float = 0.0, **delays: float) -> Any:
    """A judgement without a class, of a structure with these delays, s, of channels."""
    causes = [SimpleNamespace(kind="delay", path=f"{name}.delay") for name in delays]
    places = {cause.path: i for i, cause in enumerate(causes)}
    structure = SimpleNamespace(
        causes=[SimpleNamespace(kind="friction", path=""), *causes],
        p=list(delays.values()),
        machine=SimpleNamespace(column=places.__getitem__),
        evidence=evidence,
    )
    return SimpleNamespace(classes=(), structure=structure, adequate=adequate)


def model(said: str = "") -> Model:
    text = render(spring_model()).replace('f = { unit = "N"', f'f = {{ unit = "N"{said}')
    return parse_model(text)


def test_one_sample_for_certain_is_held() -> None:
    run = [actuated(staircase, 1, duration=2.0)]
    (held,) = held_inputs(model(), run, judged(STEP_S))
    assert (held.channel, held.kind, held.unit, held.sd) == ("f", "held", "s", 0.0)
    assert held.value == pytest.approx(STEP_S)
    assert with_holds(model(), [held]).inputs["f"].between == "held"
    for unsure in (
        judged(2 * STEP_S),
        judged(STEP_S, 0.9),
        judged(STEP_S, does="fades"),
        SimpleNamespace(classes=(), structure=None),
    ):
        assert held_inputs(model(), run, cast(Any, unsure)) == ()
    assert held_inputs(model(', between = "held"'), run, judged(STEP_S)) == ()


def test_half_a_sample_late_may_be_held() -> None:
    """At the sensor, too: in a linear machine what is late there is late at the input."""
    run = [actuated(staircase, 1, duration=2.0)]
    for one in (late(f=STEP_S / 2), late(laser=1.001 * STEP_S / 2)):
        assert [held.channel for held in held_inputs(model(), run, one)] == ["f"]
    for other in (late(), late(f=STEP_S), late(f=STEP_S / 2, laser=2 * STEP_S)):
        assert held_inputs(model(), run, other) == ()
    assert held_inputs(model(', between = "held"'), run, late(f=STEP_S / 2)) == ()


@pytest.mark.parametrize(
    ("again", "before", "named"),
    [
        (late(evidence=9.0), late(evidence=0.0), True),
        (late(evidence=3.0), late(evidence=0.0), False),
        (late(evidence=-9.0), late(adequate=False), True),
        (late(adequate=False, evidence=99.0), late(), False),
    ],
)
def test_a_hold_is_named_where_it_explains_and_is_likelier(
    again: Any, before: Any, named: bool
) -> None:
    assert likelier(again, before) == named


def test_a_slow_controller_holds_for_as_long_as_its_record_shows() -> None:
    (run,) = [actuated(staircase, 1, duration=2.0)]
    command = run.inputs["f"]
    slow = replace(run, inputs={"f": command[np.arange(command.size) // 4 * 4]})
    (held,) = held_inputs(model(), [slow], judged(STEP_S))
    assert held.value == pytest.approx(4 * STEP_S)
    (both,) = held_inputs(model(), [run, slow], judged(STEP_S))
    assert both.value == pytest.approx(STEP_S)
    quiet = replace(run, inputs={"f": np.ones_like(command)})
    assert samples_kept([quiet], "f") == 1


def test_what_is_held_stands_in_the_verdict() -> None:
    held = (Measurement("f", "held", STEP_S, 0.0, "s"),)
    answer = with_held(Diagnosis("nothing missing", "Nothing is missing."), held)
    assert (answer.verdict, answer.measurement) == ("measurement", held)
    assert answer.sentence == (
        "The physics of the model holds, the measurement does not: "
        "f is held between its recorded values, for 5 ms each."
    )


@pytest.mark.parametrize("said", ["", ', between = "line"'])
def test_a_model_file_states_in_place_that_an_input_is_held(said: str) -> None:
    found = hold_inputs(model(said), ["f"])
    assert found.inputs["f"].between == "held"
    assert text_of(found).count("between") == 1
    assert hold_inputs(model(), []) == model()
    with pytest.raises(InputError, match="there is no input 'g'"):
        hold_inputs(model(), ["g"])


@pytest.mark.slow
def test_a_held_input_is_named_and_fits() -> None:
    """It was undecided, with the class."""
    run, unseen = (actuated(staircase, seed) for seed in (4, 5))
    diagnosis = sh.diagnose(spring_model(), run)
    assert diagnosis.verdict == "measurement"
    (held,) = diagnosis.measurement
    assert (held.channel, held.kind) == ("f", "held")
    assert not any((diagnosis.found, diagnosis.parameters, diagnosis.classes))
    corrected = sh.apply(spring_model(), (), (), diagnosis.measurement)
    scores = sh.judge(spring_model(), corrected, on=unseen).holdout
    assert scores.after.free_run_nrmse["laser"] < 0.2 * scores.before.free_run_nrmse["laser"]
