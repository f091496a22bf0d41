r"""A pendulum of n links on a cart: deriving and lowering M and k, against three other ways.

    [cart]--> x         links of length l_i without mass, a point mass m_i at the end of each;
       \                q_i from hanging down, against the vertical (absolute) or the link
        o               before (relative); a force f acts on the cart
         \ q_2
          o             M q'' + k = 0,   k = k_c − k_e

The contenders get the form that suits them best: those of SymPy absolute angles, with which they
are many times faster than with relative ones. Every run starts with an empty SymPy cache.
"""

from itertools import count

import casadi as ca
import numpy as np
import sympy as sp
from sympy.core.cache import clear_cache
from sympy.physics import mechanics as me
from sympy.physics.mechanics.models import n_link_pendulum_on_cart
from timing import Row, Work, in_turns, middle, milliseconds

from symhyb.mechanics.equations import derive
from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.lowered.translate import Lowered

_FRESH = count()
ANGLES = ((True, "relative"), (False, "absolute"))


def text_of(n: int, relative: bool, mark: str = "") -> str:
    """The model file of n links; ``mark`` makes the names of its parameters new."""
    g, m, length = f"g{mark}", f"m{mark}_", f"l{mark}_"
    lines = ["symhyb = 1", f'title = "{n} links on a cart"', f'gravity = ["0", "-{g}"]']
    lines += ["[coordinates]", 'x = { unit = "m" }']
    lines += [f'q{i} = {{ unit = "rad" }}' for i in range(1, n + 1)]
    lines += ["[parameters]", f'{g} = {{ value = 9.81, unit = "m/s^2" }}']
    lines += [f'{m}{i} = {{ value = {1 / (i + 1):.4f}, unit = "kg" }}' for i in range(n + 1)]
    lines += [
        f'{length}{i} = {{ value = {0.3 + i / 50:.3f}, unit = "m" }}' for i in range(1, n + 1)
    ]
    lines += ["[inputs]", 'f = { unit = "N" }', "[bodies]"]
    lines += [f'cart = {{ mass = "{m}0", at = ["x", "0"] }}']
    lines += _hung(n, m, length) if relative else _standing(n, m, length)
    lines += ["[elements]", 'motor = { kind = "force", on = "x", force = "f" }']
    return "\n".join(lines) + "\n"


def _hung(n: int, m: str, length: str) -> list[str]:
    lines = []
    for i in range(1, n + 1):
        parent = "cart" if i == 1 else f"link{i - 1}"
        joint = '["0", "0"]' if i == 1 else f'["0", "-{length}{i - 1}"]'
        lines.append(
            f'link{i} = {{ mass = "{m}{i}", parent = "{parent}", joint = {joint}, '
            f'at = ["0", "-{length}{i}"], angle = "q{i}" }}'
        )
    return lines


def _standing(n: int, m: str, length: str) -> list[str]:
    lines, x, y = [], "x", "0"
    for i in range(1, n + 1):
        x, y = f"{x} + {length}{i}*sin(q{i})", f"{y} - {length}{i}*cos(q{i})"
        lines.append(f'link{i} = {{ mass = "{m}{i}", at = ["{x}", "{y}"] }}')
    return lines


def model_of(n: int, relative: bool, mark: str = "") -> Model:
    """The model of n links."""
    return parse_model(text_of(n, relative, mark), "links.toml")


def lowered(model: Model) -> ca.Function:
    """symhyb: (q, v, u, t, p) -> M, k."""
    low = Lowered(derive(model))
    q, v, t = low.q, low.v, low.t
    momentum = ca.gradient(low.kinetic, v)
    k_c = ca.jtimes(momentum, q, v) + ca.jacobian(momentum, t) - ca.gradient(low.kinetic, q)
    k_e = -ca.gradient(low.potential, q) + sum(low.forces)
    results = [ca.jacobian(momentum, v), k_c - k_e]
    return ca.Function("M_k", [q, v, low.u, t, low.p], results, {"cse": True})


def by_hand(n: int, relative: bool) -> ca.Function:
    """The same as an engineer writes it in CasADi, link after link: (q, v, u, t, p) -> M, k."""
    q, v, p = ca.SX.sym("q", n + 1), ca.SX.sym("v", n + 1), ca.SX.sym("p", 2 * n + 2)
    u, t = ca.SX.sym("u"), ca.SX.sym("t")
    g, masses, lengths = p[0], p[1 : n + 2], p[n + 2 :]
    kinetic, potential = masses[0] * v[0] ** 2 / 2, ca.SX(0)
    height, speed_x, speed_y = ca.SX(0), v[0], ca.SX(0)
    angle, spin = ca.SX(0), ca.SX(0)
    for i in range(1, n + 1):
        angle, spin = (angle + q[i], spin + v[i]) if relative else (q[i], v[i])
        length = lengths[i - 1]
        height -= length * ca.cos(angle)
        speed_x += length * ca.cos(angle) * spin
        speed_y += length * ca.sin(angle) * spin
        kinetic += masses[i] * (speed_x**2 + speed_y**2) / 2
        potential += masses[i] * g * height
    momentum = ca.gradient(kinetic, v)
    k = ca.jtimes(momentum, q, v) - ca.gradient(kinetic, q) + ca.gradient(potential, q)
    k[0] -= u
    return ca.Function("hand", [q, v, u, t, p], [ca.jacobian(momentum, v), k], {"cse": True})


def lagrange(n: int) -> tuple[sp.Matrix, sp.Matrix]:
    """SymPy's LagrangesMethod, absolute angles: M and −k."""
    q = me.dynamicsymbols(f"q0:{n + 1}")
    v = [coordinate.diff() for coordinate in q]
    g, f = sp.Symbol("g"), me.dynamicsymbols("f")
    m, lengths = sp.symbols(f"m0:{n + 1}"), sp.symbols(f"l1:{n + 1}")
    frame = me.ReferenceFrame("N")
    kinetic, potential = m[0] * v[0] ** 2 / 2, sp.Integer(0)
    speed_x, speed_y, height = v[0], sp.Integer(0), sp.Integer(0)
    for i in range(1, n + 1):
        speed_x += lengths[i - 1] * sp.cos(q[i]) * v[i]
        speed_y += lengths[i - 1] * sp.sin(q[i]) * v[i]
        height -= lengths[i - 1] * sp.cos(q[i])
        kinetic += m[i] * (speed_x**2 + speed_y**2) / 2
        potential += m[i] * g * height
    cart = me.Point("cart")
    cart.set_vel(frame, v[0] * frame.x)
    method = me.LagrangesMethod(
        kinetic - potential, q, forcelist=[(cart, f * frame.x)], frame=frame
    )
    method.form_lagranges_equations()
    return method.mass_matrix, method.forcing


def kane(n: int) -> tuple[sp.Matrix, sp.Matrix]:
    """SymPy's KanesMethod on the model of this machine that comes with SymPy: M and −k."""
    method = n_link_pendulum_on_cart(n)
    return method.mass_matrix, method.forcing


def apart(n: int, relative: bool) -> float:
    """Largest difference between M, k of symhyb and those written by hand, relative."""
    model, rng = model_of(n, relative), np.random.default_rng(n)
    p = [item.si for item in model.all_parameters()]
    state = [*rng.normal(size=(2, n + 1)), 0.7, 0.0, p]
    ours, theirs = lowered(model)(*state), by_hand(n, relative)(*state)
    pairs = [
        (np.asarray(a.full()), np.asarray(b.full())) for a, b in zip(ours, theirs, strict=True)
    ]
    return max(float(np.abs(a - b).max() / np.abs(b).max()) for a, b in pairs)


def rows(n: int = 12, more: int = 20, repeats: int = 11, slow_repeats: int = 2) -> list[Row]:
    """Bars of deriving and lowering for n links, and the time for ``more``."""
    contenders: dict[str, Work] = {"kane": lambda: kane(n)}
    for relative, name in ANGLES:
        model = model_of(n, relative)
        contenders[name] = lambda model=model: lowered(model)
        contenders[f"{name} by hand"] = lambda relative=relative: by_hand(n, relative)
    times = middle(in_turns(contenders, repeats, clear_cache))
    times |= middle(in_turns({"lagrange": lambda: lagrange(n)}, slow_repeats, clear_cache))
    result = [row for angles in ANGLES for row in _compared(n, *angles, times)]
    for size in (n, more):
        result += _alone(size, min(repeats, 5))
    return result


def _compared(n: int, relative: bool, name: str, times: dict[str, float]) -> list[Row]:
    """The bars against others."""
    part, ours, hand = f"{n} links, {name} angles", times[name], times[f"{name} by hand"]
    sizes = [f.n_instructions() for f in (lowered(model_of(n, relative)), by_hand(n, relative))]
    result = [
        Row(
            part,
            f"time of SymPy's {title} over ours",
            times[other] / ours,
            bar,
            True,
            "×",
            f"{milliseconds(times[other])} (absolute angles), {milliseconds(ours)}",
        )
        for other, bar, title in (("lagrange", 200, "LagrangesMethod"), ("kane", 30, "KanesMethod"))
    ]
    result += [
        Row(
            part,
            "our time over hand-written CasADi",
            ours / hand,
            4,
            False,
            "×",
            f"{milliseconds(ours)}, {milliseconds(hand)}",
        ),
        Row(
            part,
            "instructions of (M, k) over hand-written CasADi",
            sizes[0] / sizes[1],
            1.6,
            False,
            "×",
            f"{sizes[0]}, {sizes[1]}; M and k differ by {apart(n, relative):.0e}",
        ),
    ]
    return result


def _alone(n: int, repeats: int) -> list[Row]:
    """Times of ours, s; those of twenty links have a bar."""
    result = []
    for relative, name in ANGLES:
        model = model_of(n, relative)
        contenders: dict[str, Work] = {
            "derive": lambda model=model: lowered(model),
            "build": lambda relative=relative: build(model_of(n, relative, f"x{next(_FRESH)}")),
        }
        times = middle(in_turns(contenders, repeats, clear_cache))
        bar = 0.5 if n >= 20 else None
        result += [
            Row(
                f"{n} links, {name} angles",
                "M and k derived and lowered",
                times["derive"],
                bar,
                False,
                " s",
            ),
            Row(
                f"{n} links, {name} angles",
                "from the text of the file to all 16 functions",
                times["build"],
                None,
                False,
                " s",
            ),
        ]
    return result
