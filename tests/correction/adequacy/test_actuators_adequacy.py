"""Which actuators stand for the class of an input: what is asked, offered and as likely."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from builders import DRIVEN_MASS

from symhyb.correction.adequacy.actuators import (
    Behind,
    _as_likely,
    deviating_input,
    lagging_sensor,
)
from symhyb.correction.adequacy.beyond import Beyond
from symhyb.correction.adequacy.judge import Adequacy
from symhyb.correction.adequacy.late import sensor_lag_cause
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely
from symhyb.correction.naming.actuator_rivals import (
    actuator_rivals,
    lag_doubt,
    named_on_the_way,
)
from symhyb.correction.naming.classes import class_found
from symhyb.correction.search.trajectory import limits_of, with_causes
from symhyb.discrepancy.places.hypotheses import Hypothesis, parametric_hypotheses, with_channels
from symhyb.discrepancy.results import Measurement
from symhyb.discrepancy.words.wording import (
    alternative_phrase,
    measurement_phrase,
    verdict_sentence,
)
from symhyb.judgement import CERTAIN
from symhyb.model.read import parse_model
from symhyb.model.types import On
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.linear import linear
from symhyb.numeric.lowered.machine import build

AIR = """
[elements.air]
kind = "drag"
on = "x"
drag = "b"
[elements.air.parameters]
b = { value = 0.1, unit = "N*s^2/m^2" }
"""


def cause(key: str, value: float) -> Hypothesis:
    return Hypothesis(key, None, ("value",), (True,), shape=(("value", value),), path=f"f.{key}")


def trial(evidence: float, *keys: str) -> Fitted:
    """A structure with these numbers of the actuator of f: 2 ± 0.1 in SI."""
    causes = tuple(cause(key, 2.0) for key in keys)
    model = with_causes(parse_model(DRIVEN_MASS), causes, [{"value": 2.0}] * len(keys))
    fit = SimpleNamespace(values=np.full(len(keys), 2.0), covariance=np.eye(len(keys)) * 0.01)
    made = SimpleNamespace(
        causes=causes, evidence=evidence, machine=SimpleNamespace(model=model), fit=fit
    )
    return cast(Fitted, made)


LATE = Generic("sensor", "laser", (), np.zeros(0), does="lags")
NOTHING = Beyond(np.ones(1), np.ones(1), 1.0, 99.0)


def late_trial(evidence: float) -> Fitted:
    """A structure in which the laser lags, by 2 ± 0.1 s."""
    model = parse_model(DRIVEN_MASS)
    causes = (sensor_lag_cause(model, ("laser",), 1.0),)
    fit = SimpleNamespace(values=np.array([2.0]), covariance=np.eye(1) * 0.01)
    made = SimpleNamespace(model=with_causes(model, causes, [{"value": 0.0}]))
    return cast(Fitted, SimpleNamespace(causes=causes, evidence=evidence, machine=made, fit=fit))


def test_structures_that_are_as_likely_stand_together_once_each() -> None:
    near = 0.9 * CERTAIN
    found = [
        trial(100.0, "limit"),
        trial(99.0, "limit"),
        trial(100.0 - near, "dead_band"),
        trial(100.0 - 1.1 * CERTAIN, "lag"),
    ]
    assert _as_likely(found) == [found[0], found[2]]
    assert _as_likely(found[3:]) == found[3:]


@pytest.mark.parametrize(
    ("kind", "does", "where", "input_"),
    [
        ("input", "", "f", "f"),
        ("lag", "", "f", "f"),
        ("input", "holds", "f", None),
        ("input", "fades", "f", None),
        ("sensor", "lags", "laser", None),
        ("law", "", On("x"), None),
    ],
)
def test_only_the_class_of_an_input_asks_for_an_actuator(
    kind: Any, does: Any, where: Any, input_: str | None
) -> None:
    generic = Generic(kind, where, (), np.ones(1), does=does)
    judged = SimpleNamespace(classes=(Likely(generic, 0.9),))
    assert deviating_input(cast(Any, judged)) == input_
    assert deviating_input(cast(Any, SimpleNamespace(classes=()))) is None


def test_a_number_on_trial_is_none_until_it_is_fitted_and_stays_near_where_it_began() -> None:
    tried = cause("limit", 3.0)
    model = with_causes(parse_model(DRIVEN_MASS), (tried,), [{"value": 3.0}])
    (number,) = model.inputs["f"].actuator
    assert (number.path, number.value, number.unit.text) == ("f.limit", 0.0, "N")
    lower, upper, _, spread = limits_of(build(model), (tried,), 0.01)
    assert (lower[0], upper[0], spread[0]) == pytest.approx((0.1, 90.0, np.inf))


def test_a_number_that_states_its_sd_is_a_cause() -> None:
    text = DRIVEN_MASS.replace(
        'f = { unit = "N"', 'f = { unit = "N", limit = 3.0, lag = { value = 0.1, sd = 0.02 }'
    )
    paths = [one.path for one in parametric_hypotheses(with_channels(parse_model(text)))]
    assert "f.lag" in paths
    assert "f.limit" not in paths


def test_drag_makes_a_machine_nonlinear() -> None:
    """Where it is linear, a lag of its input and of its sensor are the same."""
    assert linear(state_form(build(parse_model(DRIVEN_MASS))))
    assert not linear(state_form(build(parse_model(DRIVEN_MASS + AIR))))


def test_what_is_not_distinguished_stands_among_the_alternatives() -> None:
    both = Behind((trial(100.0, "rate_limit", "lag"), trial(98.0, "limit")))
    rate, lag, limit = actuator_rivals(both, 4)
    assert [one.kind for one in (rate, lag, limit)] == ["rate_limit", "lag", "limit"]
    assert [one.together for one in (rate, lag, limit)] == [4, 4, 0]
    assert [one.evidence for one in (rate, limit)] == pytest.approx([0.0, 4.0])
    (number,) = rate.estimates
    assert (number.value, number.sd, number.unit) == pytest.approx((2.0, 0.1, "N/s"))
    assert alternative_phrase(limit) == "a limit of 2.00 ± 0.10 N in channel f"
    assert alternative_phrase(rate).startswith("a rate limit of 2.00 ± 0.10 N/s")


def test_a_lag_that_may_be_of_its_sensor_is_one_of_both() -> None:
    """Of a linear machine with one way no motion distinguishes them: one number for both."""
    behind = Behind((trial(100.0, "lag"),), ("laser",), "f")
    doubt = lag_doubt(behind)
    assert doubt is not None
    assert doubt.said.startswith("A lag of the input f shows as one of laser would: ")
    assert "this machine is linear and nothing else drives what laser shows" in doubt.said
    assert "one of laser no other sensor" in doubt.record_next
    assert lag_doubt(Behind((trial(100.0, "lag"),))) is None
    lag, sensor = actuator_rivals(behind, 4)
    assert (lag.channel, sensor.channel, sensor.together) == ("f", "laser", 0)
    assert lag.estimates[0].value == sensor.estimates[0].value == 2.0
    assert alternative_phrase(sensor) == "a lag of 2.00 ± 0.10 s in channel laser"


def test_what_fits_best_may_be_the_sensor_where_no_recording_distinguishes_them() -> None:
    """An actuator begins as if the first value had acted for long, so that its fit may be worse."""
    behind = Behind((late_trial(100.0),), ("laser",), "f")
    doubt = lag_doubt(behind)
    assert doubt is not None
    assert doubt.said.startswith("A lag of the input f shows as one of laser would: this machine ")
    sensor, lag = actuator_rivals(behind, 4)
    assert [(one.kind, one.channel) for one in (sensor, lag)] == [
        ("sensor_lag", "laser"),
        ("lag", "f"),
    ]
    assert lag.estimates[0].term == "lag"


def test_what_is_as_likely_in_these_recordings_is_said_otherwise() -> None:
    behind = Behind((trial(100.0, "lag"), late_trial(99.0)), ("laser",))
    doubt = lag_doubt(behind)
    assert doubt is not None
    assert doubt.said.endswith("both are as likely in these recordings.")
    lag, sensor = actuator_rivals(behind, 4)
    assert (lag.channel, sensor.channel, sensor.kind) == ("f", "laser", "sensor_lag")
    assert (lag.evidence, sensor.evidence) == pytest.approx((0.0, 2.0))


def test_sensors_alone_that_may_lag_are_no_class_of_an_input() -> None:
    behind = Behind((late_trial(100.0), late_trial(99.0)), ("laser", "encoder"))
    doubt = lag_doubt(behind)
    assert doubt is not None
    assert doubt.said.startswith("Which of the sensors laser and encoder lags is not known")
    judged = Adequacy(NOTHING, (Likely(LATE, 0.99),))
    assert named_on_the_way(judged, behind) == judged


@pytest.mark.parametrize("always", ["f", ""])
@pytest.mark.parametrize("first", ["sensor", "input"])
def test_the_class_of_a_lag_is_that_of_the_way_and_names_no_input_alone(
    first: str, always: str
) -> None:
    lag = Generic("lag", "f", (), np.zeros(0))
    drift = Generic("sensor", "laser", (), np.zeros(0), does="drifts")
    ways = (LATE, lag) if first == "sensor" else (lag, LATE)
    likely = (Likely(ways[0], 0.7), Likely(drift, 0.1), Likely(ways[1], 0.2))
    behind = Behind((trial(100.0, "lag"),), ("laser",), always)
    one, other = named_on_the_way(Adequacy(NOTHING, likely), behind).classes
    assert (one.probability, other.generic.does) == (pytest.approx(0.9), "drifts")
    assert class_found(one).sentence == (
        "Something lags on the way from the input f to laser, of the order of 2 s "
        "(probability 90 %)."
    )


def test_only_a_sensor_that_lags_asks_for_its_lag() -> None:
    def judged(does: Any) -> Any:
        sensor = Generic("sensor", "laser", (), np.zeros(0), does=does)
        return SimpleNamespace(classes=(Likely(sensor, 0.9),))

    assert lagging_sensor(judged("lags")) == "laser"
    assert lagging_sensor(judged("drifts")) is None
    assert lagging_sensor(cast(Any, SimpleNamespace(classes=()))) is None


@pytest.mark.parametrize(
    ("kind", "value", "sd", "unit", "said"),
    [
        ("dead_band", 0.47, 0.01, "N", "f acts only beyond a dead band of 0.470 ± 0.010 N"),
        ("quantum", 0.5, 0.01, "N", "f acts in steps of 0.500 ± 0.010 N (quantisation)"),
        ("backlash", 2.0, 0.1, "N", "f acts behind a play (backlash) of 2.00 ± 0.10 N"),
        ("limit", 14.5, 0.2, "N", "f saturates at 14.5 ± 0.2 N"),
        ("lag", 0.021, 0.001, "s", "f acts through a lag of 21.0 ± 1.0 ms"),
    ],
)
def test_what_an_actuator_does_in_words(
    kind: Any, value: float, sd: float, unit: str, said: str
) -> None:
    fault = Measurement("f", kind, value, sd, unit)
    assert measurement_phrase(fault) == said
    gain = Measurement("laser", "gain", 1.1, 0.01, "1")
    whole = verdict_sentence("missing physics", (), (), (fault, gain))
    assert whole == (
        f"The model lacks what the actuator does: {said}. "
        "Besides, laser has a gain of 1.100 ± 0.010."
    )
