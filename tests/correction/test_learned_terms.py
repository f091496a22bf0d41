"""The parts of sparse learning: candidates, the choice among them, and how terms are written."""

from collections.abc import Mapping

import numpy as np
import pytest
from builders import DRIVEN_MASS, cart_and_pole

from symhyb.correction.learning.choosing import choose_terms, coefficients_of, exchanges
from symhyb.correction.learning.library import Candidate, candidates
from symhyb.correction.learning.weak import WeakForm
from symhyb.correction.learning.written import Chosen, as_forces, as_rates, term_unit
from symhyb.mechanics.mass_text import mass_texts
from symhyb.model.expression import evaluate, parse_expression
from symhyb.model.read import parse_model
from symhyb.model.write import append_elements
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import build

TEXTS = ("1", "x", "x'", "x**2", "abs(x')*x'")


def texts(names: str, row: str, **options: object) -> list[str]:
    widths: Mapping[str, float] = dict.fromkeys(names, 0.01)
    return [one.text for one in candidates(tuple(names), row, widths, **options)]  # type: ignore[arg-type]


def test_the_laws_of_one_coordinate() -> None:
    assert texts("x", "x") == [
        "1",
        "x",
        "x'",
        "x**2",
        "x*x'",
        "x**3",
        "x**2*x'",
        "abs(x')*x'",
        "tanh(x'/0.01)",
    ]


@pytest.mark.parametrize(
    ("names", "degree", "count"), [("x", 3, 10), ("xy", 2, 15), ("xyz", 3, 84)]
)
def test_polynomials_are_complete(names: str, degree: int, count: int) -> None:
    """(2n + d) over d monomials of 2n variables up to degree d."""
    found = texts(names, "x", library="polynomial", degree=degree)
    assert len(found) == len(set(found)) == count


def test_with_many_coordinates_only_the_own_one_is_curved() -> None:
    found = texts("wxyz", "x")
    assert {"w", "w'", "z", "z'", "x**3", "x**2*x'"} <= set(found)
    assert not any("w*" in text or "y**" in text or "tanh(z" in text for text in found)


def weak(seed: int, scale: float = 1.0) -> WeakForm:
    """Forty windows of five candidate columns, of which two make the right-hand side."""
    rng = np.random.default_rng(seed)
    columns = rng.standard_normal((400, len(TEXTS)))
    columns[:, 4] = 0.9 * columns[:, 2] + 0.4 * columns[:, 4]  # losses are alike
    right = 3.0 * columns[:, [1]] - 0.5 * columns[:, [4]] + 0.2 * rng.standard_normal((400, 1))
    return WeakForm(TEXTS, columns / scale, right, np.repeat(np.arange(40), 10))


@pytest.mark.parametrize("optimizer", ["stlsq", "sr3", "ssr"])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_planted_terms_are_chosen_and_their_spread_is_true(optimizer: str, seed: int) -> None:
    form = weak(seed)
    assert choose_terms(form, 0, range(5), optimizer) == (1, 4)  # type: ignore[arg-type]
    values, sds = coefficients_of(form, 0, (1, 4))
    assert np.all(np.abs(values - [3.0, -0.5]) < 4 * sds)
    assert sds == pytest.approx([0.01, 0.01], rel=0.6)  # 0.2/√400 for unit columns


def test_units_do_not_choose() -> None:
    plain, small = weak(1), weak(1, scale=1e6)
    assert choose_terms(small, 0, range(5), "stlsq") == choose_terms(plain, 0, range(5), "stlsq")
    values, sds = coefficients_of(plain, 0, (1, 4))
    others = coefficients_of(small, 0, (1, 4))
    assert np.allclose(np.array(others) / 1e6, [values, sds])


def test_noise_alone_chooses_nothing() -> None:
    rng = np.random.default_rng(5)
    chosen = 0
    for _ in range(20):
        columns, right = rng.standard_normal((400, 5)), rng.standard_normal((400, 1))
        form = WeakForm(TEXTS, columns, right, np.repeat(np.arange(40), 10))
        chosen += len(choose_terms(form, 0, range(5), "stlsq")) > 0
    assert chosen <= 3  # two standard errors: one in forty, of either sign


def test_only_what_cannot_be_reported_apart_is_exchanged() -> None:
    form = weak(1)
    assert exchanges(form, 0, tuple(range(5)), (1, 4)) == ()
    alike = form.columns.copy()
    alike[:, 2] = alike[:, 4] + 1e-3 * alike[:, 2]
    doubled = WeakForm(TEXTS, alike, form.right, form.window)
    assert (1, 2) in exchanges(doubled, 0, tuple(range(5)), (1, 4))


def chosen(text: str, value: float, on: str = "x") -> Chosen:
    widths = {"x": 0.01, "phi": 0.01}
    by_text = {one.text: one for one in candidates(("x", "phi"), on, widths)}
    return Chosen(on, by_text[text], value, 0.1, value)


def test_terms_become_the_laws_that_they_are() -> None:
    model = cart_and_pole()
    found = [
        chosen("x**3", -5.0),
        chosen("x", 2.0),
        chosen("phi'", -0.3, "phi"),
        chosen("phi'", 0.2, "x"),
        chosen("tanh(x'/0.01)", -1.5),
        chosen("abs(x')*x'", 0.4),
        chosen("1", 0.7, "phi"),
    ]
    written = as_forces(model, found)
    kinds = {element.name: element.kind for element in written.elements}
    assert kinds == {
        "learned_spring_x": "spring",
        "learned_damper_phi": "damper",
        "learned_law_x": "law",
        "learned_friction_x": "friction",
        "learned_law_x_2": "law",
        "learned_constant_phi": "constant",
    }
    corrected = append_elements(model, written.elements)  # every unit fits, or this is refused
    values = {p.path: p.value for p in corrected.all_parameters()}
    signs = [one.sign for one in found]
    assert signs == [-1, -1, -1, 1, -1, 1, 1]
    for one, (_, (path,)) in zip(found, written.paths, strict=True):
        assert values[path] == pytest.approx(one.sign * one.value)
    q, v = np.array([0.3, 0.2]), np.array([0.5, -0.4])
    none = np.zeros(0)
    forces = []
    for each in (model, corrected):
        machine = build(each)
        forces.append(call(machine.k_e, [q, v, none, none, np.zeros(1), machine.values]))
    added = np.ravel(forces[1][0]) - np.ravel(forces[0][0])
    expected = [
        -5.0 * 0.3**3 + 2.0 * 0.3 + 0.2 * -0.4 - 1.5 * np.tanh(50.0) + 0.4 * 0.5**2,
        -0.3 * -0.4 + 0.7,
    ]
    assert added == pytest.approx(expected, rel=1e-9)


def test_rates_act_through_the_mass_matrix() -> None:
    model = cart_and_pole()
    mass = mass_texts(model)
    assert mass is not None
    written = as_rates(model, [chosen("phi'", -0.4, "phi")], mass)
    corrected = append_elements(model, written.elements)
    assert [len(paths) for _, paths in written.paths] == [2]  # on the cart and on the pole
    q, v = np.array([0.3, 0.7]), np.array([0.5, 1.2])
    none, accelerations = np.zeros(0), []
    for each in (model, corrected):
        machine = build(each)
        lacks = [
            np.ravel(
                call(machine.discrepancy, [q, v, a, none, none, np.zeros(1), machine.values])[0]
            )
            for a in (np.zeros(2), *np.eye(2))
        ]
        masses = np.column_stack([one - lacks[0] for one in lacks[1:]])
        accelerations.append(np.linalg.solve(masses, -lacks[0]))
    assert accelerations[1] - accelerations[0] == pytest.approx([0.0, -0.4 * 1.2], abs=1e-9)


def test_the_mass_matrix_of_a_cart_and_a_pole_in_words_of_the_file() -> None:
    found = mass_texts(cart_and_pole())
    assert found is not None
    values = {"M": 1.0, "m": 0.5, "l": 0.4, "phi": 0.7}
    numbers = {key: float(evaluate(parse_expression(text), values)) for key, text in found.items()}
    assert numbers == pytest.approx(
        {
            ("x", "x"): 1.5,
            ("x", "phi"): 0.2 * np.cos(0.7),
            ("phi", "x"): 0.2 * np.cos(0.7),
            ("phi", "phi"): 0.08,
        }
    )


def test_a_mass_with_parameters_of_an_element_cannot_be_written() -> None:
    added = '[elements.water]\nkind = "added_mass"\non = "x"\nmass = "a"\n'
    added += '[elements.water.parameters]\na = { value = 0.3, unit = "kg" }\n'
    assert mass_texts(parse_model(DRIVEN_MASS + added)) is None


def test_units_of_coefficients() -> None:
    model = cart_and_pole()
    assert term_unit(model, "x", "x**3", "force").text == "N/m^3"
    assert term_unit(model, "phi", "x*phi'", "rates").same_dimension(
        term_unit(model, "phi", "x", "rates")
        / term_unit(model, "phi", "1", "force")
        * term_unit(model, "phi", "phi'", "force")
    )
    assert Candidate("tanh(x'/{w})", "", width=0.5).text == "tanh(x'/0.5)"
