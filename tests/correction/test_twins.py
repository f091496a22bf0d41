"""Laws that are the same as a parameter, whatever the motion; the parameter is named for both."""

import numpy as np
from builders import damper, model_of, push, recording, spring

from symhyb.correction.search.conventions import with_twins
from symhyb.correction.search.preparing import prepare, settle
from symhyb.correction.search.twins import exact_twins

CART_POLE = {
    "coordinates": {"x": {"unit": "m"}, "phi": {"unit": "rad"}},
    "inputs": {"f": {"unit": "N"}},
    "parameters": {
        "m": {"value": 1.0, "unit": "kg", "sd": 0.1},
        "m_p": {"value": 0.3, "unit": "kg", "sd": 0.03},
        "J": {"value": 0.01, "unit": "kg*m^2", "sd": 0.001},
        "l": {"value": 0.3, "unit": "m"},
        "d": {"value": 0.2, "unit": "N*s/m", "sd": 0.1},
        "k": {"value": 50.0, "unit": "N/m", "sd": 2.0},
        "g": {"value": 9.81, "unit": "m/s^2"},
    },
    "bodies": {
        "cart": {"mass": "m", "at": ["x", "0"]},
        "pole": {
            "mass": "m_p",
            "at": ["x + l*sin(phi)", "-l*cos(phi)"],
            "inertia": "J",
            "angle": "phi",
        },
    },
    "elements": {"spring": spring("k"), "damper": damper("d"), "push": push("f")},
    "sensors": {
        "x": {"measures": "x", "unit": "m"},
        "phi": {"measures": "phi", "unit": "rad"},
    },
}


def test_a_parameter_is_named_for_the_law_that_is_the_same_in_every_motion() -> None:
    model = model_of(gravity=["0", "-g"], **CART_POLE)
    t = np.arange(0, 5, 0.01)
    x, phi = 0.05 * np.sin(5 * t), 0.4 * np.cos(4 * t)
    run = recording(t, {"f": np.sin(5 * t)}, x=x, phi=phi)
    setting = settle(prepare(model, [run], ()))
    pairs = {
        setting.hypotheses[a].path: str(setting.hypotheses[b]) for a, b in exact_twins(setting)
    }
    assert pairs == {
        "m": "added_mass (mass) on x",
        "J": "added_mass (mass) on phi",
        "d": "damper (damping) on x",
        "k": "spring (stiffness) on x",
    }  # the mass of the pole is also weight and acts on both


def test_a_cause_gives_way_once_and_to_none_that_gives_way_itself() -> None:
    assert with_twins([(0, 1)], [(1, 2), (3, 1), (0, 4), (5, 4), (6, 0)]) == ((0, 1), (0, 4))
