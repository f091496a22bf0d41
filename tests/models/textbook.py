"""The mechanics of every shipped model, written by hand in SymPy and derived by LagrangesMethod.

Nothing here comes from symhyb: numbers are read with ``tomllib`` and converted by a table of this
file, positions of chains are written out as sums of sines, and forces as they act on coordinates.

    M q'' + k_c = k_e        of LagrangesMethod(T): M = mass_matrix, k_c = −forcing
                             by hand: k_e = −∂V/∂q + Q
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import sympy as sp
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from sympy.physics.mechanics import LagrangesMethod, dynamicsymbols

Array = NDArray[np.float64]
MODELS = Path(__file__).parents[2] / "models"
T = dynamicsymbols._t
DEGREE, RPM = np.pi / 180, np.pi / 30

# Every unit that the shipped models give a parameter, an input or a coordinate, by hand.
SI = {
    "1": 1.0,
    "1/mm": 1e3,
    "C": 1.0,
    "N*m": 1.0,
    "N*m*s/rad": 1.0,
    "N*m/rad": 1.0,
    "N*s/m": 1.0,
    "N*s^2/m^2": 1.0,
    "N/A": 1.0,
    "N/m": 1.0,
    "N/m^3": 1.0,
    "N/mm": 1e3,
    "N": 1.0,
    "V": 1.0,
    "deg": DEGREE,
    "g": 1e-3,
    "kN*s/m": 1e3,
    "kN/m": 1e3,
    "kN/mm": 1e6,
    "kg": 1.0,
    "kg*m^2": 1.0,
    "kg/m^3": 1.0,
    "m": 1.0,
    "m/s": 1.0,
    "m/s^2": 1.0,
    "mH": 1e-3,
    "mH*m": 1e-3,
    "mm": 1e-3,
    "ohm": 1.0,
    "rad": 1.0,
    "rpm": RPM,
    "s": 1.0,
    "s^2": 1.0,
    "um": 1e-6,
}


def entries(name: str, section: str) -> dict[str, dict[str, object]]:
    """One table of a model file, as TOML says it."""
    return dict(tomllib.loads((MODELS / f"{name}.toml").read_text()).get(section, {}))


def numbers(name: str) -> dict[str, float]:
    """The parameters of a model file in SI."""
    table = entries(name, "parameters")
    return {key: float(p["value"]) * SI[str(p["unit"])] for key, p in table.items()}


@dataclass(frozen=True)
class Energies:
    """T, V and the other generalized forces Q (n) in dynamicsymbols of time; inputs and inner
    states as plain symbols, and the rates of the inner states."""

    kinetic: sp.Expr
    potential: sp.Expr = sp.S.Zero
    forces: tuple[sp.Expr, ...] = ()
    inner: tuple[sp.Expr, ...] = ()


@dataclass(frozen=True)
class Textbook:
    """A machine by another route: M(q, t), k_c(q, v, t), k_e(q, v, z, u, t), z'(q, v, z), all of
    plain numbers."""

    mass: Callable[..., Array]
    coriolis: Callable[..., Array]
    applied: Callable[..., Array]
    inner: Callable[..., Array]


def textbook(name: str) -> Textbook:
    """Derive one shipped model by LagrangesMethod; the numbers are those of its file."""
    q = [dynamicsymbols(key) for key in entries(name, "coordinates")]
    v = [coordinate.diff(T) for coordinate in q]
    p = {key: sp.Symbol(key) for key in entries(name, "parameters")}
    u = [sp.Symbol(f"in_{key}") for key in entries(name, "inputs")]
    z = [sp.Symbol("z")]
    said = WRITTEN[name](q, p, u, z[0])
    method = LagrangesMethod(said.kinetic, q)
    method.form_lagranges_equations()
    slope = sp.Matrix([-said.potential.diff(coordinate) for coordinate in q])
    acting = slope + sp.Matrix(said.forces or [0] * len(q))
    values = {p[key]: number for key, number in numbers(name).items()}

    def function(arguments: list[object], matrix: sp.Matrix) -> Callable[..., Array]:
        made = sp.lambdify(arguments, matrix.subs(values), modules="numpy", cse=True)
        return lambda *at: np.asarray(made(*at), dtype=float)

    return Textbook(
        function([q, T], method.mass_matrix),
        function([q, v, T], -method.forcing),
        function([q, v, z, u, T], acting),
        function([q, v, z], sp.Matrix([said.inner]) if said.inner else sp.zeros(0, 1)),
    )


Symbols = list[sp.Expr]
Names = Mapping[str, sp.Symbol]


def speed2(x: sp.Expr, y: sp.Expr) -> sp.Expr:
    """The square of the speed of a point."""
    return sp.diff(x, T) ** 2 + sp.diff(y, T) ** 2


def distance(x: sp.Expr, y: sp.Expr) -> sp.Expr:
    return sp.sqrt(x**2 + y**2)


def oscillator(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    return Energies(p["m"] * q[0].diff(T) ** 2 / 2, p["c"] * q[0] ** 4 / 4, (u[0],))


def duffing(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    return Energies(p["m"] * q[0].diff(T) ** 2 / 2, p["k"] * q[0] ** 2 / 2, (u[0],))


def emps(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    return Energies(p["M"] * q[0].diff(T) ** 2 / 2, forces=(u[0],))


def silverbox(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    rate = q[0].diff(T)
    return Energies(p["m"] * rate**2 / 2, p["k"] * q[0] ** 2 / 2, (u[0] - p["d"] * rate,))


def ship_roll(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    inertia = p["m"] * p["i"] ** 2 + p["A"]
    return Energies(inertia * q[0].diff(T) ** 2 / 2, p["m"] * p["g"] * p["GM"] * q[0] ** 2 / 2)


def pendulum(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    inertia = p["J"] + p["m"] * p["l"] ** 2
    height = -p["l"] * sp.cos(q[0])
    return Energies(inertia * q[0].diff(T) ** 2 / 2, p["m"] * p["g"] * height)


def double_pendulum(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    first, second = q[0], q[0] + q[1]
    x = p["l"] * sp.sin(first) + p["a_2"] * sp.sin(second)
    y = -p["l"] * sp.cos(first) - p["a_2"] * sp.cos(second)
    upper = (p["J_1"] + p["m_1"] * p["a_1"] ** 2) * first.diff(T) ** 2
    lower = p["m_2"] * speed2(x, y) + p["J_2"] * second.diff(T) ** 2
    high = -p["m_1"] * p["a_1"] * sp.cos(first) + p["m_2"] * y
    return Energies((upper + lower) / 2, p["g"] * high)


def triple_pendulum(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    kinetic = potential = x = y = angle = sp.Integer(0)
    for bend in q:
        angle += bend
        along, up = p["l"] * sp.cos(angle), p["l"] * sp.sin(angle)
        centre = (x + along / 2, y + up / 2)
        kinetic += p["m"] * (speed2(*centre) + p["l"] ** 2 / 12 * angle.diff(T) ** 2) / 2
        potential += p["m"] * p["g"] * centre[1]
        x, y = x + along, y + up
    return Energies(kinetic, potential, tuple(-p["d"] * bend.diff(T) for bend in q))


def pendulum_on_cart(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    x, first, second = q[0], q[1], q[1] + q[2]
    elbow = (x + p["l_1"] * sp.sin(first), -p["l_1"] * sp.cos(first))
    tip = (elbow[0] + p["l_2"] * sp.sin(second), elbow[1] - p["l_2"] * sp.cos(second))
    upper = ((x + elbow[0]) / 2, elbow[1] / 2)
    lower = ((tip[0] + elbow[0]) / 2, (tip[1] + elbow[1]) / 2)
    kinetic = p["m_c"] * x.diff(T) ** 2 + p["load"] * speed2(*tip)
    kinetic += p["m_1"] * (speed2(*upper) + p["l_1"] ** 2 / 12 * first.diff(T) ** 2)
    kinetic += p["m_2"] * (speed2(*lower) + p["l_2"] ** 2 / 12 * second.diff(T) ** 2)
    potential = p["g"] * (p["m_1"] * upper[1] + p["m_2"] * lower[1] + p["load"] * tip[1])
    wind = [-p["b"] * sp.sqrt(speed2(*tip)) * part.diff(T) for part in tip]
    forces = [sum(w * part.diff(c) for w, part in zip(wind, tip, strict=True)) for c in q]
    forces[0] += u[0] - p["F_c"] * sp.tanh(x.diff(T) / p["w"])
    return Energies(kinetic / 2, potential, tuple(forces))


def cartpole(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    x, phi = q
    a = p["a"]
    pole = p["m_p"] * speed2(x + a * sp.sin(phi), a * sp.cos(phi)) + p["J"] * phi.diff(T) ** 2
    band = distance(x + 2 * a * sp.sin(phi) - 3 * a / 2, 2 * a * (1 - sp.cos(phi))) - p["rest"]
    return Energies(
        (p["m_c"] * x.diff(T) ** 2 + pole) / 2,
        -p["m_p"] * p["g"] * a * sp.cos(phi) + p["k"] * band**2 / 2,
        (u[0], -p["d"] * phi.diff(T)),
    )


def two_link_arm(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    first, second = q[0], q[0] + q[1]
    elbow = (p["l_1"] * sp.cos(first), p["l_1"] * sp.sin(first))
    fore = (elbow[0] + p["a_2"] * sp.cos(second), elbow[1] + p["a_2"] * sp.sin(second))
    hand = (elbow[0] + p["l_2"] * sp.cos(second), elbow[1] + p["l_2"] * sp.sin(second))
    kinetic = (p["J_1"] + p["m_1"] * p["a_1"] ** 2) * first.diff(T) ** 2
    kinetic += p["m_2"] * speed2(*fore) + p["J_2"] * second.diff(T) ** 2
    kinetic += p["load"] * speed2(*hand)
    high = p["m_1"] * p["a_1"] * sp.sin(first) + p["m_2"] * fore[1] + p["load"] * hand[1]
    motors = tuple(u[i] - p[f"d_{i + 1}"] * q[i].diff(T) for i in range(2))
    return Energies(kinetic / 2, p["g"] * high, motors)


def quarter_car(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    z, w, h = q
    kinetic = (p["m_b"] * z.diff(T) ** 2 + p["m_w"] * w.diff(T) ** 2) / 2
    weight = p["g"] * (p["m_b"] * z + p["m_w"] * w)
    rate = z.diff(T) - w.diff(T)
    strut = p["d_s"] * rate * (1 + p["side"] * sp.sign(rate))
    tyre = p["k_t"] * sp.Max(h + p["r"] - w, 0)
    spring = p["k_s"] * (z - w - p["l_s"]) ** 2 / 2
    return Energies(kinetic, weight + spring, (-strut, strut + tyre, -tyre))


def strut(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    rate = q[0].diff(T)
    points = np.array(entries("strut", "elements")["strut"]["points"], dtype=float)
    lost = p["n"] * measured(rate, points[:, 0] * SI["mm"], points[:, 1])
    kinetic, spring = p["m"] * rate**2 / 2, p["k"] * q[0] ** 2 / 2
    return Energies(kinetic, spring, (u[0] - lost,))


def measured(x: sp.Expr, places: Array, values: Array) -> sp.Expr:
    """The monotone cubics of SciPy, and the lines of their end slopes beyond."""
    inner = PchipInterpolator(places, values)
    ends = inner.derivative()(places[[0, -1]])
    pieces = [(values[0] + ends[0] * (x - places[0]), x < places[0])]
    for at, until, cubic in zip(places, places[1:], inner.c.T, strict=False):
        pieces.append((sum(c * (x - at) ** (3 - i) for i, c in enumerate(cubic)), x < until))
    return sp.Piecewise(*pieces, (values[-1] + ends[1] * (x - places[-1]), True))


def half_car(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    z, theta, z_f, z_r = q
    kinetic = p["m"] * z.diff(T) ** 2 + p["J"] * theta.diff(T) ** 2
    kinetic += p["m_w"] * (z_f.diff(T) ** 2 + z_r.diff(T) ** 2)
    potential = p["g"] * (p["m"] * z + p["m_w"] * (z_f + z_r))
    forces = [sp.Integer(0)] * 4
    for arm, hub, k, d in ((p["a"], z_f, "k_f", "d_f"), (-p["b"], z_r, "k_r", "d_r")):
        strut = distance(arm * (sp.cos(theta) - 1), z + arm * sp.sin(theta) - hub)
        potential += p[k] * (strut - p["l_s"]) ** 2 / 2
        forces = [
            force - p[d] * strut.diff(T) * strut.diff(c) for force, c in zip(forces, q, strict=True)
        ]
    for i, hub in ((2, z_f), (3, z_r)):
        forces[i] += p["k_t"] * sp.Max(u[i - 2] + p["r"] - hub, 0)
    return Energies(kinetic / 2, potential, tuple(forces))


def chain_of_masses(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    kinetic = p["m"] * sum(x.diff(T) ** 2 for x in q) / 2
    places = [sp.Integer(0), *q, sp.Integer(0)]
    stretches = [b - a for a, b in pairwise(places)]
    potential = p["k"] * sum(stretch**2 for stretch in stretches) / 2
    return Energies(kinetic, potential, (u[0], *[sp.Integer(0)] * 3))


def two_inertia_backlash(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    motor, twist = q[0].diff(T), q[1].diff(T)
    kinetic = (p["J_m"] * motor**2 + p["J_l"] * (motor - twist) ** 2) / 2
    ahead = p["k"] * (q[1] - p["play"]) + p["d"] * twist
    behind = p["k"] * (q[1] + p["play"]) + p["d"] * twist
    shaft = sp.Piecewise(
        (sp.Max(ahead, 0), q[1] > p["play"]), (sp.Min(behind, 0), q[1] < -p["play"]), (0, True)
    )
    return Energies(kinetic, forces=(u[0] - p["d_m"] * motor, -shaft))


def rotor_imbalance(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    x, y = q
    mass = (x + p["e"] * sp.cos(p["spin"] * T), y + p["e"] * sp.sin(p["spin"] * T))
    springs = (p["k_x"] * x**2 + p["k_y"] * y**2) / 2
    return Energies(
        p["m"] * speed2(*mass) / 2,
        springs + p["m"] * p["g"] * mass[1],
        (-p["d"] * x.diff(T), -p["d"] * y.diff(T)),
    )


def falling_ball(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    area = sp.pi * p["r"] ** 2
    drag = p["c_d"] * p["rho"] * area / 2 * sp.sqrt(speed2(*q))
    return Energies(
        p["m"] * speed2(*q) / 2, p["m"] * p["g"] * q[1], tuple(-drag * x.diff(T) for x in q)
    )


def dropped_ball(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    return Energies(p["m"] * q[0].diff(T) ** 2 / 2, p["m"] * p["g"] * q[0])


def damper_rig(q: Symbols, p: Names, u: Symbols, z: sp.Symbol) -> Energies:
    rate = q[0].diff(T)
    taut = sp.Piecewise((z - p["p"], z > p["p"]), (z + p["p"], z < -p["p"]), (0, True))
    inner = rate - p["b"] * sp.Abs(rate) * z
    return Energies(p["m"] * rate**2 / 2, forces=(-p["k"] * taut,), inner=(inner,))


def rig_alone(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    return Energies(sp.Integer(0))


def loudspeaker(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    x, current = q[0], q[1].diff(T)
    kinetic = (p["m"] * x.diff(T) ** 2 + p["L_e"] * current**2) / 2 + p["Bl"] * x * current
    forces = (-p["d"] * x.diff(T), u[0] - p["R_e"] * current)
    return Energies(kinetic, p["k"] * x**2 / 2, forces)


def maglev(q: Symbols, p: Names, u: Symbols, _: sp.Symbol) -> Energies:
    gap, current = q[0], q[1].diff(T)
    field = (p["L_c"] + p["K"] / (gap + p["a"])) * current**2 / 2
    forces = (sp.Integer(0), u[0] - p["R_e"] * current)
    return Energies(p["m"] * gap.diff(T) ** 2 / 2 + field, -p["m"] * p["g"] * gap, forces)


WRITTEN: Mapping[str, Callable[[Symbols, Names, Symbols, sp.Symbol], Energies]] = {
    written.__name__: written
    for written in (
        oscillator,
        duffing,
        emps,
        silverbox,
        ship_roll,
        pendulum,
        double_pendulum,
        triple_pendulum,
        pendulum_on_cart,
        cartpole,
        two_link_arm,
        quarter_car,
        strut,
        half_car,
        chain_of_masses,
        two_inertia_backlash,
        rotor_imbalance,
        falling_ball,
        damper_rig,
        dropped_ball,
        rig_alone,
        loudspeaker,
        maglev,
    )
}
