"""Equations for people: what is printed is what is computed, and it can be read."""

import re
import time
from pathlib import Path

import numpy as np
import pytest
from builders import damper, double_pendulum, model_of, oscillator, push, spring, value

from symhyb.mechanics.show import WIDTH, show_equations
from symhyb.model.expression import evaluate, parse_expression
from symhyb.model.read import read_model
from symhyb.model.types import Model
from symhyb.numeric.machine import build

MODELS = Path(__file__).parents[2] / "models"


def blocks(model: Model) -> dict[str, str]:
    """The printed equation of each coordinate, without line breaks in a row."""
    parts = show_equations(model).split("\n\n")
    return {part.split(" [")[0]: re.sub(r"\n {12,}(?=\S*[-+(*])", " ", part) for part in parts}


def test_cart_and_pole_reads_like_the_mechanics_book() -> None:
    begin = time.perf_counter()
    text = show_equations(read_model(MODELS / "cartpole.toml"))
    assert time.perf_counter() - begin < 1.0
    rows = [re.sub(" +", " ", line.strip()) for line in text.splitlines()]
    band = "|tip - post|"
    for row in (
        "x [m], position of the cart along the rail",
        "M q'' a*m_p*phi''*cos(phi) + x''*(m_c + m_p)",
        "+ k_c -a*m_p*phi'**2*sin(phi)",
        "= k_e elements.motor push",
        f"elements.band -k*(-rest + {band})*(2*a*sin(phi) - 1.5*a + x)/{band}",
        "M q'' a*m_p*x''*cos(phi) + phi''*(J + a**2*m_p)",
        "+ k_c 0",
        "= k_e gravity -a*g*m_p*sin(phi)",
        "elements.bearing -d*phi'",
        f"{band} = sqrt((-2*a*cos(phi) + 2*a)**2 + (2*a*sin(phi) - 1.5*a + x)**2)",
        "J 0.0075 ± 0.0005 kg*m^2 pole about its centre",
        "a 0.3 m pivot to centre of mass",
    ):
        assert row in rows, row
    assert max(map(len, text.splitlines())) <= WIDTH


def test_the_printed_rows_add_up_to_the_numbers_of_the_machine() -> None:
    model = double_pendulum()
    machine = build(model)
    rng = np.random.default_rng(1)
    p = {item.name: item.si for item in model.parameters}
    found = blocks(model)
    for _ in range(5):
        q, v, a = rng.normal(size=(3, 2))
        values = dict(p)
        for i, c in enumerate(model.coordinates):
            values |= {(c.name, 0): q[i], (c.name, 1): v[i], (c.name, 2): a[i]}
        k_c = value(machine.k_c, q, v, 0, machine.values)
        k_e = value(machine.k_e, q, v, [], 0, machine.values)
        inertia = value(machine.M, q, 0, machine.values) @ a
        for i, c in enumerate(model.coordinates):
            _, *rows = found[c.name].splitlines()
            printed = [re.split(r"M q''|k_c|k_e  gravity", row)[-1].strip() for row in rows]
            numbers = [evaluate(parse_expression(text).tree, values) for text in printed]
            assert numbers == pytest.approx([inertia[i], k_c[i], k_e[i]], rel=1e-12)


def test_angles_of_a_chain_appear_as_differences() -> None:
    text = show_equations(double_pendulum())
    assert "alpha''*l1**2*(m1 + m2) + beta''*l1*l2*m2*cos(alpha - beta)" in text
    assert "beta'**2*l1*l2*m2*sin(alpha - beta)" in text


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
    rows = [line.strip() for line in show_equations(model).splitlines()]
    assert "+ k_c           -A*m*w**2*sin(t*w)" in rows
    assert "= k_e           0" in rows


def test_declared_energies_are_named_beside_gravity() -> None:
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"y": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "g": (9.81, "m/s^2"), "k": (5.0, "N/m")},
        bodies={"block": {"mass": "m", "at": ["0*y", "y"]}},
        energy={"potential": "0.5*k*y**2"},
    )
    text = show_equations(model)
    assert re.search(r"= k_e +gravity +-g\*m\n", text)
    assert re.search(r" energy\.potential +-1\.0\*k\*y\n", text)


def test_points_on_one_line_need_no_distance() -> None:
    model = oscillator(
        {"bar": {"kind": "spring", "between": ["wall", "block"], "stiffness": "k"}},
        {"k": (5.0, "N/m")},
    )
    assert "distances" not in show_equations(model)


def test_a_product_of_many_sums_is_not_multiplied_out() -> None:
    factors = "*".join(f"(1 + a*{i}*x)" for i in range(1, 40))
    model = model_of(
        coordinates={"x": {"unit": "m"}},
        parameters={"m": (1.2, "kg"), "a": (1.0, "1/m")},
        energy={"kinetic": f"0.5*m*x'**2*{factors}"},
    )
    begin = time.perf_counter()
    assert "(39*a*x + 1)" in show_equations(model)
    assert time.perf_counter() - begin < 5.0


def latex(model: Model) -> str:
    text = show_equations(model, latex=True)
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")
    assert text.count(r"\begin{align*}") == text.count(r"\end{align*}")
    return text


def test_latex_has_dots_for_rates_and_the_element_beside_its_force() -> None:
    text = latex(read_model(MODELS / "cartpole.toml"))
    assert r"\ddot{x} \left(m_{c} + m_{p}\right)" in text
    assert r"& {}-{} a m_{p} \dot{\phi}^{2} \sin{\left(\phi \right)} && k_c \\" in text
    assert r"& {}={} \mathit{push} && \text{elements.motor} \\" in text
    assert r"& {}-{} d \dot{\phi} && \text{elements.bearing} \\" in text
    assert r"J &= 0.0075 \pm 0.0005\ \mathrm{kg\,m^{2}} \\" in text


def test_latex_escapes_names_and_keeps_the_signs_of_sums() -> None:
    law = {
        "kind": "law", "on": "theta_1", "torque": "-b*theta_1 - c*theta_1**3",
        "parameters": {"b": (2.0, "N*m/rad"), "c": (4.0, "N*m/rad^3")},
    }  # fmt: skip
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
