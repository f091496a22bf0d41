"""Models from SymPy's mechanics agree with the equations that SymPy derived."""

from dataclasses import replace

import numpy as np
import pytest
import sympy as sp
from sympy.physics.mechanics import (
    KanesMethod,
    LagrangesMethod,
    Particle,
    PinJoint,
    Point,
    ReferenceFrame,
    RigidBody,
    dynamicsymbols,
    inertia,
)
from sympy.physics.mechanics.system import System

import symhyb as sh
from symhyb.model.read import parse_model
from symhyb.numeric.lowered.machine import build

m, M, l, g, k, d = sp.symbols("m M l g k d")  # noqa: E741 - the length of a rod
x, theta, f = dynamicsymbols("x theta f")
t = dynamicsymbols._t
CONSTANTS = {m: (0.3, "kg"), M: (1.2, "kg"), l: (0.5, "m"), g: (9.81, "m/s^2")}
CART = {**CONSTANTS, k: (20.0, "N/m", 2.0), d: (0.4, "N*s/m")}
UNITS = {x: "m", theta: "rad", f: "N"}


def lagranges() -> LagrangesMethod:
    """A cart on a spring with a pendulum, pushed."""
    frame = ReferenceFrame("N")
    cart, bob = Point("cart"), Point("bob")
    cart.set_vel(frame, x.diff(t) * frame.x)
    moving = (x.diff(t) + l * theta.diff(t) * sp.cos(theta)) * frame.x
    bob.set_vel(frame, moving + l * theta.diff(t) * sp.sin(theta) * frame.y)
    bodies = Particle("cart", cart, M), Particle("bob", bob, m)
    kinetic = sum(body.kinetic_energy(frame) for body in bodies)
    potential = -m * g * l * sp.cos(theta) + k * x**2 / 2
    forces = [(cart, (f - d * x.diff(t)) * frame.x)]
    method = LagrangesMethod(kinetic - potential, [x, theta], forcelist=forces, frame=frame)
    method.form_lagranges_equations()
    return method


def kanes(speeds: str = "plain") -> KanesMethod:
    """The same by Kane's method, with rates as speeds, or with the speed of the bob for one."""
    frame = ReferenceFrame("N")
    u, w = dynamicsymbols("u w")
    rod = frame.orientnew("rod", "Axis", [theta, frame.z])
    ground = Point("ground")
    ground.set_vel(frame, 0)
    if speeds == "plain":
        kinematics = [x.diff(t) - u, theta.diff(t) - w]
        rate, turn = u, w
    else:
        kinematics = [x.diff(t) - u, theta.diff(t) - w / l + u / l]
        rate, turn = u, (w - u) / l
    rod.set_ang_vel(frame, turn * frame.z)
    cart = ground.locatenew("cart", x * frame.x)
    cart.set_vel(frame, rate * frame.x)
    bob = cart.locatenew("bob", -l * rod.y)
    bob.v2pt_theory(cart, frame, rod)
    bodies = [Particle("cart", cart, M), Particle("bob", bob, m)]
    loads = [(cart, (f - k * x - d * rate) * frame.x), (bob, -m * g * frame.y)]
    method = KanesMethod(frame, [x, theta], [u, w], kinematics)
    method.kanes_equations(bodies, loads)
    return method


def accelerations(method: object, values: dict[sp.Symbol, float], state: list[float]) -> np.ndarray:
    """What SymPy's own equations give at x, theta, x', theta', f."""
    symbols = [x.diff(t), theta.diff(t), x, theta, f]
    shown = dict(zip(symbols, [*state[2:4], *state[:2], state[4]], strict=True))
    mass = sp.Matrix(method.mass_matrix).subs(values).subs(shown)
    forcing = sp.Matrix(method.forcing).subs(values).subs(shown)
    return np.array(mass.LUsolve(forcing), dtype=float).ravel()


def ours(model: sh.Model, state: list[float]) -> np.ndarray:
    machine = build(model, keep=False)
    q, v = np.array(state[:2]), np.array(state[2:4])
    M_, k_c = machine.M(q, 0.0, machine.values), machine.k_c(q, v, 0.0, machine.values)
    k_e = machine.k_e(q, v, [], state[4:], 0.0, machine.values)
    return np.linalg.solve(np.array(M_), (np.array(k_e) - np.array(k_c)).ravel())


@pytest.mark.parametrize("make", [lagranges, kanes, lambda: kanes("of the bob")])
def test_the_accelerations_are_those_of_sympy(make) -> None:
    model = sh.from_sympy(make(), CART, UNITS, title="Cart with a pendulum")
    values = {symbol: value[0] for symbol, value in CART.items()}
    rng = np.random.default_rng(4)
    reference = lagranges()
    for _ in range(5):
        state = list(rng.normal(size=5))
        np.testing.assert_allclose(
            ours(model, state), accelerations(reference, values, state), rtol=1e-10, atol=1e-12
        )


def test_the_text_is_a_model_file_with_energies_and_forces() -> None:
    model = sh.from_sympy(lagranges(), CART, UNITS, start={theta: 0.3})
    assert parse_model(model.text) == replace(model, file="")
    assert [c.name for c in model.coordinates] == ["x", "theta"]
    assert model.coordinates[1].start == 0.3
    assert [s.name for s in model.sensors] == ["x", "theta"]
    assert '[elements.force_on_x]\nkind = "law"\non = "x"\nforce = "-d*x\' + f"' in model.text
    assert "force_on_theta" not in model.text  # gravity is in the potential
    assert {p.name: p.sd for p in model.parameters}["k"] == 2.0


def test_a_body_in_space() -> None:
    frame = ReferenceFrame("N")
    psi, phi, torque = dynamicsymbols("psi phi torque")
    A, C = sp.symbols("A C")
    cage = frame.orientnew("cage", "Axis", [psi, frame.z])
    rotor = cage.orientnew("rotor", "Axis", [phi, cage.x])
    centre = Point("O")
    centre.set_vel(frame, 0)
    body = RigidBody("rotor", centre, rotor, m, (inertia(rotor, C, A, A), centre))
    kinetic = body.kinetic_energy(frame)
    method = LagrangesMethod(kinetic, [psi, phi], forcelist=[(cage, torque * frame.z)], frame=frame)
    method.form_lagranges_equations()
    given = {A: (2e-3, "kg*m^2"), C: (5e-3, "kg*m^2")}
    units = {psi: "rad", phi: "rad", torque: "N*m"}
    sensors = {"gyro": (psi.diff(t), "deg/s"), "turn": (phi, "deg")}
    model = sh.from_sympy(method, given, units, sensors=sensors)
    assert [s.unit.text for s in model.sensors] == ["deg/s", "deg"]
    machine = build(model, keep=False)
    q, v = [0.2, 0.9], [1.0, 3.0]
    mass = np.array(machine.M(q, 0.0, machine.values))
    np.testing.assert_allclose(mass, np.diag([2e-3, 5e-3]), atol=1e-15)
    np.testing.assert_allclose(np.array(machine.k_c(q, v, 0.0, machine.values)), 0.0, atol=1e-15)


def test_a_system_of_joints() -> None:
    ground, rod = RigidBody("ground"), RigidBody("rod", mass=m)
    angle, speed = dynamicsymbols("angle speed")
    pin = PinJoint("pin", ground, rod, angle, speed, child_point=l * rod.y, joint_axis=ground.z)
    system = System.from_newtonian(ground)
    system.add_joints(pin)
    system.apply_uniform_gravity(-g * ground.y)
    with pytest.raises(sh.InputError, match=r"form_eoms\(\) first"):
        sh.from_sympy(system, CART, {angle: "rad"})
    system.form_eoms()
    inertias = dict.fromkeys(("rod_izz", "rod_ixx", "rod_iyy"), (0.001, "kg*m^2"))
    model = sh.from_sympy(system, {**CART, **inertias}, {angle: "rad"})
    machine = build(model, keep=False)
    mass = float(machine.M([0.4], 0.0, machine.values))
    assert mass == pytest.approx(1e-3 + 0.3 * 0.5**2)
    pull = float(machine.k_e([0.4], [0.0], [], [], 0.0, machine.values))
    assert pull == pytest.approx(-0.3 * 9.81 * 0.5 * np.sin(0.4))


def test_all_that_is_missing_is_said_at_once() -> None:
    with pytest.raises(sh.InputError) as caught:
        sh.from_sympy(lagranges(), {m: (0.3, "kg"), "l": ("long", "m")}, {x: "m"})
    said = str(caught.value)
    for name in ("g", "k", "d", "M"):
        assert f"'{name}' has no value" in said
    assert "'theta' has no unit" in said
    assert "'f' has no unit" in said
    assert "('long', 'm') is no value with its unit" in said


@pytest.mark.parametrize("sensor", ["x", ("__import__('os')", "m"), (x, 3), (x,)])
def test_a_sensor_is_an_expression_with_a_unit_and_text_is_not_evaluated(sensor) -> None:
    with pytest.raises(sh.InputError, match=r"sensors\.laser: .* is no expression of SymPy"):
        sh.from_sympy(lagranges(), CART, UNITS, sensors={"laser": sensor})


def test_units_that_do_not_fit_are_refused() -> None:
    with pytest.raises(sh.InputError, match=r"potential: adds .* in N\*m\^2"):
        sh.from_sympy(lagranges(), {**CART, k: (20.0, "N")}, UNITS)


@pytest.mark.parametrize(
    ("force", "said"),
    [
        (sp.Function("friction")(x.diff(t)), "no function of time"),
        (sp.Piecewise((1, x > 0), (0, True)), "Piecewise"),
        (sp.besselj(0, x), "besselj"),
        (f.diff(t), "no rate or acceleration of a coordinate"),
        (sp.I * x, "finite and real"),
    ],
)
def test_what_a_model_file_cannot_say_is_refused(force: sp.Expr, said: str) -> None:
    frame = ReferenceFrame("N")
    point = Point("P")
    point.set_vel(frame, x.diff(t) * frame.x)
    method = LagrangesMethod(
        m * x.diff(t) ** 2 / 2, [x], forcelist=[(point, force * frame.x)], frame=frame
    )
    method.form_lagranges_equations()
    with pytest.raises(sh.InputError, match=said):
        sh.from_sympy(method, CART, UNITS)


def test_another_object_and_equations_that_are_not_formed() -> None:
    with pytest.raises(sh.InputError, match="a dict is no KanesMethod"):
        sh.from_sympy({}, {}, {})
    with pytest.raises(sh.InputError, match="form_lagranges_equations"):
        sh.from_sympy(LagrangesMethod(m * x.diff(t) ** 2 / 2, [x]), CART, UNITS)
    frame, u = ReferenceFrame("N"), dynamicsymbols("u")
    with pytest.raises(sh.InputError, match="kanes_equations"):
        sh.from_sympy(KanesMethod(frame, [x], [u], [x.diff(t) - u]), CART, UNITS)


def test_constraints_are_refused_with_the_cure() -> None:
    method = LagrangesMethod(
        m * (x.diff(t) ** 2 + theta.diff(t) ** 2) / 2, [x, theta], hol_coneqs=[x - theta]
    )
    method.form_lagranges_equations()
    with pytest.raises(sh.InputError, match=r"\[constraints\]"):
        sh.from_sympy(method, CART, UNITS)


def test_long_sums_are_grouped() -> None:
    frame, point = ReferenceFrame("N"), Point("P")
    point.set_vel(frame, x.diff(t) * frame.x)
    many = sp.symbols("c0:90")
    force = sum(c * sp.sin((i + 1) * x / l) for i, c in enumerate(many))
    method = LagrangesMethod(
        m * x.diff(t) ** 2 / 2, [x], forcelist=[(point, force * frame.x)], frame=frame
    )
    method.form_lagranges_equations()
    model = sh.from_sympy(method, {**CART, **dict.fromkeys(many, (0.1, "N"))}, UNITS)
    assert len(model.parameters) == 92
