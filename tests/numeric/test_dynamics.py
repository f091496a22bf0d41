"""The machine as a system of first order, and coordinates whose motion is given."""

from dataclasses import replace

import numpy as np
import pytest
from builders import cart_pole, damper, model_of, oscillator, push, run, spring, value
from numpy.typing import NDArray

from symhyb.model.read import parse_model
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.lowered.dynamics import StateForm, inner_form, state_form
from symhyb.numeric.lowered.machine import Machine, build
from symhyb.numeric.runs.integrate import Trajectory, simulate
from symhyb.numeric.runs.scenario import Scenario

Array = NDArray[np.float64]
T = np.linspace(0, 3, 1201)
W, SIZE = 7.0, 0.02


def imposed(model: Model, *names: str) -> Model:
    """The model with these coordinates imposed."""
    return replace(
        model,
        coordinates=tuple(replace(c, imposed=c.name in names) for c in model.coordinates),
    )


SLOW = """
[elements.slow]
kind = "relaxation"
on = "x"
stiffness = "k"
damping = "0.2*k*a/w"
"""


def remembering() -> Machine:
    """The cart and pole with a spring that relaxes on its cart, which a rig moves."""
    return build(imposed(parse_model(cart_pole().text + SLOW), "x"))


def test_state_and_drive_hold_all_that_moves_and_all_that_is_given() -> None:
    machine = remembering()
    form = state_form(machine)
    assert (form.given, form.free, form.size, form.drive) == ((0,), (1,), 3, 4)
    rng = np.random.default_rng(1)
    q, v, a = rng.normal(size=(3, 5, 2))
    z, u = rng.normal(size=(5, 1)), rng.normal(size=(5, 1))
    x, d = form.state(q, v, z), form.driven(u, q, v, a)
    assert x == pytest.approx(np.column_stack([q[:, 1], v[:, 1], z]))
    assert d == pytest.approx(np.column_stack([u, q[:, 0], v[:, 0], a[:, 0]]))
    again_q, again_v = form.motion(x, d)
    assert again_q.tolist() == q.tolist()
    assert again_v.tolist() == v.tolist()


def test_rates_are_those_of_the_machine() -> None:
    machine = remembering()
    form = state_form(machine)
    rng = np.random.default_rng(2)
    q, v, a = rng.normal(size=(3, 2))
    z, u, w, p = rng.normal(size=1), rng.normal(size=1), rng.normal(size=2), machine.values
    x, d = form.state(q, v, z), form.driven(u, q, v, a)
    pull = value(machine.acceleration, q, v, z, u, 0.3, p, w, a[:1])
    assert pull[0] == a[0]
    expected = [pull[1], value(machine.inner, q, v, z, u, 0.3, p)[0]]
    assert value(form.rates(), x, d, 0.3, p, w) == pytest.approx(expected)
    y, found = call(form.outputs(), (x, d, 0.3, p, w))
    assert found[0] == pytest.approx(pull)
    assert y[0] == pytest.approx(value(machine.sensed, q, v, pull, z, u, 0.3, p, w))


def test_a_free_coordinate_feels_an_imposed_one_through_its_mass() -> None:
    """M_ff a_f = f_f − M_fi b: what M a + k_c − k_e leaves acts on the imposed coordinate alone."""
    machine = build(imposed(cart_pole(), "x"))
    rng = np.random.default_rng(3)
    q, v = rng.normal(size=(2, 2))
    p = machine.values
    a = value(machine.acceleration, q, v, [], 0.7, 0, p, np.zeros(2), 1.9)
    rest = value(machine.discrepancy, q, v, a, [], 0.7, 0, p)
    assert a[0] == 1.9
    assert rest[1] == pytest.approx(0, abs=1e-12)
    assert abs(rest[0]) > 0.1


def test_with_all_motion_given_only_what_remembers_is_left() -> None:
    machine = remembering()
    form = inner_form(machine)
    assert (form.free, form.size, form.drive) == ((), 1, 7)
    rng = np.random.default_rng(4)
    q, v, a = rng.normal(size=(3, 2))
    z, u, p = rng.normal(size=1), rng.normal(size=1), machine.values
    rates = value(form.rates(), z, form.driven(u, q, v, a), 0.0, p, np.zeros(2))
    assert rates == pytest.approx(value(machine.inner, q, v, z, u, 0.0, p))
    back = StateForm(machine, (1, 0))  # in another order
    _, found = call(back.outputs(), (z, back.driven(u, q, v, a), 0.0, p, np.zeros(2)))
    assert found[0] == pytest.approx(a)


# --- a base that is moved --------------------------------------------------------------------


def shaken(rig: bool = True) -> Model:
    """A mass on a spring and damper above a base that a rig moves, and whose force is measured;
    without a ``rig`` the force is an input, and the base is free."""
    sensors = {
        "cell": {"measures": "reaction(base)", "unit": "N"},
        "link": {"measures": "force(hold) + force(oil)", "unit": "N"},
        "table": {"measures": "base", "unit": "m"},
    }
    return model_of(
        coordinates={"base": {"unit": "m", "imposed": rig}, "x": {"unit": "m"}},
        parameters={
            "m": (1.2, "kg"),
            "m_b": (0.5, "kg"),
            "k": (90.0, "N/m"),
            "d": (2.0, "N*s/m"),
            "far": (1.0, "m"),
        },
        inputs={} if rig else {"f": {"unit": "N"}},
        points={"foot": ["base", "0"], "head": ["far + x", "0"]},
        bodies={"table": {"mass": "m_b", "at": "foot"}, "block": {"mass": "m", "at": "head"}},
        elements={
            "hold": {
                "kind": "spring",
                "between": ["foot", "head"],
                "stiffness": "k",
                "length": "far",
            },
            "oil": {"kind": "damper", "between": ["foot", "head"], "damping": "d"},
            **({} if rig else {"rig": push("f", on="base")}),
        },
        sensors=sensors if rig else {},
    )


def moved(machine: Machine, t: Array = T) -> Trajectory:
    base = SIZE * np.stack([np.sin(W * t), W * np.cos(W * t), -(W**2) * np.sin(W * t)], axis=1)
    q, v, u = np.zeros(2), np.array([SIZE * W, 0.0]), np.empty((t.size, 0))
    return simulate(machine, Scenario(t, q, v, t, u, given=base))


def test_a_mass_on_a_moved_base_is_a_mass_in_relative_coordinates() -> None:
    """y = x − base:  m y'' + d y' + k y = −m base'' (an applied force of inertia)."""
    result = moved(build(shaken()))
    relative = oscillator(
        {"hold": spring("k"), "oil": damper("d"), "inertia": push("m*s*w**2*sin(w*t)")},
        {"k": (90.0, "N/m"), "d": (2.0, "N*s/m"), "s": (SIZE, "m"), "w": (W, "1/s")},
    )
    expected = run(relative, T, 0.0, -SIZE * W)
    base = SIZE * np.sin(W * T)
    assert result.complete
    assert result.q[:, 0] == pytest.approx(base, abs=1e-9)
    assert np.ptp(expected.q) > 0.05
    assert result.q[:, 1] - base == pytest.approx(expected.q[:, 0], abs=5e-6)


def test_the_reaction_is_the_force_by_which_the_rig_moves_the_base() -> None:
    """reaction = m_b base'' + m x'': nothing else holds the two; and the table's own balance:
    m_b base'' = reaction + the tension of the link."""
    result = moved(build(shaken()))
    reaction, tension, base = result.y.T
    assert base == pytest.approx(result.q[:, 0])
    assert result.a[:, 0] == pytest.approx(-(W**2) * SIZE * np.sin(W * T), abs=1e-9)
    total = 0.5 * result.a[:, 0] + 1.2 * result.a[:, 1]
    assert reaction == pytest.approx(total, abs=1e-9)
    assert reaction == pytest.approx(0.5 * result.a[:, 0] - tension, abs=1e-9)
    assert np.ptp(reaction) > 1


def test_a_machine_that_is_moved_by_its_reaction_is_the_same_machine() -> None:
    """What the rig did, applied as an input to the free base, gives the same motion."""
    driven = moved(build(shaken()))
    result = run(shaken(rig=False), T, [0, 0], [SIZE * W, 0], driven.y[:, :1])
    assert result.q == pytest.approx(driven.q, abs=2e-5)


def test_a_machine_that_is_moved_altogether_reads_its_reactions() -> None:
    """A pendulum turned by a motor at a steady rate: torque = m g l sin(phi), no solver at work."""
    model = model_of(
        gravity=["0", "-g"],
        coordinates={"phi": {"unit": "rad", "imposed": True}},
        parameters={"m": (0.4, "kg"), "g": (9.81, "m/s^2"), "l": (0.3, "m")},
        bodies={"bob": {"mass": "m", "at": ["l*sin(phi)", "-l*cos(phi)"]}},
        sensors={"cell": {"measures": "reaction(phi)", "unit": "N*m"}},
    )
    machine = build(model)
    phi = 2 * T
    given = np.stack([phi, np.full(T.size, 2.0), np.zeros(T.size)], axis=1)
    scenario = Scenario(T, phi[:1], np.array([2.0]), T, np.empty((T.size, 0)), given=given)
    result = simulate(machine, scenario)
    assert (result.method, result.reason) == ("none", "")
    assert result.y[:, 0] == pytest.approx(0.4 * 9.81 * 0.3 * np.sin(phi))


def test_a_motion_that_was_not_given_is_named() -> None:
    machine = build(shaken())
    scenario = Scenario(T, np.zeros(2), np.zeros(2), T, np.empty((T.size, 0)))
    with pytest.raises(ValueError, match="the motion of base is imposed and was not given"):
        simulate(machine, scenario)


def test_a_given_motion_must_cover_the_simulation() -> None:
    machine = build(shaken())
    short = T[:-5]
    scenario = Scenario(
        T,
        np.zeros(2),
        np.zeros(2),
        short,
        np.empty((short.size, 0)),
        given=np.zeros((short.size, 3)),
    )
    with pytest.raises(ValueError, match=r"runs from 0 to 3 s"):
        simulate(machine, scenario)
