"""M, k_c and k_e against SymPy's LagrangesMethod, which differentiates through time."""

from collections.abc import Mapping

import numpy as np
import pytest
import sympy as sp
from builders import cart_pole, double_pendulum, pendulum, value
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

from symhyb.model.types import Model
from symhyb.numeric.machine import build

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
        k_e = value(machine.k_e, at, v, u, 0, machine.values)
        applied = forcing[:, 0] - inertial[:, 0]  # −∂V/∂q
        if n == 2 and u.size:
            applied = applied + dissipation(v, p) + np.array([u[0], 0])
        close = {"rel": 1e-9, "abs": 1e-9}
        assert np.atleast_2d(value(machine.M, at, 0, machine.values)) == pytest.approx(
            mass, **close
        )
        assert k_c == pytest.approx(-inertial[:, 0], **close)
        assert k_e == pytest.approx(applied, **close)
        gap = value(machine.discrepancy, at, v, a, u, 0, machine.values)
        assert gap == pytest.approx(mass @ a - inertial[:, 0] - applied, **close)
        w = rng.normal(size=n)
        found = value(machine.acceleration, at, v, u, 0, machine.values, w)
        assert found == pytest.approx(np.linalg.solve(mass, inertial[:, 0] + applied + w), **close)
