"""Where all sensors are late by the same, all inputs may be instead, and the other way around."""

from collections.abc import Mapping

import pytest

from symhyb.correction.naming.other_side import late_on_the_other_side
from symhyb.discrepancy.results import Measurement
from symhyb.model.read import parse_model
from symhyb.model.types import Model

PUSHED = """symhyb = 1
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.0, unit = "kg" }
[inputs]
f = { unit = "N" }
h = { unit = "N" }
[energy]
kinetic = "m*x'**2/2"
[elements.push]
kind = "force"
on = "x"
force = "f + h"
[sensors]
place = { measures = "x", unit = "m" }
speed = { measures = "x'", unit = "m/s" }
"""
WAVE = """[elements.hum]
kind = "harmonic"
on = "x"
amplitude = "f"
frequency = "1/T"
[elements.hum.parameters]
T = { value = 1.0, unit = "s" }
"""


def pushed(more: str = "") -> Model:
    return parse_model(PUSHED + more, "pushed.toml")


def late(by: Mapping[str, float]) -> tuple[Measurement, ...]:
    return tuple(Measurement(name, "delay", value, 1e-5, "s") for name, value in by.items())


@pytest.mark.parametrize(
    ("found", "others"),
    [
        ({"place": 3e-3, "speed": 3.01e-3}, ["f", "h"]),
        ({"f": 3e-3, "h": 3e-3}, ["place", "speed"]),
        ({"place": 3e-3}, []),  # the other sensor is not late
        ({"place": 3e-3, "speed": 3.1e-3}, []),
        ({"place": 3e-3, "speed": 3e-3, "f": 1e-3}, []),
        ({}, []),
    ],
)
def test_the_other_side_may_be_late(found: dict[str, float], others: list[str]) -> None:
    told = late_on_the_other_side(pushed(), late(found), 4)
    assert [one.channel for one in told] == others
    assert all((one.kind, one.together, one.evidence) == ("delay", 4, 0.0) for one in told)
    for one in told:
        assert one.estimates[0].value == pytest.approx(3e-3)
        assert one.instead_of in {f"{name}.delay" for name in found}


def test_a_law_that_runs_by_the_clock_distinguishes_the_sides() -> None:
    found = late({"place": 3e-3, "speed": 3e-3})
    assert late_on_the_other_side(pushed(WAVE), found, 1) == ()


def test_a_pair_is_compared_by_the_search() -> None:
    alone = PUSHED.replace('h = { unit = "N" }\n', "").replace("f + h", "f")
    alone = alone.replace('speed = { measures = "x\'", unit = "m/s" }\n', "")
    model = parse_model(alone, "pushed.toml")
    assert late_on_the_other_side(model, late({"place": 3e-3}), 1) == ()
