"""Friction that turns over gradually is a smooth law wherever friction would hold or switch."""

import numpy as np
import pytest
from builders import model_of

from symhyb.errors import InputError
from symhyb.exact.simulation import simulate
from symhyb.export.spec import spec_of
from symhyb.model.switching import frictions, gradual, left_smooth, modes, rubbing
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario

LEVEL, TRANSITION, PUSH = 2.0, 0.2, 0.5  # N, m/s, N


def block(sd: float | None) -> Model:
    """A block that is pushed with less than the level of its friction."""
    transition = (TRANSITION, "m/s") if sd is None else (TRANSITION, "m/s", sd)
    return model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={
            "m": (0.5, "kg"),
            "F_c": (LEVEL, "N"),
            "v_t": transition,
            "p": (PUSH, "N"),
        },
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={
            "rail": {"kind": "friction", "on": "x", "coulomb": "F_c", "transition": "v_t"},
            "push": {"kind": "constant", "on": "x", "constant": "p"},
        },
        sensors={"place": {"measures": "x", "unit": "m"}},
    )


@pytest.mark.parametrize("sd", [None, 0.01])
def test_a_transition_with_an_sd_is_a_number_of_the_machine(sd: float | None) -> None:
    """Under a push below its level dry friction holds; gradual friction creeps, at the speed at
    which it is as large as the push."""
    model = block(sd)
    (rail, push) = model.elements
    assert (gradual(model, rail), gradual(model, push)) == (sd is not None, False)
    assert frictions(model) == rubbing(model) == ((0,) if sd is None else ())
    assert modes(model) == ((("rail", 3),) if sd is None else ())
    assert [text.split(" turns")[0] for text in left_smooth(model)] == (
        [] if sd is None else ["elements.rail"]
    )
    t = np.linspace(0, 2, 201)
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t[[0, -1]], np.empty((2, 0)))
    run = simulate(build(model), scenario, exact=True)
    assert run.complete
    creeps = TRANSITION * np.arctanh(PUSH / LEVEL)
    assert run.v[-1, 0] == (0.0 if sd is None else pytest.approx(creeps, rel=1e-4))


def test_events_leave_it_as_it_is() -> None:
    """Between the modes of an FMU dry friction is a straight line; this one stays a tanh."""
    (mine,) = spec_of(block(0.01), "rail", ("rail",)).exported.evaluate(
        0.0, np.empty(0), np.array([TRANSITION]), np.array([LEVEL, TRANSITION])
    )[1]
    assert mine == pytest.approx(-LEVEL * np.tanh(1.0))
    with pytest.raises(InputError, match="nothing in what is exported switches"):
        spec_of(block(0.01), "rail", ("rail",), events=True)
