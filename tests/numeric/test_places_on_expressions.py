r"""Laws on sums and differences of coordinates against closed forms and other ways to write them.

 J1       c       J2
(  )===/\/\/\===(  )        twist q1 − q2
 q1               q2
"""

import numpy as np
import pytest
from builders import Entries, model_of, run, spring, value

from symhyb.exact.simulation import simulate
from symhyb.mechanics.show import show_equations
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.scenario import Scenario

J1, J2, C = 1.2, 0.4, 50.0
TURN = np.array([[1.0, 0.0], [1.0, -1.0]])  # q1, q2 to q1, q1 − q2
LAWS: dict[str, Entries] = {
    "spring": {"stiffness": "c", "cubic": "c3"},
    "damper": {"damping": "d", "asymmetry": "n"},
    "drag": {"drag": "b"},
    "friction": {"coulomb": "M", "transition": "w"},
    "gap": {"stiffness": "c", "clearance": "p"},
    "hysteresis": {"stiffness": "c", "beta": "e", "gamma": "e", "play": "p"},
    "friction_dynamic": {"coulomb": "M", "stiffness": "c", "micro_damping": "d"},
    "relaxation": {"stiffness": "c", "damping": "d"},
    "constant": {"constant": "M"},
    "harmonic": {"amplitude": "M", "frequency": "f"},
    "ripple": {"amplitude": "M", "period": "p"},
    "added_mass": {"mass": "J"},
    "torque": {"torque": "M*sin(f*t)"},
    "law": {"torque": "-d*(q1' - q2')**3/w**2"},
}


def shaft(elements: dict[str, Entries], twist: bool = False) -> Model:
    """Two inertias by their angles, or by the angle of the first and the twist ``w12``."""
    second = "q1 - w12" if twist else "q2"
    name = "w12" if twist else "q2"
    start = 0.3 if twist else -0.1
    return model_of(
        coordinates={"q1": {"unit": "rad", "start": 0.2}, name: {"unit": "rad", "start": start}},
        parameters={
            "m": (1.0, "kg"),
            "J1": (J1, "kg*m^2"),
            "J2": (J2, "kg*m^2"),
            "J": (0.3, "kg*m^2"),
            "c": (C, "N*m/rad"),
            "c3": (90.0, "N*m/rad^3"),
            "d": (0.7, "N*m*s/rad"),
            "n": (0.3, "1"),
            "b": (0.2, "N*m*s^2/rad^2"),
            "M": (1.5, "N*m"),
            "w": (0.2, "rad/s"),
            "p": (0.1, "rad"),
            "e": (4.0, "1/rad"),
            "f": (1.7, "Hz"),
        },
        bodies={
            "one": {"mass": "m", "at": ["0", "0"], "inertia": "J1", "angle": "q1"},
            "two": {"mass": "m", "at": ["0", "0"], "inertia": "J2", "angle": second},
        },
        elements=elements,
        sensors={"first": {"measures": "q1", "unit": "rad"}},
    )


def test_two_inertias_on_a_torsional_spring_against_the_closed_form() -> None:
    """The centre turns uniformly, the twist swings at √(c (1/J1 + 1/J2))."""
    model = shaft({"spring": spring("c", on="q1 - q2")})
    t = np.linspace(0, 3, 301)
    found = run(model, t, [0.2, -0.1], [1.0, -2.0])
    omega = np.sqrt(C * (1 / J1 + 1 / J2))
    twist = 0.3 * np.cos(omega * t) + 3.0 / omega * np.sin(omega * t)
    centre = (J1 * (0.2 + t) + J2 * (-0.1 - 2 * t)) / (J1 + J2)
    assert found.q[:, 0] - found.q[:, 1] == pytest.approx(twist, abs=1e-7)
    assert (J1 * found.q[:, 0] + J2 * found.q[:, 1]) / (J1 + J2) == pytest.approx(centre, abs=1e-7)


def test_a_gear_of_a_given_ratio_turns_the_other_side_with_its_moment() -> None:
    """Q = −(∂s/∂q)ᵀF of s = q1 − n·q2: −F on the first, +n·F on the second."""
    machine = build(shaft({"spring": spring("c", on="q1 - n*q2")}))
    force = value(machine.k_e, [0.5, -0.2], [0.0, 0.0], [], [], 0.0, machine.values)
    torque = C * (0.5 + 0.3 * 0.2)
    assert force == pytest.approx([-torque, 0.3 * torque], rel=1e-14)


def test_what_a_damper_takes_is_what_the_energy_falls_by() -> None:
    elements = {
        "spring": spring("c", on="q1 - q2"),
        "damper": {"kind": "damper", "on": "q1 - q2", "damping": "d"},
    }
    t = np.linspace(0, 2, 4001)
    found = run(shaft(elements), t, [0.2, -0.1], [1.0, -2.0])
    twist, rate = (x[:, 0] - x[:, 1] for x in (found.q, found.v))
    stored = (J1 * found.v[:, 0] ** 2 + J2 * found.v[:, 1] ** 2 + C * twist**2) / 2
    power = 0.7 * rate**2
    lost = np.concatenate([[0], np.cumsum((power[1:] + power[:-1]) / 2 * np.diff(t))])
    assert lost[-1] > 0.4 * stored[0]
    assert stored + lost == pytest.approx(np.full(t.size, stored[0]), rel=1e-5)


@pytest.mark.parametrize("kind", LAWS)
def test_every_law_is_the_one_on_a_coordinate_of_twist(kind: str) -> None:
    t, law = np.linspace(0, 2, 201), {"kind": kind, **LAWS[kind]}
    on_twist = {key: str(text).replace("q1' - q2'", "w12'") for key, text in law.items()}
    one = build(shaft({"law": {"on": "q1 - q2", **law}}))
    other = build(shaft({"law": {"on": "w12", **on_twist}}, twist=True))
    apart, same = run(one, t, [0.2, -0.1], [1.0, -2.0]), run(other, t, [0.2, 0.3], [1.0, 3.0])
    assert apart.complete
    assert same.complete
    assert np.abs(apart.q[:, 0] - (0.2 + t)).max() > 1e-3 or kind == "added_mass"
    assert apart.q @ TURN.T == pytest.approx(same.q, abs=1e-6)  # of the integration
    for t_i, q, v, z in zip(t[::10], apart.q[::10], apart.v[::10], apart.z[::10], strict=True):
        drive = z, [], t_i, one.values, np.zeros(2), []
        first = value(one.acceleration, q, v, *drive)
        assert TURN @ first == pytest.approx(value(other.acceleration, TURN @ q, TURN @ v, *drive))


def test_dry_friction_on_a_difference_sticks_exactly() -> None:
    """The wheels turn as one from when the friction has used up their relative speed."""
    model = shaft({"rub": {"kind": "friction", "on": "q1 - q2", "coulomb": "M"}})
    machine, t = build(model), np.linspace(0, 2, 201)
    scenario = Scenario(t, np.array([0.2, -0.1]), np.array([1.0, -2.0]), t, np.empty((201, 0)))
    found = simulate(machine, scenario, exact=True)
    assert found.complete
    stop = 3.0 / (1.5 * (1 / J1 + 1 / J2))
    assert [event.time for event in found.events] == pytest.approx([stop], abs=1e-9)
    after = t > stop
    together = (J1 * 1.0 - J2 * 2.0) / (J1 + J2)
    assert found.v[after] == pytest.approx(np.full((after.sum(), 2), together), abs=1e-10)


def test_an_expression_that_is_a_distance_is_the_spring_between_points() -> None:
    sections = {
        "coordinates": {"x": {"unit": "m"}, "y": {"unit": "mm"}},
        "parameters": {"m": (1.0, "kg"), "k": (30.0, "N/m"), "l": (0.5, "m"), "o": (3.0, "1/s")},
        "points": {"a": ["x", "0"], "b": ["l*sin(o*t)", "y + l"]},
        "bodies": {"one": {"mass": "m", "at": "a"}, "two": {"mass": "m", "at": "b"}},
    }
    between = {"kind": "spring", "between": ["a", "b"], "stiffness": "k", "length": "l"}
    distance = "sqrt((x - l*sin(o*t))**2 + (y + l)**2) - l"
    t = np.linspace(0, 3, 201)
    runs = [
        run(model_of(**sections, elements={"tie": tie}), t, [0.4, 0.1], [0.0, 0.3])
        for tie in (between, spring("k", on=distance))
    ]
    assert runs[0].q == pytest.approx(runs[1].q, abs=1e-8)


def test_the_equations_for_people_show_both_sides() -> None:
    text = show_equations(shaft({"spring": spring("c", on="q1 - q2")}))
    rows = [" ".join(line.split()) for line in text.splitlines()]
    assert "= k_e elements.spring -c*(q1 - q2)" in rows
    assert any(row.endswith("elements.spring c*(q1 - q2)") for row in rows)
