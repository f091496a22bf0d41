"""Corrections of forces and of rates: one truth, two levels, the same motion."""

import numpy as np
import pytest
from builders import DRIVEN_MASS, cart_and_pole

from symhyb.correction.learning.corrected import (
    Correction,
    Formulation,
    Networks,
    Terms,
    rows_of,
    simulate_corrected,
)
from symhyb.correction.learning.formulations import (
    lacking,
    measured_course,
    network_law,
    sparse_law,
    values_along,
)
from symhyb.errors import InputError
from symhyb.model.read import parse_model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

BOTH: tuple[Formulation, Formulation] = ("force", "rates")
DRAG = '[elements.more]\nkind = "drag"\non = "x"\ndrag = "b"\n'
DRAG += '[elements.more.parameters]\nb = { value = 0.8, unit = "N*s^2/m^2" }\n'


def swung(machine: Machine, end: float = 8.0) -> tuple[Scenario, Trajectory]:
    t = np.linspace(0, end, round(end * 100) + 1)
    start = np.array([0.1, 1.2])
    scenario = Scenario(t, start, np.zeros(2), t, np.empty((t.size, 0)))
    return scenario, simulate(machine, scenario)


def shaken(machine: Machine, seed: int) -> tuple[Scenario, Trajectory]:
    t = np.arange(0, 20, 0.02)
    phases = np.random.default_rng(seed).uniform(0, 2 * np.pi, 10)
    f = np.sin(2 * np.pi * np.linspace(0.2, 1.8, 10) * t[:, None] + phases).sum(axis=1)
    scenario = Scenario(t, np.zeros(1), np.zeros(1), t, f[:, None])
    return scenario, simulate(machine, scenario)


def test_rates_are_forces_over_the_mass_matrix() -> None:
    model, truth = build(cart_and_pole()), build(cart_and_pole(rubs=True))
    scenario, run = swung(truth)
    course = measured_course(model, run.t, (run.q, run.v, run.a), scenario.u)
    force, rates = (lacking(model, course, form) for form in BOTH)
    assert np.abs(rates[:, :2]).max() == 0
    assert force[:, 1] == pytest.approx(-0.02 * run.v[:, 1], abs=1e-9)
    for i in range(0, run.t.size, 80):
        mass = call(model.M, (run.q[i], run.t[i], model.values))[0]
        assert mass @ rates[i, 2:] == pytest.approx(force[i], abs=1e-9)


def test_a_law_of_forces_is_found_and_simulates_as_the_machine_does() -> None:
    model, truth = build(cart_and_pole()), build(cart_and_pole(rubs=True))
    scenario, run = swung(truth)
    course = measured_course(model, run.t, (run.q, run.v, run.a), scenario.u)
    wanted = lacking(model, course, "force")
    law = sparse_law(model, course, wanted, ("x", "x'", "phi'", "abs(phi')*phi'", "sin(phi)"))
    assert law.coefficients == pytest.approx(np.array([[0] * 5, [0, 0, -0.02, 0, 0]]), abs=1e-8)
    corrected = simulate_corrected(model, scenario, Correction("force", (law,)))
    assert corrected.complete
    assert np.abs(corrected.q - run.q).max() < 1e-5
    assert np.abs(simulate_corrected(model, scenario).q - run.q).max() > 0.05
    # accelerations and sensors are those of the corrected system
    assert np.abs(corrected.a - run.a).max() < 1e-3
    assert np.abs(corrected.y - run.y).max() < 1e-3


def test_the_same_motion_needs_a_law_of_rates_that_knows_the_mass_matrix() -> None:
    """−d φ' in the joint is −d φ' (−m l cos φ, M + m)/det M in the rates."""
    model, truth = build(cart_and_pole()), build(cart_and_pole(rubs=True))
    scenario, run = swung(truth)
    course = measured_course(model, run.t, (run.q, run.v, run.a), scenario.u)
    wanted = lacking(model, course, "rates")
    over = "(m*l**2*(M + m*sin(phi)**2))"
    texts = (f"phi'*m*l*cos(phi)/{over}", f"phi'*(M + m)/{over}", "phi'")
    law = sparse_law(model, course, wanted, texts)
    exact = np.array([[0, 0, 0], [0, 0, 0], [0.02, 0, 0], [0, -0.02, 0]])
    assert law.coefficients == pytest.approx(exact, abs=1e-7)
    corrected = simulate_corrected(model, scenario, Correction("rates", (law,)))
    assert np.abs(corrected.q - run.q).max() < 1e-5
    simple = sparse_law(model, course, wanted, ("x'", "phi'"))
    less = simulate_corrected(model, scenario, Correction("rates", (simple,)))
    assert np.abs(less.q - run.q).max() > 1e-3


@pytest.mark.parametrize("formulation", BOTH)
def test_noisy_samples_at_either_level(formulation: Formulation) -> None:
    """Sparse terms find the drag; a network follows it; together the network has little to do."""
    model, truth = build(parse_model(DRIVEN_MASS)), build(parse_model(DRIVEN_MASS + DRAG))
    scenario, run = shaken(truth, 1)
    rng = np.random.default_rng(2)
    noisy = [
        x + 0.01 * np.abs(x).max() * rng.standard_normal(x.shape) for x in (run.q, run.v, run.a)
    ]
    course = measured_course(model, run.t, (noisy[0], noisy[1], noisy[2]), scenario.u)
    wanted = lacking(model, course, formulation)
    terms = sparse_law(model, course, wanted, ("x", "x'", "x**2", "x**3", "abs(x')*x'"), 0.2)
    assert np.flatnonzero(terms.coefficients[-1]).tolist() == [4]
    assert terms.coefficients[-1, 4] == pytest.approx(-0.8, rel=0.05)
    net = network_law(model, course, wanted, ("x", "x'"))
    assert [row is None for row in net.rows] == [True, False][-len(net.rows) :]
    rest = network_law(model, course, wanted - values_along(model, course, terms), ("x", "x'"))
    unseen, real = shaken(truth, 3)
    alone = np.sqrt(np.mean((simulate(model, unseen).q - real.q) ** 2))
    errors = []
    for laws in ((terms,), (net,), (terms, rest)):
        again = simulate_corrected(model, unseen, Correction(formulation, laws))
        errors.append(float(np.sqrt(np.mean((again.q - real.q) ** 2)) / alone))
    assert errors[0] < 0.05
    assert errors[1] < 0.4
    assert errors[2] < 0.2


def test_a_speed_that_is_measured_on_its_own_shows_in_the_kinematic_rows() -> None:
    """A tachometer that shows 5 % too much: q' = v − 0.05/1.05 v, and a' beside it."""
    machine = build(parse_model(DRIVEN_MASS))
    scenario, run = shaken(machine, 1)
    shown = 1.05 * run.v
    course = measured_course(machine, run.t, (run.q, shown, 1.05 * run.a), scenario.u)
    wanted = lacking(machine, course, "rates", rate=run.v)
    law = sparse_law(machine, course, wanted, ("x", "x'", "f"), 0.01)
    assert law.coefficients[0] == pytest.approx([0, -0.05 / 1.05, 0], abs=1e-6)
    again = simulate_corrected(machine, scenario, Correction("rates", (law,)))
    assert np.abs(again.v - shown).max() < 2e-4 * np.abs(shown).max()
    assert np.abs(again.q - run.q).max() < 2e-4 * np.abs(run.q).max()


def test_without_a_correction_it_is_the_machine() -> None:
    machine = build(parse_model(DRIVEN_MASS + DRAG))
    scenario, run = shaken(machine, 1)
    again = simulate_corrected(machine, scenario)
    assert again.method == "bdf"
    for name in ("q", "v", "a", "y"):
        one, other = getattr(again, name), getattr(run, name)
        assert np.abs(one - other).max() < 1e-5 * np.abs(other).max()


def test_what_cannot_be_a_correction_is_said() -> None:
    machine = build(parse_model(DRIVEN_MASS))
    scenario, run = shaken(machine, 1)
    course = measured_course(machine, run.t, (run.q, run.v, run.a), scenario.u)
    wanted = lacking(machine, course, "force")
    with pytest.raises(InputError, match=r"(?s)'y' in 'x \+ y'.*'x''' in .*not an expr"):
        sparse_law(machine, course, wanted, ("x + y", "x''", "x +"))
    with pytest.raises(InputError, match="k never changes"):
        network_law(machine, course, wanted, ("x", "k"))
    assert [rows_of(machine, form) for form in BOTH] == [1, 2]
    wrong = Correction("rates", (Terms(("x'",), np.ones((1, 1))),))
    with pytest.raises(InputError, match="has 2 rows here, not 1"):
        simulate_corrected(machine, scenario, wrong)
    with pytest.raises(InputError, match="has 1 rows here, not 2"):
        simulate_corrected(machine, scenario, Correction("force", (Networks(("x",), (None,) * 2),)))
