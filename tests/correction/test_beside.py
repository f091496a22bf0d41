"""A damper that differs by direction, of which the model has the mean: found beside it, and told
together with it."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.correction.naming.beside_words import together
from symhyb.correction.naming.findings import Named
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.candidates import force_hypotheses
from symhyb.laws.reach import Reach
from symhyb.model.read import parse_model
from symhyb.model.types import Model, On

MODEL = """
symhyb = 1
[coordinates]
x = {{ unit = "m" }}
[parameters]
m = {{ value = 2.0, unit = "kg" }}
k = {{ value = 200, unit = "N/m" }}
d = {{ value = 10, unit = "N*s/m"{sd} }}
[inputs]
f = {{ unit = "N" }}
[points]
wall = ["-1", "0"]
block = ["x", "0"]
[bodies.block]
mass = "m"
at = "block"
[elements.spring]
kind = "spring"
on = "x"
stiffness = "k"
[elements.oil]
kind = "damper"
on = "x"
damping = "d"
[elements.motor]
kind = "force"
on = "x"
force = "f"
[sensors]
place = {{ measures = "x", unit = "m", sd = 1e-4 }}
"""
FORWARD, BACKWARD = 16.0, 6.0  # N·s/m


def declared(sd: str = ", sd = 2") -> Model:
    return parse_model(MODEL.format(sd=sd), "block.toml")


def recorded(seed: int) -> Recording:
    """A block on a spring under a sum of sines, by SciPy."""
    t = np.arange(0, 20, 0.005)
    chance = np.random.default_rng(seed)
    phases = chance.uniform(0, 2 * np.pi, 8)
    f = sum(8 * np.sin((3 + 2 * i) * t + phase) for i, phase in enumerate(phases))

    def rates(now: float, state: np.ndarray) -> tuple[float, float]:
        x, v = state
        loss = (FORWARD if v > 0 else BACKWARD) * v
        return v, (np.interp(now, t, f) - 200 * x - loss) / 2.0

    run = solve_ivp(rates, (0, 20), [0.0, 0.0], t_eval=t, max_step=0.005, rtol=1e-8, atol=1e-10)
    x = run.y[0] + 1e-4 * chance.standard_normal(t.size)
    return Recording(f"run{seed}.csv", t, {"f": f}, {"place": x}, (), "")


@pytest.mark.parametrize(
    "sd",
    [
        pytest.param(", sd = 2", marks=pytest.mark.thorough),
        pytest.param("", marks=pytest.mark.slow),
    ],
)
def test_a_damper_that_differs_by_direction_is_found_beside_the_one_of_the_model(sd: str) -> None:
    found = sh.diagnose(declared(sd), recorded(1), recorded(2))
    (one,) = found.found
    assert one.element.kind == "damper"
    values = {estimate.term: estimate for estimate in one.estimates}
    added, ratio = values["damping"], values["asymmetry"]
    assert added.value * (1 + ratio.value) == pytest.approx(FORWARD - 10, abs=0.15)
    assert added.value * (1 - ratio.value) == pytest.approx(BACKWARD - 10, abs=0.15)
    assert added.sd < 0.3  # of the sum alone is anything known, and this is told for d as stated
    assert "Together with oil, this is viscous damping of" in found.sentence
    corrected = sh.apply(declared(sd), found.found, found.parameters, found.measurement)
    assert sh.build(corrected).n == 1


def test_only_beside_a_loss_of_the_model_may_one_take_back_a_part() -> None:
    t = np.arange(400) / 100
    swing = Reach(np.sin(t), np.cos(t), np.cos(t), t)
    bounds = {
        place: [h.limits("asymmetry") for h in tried if "skew" in h.terms and h.kind == "damper"]
        for place in (On("x"), On("2*x"))
        for tried in [force_hypotheses(declared(), {place: swing})]
    }
    assert all(upper > 1 for _, upper in bounds[On("x")])
    assert bounds[On("2*x")] == [(-0.95, 0.95)]


def test_the_sum_is_told_forward_and_backward() -> None:
    model = declared()
    machine = sh.build(model)
    fitted = type("Fitted", (), {"machine": machine, "p": machine.values})()
    values = {"damping": (1.0, 0.1), "asymmetry": (5.0, 0.3)}
    item = Named("damper", On("x"), (0,), values)
    (said,) = together(model, fitted, [item])
    assert said == (
        "Together with oil, this is viscous damping of 16 N·s/m forward and 6 N·s/m backward on x."
    )
    plain = Named("damper", On("x"), (0,), {"damping": (1.0, 0.1)})
    elsewhere = Named("damper", On("2*x"), (0,), values)
    assert not list(together(model, fitted, [plain, elsewhere]))


def test_beside_a_coefficient_that_an_input_changes_there_is_no_sum() -> None:
    text = MODEL.format(sd="").replace('damping = "d"', 'damping = "d*f/f_0"')
    text = text.replace("[inputs]", 'f_0 = { value = 1.0, unit = "N" }\n[inputs]')
    machine = sh.build(sh.parse_model(text))
    fitted = type("Fitted", (), {"machine": machine, "p": machine.values})()
    values = {"damping": (1.0, 0.1), "asymmetry": (5.0, 0.3)}
    item = Named("damper", On("x"), (0,), values)
    assert not list(together(machine.model, fitted, [item]))
