"""What is said of delays: of each channel by itself, and of those that share one."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from symhyb.correction.naming.delays import channel_by_channel, late_channels, shared_path
from symhyb.correction.naming.findings import cause_phrase
from symhyb.correction.search.trajectory import Refined, delayed
from symhyb.discrepancy.places.hypotheses import (
    parametric_hypotheses,
    with_channels,
)
from symhyb.discrepancy.results import Alternative, Measurement
from symhyb.discrepancy.words.wording import measurement_phrases
from symhyb.model.delays import with_shared_delays
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build
from tests.correction.test_other_side import PUSHED, WAVE

STATED = PUSHED.replace(
    'f = { unit = "N" }', 'f = { unit = "N", delay = { value = 2, unit = "ms" } }'
)
MODEL = with_shared_delays(
    with_channels(parse_model(STATED + WAVE, "pushed.toml")), ("place", "speed")
)
MACHINE = build(MODEL, keep=False)
CAUSES = {cause.path: cause for cause in parametric_hypotheses(MODEL)}


def structure(**values: float) -> Refined:
    """A structure whose causes are delays of these values, s, with deviations of 0.1 ms that have
    nothing to do with each other."""
    paths = tuple(f"{name.replace('_', ' ')}.delay" for name in values)
    covariance = np.eye(len(paths)) * 1e-8
    fit = SimpleNamespace(values=np.array(list(values.values())), covariance=covariance)
    causes = tuple(CAUSES[path] for path in paths)
    return Refined(causes, MACHINE, paths, MACHINE.values, fit)  # type: ignore[arg-type]


def said(*faults: Measurement) -> dict[str, tuple[float, float, int]]:
    return {one.channel: (one.value, one.sd, one.together) for one in faults}


def test_all_of_a_side_have_the_number_that_they_share() -> None:
    found = structure(all_sensors=3e-3)
    rows = tuple(late_channels(found))
    assert said(*rows) == {"place": (3e-3, 1e-4, 2), "speed": (3e-3, 1e-4, 2)}
    assert measurement_phrases(rows) == [
        "place and speed arrive 3.00 ± 0.10 ms late, all by one delay"
    ]
    assert delayed(found) == ("place", "speed")
    assert {shared_path(MODEL, one.channel) for one in rows} == {"all sensors.delay"}


def test_what_a_channel_has_beside_it_adds_up() -> None:
    rows = tuple(late_channels(structure(all_sensors=3e-3, speed=1e-3)))
    both = said(*rows)
    assert both["place"] == (3e-3, 1e-4, 2)
    assert both["speed"] == pytest.approx((4e-3, 2**0.5 * 1e-4, 0))
    assert measurement_phrases(rows) == [
        "place arrives 3.00 ± 0.10 ms late",
        "speed arrives 4.00 ± 0.14 ms late",
    ]


def test_what_the_file_states_adds_up_too() -> None:
    """The delay of f is in its own unit, and 2 ms of it are known: f and h are not late alike."""
    rows = tuple(late_channels(structure(all_inputs=1e-3)))
    assert said(*rows)["f"] == pytest.approx((3.0, 0.1, 0))
    assert said(*rows)["h"] == pytest.approx((1e-3, 1e-4, 0))


def test_what_is_in_doubt_is_not_said() -> None:
    found = structure(all_sensors=3e-3, f=1e-3)
    rows = tuple(late_channels(found, {CAUSES["all sensors.delay"]}))
    assert [one.channel for one in rows] == ["f"]


def test_an_alternative_stands_with_each_channel() -> None:
    shared = Alternative(None, "delay", (), 0.0, channel="all sensors")
    other = Alternative(None, "gain", (), 0.0, channel="f", together=1)
    rows = channel_by_channel(MODEL, (other, shared))
    assert rows == (
        other,
        replace(shared, channel="place", together=2),
        replace(shared, channel="speed", together=2),
    )
    beside = channel_by_channel(MODEL, (other, replace(shared, together=1)))
    assert [one.together for one in beside] == [1, 1, 1]


def test_what_stands_instead_of_it_names_a_delay_that_a_file_can_state() -> None:
    gain = Alternative("all inputs.delay", "gain", (), 2.0, channel="place")
    assert channel_by_channel(MODEL, (gain,)) == (replace(gain, instead_of="f.delay"),)


def test_the_cause_is_named_by_its_side() -> None:
    assert cause_phrase(CAUSES["all inputs.delay"]) == "one delay of all inputs"
    assert cause_phrase(CAUSES["f.delay"]) == "a delay in channel f"
