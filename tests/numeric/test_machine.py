"""A model as functions: signs, energies, units, the order of coordinates, and missing mass."""

from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest
from builders import (
    DRIVEN_MASS,
    Entries,
    cart_pole,
    damper,
    double_pendulum,
    model_of,
    oscillator,
    push,
    spring,
    value,
)

from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.constrained import solve_symmetric
from symhyb.numeric.lowered.machine import Machine, build

FAR = 2.0  # the wall stands at −FAR


def force_on(element: Entries, x: float, v: float, f: float = 0.0) -> float:
    """The generalized force of one element on the coordinate of the oscillator."""
    parameters = {
        "k": (3.0, "N/m"),
        "k2": (3.0, "N/m^2"),
        "k3": (3.0, "N/m^3"),
        "d": (2.0, "N*s/m"),
        "b": (2.0, "N*s^2/m^2"),
        "c": (1.5, "N"),
        "w": (0.01, "m/s"),
    }
    machine = build(oscillator({"it": element}, parameters, inputs={"f": {"unit": "N"}}))
    k_e = value(machine.k_e, x, v, [], f, 0, machine.values)
    each = value(machine.elements, x, v, [], f, 0, machine.values)
    assert k_e == pytest.approx(each)
    assert value(machine.discrepancy, x, v, 0, [], f, 0, machine.values) == pytest.approx(-k_e)
    return float(k_e[0])


ON, BETWEEN = {"on": "x"}, {"between": ["wall", "block"]}
# Pulled to the right (x = 0.5) or moving to the right (v = 0.5), what passive elements do on x:
PASSIVE: list[tuple[str, Mapping[str, str], float]] = [
    ("spring", {"stiffness": "k"}, -1.5),
    ("spring", {"cubic": "k3"}, -3 * 0.5**3),
    ("damper", {"damping": "d"}, -1.0),
    ("drag", {"drag": "b"}, -0.5),
    ("friction", {"coulomb": "c", "transition": "w"}, -1.5),
]


@pytest.mark.parametrize(("kind", "keys", "expected"), PASSIVE)
@pytest.mark.parametrize("side", [1, -1])
def test_pulled_to_the_right_it_pulls_to_the_left(
    kind: str, keys: Mapping[str, str], expected: float, side: int
) -> None:
    on = {"kind": kind, **ON, **keys}
    between = {"kind": kind, **BETWEEN, **keys}
    if kind == "spring":
        between["length"] = "far"  # at rest at x = 0
    backwards = {**between, "between": ["block", "wall"]}
    for element in (on, between, backwards):
        assert force_on(element, side * 0.5, side * 0.5) == pytest.approx(side * expected)


def test_a_quadratic_spring_pulls_the_same_way_on_both_sides() -> None:
    element = {"kind": "spring", **ON, "quadratic": "k2"}
    assert [force_on(element, x, 0.0) for x in (0.5, -0.5)] == pytest.approx([-0.75, -0.75])


def test_a_spring_between_points_counts_from_its_length() -> None:
    """Without ``length`` it is slack where the two points meet."""
    element = {"kind": "spring", **BETWEEN, "stiffness": "k"}
    assert force_on(element, 0.0, 0.0) == pytest.approx(-3.0 * FAR)


@pytest.mark.parametrize(
    "on",
    [
        {"kind": "constant", "constant": "c"},
        {"kind": "force", "force": "c + f - f"},
        {"kind": "law", "force": "c"},
    ],
)
def test_active_elements_push_along_the_coordinate_and_pull_points_together(on: Entries) -> None:
    assert force_on({**on, **ON}, 0.2, 0.3, 0.7) == pytest.approx(1.5)
    tension = {key.replace("force", "tension"): text for key, text in on.items()}
    assert force_on({**tension, **BETWEEN}, 0.2, 0.3, 0.7) == pytest.approx(-1.5)


def test_an_input_pushes_along_the_coordinate() -> None:
    assert force_on(push("f"), 0.0, 0.0, 0.7) == pytest.approx(0.7)


def test_a_force_at_a_point_acts_along_the_axes() -> None:
    element = {"kind": "force", "at": "block", "force": ["c", "7*c"]}
    assert force_on(element, 0.2, 0.3) == pytest.approx(1.5)


def test_a_force_at_a_point_does_the_same_work_on_coordinates_and_in_the_plane() -> None:
    """Q·q' = F·r' for any speed of the tip of a pole on a cart, and −F |r'| of drag there."""
    plain = cart_pole()
    text = """
    [elements.wind]
    kind = "force"
    at = "tip"
    force = ["c", "-3*c"]
    [elements.mist]
    kind = "drag"
    at = "tip"
    drag = "b"
    """
    machine = build(parse_model(plain.text + text))
    p = {item.name: item.si for item in plain.parameters}
    rng = np.random.default_rng(6)
    for _ in range(5):
        q, v = rng.normal(size=(2, 2))
        wind, mist = value(machine.elements, q, v, [], 0.3, 0, machine.values)[-2:]
        swing = 2 * p["a"] * v[1]
        tip = np.array([v[0] + swing * np.cos(q[1]), swing * np.sin(q[1])])
        assert wind @ v == pytest.approx(p["c"] * tip[0] - 3 * p["c"] * tip[1])
        assert mist @ v == pytest.approx(-p["b"] * np.hypot(*tip) ** 3)


def test_signs_on_an_angle() -> None:
    """Turned counter-clockwise, a torsion spring turns clockwise; a torque turns as it says."""
    model = model_of(
        coordinates={"phi": {"unit": "rad"}},
        parameters={"J": (0.2, "kg*m^2"), "k": (3.0, "N*m/rad"), "T": (0.5, "N*m")},
        bodies={"disc": {"mass": "J", "at": ["phi", "0"]}},
        elements={
            "hold": spring("k", on="phi"),
            "turn": {"kind": "torque", "on": "phi", "torque": "T"},
        },
    )
    machine = build(model)
    each = value(machine.elements, 0.4, 0.0, [], [], 0, machine.values)
    assert each.ravel() == pytest.approx([-1.2, 0.5])


def test_gravity_pulls_down() -> None:
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"y": {"unit": "m"}},
        parameters={"m": (2.0, "kg"), "g": (9.81, "m/s^2")},
        bodies={"stone": {"mass": "m", "at": ["0*y", "y"]}},
    )
    machine = build(model)
    assert value(machine.k_e, 3.0, 0, [], [], 0, machine.values) == pytest.approx([-19.62])
    _, potential, _ = call(machine.energy, [3.0, 0.0, [], 0.0, machine.values])
    assert float(potential[0, 0]) == pytest.approx(2 * 9.81 * 3)


def test_energies_and_pathways_of_the_cart_and_pole() -> None:
    machine = build(cart_pole())
    p = {item.name: item.si for item in machine.model.parameters}
    q, v, a = np.array([0.1, 0.4]), np.array([-0.3, 1.1]), p["a"]
    kinetic, potential, stored = call(machine.energy, [q, v, [], 0.0, machine.values])
    pole = np.array([v[0] + a * v[1] * np.cos(q[1]), a * v[1] * np.sin(q[1])])
    expected = 0.5 * p["m_c"] * v[0] ** 2 + 0.5 * p["m_p"] * pole @ pole + 0.5 * p["J"] * v[1] ** 2
    assert float(kinetic[0, 0]) == pytest.approx(expected)
    assert float(potential[0, 0]) == pytest.approx(-p["m_p"] * p["g"] * a * np.cos(q[1]))
    distance = np.hypot(q[0] + 2 * a * np.sin(q[1]) - 1.5 * a, 2 * a * (1 - np.cos(q[1])))
    spring_energy = 0.5 * p["k"] * (distance - p["rest"]) ** 2
    assert stored[0] == pytest.approx([0, 0, spring_energy, 0, 0])
    stretch, rate, direction = call(machine.pathways, [q, v, 0.0, machine.values])
    assert stretch[0] == pytest.approx([q[0], q[1], distance - p["rest"], q[0], q[0]])
    assert direction @ v == pytest.approx(rate[0])


def test_a_place_at_a_point_has_no_pathway() -> None:
    model = oscillator(
        {"it": {"kind": "force", "at": "block", "force": ["c", "0"]}}, {"c": (1.0, "N")}
    )
    machine = build(model)
    parts = call(machine.pathways, [0.0, 0.0, 0.0, machine.values])
    assert all(np.isnan(part).all() for part in parts)


def test_a_model_without_elements_and_sensors_has_empty_columns() -> None:
    machine = build(double_pendulum())
    q = v = np.zeros(2)
    assert machine.elements.size_out(0) == (2, 0)
    assert machine.outputs.size_out(0) == (0, 1)
    assert value(machine.k_e, q, v, [], [], 0, machine.values).shape == (2,)


def states(machine: Machine, units: Mapping[str, float]) -> tuple[np.ndarray, ...]:
    """One state and acceleration of the cart and pole, in the order of the machine."""
    chosen = {"x": (0.12, -0.7, 2.0), "phi": (0.5, 1.4, -3.0)}
    rows = [chosen[c.name] for c in machine.model.coordinates]
    assert {c.name: c.unit.factor for c in machine.model.coordinates} == units
    return tuple(np.array(column) for column in zip(*rows, strict=True))


@pytest.mark.parametrize(
    ("model", "units"),
    [
        (cart_pole(length="mm", angle="deg"), {"x": 1e-3, "phi": np.pi / 180}),
        (cart_pole(order=("phi", "x")), {"x": 1.0, "phi": 1.0}),
    ],
    ids=["mm and deg", "other order"],
)
def test_units_and_the_order_of_coordinates_change_nothing(
    model: Model, units: Mapping[str, float]
) -> None:
    """Everything below the model file is SI, so a coordinate in mm gives the same functions."""
    results = []
    for machine in (build(cart_pole()), build(model)):
        expected_units = {"x": 1.0, "phi": 1.0} if not results else units
        q, v, a = states(machine, expected_units)
        order = np.argsort([c.name for c in machine.model.coordinates])
        u, p = [1.3], machine.values
        mass = value(machine.M, q, 0, p)[np.ix_(order, order)]
        vectors = [
            value(machine.k_c, q, v, 0, p),
            value(machine.k_e, q, v, [], u, 0, p),
            value(machine.discrepancy, q, v, a, [], u, 0, p),
            value(machine.acceleration, q, v, [], u, 0, p, np.zeros(2), []),
        ]
        outputs = value(machine.outputs, q, v, a, [], u, 0, p)
        results.append([mass, *(vector[order] for vector in vectors), outputs])
    for first, second in zip(*results, strict=True):
        assert second == pytest.approx(first, rel=1e-12, abs=1e-12)


def test_parameters_in_other_units_are_the_same_machine() -> None:
    plain = build(oscillator({"hold": spring("k")}, {"k": (3000.0, "N/m")}))
    other = build(oscillator({"hold": spring("k")}, {"k": (3.0, "N/mm")}))
    assert other.values == pytest.approx(plain.values)
    assert other.column("k") == 2


def test_start_values_are_in_the_unit_of_the_coordinate() -> None:
    """The mass matrix is judged at the start: at 0 mm it would be singular, at 100 mm it is not."""
    sections = {
        "parameters": {"m": (2.0, "kg"), "l": (1.0, "m")},
        "bodies": {"ball": {"mass": "m", "at": ["x**2/l", "0"]}},
    }
    build(model_of(coordinates={"x": {"unit": "mm", "start": 100.0}}, **sections))
    with pytest.raises(InputError, match="singular"):
        build(model_of(coordinates={"x": {"unit": "mm"}}, **sections))


def test_inputs_that_act_linearly_are_kept_visible() -> None:
    machine = build(cart_pole())
    q, v = np.array([0.1, 0.4]), np.array([-0.3, 1.1])
    assert machine.input_matrix is not None
    B = value(machine.input_matrix, q, v, 0, machine.values)
    assert B.ravel() == pytest.approx([1, 0])
    at = [value(machine.k_e, q, v, [], u, 0, machine.values) for u in (0.0, 2.5)]
    assert at[1] - at[0] == pytest.approx(2.5 * B.ravel())


def test_an_input_that_acts_nonlinearly_has_no_matrix() -> None:
    model = oscillator({"valve": push("c*f**2")}, {"c": (1.0, "1/N")}, inputs={"f": {"unit": "N"}})
    assert build(model).input_matrix is None


def test_gain_and_offset_of_channels() -> None:
    model = oscillator(
        {"motor": push("f")},
        inputs={"f": {"unit": "N", "gain": 1.5, "offset": {"value": 0.25, "unit": "N"}}},
        sensors={
            "laser": {
                "measures": "x",
                "unit": "mm",
                "gain": 0.9,
                "offset": {"value": 2.0, "unit": "mm"},
            }
        },
    )
    machine = build(model)
    assert value(machine.k_e, 0, 0, [], 4.0, 0, machine.values) == pytest.approx([6.25])
    y = value(machine.outputs, 0.3, 0, 0, [], 4.0, 0, machine.values)
    assert y == pytest.approx([0.9 * 0.3 + 0.002])


def test_slopes_of_outputs() -> None:
    sensors = {"mix": {"measures": "3*x + 2*x'*x'/g - 5*l*x''/g", "unit": "m"}}
    more = {"l": (1.0, "m"), "g": (1.0, "m/s^2")}
    machine = build(oscillator({}, more, sensors=sensors))
    slopes = call(machine.output_slopes, [0.3, 0.7, 0.1, [], [], 0.0, machine.values])
    assert [float(slope[0, 0]) for slope in slopes] == pytest.approx([3, 2.8, -5])


def singular(**sections: Entries) -> str:
    with pytest.raises(InputError, match="mass matrix") as caught:
        build(model_of(**sections))
    return str(caught.value)


def test_a_coordinate_without_mass_is_named() -> None:
    text = singular(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "k": (5.0, "N/m")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"hold": spring("k", on="y")},
    )
    assert text.startswith("test.toml: bodies:")
    assert "nothing that moves with y has mass" in text


def test_two_coordinates_that_move_one_mass_are_named() -> None:
    text = singular(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}, "z": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        bodies={
            "block": {"mass": "m", "at": ["x + z", "0"]},
            "other": {"mass": "m", "at": ["y", "0"]},
        },
    )
    assert "singular or not positive definite in x, z" in text or "in z, x" in text


def test_a_kinetic_energy_of_the_wrong_sign_is_named() -> None:
    text = singular(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
        parameters={"m": (1.0, "kg")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        energy={"kinetic": "-0.5*m*y'**2"},
    )
    assert "not positive definite in y" in text


def test_a_mass_matrix_that_is_not_finite_is_named() -> None:
    text = singular(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.0, "kg"), "l": (1.0, "m")},
        bodies={"block": {"mass": "m", "at": ["l*log(x/l)", "0"]}},
    )
    assert "not finite at the start" in text


def test_solving_a_symmetric_system() -> None:
    rng = np.random.default_rng(4)
    half = rng.normal(size=(5, 5))
    matrix, right = half @ half.T + np.eye(5), rng.normal(size=5)
    A, b = ca.SX.sym("A", 5, 5), ca.SX.sym("b", 5)
    found = value(ca.Function("solve", [A, b], [solve_symmetric(A, b)]), matrix, right)
    assert found == pytest.approx(np.linalg.solve(matrix, right), rel=1e-12)


def test_damping_of_all_elements_adds_up() -> None:
    model = oscillator(
        {"one": damper("d"), "two": damper("3*d"), "hold": spring("k")},
        {"d": (2.0, "N*s/m"), "k": (5.0, "N/m")},
    )
    machine = build(model)
    each = value(machine.elements, 0.5, 0.5, [], [], 0, machine.values).ravel()
    assert each == pytest.approx([-1.0, -3.0, -2.5])
    assert value(machine.k_e, 0.5, 0.5, [], [], 0, machine.values) == pytest.approx([each.sum()])


def test_a_stiffness_that_an_input_changes_pushes_and_is_counted_in_no_energy() -> None:
    text = (
        DRIVEN_MASS
        + """
[elements.magnet]
kind = "spring"
on = "x"
stiffness = "k*f/F0"
[parameters.F0]
value = 2.0
unit = "N"
"""
    )
    machine = build(parse_model(text))
    forces = value(machine.elements, 0.5, 0.0, [], [3.0], 0, machine.values).ravel()
    assert forces[-1] == pytest.approx(-25.0 * 3.0 / 2.0 * 0.5)
    _, _, stored = call(
        machine.energy, (np.array([0.5]), np.zeros(1), np.zeros(0), 0.0, machine.values)
    )
    assert stored.ravel()[-1] == 0.0
    assert stored.ravel()[0] == pytest.approx(0.5 * 25.0 * 0.25)
