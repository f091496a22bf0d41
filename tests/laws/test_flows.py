"""Drag and lift by a speed that was recorded beside the machine: what they do, where they are
tried, and that they are found there and nowhere else. The recordings are made by SciPy alone."""

from collections.abc import Callable

import numpy as np
import pytest
from law_rigs import numbers
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.candidates import force_hypotheses
from symhyb.discrepancy.places.standing import flows_at
from symhyb.laws import drag, flow_drag, flow_lift
from symhyb.laws.base import Law
from symhyb.laws.maths import NUMPY, Motion
from symhyb.laws.reach import Reach
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On

MASS, STIFFNESS, DAMPING = 1.3, 200.0, 0.8
RATE = np.linspace(-2, 2, 41)
TEXT = """
symhyb = 1
title = "a mast in the wind"
[coordinates]
x = { unit = "m" }
[parameters]
m = { value = 1.3, unit = "kg" }
k = { value = 200, unit = "N/m" }
d = { value = 0.8, unit = "N*s/m" }
[inputs]
f = { unit = "N" }
wind = { unit = "UNIT" }
[bodies.mass]
mass = "m"
at = ["x", "0"]
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.damper]
kind = "damper"
on = "x"
damping = "d"
[elements.shaker]
kind = "force"
on = "x"
force = "f"
[sensors]
laser = { measures = "x", unit = "m" }
"""


def mast(unit: str = "m/s", more: str = "") -> Model:
    return parse_model(TEXT.replace("UNIT", unit) + more, "mast.toml")


def force(law: Law, **values: float) -> np.ndarray:
    assert law.action is not None
    does = law.action(NUMPY, Motion(0 * RATE, RATE, (), 0 * RATE), values, {})
    return np.asarray(does.force + 0 * RATE)


def test_drag_in_a_flow_is_drag_where_nothing_flows_and_pushes_what_is_slower() -> None:
    assert force(flow_drag.LAW, drag=0.7, flow=0.0) == pytest.approx(-force(drag.LAW, drag=0.7))
    at_rest = force(flow_drag.LAW, drag=0.7, flow=-1.5)[20]
    assert at_rest == pytest.approx(-0.7 * 1.5**2)
    assert force(flow_drag.LAW, drag=0.7, flow=2.0)[-1] == pytest.approx(0.0)


def test_lift_does_not_depend_on_the_motion_nor_on_the_sign_of_the_flow() -> None:
    for flow in (-1.5, 1.5):
        assert force(flow_lift.LAW, lift=-0.4, flow=flow) == pytest.approx(-0.4 * 1.5**2 + 0 * RATE)


def test_both_are_tried_for_each_flow_and_drag_for_either_way_that_it_is_counted() -> None:
    reach = Reach(RATE, RATE, RATE, RATE, flows=("wind", "gust"))
    tried = [one.options for one in flow_drag.LAW.candidates(reach)]
    assert tried == [(("flow", text),) for text in ("wind", "-wind", "gust", "-gust")]
    tried = [one.options for one in flow_lift.LAW.candidates(reach)]
    assert tried == [(("flow", "wind"),), (("flow", "gust"),)]
    none = Reach(RATE, RATE, RATE, RATE)
    assert not [*flow_drag.LAW.candidates(none), *flow_lift.LAW.candidates(none)]


def test_a_flow_is_an_input_that_no_element_uses_in_a_unit_of_the_rate() -> None:
    used = '[elements.blow]\nkind = "flow_lift"\non = "x"\nlift = "b"\nflow = "wind"\n'
    used += '[elements.blow.parameters]\nb = { value = 0.4, unit = "N*s^2/m^2" }\n'
    assert flows_at(mast(), On("x")) == ("wind",)
    assert flows_at(mast("km/h"), On("x")) == ("wind",)
    for unit in ("rad/s", "K", "m"):
        assert flows_at(mast(unit), On("x")) == ()
    assert flows_at(mast(more=used), On("x")) == ()
    reach = Reach(RATE, RATE, RATE, RATE)
    for model, kinds in ((mast(), {"flow_drag", "flow_lift"}), (mast("K"), set())):
        tried = {one.kind for one in force_hypotheses(model, {On("x"): reach})}
        assert tried & {"flow_drag", "flow_lift"} == kinds


def blown(law: Callable[[float, float], float], way: float = 1.0) -> Recording:
    """8 s at 200 Hz under a multisine of 8 N and a wind of 4 ± 1.5 m/s, recorded with the sign
    ``way``; ``law`` is the force (N) of rate and wind (m/s). Noise 0.3 % of the position."""
    random = np.random.default_rng(3)
    t = np.arange(0, 8, 0.005)
    shaken, phases = np.linspace(0.3, 5, 14), random.uniform(0, 2 * np.pi, 14)
    gusts, others = np.linspace(0.1, 0.8, 6), random.uniform(0, 2 * np.pi, 6)

    def push(s: float) -> float:
        return float(8 * np.sqrt(2 / 14) * np.sin(2 * np.pi * shaken * s + phases).sum())

    def wind(s: float) -> float:
        return 4.0 + float(1.5 * np.sqrt(2 / 6) * np.sin(2 * np.pi * gusts * s + others).sum())

    def rate(s: float, state: np.ndarray) -> list[float]:
        x, v = state
        acts = push(s) + law(v, wind(s))
        return [v, (acts - STIFFNESS * x - DAMPING * v) / MASS]

    run = solve_ivp(rate, (0, 8), [0, 0], t_eval=t, rtol=1e-8, atol=1e-10, max_step=0.005)
    x = run.y[0] + 0.003 * run.y[0].std() * random.standard_normal(t.size)
    inputs = {"f": np.array([push(s) for s in t]), "wind": way * np.array([wind(s) for s in t])}
    return Recording("mast.csv", t, inputs, {"laser": x}, (), "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "way", "truth", "said"),
    [
        (lambda v, w: 0.12 * abs(w - v) * (w - v), 1.0, {"flow_drag.drag": 0.12}, "flow wind"),
        (lambda v, w: 0.12 * abs(w - v) * (w - v), -1.0, {"flow_drag.drag": 0.12}, "flow -wind"),
        (lambda v, w: -0.1 * w**2, 1.0, {"flow_lift.lift": -0.1}, "the square of wind"),
        (lambda v, w: -0.9 * abs(v) * v, 1.0, {"drag.drag": 0.9}, "drag quadratic in speed"),
    ],
    ids=["drag", "against it", "lift", "no wind"],
)
def test_what_a_flow_does_is_found_by_its_name(
    law: Callable[[float, float], float], way: float, truth: dict[str, float], said: str
) -> None:
    diagnosis = sh.diagnose(mast(), blown(law, way))
    assert diagnosis.verdict == "missing physics", diagnosis.sentence
    found = dict(numbers(diagnosis))
    assert found.keys() == truth.keys()
    for key, value in truth.items():
        assert found[key][0] == pytest.approx(value, rel=0.05)
        assert abs(found[key][0] - value) < 4 * found[key][1]
    assert said in diagnosis.sentence
    corrected = sh.apply(mast(), diagnosis.found)
    assert parse_model(corrected.text, "mast.toml").elements == corrected.elements


@pytest.mark.slow
def test_a_wind_that_does_nothing_is_not_named() -> None:
    diagnosis = sh.diagnose(mast(), blown(lambda v, w: 0.0))
    assert diagnosis.verdict == "nothing missing", diagnosis.sentence
