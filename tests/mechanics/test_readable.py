"""What `symhyb equations` derives is what the machine computes, for every model that ships."""

import re
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from builders import Array, value
from matplotlib.mathtext import MathTextParser

from symhyb.mechanics.readable import Readable, readable
from symhyb.mechanics.show import show_equations
from symhyb.mechanics.tabulated import TabulatedBase
from symhyb.mechanics.tidy import along
from symhyb.model.expression import parse_expression
from symhyb.model.read import parse_model, read_model
from symhyb.model.types import Between, Element, Model, Network, On
from symhyb.numeric.lowered.machine import Machine, build

MODELS = sorted((Path(__file__).parents[2] / "models").glob("*.toml"))
LARGE = {"bicycle", "six_joint_arm"}  # their numbers are put in for half a minute

EVERY_KIND = """\
symhyb = 1
gravity = ["0", "-g"]
[coordinates]
x = { unit = "m" }
y = { unit = "m" }
phi = { unit = "rad", imposed = true }
[parameters]
g = { value = 9.81, unit = "m/s^2" }
m = { value = 1.3, unit = "kg" }
J = { value = 0.2, unit = "kg*m^2" }
l = { value = 0.4, unit = "m" }
k = { value = 70, unit = "N/m" }
d = { value = 3, unit = "N*s/m" }
b = { value = 0.7, unit = "N*s^2/m^2" }
c = { value = 2, unit = "N" }
cs = { value = 4, unit = "N" }
w = { value = 0.3, unit = "m/s" }
f0 = { value = 1.7, unit = "Hz" }
h = { value = 0.05, unit = "m" }
beta = { value = 3, unit = "1/m^2" }
e = { value = 0.1, unit = "1" }
[inputs]
u = { unit = "N", gain = 1.1, offset = 0.2 }
[points]
wall = ["-l", "h*sin(2*pi*f0*t)"]
block = ["x", "y"]
tip = { body = "arm", at = ["l", "0"] }
[bodies.block]
at = "block"
mass = "m"
[bodies.arm]
joint = "block"
angle = "phi"
mass = "m/2"
at = ["l/2", "0"]
inertia = "J"
[energy]
kinetic = "m*x'*y'*sin(phi)/9"
potential = "0.5*k*x**2*y/l"
[elements]
spring = { kind = "spring", between = ["wall", "tip"], stiffness = "k", length = "l" }
damper = { kind = "damper", between = ["wall", "tip"], damping = "d", asymmetry = "e" }
lag = { kind = "relaxation", between = ["wall", "tip"], stiffness = "k", damping = "d" }
bush = { kind = "hysteresis", on = "x", stiffness = "k", beta = "beta", exponent = 2, play = "h" }
slide = { kind = "friction_dynamic", on = "y", coulomb = "c", stiffness = "k", micro_damping = "d" }
rub = { kind = "friction", on = "x", coulomb = "c", static = "cs", stribeck = "w" }
skid = { kind = "friction", at = "tip", coulomb = "c", transition = "w" }
air = { kind = "drag", at = "tip", drag = "b" }
oil = { kind = "damper", at = "block", damping = "d" }
stop = { kind = "gap", on = "y", stiffness = "k", damping = "d", clearance = "h", side = "upper" }
cog = { kind = "ripple", on = "x", amplitude = "c", period = "h" }
shake = { kind = "harmonic", on = "y", amplitude = "c", frequency = "f0" }
pull = { kind = "harmonic", at = "tip", amplitude = ["c", "2*c"], frequency = "f0" }
drive = { kind = "force", at = "tip", force = ["u*x/l", "u"] }
rope = { kind = "law", between = ["wall", "block"], tension = "c*cos(phi)" }
ball = { kind = "added_inertia", at = "tip", inertia = "J/3" }
loose = { kind = "play", on = "x", stiffness = "k", clearance = "h" }
load = { kind = "mode", on = "x - y", mass = "m/4", frequency = "f0", damping_ratio = "e" }
water = { kind = "added_mass", on = "x", mass = "m/3" }
cable = { kind = "added_mass", between = ["wall", "tip"], mass = "m/5" }
pad = { kind = "curve", between = ["wall", "tip"], over = "rate", scale = "k*l/c", curve = "p" }
tilt = { kind = "law", on = "phi", torque = "l*curve(p, curve(r, phi)*w)" }
[curves]
p = { units = ["m/s", "N"], points = [[-2, -3], [-1, -2], [0, 0], [0.5, 3]] }
r = { units = ["rad", "1"], points = [[-1, 2], [0, 0], [1, 1]], extrapolation = "hold" }
[sensors]
place = { measures = "x + y", unit = "m", gain = 1.2, delay = 0.01, about = "50 % of all_things" }
cell = { measures = "reaction(phi)", unit = "N*m" }
felt = { measures = "accelerometer_x(tip, arm)", unit = "m/s^2" }
"""

ARM_LINK = """\
[bodies.link{i}]
parent = "link{before}"
joint = ["l", "0"]
mass = "m"
at = ["l/2", "0"]
inertia = "J"
angle = "q{i}"
"""


def chain(links: int) -> Model:
    """A cart with a chain of links, each hung on the one before: x, then relative angles."""
    angles = "\n".join(f'q{i} = {{ unit = "rad" }}' for i in range(1, links + 1))
    first = ARM_LINK.format(i=1, before=0).replace('parent = "link0"\n', "")
    first = first.replace('["l", "0"]', '["x", "0"]')
    rest = "".join(ARM_LINK.format(i=i, before=i - 1) for i in range(2, links + 1))
    return parse_model(
        f"""\
symhyb = 1
gravity = ["0", "-g"]
[coordinates]
x = {{ unit = "m" }}
{angles}
[parameters]
g = {{ value = 9.81, unit = "m/s^2" }}
m = {{ value = 1.3, unit = "kg" }}
J = {{ value = 0.2, unit = "kg*m^2" }}
l = {{ value = 0.4, unit = "m" }}
[bodies.cart]
at = ["x", "0"]
mass = "2*m"
{first}{rest}"""
    )


class Evaluated:
    """The numbers of printed expressions at one random state, names resolved in printed order."""

    def __init__(self, derived: Readable, machine: Machine, seed: int):
        s, rng = derived.symbols, np.random.default_rng(seed)
        self.q, self.v, self.a = rng.normal(size=(3, len(s.q)))
        inner = tuple(z for states in s.z.values() for z in states)
        self.z, self.u = rng.normal(size=len(inner)), rng.normal(size=len(s.u))
        self.t, self.p = rng.normal(), machine.values
        rows = (
            (s.q, self.q),
            (s.v, self.v),
            (s.a, self.a),
            (inner, self.z),
            (s.u, self.u),
            (s.p, self.p),
            ((s.t,), [self.t]),
        )
        self.known = {x: float(n) for names, row in rows for x, n in zip(names, row, strict=True)}
        for item in derived.names:
            self.known[item.symbol] = self(item.value)

    def __call__(self, expression: sp.Expr) -> float:
        curves = expression.atoms(TabulatedBase)
        known = {one: sp.Float(one.characteristic(self(one.args[0]))) for one in curves}
        expression = expression.xreplace(known)
        names = list(expression.free_symbols)
        function = sp.lambdify(names, expression, "numpy")
        return float(function(*(self.known[name] for name in names)))


def compare(model: Model, states: int = 5) -> None:
    """Rows of each side add up to the machine's M q'', M, k_c, k_e; z' and y are the machine's."""
    machine = build(model)
    for matrices in (False, True):
        derived = readable(model, matrices)
        for seed in range(states):
            _compare(derived, machine, seed, matrices)


def _compare(derived: Readable, machine: Machine, seed: int, matrices: bool) -> None:
    at = Evaluated(derived, machine, seed)
    mass = np.atleast_2d(value(machine.M, at.q, at.t, at.p))
    expected = {
        "M": mass if matrices else mass @ at.a,
        "k_c": value(machine.k_c, at.q, at.v, at.t, at.p),
        "k_e": value(machine.k_e, at.q, at.v, at.z, at.u, at.t, at.p),
    }
    found: dict[str, Array] = {side: np.zeros_like(row) for side, row in expected.items()}
    for row in derived.rows:
        found[row.side][row.of] += at(row.value)
        if len(set(row.of)) == 2:
            found[row.side][row.of[::-1]] += at(row.value)
    for side, numbers in expected.items():
        scale = np.abs(numbers).max() + 1e-3
        np.testing.assert_allclose(found[side], numbers, rtol=1e-9, atol=1e-11 * scale)
    rates = [at(rate) for _, rate in derived.inner]
    inner = value(machine.inner, at.q, at.v, at.z, at.u, at.t, at.p) if rates else []
    np.testing.assert_allclose(rates, inner, rtol=1e-9)


@pytest.mark.parametrize(
    "path",
    [pytest.param(x, marks=pytest.mark.thorough) if x.stem in LARGE else x for x in MODELS],
    ids=[path.stem for path in MODELS],
)
def test_what_is_printed_is_what_the_machine_computes(path: Path) -> None:
    compare(read_model(path), 3)


@pytest.mark.slow
def test_every_kind_and_place_is_printed_as_it_is_computed() -> None:
    compare(parse_model(EVERY_KIND))


def test_an_inertia_that_is_added_in_space_is_printed_as_it_is_computed() -> None:
    ball = '[elements.ball]\nkind = "added_inertia"\nat = "unit"\ninertia = "A_c/3"\n'
    gyroscope = next(path for path in MODELS if path.stem == "gyroscope")
    text = gyroscope.read_text(encoding="utf-8")
    compare(parse_model(f"{text}\n{ball}"), 3)


@pytest.mark.parametrize("links", [2, 6])
def test_a_chain_is_printed_as_it_is_computed(links: int) -> None:
    compare(chain(links), 2)


def test_a_chain_of_twelve_links_is_short_and_fast() -> None:
    """Σ over 12 bodies of 13 x 13 products of up to 12 sines would fill hundreds of pages."""
    model = chain(12)
    begin = time.process_time()
    for matrices in (False, True):
        text = show_equations(model, matrices=matrices)
        assert max(map(len, text.splitlines())) <= 110
        assert len(text) < 60_000
    assert time.process_time() - begin < 10.0
    assert "x(link3)_q2 = " in text
    assert text.count("sin(") == 12  # each sine once


@pytest.mark.thorough
def test_a_point_that_moves_by_a_long_product_is_no_trap() -> None:
    """Written out, the second derivative of 60 factors has 200 000 of them."""
    tens = ("*".join(f"(1+{i}*x/l)" for i in range(k, k + 10)) for k in range(1, 61, 10))
    factors = "*".join(f"({ten})" for ten in tens)
    model = parse_model(
        f"""\
symhyb = 1
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = 1.3, unit = "kg" }}
l = {{ value = 1e4, unit = "m" }}
[bodies.bead]
mass = "m"
at = ["x", "l*{factors}"]
"""
    )
    begin = time.process_time()
    text = show_equations(model)
    assert time.process_time() - begin < 10.0
    assert len(text) < 60_000
    compare(model, 1)


@pytest.mark.thorough
def test_latex_is_balanced_and_its_formulas_can_be_set() -> None:
    parser = MathTextParser("path")
    texts = [
        show_equations(read_model(path), latex=True) for path in MODELS if path.stem not in LARGE
    ]
    texts += [show_equations(parse_model(EVERY_KIND), True, matrices) for matrices in (False, True)]
    texts.append(show_equations(chain(4), True))
    cells = set()
    for text in texts:
        assert text.count("{") == text.count("}")
        assert text.count(r"\begin{align*}") == text.count(r"\end{align*}")
        formulas = [line for line in text.splitlines() if line.startswith("  ")]
        assert formulas
        for line in formulas:
            # \text may hold a \& of the file, which separates no cells
            plain = re.sub(
                r"\\text\{((?:[^{}\\]|\\.)*)\}", r"\\mathrm{a}", line.removesuffix(r"\\")
            )
            cells |= {cell.strip() for cell in plain.split("&")}
    for cell in sorted(cells - {""})[::4]:  # amsmath itself is not at hand; a quarter takes 2 s
        parser.parse(f"${cell}$")


def test_a_network_is_shown_with_what_it_sees() -> None:
    model = parse_model(EVERY_KIND)
    seen = Network("weights.bin", "0" * 64, (parse_expression("x'"), parse_expression("y")), ())
    left = Element("left", "network", On("x"), (), network=seen)
    right = replace(left, name="right", place=Between("wall", "tip"))
    one = replace(model, elements=(left,), sensors=())
    assert re.search(r"elements\.left +network\(x', y\)\n", show_equations(one))
    two = show_equations(replace(one, elements=(left, right)))
    assert re.search(r"elements\.left +network\.left\(x', y\)\n", two)
    pull = r"-\(l\*cos\(phi\) \+ l \+ x\)\*network\.right\(x', y\)/\|tip - wall\|"
    assert re.search(rf"elements\.right +{pull}\n", two)
    written = show_equations(one, latex=True)
    assert r"{}+{} \mathrm{network}\left(\dot{x}, y\right) && \text{elements.left}" in written


def test_the_derivative_along_a_direction_is_that_of_sympy() -> None:
    x, y, t = sp.symbols("x y t", real=True)
    expression = (
        sp.sin(x + y) ** 3 * sp.atan2(y, x)
        + sp.exp(x * t) ** y
        + sp.sqrt(x**2 + y**2)
        + sp.Max(x, y) * sp.tanh(x / t)
        + sp.Abs(x - y)
        + sp.sign(x)
    )
    ways = {x: sp.Float(0.3), y: sp.Float(-1.2), t: sp.Float(0.7)}
    plain = expression - sp.sign(x)  # SymPy's slope of a step is a Dirac impulse
    expected = sum(sp.diff(plain, symbol) * way for symbol, way in ways.items())
    at = {x: 0.8, y: 1.9, t: 1.1}
    assert float(along(ways)(expression).subs(at)) == pytest.approx(float(expected.subs(at)))
    assert along({x: sp.Symbol("v")})(sp.sin(x + y)) == sp.Symbol("v") * sp.cos(x + y)
