"""One delay that all inputs share, and one that all sensors do: where there is one, and what of."""

import numpy as np
import pytest
from builders import model_of, oscillator, push, spring

from symhyb.discrepancy.places.hypotheses import parametric_hypotheses, with_channels
from symhyb.model.delays import (
    channels_of,
    delay_paths,
    delayed_by,
    shared_delays,
    with_shared_delays,
)
from symhyb.model.types import Model
from symhyb.numeric.lowered.dynamics import delay_of
from symhyb.numeric.lowered.machine import build, structure_of
from symhyb.numeric.runs.windows import WindowModel

BOTH = ("place", "speed")


def rig(inputs: str = "fh", sensors: tuple[str, ...] = BOTH, wave: bool = False) -> Model:
    """A mass on a spring that some inputs push."""
    shown = {"place": {"measures": "x", "unit": "m"}, "speed": {"measures": "x'", "unit": "m/s"}}
    elements = {"hold": spring("k"), **{f"push_{name}": push(name) for name in inputs}}
    if wave:
        hum = {"kind": "harmonic", "on": "x", "amplitude": "a", "frequency": "1/T"}
        elements["hum"] = hum
    return oscillator(
        elements,
        {"k": (300.0, "N/m"), "a": (1.0, "N"), "T": (1.0, "s")},
        sensors={name: shown[name] for name in sensors},
        inputs={name: {"unit": "N"} for name in inputs},
    )


@pytest.mark.parametrize(
    ("model", "sides"),
    [
        (rig(), {"all inputs": ("f", "h")}),  # all sensors late: all inputs are
        (rig("f"), {}),  # all sensors late: the input is
        (rig(sensors=("place",)), {}),
        (rig("f", ("place",)), {}),
        (rig(""), {}),  # nothing they could be late against
        (rig("", wave=True), {"all sensors": BOTH}),
        (rig("f", wave=True), {"all sensors": BOTH}),
        (rig(wave=True), {"all inputs": ("f", "h"), "all sensors": BOTH}),
        (rig(sensors=("place",), wave=True), {"all inputs": ("f", "h")}),
    ],
)
def test_a_side_shares_a_delay_where_no_other_says_the_same(
    model: Model, sides: dict[str, tuple[str, ...]]
) -> None:
    shared = shared_delays(with_shared_delays(model, BOTH))
    assert shared == {f"{side}.delay": names for side, names in sides.items()}


def test_a_sensor_without_a_record_shares_none() -> None:
    assert shared_delays(with_shared_delays(rig(), {"place"})) == {}


def test_a_sensor_of_a_given_motion_shares_none() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m"}, "ground": {"unit": "m", "imposed": True}},
        parameters={"m": (1.0, "kg"), "k": (100.0, "N/m")},
        bodies={"mass": {"mass": "m", "at": ["x", "0"]}},
        elements={"tyre": {"kind": "spring", "on": "x - ground", "stiffness": "k"}},
        sensors={
            "road": {"measures": "ground", "unit": "m"},
            "place": {"measures": "x", "unit": "m"},
            "speed": {"measures": "x'", "unit": "m/s"},
        },
    )
    found = shared_delays(with_shared_delays(model, ("road", *BOTH)))
    assert found == {"all sensors.delay": BOTH}


def test_it_adds_to_the_delay_of_each() -> None:
    model = with_shared_delays(with_channels(rig(wave=True)), BOTH)
    machine = build(model)
    p = machine.values.copy()
    p[machine.column("all sensors.delay")] = 2e-3
    p[machine.column("speed.delay")] = 3e-3
    delays = {one.name: delay_of(machine, one, p) for one in channels_of(model)}
    assert delays == pytest.approx({"f": 0, "h": 0, "place": 2e-3, "speed": 5e-3})
    assert delay_paths(model.sensors["place"]) == ("place.delay", "all sensors.delay")
    assert delayed_by(model, "place.delay") == ("place",)
    assert delayed_by(model, "all sensors.delay") == BOTH
    late = WindowModel(machine, (machine.column("all inputs.delay"),)).form.late
    assert late == ("f", "h")


def test_a_file_knows_nothing_of_it() -> None:
    plain = with_channels(rig(wave=True))
    shared = with_shared_delays(plain, BOTH)
    paths = [[item.path for item in one.all_parameters()] for one in (plain, shared)]
    assert paths[1] == [*paths[0], "all inputs.delay", "all sensors.delay"]
    assert structure_of(shared) != structure_of(plain)
    assert build(shared).values[-2:] == pytest.approx(np.zeros(2))


def test_it_is_one_cause_with_one_number() -> None:
    model = with_shared_delays(with_channels(rig(wave=True)), BOTH)
    causes = [one for one in parametric_hypotheses(model) if one.options]
    assert [(one.kind, one.path, one.numbers) for one in causes] == [
        ("delay", "all inputs.delay", 1),
        ("delay", "all sensors.delay", 1),
    ]
    assert causes[1].options == (("late", "place"), ("late", "speed"))
