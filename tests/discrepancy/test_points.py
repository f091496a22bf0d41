"""Laws at points: offered where a point moves in its own way, and found there."""

import numpy as np
import pytest
from builders import cart_pole, double_pendulum, oscillator, spring
from law_rigs import PENDULUM, numbers, pendulum

import symhyb as sh
from symhyb.discrepancy.places.points import moving_points, point_hypotheses
from symhyb.model.read import parse_model
from symhyb.model.types import At

T = np.linspace(0, 1, 50)


def test_a_point_that_moves_with_one_coordinate_alone_is_no_place() -> None:
    """The elbow turns with alpha, the pivot slides with x, the post is fixed."""
    assert moving_points(double_pendulum()) == (At("hand"),)
    assert moving_points(cart_pole()) == (At("centre"), At("tip"))
    assert moving_points(oscillator({"hold": spring("k")}, {"k": (5.0, "N/m")})) == ()


def test_friction_at_a_point_scales_with_its_speed() -> None:
    """The hand of two rods that turn alike, 0.7 m and 0.4 m long, moves with 1.1 m times that."""
    q = np.stack([0.3 * np.sin(2 * T)] * 2, axis=1)
    v = np.stack([0.6 * np.cos(2 * T)] * 2, axis=1)
    tried = point_hypotheses(double_pendulum(), [(q, v, T)], 1e-3)
    assert [h.kind for h in tried] == ["damper", "drag", "friction", "added_mass", "payload"]
    assert {h.place for h in tried} == {At("hand")}
    (friction,) = (h for h in tried if h.kind == "friction")
    fastest = np.quantile(1.1 * 0.6 * np.cos(2 * T), 0.99)
    assert dict(friction.shape)["transition"] == pytest.approx(1e-3 * fastest)
    assert point_hypotheses(double_pendulum(), [(q, 0 * v, T)], 1e-3) == ()


@pytest.mark.thorough
def test_drag_at_the_hand_of_a_double_pendulum_is_found_there() -> None:
    model = parse_model(PENDULUM, "pendulum.toml")
    diagnosis = sh.diagnose(model, pendulum(1, tip=0.05), pendulum(2, tip=0.05))
    (found,) = diagnosis.found
    assert found.element.place == At("hand")
    value, sd = numbers(diagnosis)["drag.drag"]
    assert value == pytest.approx(0.05, rel=0.03)
    assert abs(value - 0.05) < 4 * sd
    assert "at hand" in found.sentence.lower()
    corrected = sh.apply(model, diagnosis.found)
    assert corrected.elements[-1].place == At("hand")


@pytest.mark.slow
def test_drag_on_a_coordinate_stays_there() -> None:
    model = parse_model(PENDULUM, "pendulum.toml")
    diagnosis = sh.diagnose(model, pendulum(3, upper=0.05))
    assert [str(f.element.place) for f in diagnosis.found] == ["On(coordinate='alpha')"]
    assert sh.diagnose(model, pendulum(4)).verdict == "nothing missing"
