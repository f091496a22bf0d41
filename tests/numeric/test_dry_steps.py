"""The step of windows in which dry friction holds, lets go and turns over."""

from collections.abc import Mapping

import numpy as np
import pytest
from builders import Entries, damper, model_of, oscillator, push, spring, value
from numpy.typing import ArrayLike, NDArray

from symhyb.exact.simulation import simulate
from symhyb.numeric.lowered.dry_steps import window_step
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.lowered.steps import step_and_middle
from symhyb.numeric.runs.integrate import Trajectory
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
H, MASS, LEVEL = 0.01, 1.2, 60.0  # s, kg, N: it comes to rest from 0.1 m/s within 2 ms
RAIL: Mapping[str, Entries] = {
    "rail": {"kind": "friction", "on": "x", "coulomb": "c", "transition": "w"},
    "motor": push("f"),
}


def rubbing(transition: float = 1e-7, **rail: object) -> Machine:
    """A mass of 1.2 kg in dry friction of 60 N, which turns over within ``transition`` in m/s."""
    elements = {**RAIL, "rail": {**RAIL["rail"], **rail}}
    numbers = {"c": (LEVEL, "N"), "w": (transition, "m/s")}
    return build(oscillator(elements, numbers, inputs={"f": {"unit": "N"}}))


def stepped(machine: Machine, x: ArrayLike, f0: float, f1: float, h: float = H) -> list[Array]:
    """The state after a step and in its middle, under a force from ``f0`` to ``f1`` in N."""
    made = window_step(state_form(machine))(x, f0, f1, 0.0, h, machine.values)
    return [np.array(one).ravel() for one in made]


def test_what_comes_to_rest_within_a_step_rests_to_its_end() -> None:
    after, middle = stepped(rubbing(), [0.0, 0.1], 0.0, 0.0)
    way = 0.1**2 / (2 * LEVEL / MASS)
    assert after == pytest.approx([way, 0.0], abs=1e-9)
    assert middle == pytest.approx([way, 0.0], abs=1e-9)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_what_is_pulled_by_more_slides_back_within_a_step(way: float) -> None:
    pull = 3 * LEVEL
    after, middle = stepped(rubbing(), [0.0, 0.5 * way], -pull * way, -pull * way)
    slowing, back = (pull + LEVEL) / MASS, (pull - LEVEL) / MASS
    turned = 0.5 / slowing
    for found, t in ((after, H), (middle, H / 2)):
        assert found[1] == pytest.approx(-way * back * (t - turned), abs=1e-6)
        place = 0.5 * turned / 2 - back * (t - turned) ** 2 / 2
        assert found[0] == pytest.approx(way * place, abs=1e-8)


def test_what_rests_is_held_and_creeps_within_the_transition_alone() -> None:
    machine, x = rubbing(1e-6), np.zeros(2)
    for _ in range(50):
        x = stepped(machine, x, 0.9 * LEVEL, 0.9 * LEVEL)[0]
    assert x[1] == pytest.approx(0.9e-6, rel=1e-6)
    assert abs(x[0]) < 50 * H * 1e-6


def test_what_is_pulled_by_more_than_friction_holds_lets_go() -> None:
    after, middle = stepped(rubbing(), [0.0, 0.0], 1.5 * LEVEL, 1.5 * LEVEL)
    pace = 0.5 * LEVEL / MASS
    assert after == pytest.approx([pace * H**2 / 2, pace * H], rel=1e-5)
    assert middle == pytest.approx([pace * H**2 / 8, pace * H / 2], rel=1e-5)


def test_friction_that_differs_by_direction_holds_by_the_one_that_it_resists() -> None:
    machine = rubbing(asymmetry=0.5)  # 90 N forwards, 30 N backwards
    assert stepped(machine, [0.0, 0.0], 80.0, 80.0)[0][1] == pytest.approx(0.0, abs=1e-6)
    backwards = stepped(machine, [0.0, 0.0], -80.0, -80.0)[0]
    assert backwards[1] == pytest.approx(-50.0 / MASS * H, rel=1e-5)


def test_a_law_that_turns_over_slowly_is_left_as_it_is() -> None:
    machine = rubbing(LEVEL / MASS * H * 1.1)
    form = state_form(machine)
    given = ([0.0, 0.1], 5.0, 9.0, 0.0, H, machine.values)
    for mine, plain in zip(window_step(form)(*given), step_and_middle(form)(*given), strict=True):
        assert np.array_equal(np.array(mine), np.array(plain))


def test_without_friction_it_is_the_rosenbrock_step() -> None:
    form = state_form(build(oscillator({"oil": damper("d")}, {"d": (1.0, "N*s/m")})))
    assert window_step(form).n_instructions() == step_and_middle(form).n_instructions()


@pytest.mark.parametrize("level", [LEVEL, 0.0])
def test_a_step_of_no_length_and_friction_of_no_level_change_nothing(level: float) -> None:
    machine = build(
        oscillator(RAIL, {"c": (level, "N"), "w": (1e-4, "m/s")}, inputs={"f": {"unit": "N"}})
    )
    for start in ([0.2, 0.1], [0.2, 0.0]):
        assert stepped(machine, start, 1.0, 7.0, 0.0)[0] == pytest.approx(start, abs=1e-15)
    if not level:
        assert stepped(machine, [0.2, 0.1], 0.0, 0.0)[0] == pytest.approx([0.201, 0.1])


def light_on_heavy() -> Machine:
    """A slider of 20 g that rubs on a cart of 2 kg, and both on the ground, with springs."""
    return build(
        model_of(
            coordinates={"x": {"unit": "m"}, "y": {"unit": "m"}},
            parameters={
                "m": (2.0, "kg"),
                "s": (0.02, "kg"),
                "k": (40.0, "N/m"),
                "g": (3.0, "N"),
                "c": (2.0, "N"),
                "w": (1e-4, "m/s"),
            },
            inputs={"f": {"unit": "N"}},
            points={"cart": ["x", "0"], "slider": ["y", "0"]},
            bodies={"cart": {"mass": "m", "at": "cart"}, "slider": {"mass": "s", "at": "slider"}},
            elements={
                "hold": spring("k"),
                "pull": spring("k", on="y - x"),
                "ground": {"kind": "friction", "on": "x", "coulomb": "g", "transition": "w"},
                "bed": {"kind": "friction", "on": "y - x", "coulomb": "c", "transition": "w"},
                "motor": push("f"),
            },
            sensors={"cart": {"measures": "x", "unit": "m"}, "top": {"measures": "y", "unit": "m"}},
        )
    )


def simulated(machine: Machine, start: ArrayLike, t: Array, f: Array) -> tuple[Array, Trajectory]:
    """The places (N, n) in one step a sample under a force (N,) in N, and the exact
    run, in which friction holds, lets go and turns over at located times."""
    x0 = np.asarray(start, float)
    step, x = window_step(state_form(machine)), [x0]
    for i, h in enumerate(np.diff(t)):
        x.append(value(step, x[-1], f[i], f[i + 1], t[i], h, machine.values))
    q, v = x0[: machine.n], x0[machine.n :]
    return np.array(x)[:, : machine.n], simulate(
        machine, Scenario(t, q, v, t, f[:, None]), exact=True
    )


def test_a_light_slider_on_a_cart_is_followed_in_steps_far_above_its_time_constant() -> None:
    machine, t = light_on_heavy(), np.linspace(0, 3, 301)
    places, exact = simulated(machine, [0.1, 0.1, 0.0, -0.3], t, 30 * np.sin(12 * t))
    assert np.ptp(exact.q, axis=0).min() > 0.1
    assert len(exact.events) > 10
    assert np.sqrt(np.mean((places - exact.q) ** 2, axis=0)).max() < 5e-4


def test_a_mass_that_sticks_in_every_swing_agrees_with_exact_stick_slip() -> None:
    numbers = {"k": (120.0, "N/m"), "c": (3.0, "N"), "w": (1e-6, "m/s")}
    elements = {**RAIL, "hold": spring("k")}
    machine = build(oscillator(elements, numbers, inputs={"f": {"unit": "N"}}))
    t = np.linspace(0, 2, 401)
    places, exact = simulated(machine, [0.02, 0.1], t, 6 * np.sin(6 * t))
    assert np.mean(exact.v[:, 0] == 0) > 0.05
    assert places == pytest.approx(exact.q, abs=1e-4)
