"""Equations for people: what is printed is what is computed, and it can be read."""

import math
import re
import time
from pathlib import Path

import pytest
from builders import Array, damper, double_pendulum, model_of, oscillator, pendulum, push, spring

from symhyb.mechanics.show import WIDTH, show_equations
from symhyb.mechanics.words import reading_in_words
from symhyb.model.expression import READINGS, Reading, evaluate, parse_expression
from symhyb.model.read import read_model
from symhyb.model.types import Model

MODELS = Path(__file__).parents[2] / "models"


def test_cart_and_pole_reads_like_the_mechanics_book() -> None:
    begin = time.process_time()
    text = show_equations(read_model(MODELS / "cartpole.toml"))
    assert time.process_time() - begin < 1.0
    rows = [re.sub(" +", " ", line.strip()) for line in text.splitlines()]
    band = "|tip - post|"
    for row in (
        "x [m], position of the cart along the rail",
        "M q'' bodies.cart m_c*x''",
        "bodies.pole a*m_p*phi''*cos(phi) + m_p*x''",
        "+ k_c bodies.pole -a*m_p*phi'**2*sin(phi)",
        "= k_e elements.motor push",
        f"elements.band -k*(-rest + {band})*(2*a*sin(phi) - 3*a/2 + x)/{band}",
        "M q'' bodies.pole a*m_p*x''*cos(phi) + phi''*(J + a**2*m_p)",
        "+ k_c 0",
        "= k_e gravity on pole -a*g*m_p*sin(phi)",
        "elements.bearing -d*phi'",
        f"{band} = sqrt((-2*a*cos(phi) + 2*a)**2 + (2*a*sin(phi) - 3*a/2 + x)**2)",
        "J 0.0075 ± 0.0005 kg*m^2 pole about its centre",
        "a 0.3 m pivot to centre of mass",
        "pole [rad] = phi encoder in the pivot",
    ):
        assert row in rows, row
    assert max(map(len, text.splitlines())) <= WIDTH


def rows_of(model: Model, matrices: bool = False) -> list[str]:
    text = show_equations(model, matrices=matrices)
    return [re.sub(" +", " ", line.strip()) for line in text.splitlines()]


def test_the_printed_text_is_the_equation_in_the_notation_of_the_model_file() -> None:
    """Read back what is printed of (J + m l²) φ'' = −m g l sin φ and put numbers in."""
    model = pendulum()
    p = {(item.name, 0): item.si for item in model.parameters}
    values: dict[tuple[str, int] | str, Array | float] = {
        **p,
        ("phi", 0): 0.4,
        ("phi", 1): 1.1,
        ("phi", 2): -2.0,
    }
    (inertia,) = (row for row in rows_of(model) if row.startswith("M q''"))
    (weight,) = (row for row in rows_of(model) if row.startswith("= k_e"))
    left = evaluate(parse_expression(inertia.removeprefix("M q'' bodies.rod ")).tree, values)
    right = evaluate(parse_expression(weight.removeprefix("= k_e gravity on rod ")).tree, values)
    assert left == pytest.approx((0.01 + 0.4 * 0.3**2) * -2.0, rel=1e-12)
    assert right == pytest.approx(-0.4 * 9.81 * 0.3 * math.sin(0.4), rel=1e-12)


def test_angles_of_a_chain_appear_as_differences() -> None:
    rows = rows_of(double_pendulum())
    assert "M q'' bodies.upper alpha''*l1**2*m1" in rows
    assert "bodies.lower alpha''*l1**2*m2 + beta''*l1*l2*m2*cos(alpha - beta)" in rows
    assert "+ k_c bodies.lower beta'**2*l1*l2*m2*sin(alpha - beta)" in rows


def test_matrices_are_summed_up_entry_by_entry() -> None:
    rows = rows_of(double_pendulum(), matrices=True)
    begin = rows.index("M, symmetric; entries not shown are 0")
    assert rows[begin + 1 :] == [
        "[alpha, alpha] l1**2*(m1 + m2)",
        "[alpha, beta] l1*l2*m2*cos(alpha - beta)",
        "[beta, beta] l2**2*m2",
        "",
        "k_c; entries not shown are 0",
        "[alpha] beta'**2*l1*l2*m2*sin(alpha - beta)",
        "[beta] -alpha'**2*l1*l2*m2*sin(alpha - beta)",
        "",
        "k_e; entries not shown are 0",
        "[alpha] -g*l1*m1*sin(alpha) - g*l1*m2*sin(alpha)",
        "[beta] -g*l2*m2*sin(beta)",
        *rows[-7:],
    ]
    text = show_equations(double_pendulum(), latex=True, matrices=True)
    assert r"M_{\alpha,\beta} &= l_{1} l_{2} m_{2} \cos{\left(\alpha - \beta \right)} \\" in text


def test_two_masses_on_springs_and_a_lag_with_its_inner_state() -> None:
    model = model_of(
        coordinates={"x": {"unit": "m"}, "y": {"unit": "m", "imposed": True}},
        parameters={"m": (1.2, "kg"), "k": (5.0, "N/m"), "d": (2.0, "N*s/m"), "l": (1.0, "m")},
        points={"one": ["x", "0"], "two": ["l + y", "0"]},
        bodies={"first": {"mass": "m", "at": "one"}, "second": {"mass": "2*m", "at": "two"}},
        elements={
            "base": spring("k"),
            "lag": {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"},
            "water": {"kind": "added_mass", "on": "y", "mass": "m/2"},
        },
        sensors={"cell": {"measures": "reaction(y)", "unit": "N", "delay": 0.1}},
    )
    rows = rows_of(model)
    begin = rows.index("x [m]")
    assert rows[begin : begin + 14] == [
        "x [m]",
        "M q'' bodies.first m*x''",
        "+ k_c 0",
        "= k_e elements.base -k*x",
        "elements.lag -k*(x - z(lag))",
        "",
        "y [m]",
        "M q'' bodies.second 2*m*y''",
        "elements.water m*y''/2",
        "+ k_c 0",
        "= k_e 0",
        "imposed reaction(y): the motion of y is given; this force is what it takes",
        "",
        "rates of the inner states",
    ]
    assert "z(lag)' = k*(x - z(lag))/d" in rows
    assert "cell [N] = reaction(y) recorded cell.delay later" in rows
    assert rows[-1] == ("reaction(y): the force that gives y its imposed motion, M q'' + k_c - k_e")
    written = latex(model)
    assert r"\dot{z_{\text{lag}}} &= \frac{k \left(x - z_{\text{lag}}\right)}{d}" in written
    assert r"& {}+{} \mathrm{reaction}(y) && \text{imposed motion}" in written


def test_every_instrument_has_words() -> None:
    for what, places in READINGS.items():
        words = reading_in_words(Reading(what, tuple(f"p{i}" for i in range(len(places)))))
        assert "p0" in words
        assert "(" not in words
        assert len(places) == 1 or "p1" in words


def test_functions_are_written_as_in_the_model_file_and_a_law_keeps_its_form() -> None:
    model = oscillator(
        {
            "air": {"kind": "drag", "on": "x", "drag": "b"},
            "law": {"kind": "law", "on": "x", "force": "max(k*x, 0*k*x) - min(f0, k*abs(x))"},
            "lid": {"kind": "force", "at": "block", "force": ["f0*cos(x/l)", "0"]},
        },
        {"b": (0.5, "N*s^2/m^2"), "k": (3.0, "N/m"), "f0": (2.0, "N"), "l": (1.0, "m")},
    )
    text = show_equations(model)
    assert re.search(r"elements\.air +-b\*x'\*abs\(x'\)\n", text)
    assert re.search(r"elements\.law +max\(0, k\*x\) - min\(f0, k\*abs\(x\)\)\n", text)
    assert re.search(r"elements\.lid +f0\*cos\(x/l\)\n", text)


def test_a_moving_support_shows_the_part_of_k_c_that_comes_from_time() -> None:
    """T = ½ m (x' + A w cos(w t))², so k_c = ∂p/∂t = −m A w² sin(w t)."""
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "A": (0.1, "m"), "w": (3.0, "1/s")},
        bodies={"block": {"mass": "m", "at": ["x + A*sin(w*t)", "0"]}},
    )
    rows = rows_of(model)
    assert "+ k_c bodies.block -A*m*w**2*sin(t*w)" in rows
    assert "= k_e 0" in rows


def test_declared_energies_are_named_beside_gravity() -> None:
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"y": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "g": (9.81, "m/s^2"), "k": (5.0, "N/m")},
        bodies={"block": {"mass": "m", "at": ["0*y", "y"]}},
        energy={"potential": "0.5*k*y**2"},
    )
    text = show_equations(model)
    assert re.search(r"= k_e +energy\.potential +-k\*y\n", text)
    assert re.search(r" gravity on block +-g\*m\n", text)


def test_points_on_one_line_need_no_distance() -> None:
    model = oscillator(
        {"bar": {"kind": "spring", "between": ["wall", "block"], "stiffness": "k"}},
        {"k": (5.0, "N/m")},
    )
    assert "|" not in show_equations(model)


def test_a_product_of_many_sums_is_not_multiplied_out() -> None:
    factors = "*".join(f"(1 + a*{i}*x)" for i in range(1, 40))
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "a": (1.0, "1/m")},
        energy={"kinetic": f"0.5*m*x'**2*{factors}"},
    )
    begin = time.process_time()
    assert "(39*a*x + 1)" in show_equations(model)
    assert time.process_time() - begin < 5.0


def latex(model: Model) -> str:
    text = show_equations(model, latex=True)
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")
    assert text.count(r"\begin{align*}") == text.count(r"\end{align*}")
    return text


def test_latex_has_dots_for_rates_and_the_element_beside_its_force() -> None:
    text = latex(read_model(MODELS / "cartpole.toml"))
    assert r"& m_{c} \ddot{x} && M \ddot{q},\ \text{bodies.cart} \\" in text
    assert (
        r"& {}-{} a m_{p} \dot{\phi}^{2} \sin{\left(\phi \right)} && k_c,\ \text{bodies.pole} \\"
        in text
    )
    assert r"& {}={} \mathit{push} && \text{elements.motor} \\" in text
    assert r"& {}-{} d \dot{\phi} && \text{elements.bearing} \\" in text
    assert r"J &= 0.0075 \pm 0.0005\ \mathrm{kg\,m^{2}} \\" in text


def test_latex_escapes_names_and_keeps_the_signs_of_sums() -> None:
    law = {
        "kind": "law",
        "on": "theta_1",
        "torque": "-b*theta_1 - c*theta_1**3",
        "parameters": {"b": (2.0, "N*m/rad"), "c": (4.0, "N*m/rad^3")},
    }
    model = model_of(
        coordinates={"theta_1": {"unit": "rad"}},
        parameters={"J": (0.2, "kg*m^2"), "k": (3.0, "N*m/rad")},
        bodies={"disc": {"mass": "J/(1 - 0)", "at": ["theta_1", "0"]}},
        elements={"hold": spring("k", on="theta_1"), "found_law": law},
    )
    text = latex(model)
    assert r"\ddot{\theta}_{1}" in text
    assert r"& {}={} - k \theta_{1} && \text{elements.hold} \\" in text
    b, c = (rf"{{{name}}}_{{\text{{found\_law}}}}" for name in "bc")
    assert rf"{{}}+{{}} \left(- {b} \theta_{{1}} - {c} \theta_{{1}}^{{3}}\right)" in text
    assert rf"{b} &= 2.0\ \mathrm{{N\,m/rad}} \\" in text


def test_latex_of_a_free_mass_and_of_a_title_with_line_breaks() -> None:
    model = oscillator(
        {"hold": damper("d"), "pull": push("f")}, {"d": (1.0, "N*s/m"), "f": (2.0, "N")}
    )
    assert latex(model).startswith("% test\n% x:")
    free = oscillator({})
    assert r"{}={} 0 && \text{}" in latex(free)
