"""M, k_c and k_e against SymPy's LagrangesMethod, which differentiates through time."""

from collections.abc import Mapping

import numpy as np
import pytest
import sympy as sp
from builders import cart_pole, double_pendulum, model_of, pendulum, value
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build

T = sp.Symbol("t")


def parameters(model: Model) -> Mapping[str, float]:
    return {item.name: item.si for item in model.parameters}


def pendulum_energies() -> tuple[list[sp.Expr], sp.Expr, sp.Expr]:
    g, m, length, J = sp.symbols("g m l J")
    (phi,) = q = dynamicsymbols("phi,")
    return list(q), (J + m * length**2) * phi.diff(T) ** 2 / 2, -m * g * length * sp.cos(phi)


def cart_pole_energies() -> tuple[list[sp.Expr], sp.Expr, sp.Expr]:
    g, m_c, m_p, a, J, k, rest = sp.symbols("g m_c m_p a J k rest")
    x, phi = q = dynamicsymbols("x phi")
    speed = (x + a * sp.sin(phi)).diff(T) ** 2 + (a * sp.cos(phi)).diff(T) ** 2
    kinetic = m_c * x.diff(T) ** 2 / 2 + m_p * speed / 2 + J * phi.diff(T) ** 2 / 2
    stretch = sp.sqrt(
        (x + 2 * a * sp.sin(phi) - sp.Rational(3, 2) * a) ** 2 + (2 * a * (1 - sp.cos(phi))) ** 2
    )
    return q, kinetic, -m_p * g * a * sp.cos(phi) + k * (stretch - rest) ** 2 / 2


def double_pendulum_energies() -> tuple[list[sp.Expr], sp.Expr, sp.Expr]:
    g, l1, l2, m1, m2 = sp.symbols("g l1 l2 m1 m2")
    alpha, beta = q = dynamicsymbols("alpha beta")
    x, y = l1 * sp.sin(alpha), -l1 * sp.cos(alpha)
    far_x, far_y = x + l2 * sp.sin(beta), y - l2 * sp.cos(beta)
    kinetic = m1 * (x.diff(T) ** 2 + y.diff(T) ** 2) / 2
    kinetic += m2 * (far_x.diff(T) ** 2 + far_y.diff(T) ** 2) / 2
    return q, kinetic, m1 * g * y + m2 * g * far_y


def swing() -> Model:
    """A pendulum whose rod is wound up in time, on a support that is shaken up and down,
    with a flywheel that changes in time. What is explicit in t is in M, ∂p/∂t and ∂T/∂q."""
    return model_of(
        gravity=["0", "-g"],
        coordinates={"x": {"unit": "m"}, "phi": {"unit": "rad"}},
        parameters={
            "g": (9.81, "m/s^2"),
            "m": (0.4, "kg"),
            "n": (0.7, "kg"),
            "l": (0.6, "m"),
            "s": (0.1, "m"),
            "w": (3.0, "1/s"),
            "c": (0.2, "1/s"),
        },
        points={
            "support": ["x", "s*sin(w*t)"],
            "bob": ["x + l*(1 - c*t)*sin(phi)", "s*sin(w*t) - l*(1 - c*t)*cos(phi)"],
        },
        bodies={"cart": {"mass": "n", "at": "support"}, "bob": {"mass": "m", "at": "bob"}},
        energy={"kinetic": "m*l**2*(1 + c*t)*phi'**2"},
    )


def swing_energies() -> tuple[list[sp.Expr], sp.Expr, sp.Expr]:
    g, m, n, l, s, w, c = sp.symbols("g m n l s w c")  # noqa: E741
    x, phi = q = dynamicsymbols("x phi")
    lift, rod = s * sp.sin(w * T), l * (1 - c * T)
    far, low = x + rod * sp.sin(phi), lift - rod * sp.cos(phi)
    kinetic = n * (x.diff(T) ** 2 + lift.diff(T) ** 2) / 2
    kinetic += m * (far.diff(T) ** 2 + low.diff(T) ** 2) / 2
    kinetic += m * l**2 * (1 + c * T) * phi.diff(T) ** 2
    return q, kinetic, n * g * lift + m * g * low


def test_equations_that_depend_on_time() -> None:
    """k_c = (∂p/∂q) v + ∂p/∂t − ∂T/∂q of a moving support, M(q,t) and ∂V/∂q at random times."""
    model, (q, kinetic, potential) = swing(), swing_energies()
    numbers = {sp.Symbol(name): number for name, number in parameters(model).items()}
    functions = []
    for L, what in ((kinetic, "mass_matrix"), (kinetic, "forcing"), (-potential, "forcing")):
        method = LagrangesMethod(L, q)
        method.form_lagranges_equations()
        matrix = getattr(method, what).subs(numbers)
        functions.append(sp.lambdify([q, [x.diff(T) for x in q], T], matrix))
    machine = build(model)
    rng = np.random.default_rng(8)
    moved = []
    for _ in range(20):
        at, v, t = rng.normal(size=2), rng.normal(size=2), rng.uniform(0, 3)
        mass, inertial, applied = (np.asarray(f(at, v, t), float) for f in functions)
        close = {"rel": 1e-9, "abs": 1e-9}
        assert value(machine.M, at, t, machine.values) == pytest.approx(mass, **close)
        k_c = value(machine.k_c, at, v, t, machine.values)
        assert k_c == pytest.approx(-inertial[:, 0], **close)
        k_e = value(machine.k_e, at, v, [], [], t, machine.values)
        assert k_e == pytest.approx(applied[:, 0], **close)
        moved.append(k_c - value(machine.k_c, at, v, 0, machine.values))
    assert np.abs(moved).min(axis=0).max() > 1e-3  # time itself matters


def dissipation(v: np.ndarray, p: Mapping[str, float]) -> np.ndarray:
    """The non-conservative forces of the cart and pole, without its motor."""
    rail = p["c"] * np.tanh(v[0] / p["w"]) + p["b"] * abs(v[0]) * v[0]
    return -np.array([rail, p["d"] * v[1]])


CASES = [
    (pendulum(), pendulum_energies()),
    (cart_pole(), cart_pole_energies()),
    (double_pendulum(), double_pendulum_energies()),
]


@pytest.mark.parametrize(("model", "energies"), CASES, ids=["pendulum", "cart pole", "double"])
def test_equations_of_motion_at_random_states(
    model: Model, energies: tuple[list[sp.Expr], sp.Expr, sp.Expr]
) -> None:
    q, kinetic, potential = energies
    p = parameters(model)
    numbers = {sp.Symbol(name): number for name, number in p.items()}
    unforced, full = (LagrangesMethod(L, q) for L in (kinetic, kinetic - potential))
    functions = []
    for method, what in ((full, "mass_matrix"), (full, "forcing"), (unforced, "forcing")):
        method.form_lagranges_equations()
        matrix = getattr(method, what).subs(numbers)
        functions.append(sp.lambdify([q, [x.diff(T) for x in q]], matrix))
    machine, n = build(model), len(q)
    rng = np.random.default_rng(3)
    for _ in range(20):
        at, v, a = rng.normal(size=(3, n))
        u = rng.normal(size=len(model.inputs))
        mass, forcing, inertial = (np.asarray(f(at, v), float) for f in functions)
        k_c = value(machine.k_c, at, v, 0, machine.values)
        k_e = value(machine.k_e, at, v, [], u, 0, machine.values)
        applied = forcing[:, 0] - inertial[:, 0]  # −∂V/∂q
        if n == 2 and u.size:
            applied = applied + dissipation(v, p) + np.array([u[0], 0])
        close = {"rel": 1e-9, "abs": 1e-9}
        assert np.atleast_2d(value(machine.M, at, 0, machine.values)) == pytest.approx(
            mass, **close
        )
        assert k_c == pytest.approx(-inertial[:, 0], **close)
        assert k_e == pytest.approx(applied, **close)
        gap = value(machine.discrepancy, at, v, a, [], u, 0, machine.values)
        assert gap == pytest.approx(mass @ a - inertial[:, 0] - applied, **close)
        w = rng.normal(size=n)
        found = value(machine.acceleration, at, v, [], u, 0, machine.values, w, [])
        assert found == pytest.approx(np.linalg.solve(mass, inertial[:, 0] + applied + w), **close)


def test_the_weak_form_is_the_balance_without_accelerations() -> None:
    """ΔF = p' − (∂T/∂q + k_e) along a motion: p differentiated in time, no q'' given to it."""
    machine, step = build(swing()), 1e-4

    def motion(t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        q = np.array([0.3 * np.sin(2 * t), 0.5 * np.cos(3 * t)])
        v = np.array([0.6 * np.cos(2 * t), -1.5 * np.sin(3 * t)])
        return q, v, np.array([-4 * q[0], -9 * q[1]])

    def weak(t: float) -> tuple[np.ndarray, ...]:
        q, v, _ = motion(t)
        return tuple(part[0] for part in call(machine.weak, (q, v, [], [], t, machine.values)))

    for t in np.linspace(0.1, 2, 7):
        ahead, behind = weak(t + step)[0], weak(t - step)[0]
        q, v, a = motion(t)
        rest = value(machine.discrepancy, q, v, a, [], [], t, machine.values)
        assert (ahead - behind) / (2 * step) - weak(t)[1] == pytest.approx(rest, abs=1e-5)
