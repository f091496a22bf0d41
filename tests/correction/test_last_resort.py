"""Products as the last resort: found where nothing with a name explains, said with a warning."""

import pytest
from law_rigs import Law, driven, lugre, numbers, product
from rigs import spring_model

import symhyb as sh
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.places.memoryless import memory_sentence
from symhyb.discrepancy.places.products import formulas, products
from symhyb.discrepancy.words.formula import WARNING, law_element, law_unit
from symhyb.model.read import parse_model
from symhyb.model.types import On
from symhyb.model.write import append_elements
from tests.builders import DRIVEN_MASS

X = On("x")


@pytest.mark.parametrize(
    ("formula", "unit"),
    [
        ("x**2*x'", "N*s/m^3"),
        ("x'**3", "N*s^3/m^3"),
        ("f*x'", "s/m"),
        ("abs(x)*tanh(x'/transition)", "N/m"),
        ("abs(f)*tanh(x'/transition)", "1"),
    ],
)
def test_a_product_is_an_element_of_the_model_file(formula: str, unit: str) -> None:
    """Its units are those that the file demands, and it reads back as it was written."""
    assert law_unit(spring_model(), X, formula, "coefficient").text == unit
    values = {"coefficient": 2.0}
    if "transition" in formula:
        values["transition"] = 1e-4
    element = law_element(spring_model(), "found_law", X, formula, values, {"coefficient": "c"})
    again = append_elements(spring_model(), [element]).elements[-1]
    assert {own.name: own.si for own in again.parameters} == pytest.approx(
        {"c" if key == "coefficient" else key: value for key, value in values.items()}
    )


def test_products_couple_coordinates_and_inputs() -> None:
    found = formulas("x", ["x", "y"], ["u"])
    assert {"x*y", "x*y'", "u*x", "u*x'", "x**2*x'", "x'**3", "abs(x)*x'"} <= set(found)
    assert len(set(found)) == len(found)
    tried = products(spring_model(), {"x": 1e-3})
    assert {h.place for h in tried} == {X}
    assert all(("transition" in h.path) == bool(h.shape) for h in tried)
    assert products(spring_model(), {}) == ()
    assert str(tried[2]) == "law (x**2*x') on x"
    assert isinstance(tried[0], Hypothesis)


def test_a_number_that_may_change_with_a_channel_has_a_course_and_no_product() -> None:
    """Of a pressure that moves nothing: with the stiffness that is uncertain, not with the damping,
    and dry friction may grow with it."""
    text = DRIVEN_MASS.replace("[bodies.mass]", 'p = { unit = "bar" }\n[bodies.mass]')
    found = {h.path for h in products(parse_model(text), {"x": 1e-3})}
    assert "p*x" not in found
    assert {"p*x'", "abs(p)*tanh(x'/transition)", "f*x", "f*x'"} <= found


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("law", "formula", "truth"),
    [
        (product(800.0, lambda x, v, f: x * x * v), "x**2*x'", 800.0),
        (product(3.0, lambda x, v, f: v**3), "x'**3", 3.0),
        (product(0.3, lambda x, v, f: f * v), "f*x'", 0.3),
    ],
    ids=["x²x'", "x'³", "f x'"],
)
def test_a_product_that_has_no_name_is_found_and_said_with_a_warning(
    law: Law, formula: str, truth: float
) -> None:
    model = spring_model()
    diagnosis = sh.diagnose(model, driven(law, 1))
    (found,) = diagnosis.found
    assert found.law == f"-coefficient*{formula}"
    value, sd = numbers(diagnosis)["law.coefficient"]
    assert value == pytest.approx(truth, rel=0.02)
    assert abs(value - truth) < 4 * sd
    assert WARNING in found.sentence
    assert any(WARNING in note for note in diagnosis.notes)
    assert diagnosis.memory is not None
    assert diagnosis.memory.state > 0.9
    assert sh.apply(model, diagnosis.found).elements[-1].kind == "law"


@pytest.mark.thorough
def test_what_has_a_name_is_reported_by_it() -> None:
    """Dahl's friction and drag are explained by products less well; and nothing stays nothing."""
    for law, kind in (
        (lugre(1.0, 600.0), "friction_dynamic"),
        (product(2.0, lambda x, v, f: abs(v) * v), "drag"),
    ):
        (found,) = sh.diagnose(spring_model(), driven(law, 2)).found
        assert found.element.kind == kind
    none = product(0.0, lambda x, v, f: 0.0)
    assert sh.diagnose(spring_model(), driven(none, 3)).verdict == "nothing missing"


@pytest.mark.thorough
def test_overtones_of_a_line_are_found() -> None:
    none = product(0.0, lambda x, v, f: 0.0)
    lines = {6.3: 1.0, 12.6: 0.6, 18.9: 0.4}
    diagnosis = sh.diagnose(spring_model(), driven(none, 1, lines=lines, noise=3e-4))
    found = {}
    for item in diagnosis.found:
        numbers_of = {one.term: one.value for one in item.estimates}
        found[numbers_of["frequency"]] = numbers_of["amplitude"]
    assert sorted(found) == pytest.approx(sorted(lines), rel=1e-3)
    assert [found[f] for f in sorted(found)] == pytest.approx([1.0, 0.6, 0.4], rel=0.1)


def test_whether_a_force_is_a_function_of_the_state_is_said() -> None:
    assert memory_sentence(0.97, 0.975).startswith("What is missing is a function of position")
    assert memory_sentence(0.8, 0.97).startswith("What is missing remembers")
    assert "something else" in memory_sentence(0.4, 0.5)
