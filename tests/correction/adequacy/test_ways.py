"""Where a lag of an input is the same as one of sensors."""

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from builders import DRIVEN_MASS

from symhyb.correction.adequacy.ranking import ranked
from symhyb.correction.adequacy.structure import Fitted, Generic, Likely
from symhyb.correction.adequacy.ways import on_ways, same_way, shown_sensors
from symhyb.judgement import CERTAIN
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build

SECOND = """
[coordinates.y]
unit = "m"
[inputs.g]
unit = "N"
[bodies.other]
mass = "m"
at = ["0", "y"]
[elements.holds]
kind = "spring"
on = "y"
stiffness = "k"
[elements.pushes]
kind = "force"
on = "y"
force = "{force}"
[sensors.camera]
measures = "{shows}"
unit = "m"
"""
AIR = """
[elements.air]
kind = "drag"
on = "x"
drag = "b"
[parameters.b]
value = 0.1
unit = "N*s^2/m^2"
"""
RATE = """
[sensors.rate]
measures = "x'"
unit = "m/s"
"""


def two(force: str = "g", shows: str = "y") -> str:
    return DRIVEN_MASS + SECOND.format(force=force, shows=shows)


@pytest.mark.parametrize(
    ("text", "which", "sensors"),
    [
        (DRIVEN_MASS, 0, (0,)),
        (DRIVEN_MASS + RATE, 0, (0, 1)),  # all sensors of the motion
        (DRIVEN_MASS + AIR, 0, ()),  # air makes the answer to a late force another one
        (two(), 0, (0,)),  # two axes that do not act on each other
        (two(), 1, (1,)),
        (two(force="g + f"), 0, ()),  # the camera sees what both drive
        (two(force="g + f"), 1, ()),
        (two(shows="x + y"), 1, ()),
        (two(force="0*g"), 1, ()),  # what drives nothing lags nowhere
    ],
)
def test_a_lag_at_both_ends_of_a_way_that_nothing_else_joins(
    text: str, which: int, sensors: tuple[int, ...]
) -> None:
    machine = build(parse_model(text))
    assert same_way(machine, which, range(len(machine.model.sensors))) == sensors


def test_both_ends_give_one_motion_by_numpy() -> None:
    """A mass of 1 kg on 25 N/m and 0.6 N·s/m: from rest the lagged force moves it as the lag of its
    motion shows; with air it does not."""
    h, n, tau = 1e-3, 6000, 0.05
    push = np.sin(2 * np.pi * 0.9 * np.arange(n) * h) + np.sin(2 * np.pi * 0.4 * np.arange(n) * h)

    def lagged(values: np.ndarray) -> np.ndarray:
        z, made = 0.0, []
        for value in values:
            made.append(z)
            z += h * (value - z) / tau
        return np.array(made)

    def moved(force: np.ndarray, air: float) -> np.ndarray:
        x = v = 0.0
        made = []
        for f in force:
            made.append(x)
            x, v = x + h * v, v + h * (f - 25 * x - 0.6 * v - air * abs(v) * v)
        return np.array(made)

    for air, same in ((0.0, True), (5.0, False)):
        front, back = moved(lagged(push), air), lagged(moved(push, air))
        assert bool(np.max(np.abs(front - back)) < 1e-9 * np.max(np.abs(back))) == same


def ground(text: str, shown: tuple[bool, ...] = (True,)) -> Any:
    y = np.where(shown, np.zeros((5, len(shown))), np.nan)
    machine = build(parse_model(text))
    block = SimpleNamespace(y=[y])
    return SimpleNamespace(
        windows=SimpleNamespace(machine=machine), items=(SimpleNamespace(block=block),)
    )


def lag(name: str, kind: Any = "lag", does: Any = "") -> Generic:
    return Generic(kind, name, (), np.ones(1), figure=0.1 if kind == "lag" else np.nan, does=does)


def test_sensors_without_a_record_lag_nowhere() -> None:
    some = ground(two(), (True, False))
    assert shown_sensors(some) == [0]


def test_classes_of_both_ends_of_a_way_are_one() -> None:
    late = Likely(lag("laser", "sensor", "lags"), 0.9)
    drifts = Likely(lag("laser", "sensor", "drifts"), 0.06)
    acts = Likely(lag("f"), 0.03)
    one, other = on_ways(ground(DRIVEN_MASS), (late, drifts, acts))
    assert (one.generic.kind, one.generic.where) == ("lag", "f")
    assert one.generic.sensors == ("laser",)
    assert (one.probability, one.generic.figure) == pytest.approx((0.93, 0.1))
    assert other == drifts
    assert on_ways(ground(DRIVEN_MASS + AIR), (late, acts)) == (late, acts)
    assert on_ways(ground(DRIVEN_MASS), (drifts,)) == (drifts,)


def test_one_of_several_sensors_is_not_the_input() -> None:
    late = Likely(lag("laser", "sensor", "lags"), 0.9)
    some = ground(DRIVEN_MASS + RATE, (True, True))
    assert on_ways(some, (late,)) == (late,)
    (acts,) = on_ways(some, (Likely(lag("f"), 0.9),))
    assert acts.generic.sensors == ("laser", "rate")


def trial(generic: Generic, evidence: float) -> Fitted:
    return cast(Fitted, SimpleNamespace(extra=generic, evidence=evidence))


@pytest.mark.parametrize("first", ["lag", "sensor"])
@pytest.mark.parametrize("apart", [0.9, 1.1])
def test_lags_that_are_as_likely_are_one_class_of_both(first: str, apart: float) -> None:
    """Whichever has the better odds: within 100 to 1 none of the two is the one."""
    late, acts = lag("laser", "sensor", "lags"), lag("f")
    order = (late, acts) if first == "sensor" else (acts, late)
    trials = [trial(order[0], 50.0), trial(order[1], 50.0 - apart * CERTAIN)]
    classes = ranked(trials, {one.key for one in order})
    if apart < 1:
        assert [one.generic.sensors for one in classes] == [("laser",)]
        assert classes[0].probability == pytest.approx(1.0)
    else:
        assert classes[0].generic is order[0]
