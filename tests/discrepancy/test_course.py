"""The course of a recording: what acts and remembers along it, and the force of a rig."""

from collections.abc import Mapping

import numpy as np
import pytest
from builders import Entries, model_of, oscillator, push, recording, spring

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.discrepancy.recorded.residual import compare, discrepancy
from symhyb.numeric.lowered.inner import inner_along
from symhyb.numeric.lowered.machine import Machine, build

T = np.arange(600) / 200
W, SIZE, FORCE = 6.0, 0.05, 2.0
X, V, A = SIZE * np.sin(W * T), SIZE * W * np.cos(W * T), -SIZE * W**2 * np.sin(W * T)
INSIDE = slice(30, -30)


def of(run: Recording, machine: Machine) -> Course:
    return course_of(run, machine, motion_of(run, machine))


def test_the_course_of_a_machine_that_remembers() -> None:
    slow = {"kind": "relaxation", "on": "x", "stiffness": "k", "damping": "d"}
    model = oscillator(
        {"slow": slow, "motor": push("f")},
        {"k": (60.0, "N/m"), "d": (6.0, "N*s/m")},
        inputs={"f": {"unit": "N"}},
    )
    machine = build(model)
    found = of(recording(T, {"f": np.cos(T)}, place=X), machine)
    assert found.q[:, 0] == pytest.approx(X, abs=1e-6)
    assert found.u[:, 0] == pytest.approx(np.cos(T))
    assert found.states.shape == (600, 3)
    assert found.states == pytest.approx(np.hstack([found.q, found.v, found.z]))
    assert found.drive == pytest.approx(found.u)
    assert found.z[0] == pytest.approx(found.q[0])  # begun at rest
    rate = 10.0  # 1/s, of z' = (s − z) k/d
    steady = SIZE * rate / np.hypot(rate, W) * np.sin(W * T - np.arctan(W / rate))
    assert found.z[T > 1.5, 0] == pytest.approx(steady[T > 1.5], abs=1e-5)
    motion = (found.q, found.v, found.a)
    again = inner_along(machine, found.t, motion, found.u, machine.values)
    assert again == pytest.approx(found.z)
    assert found.reaction == pytest.approx(0)


def rig(sensors: Mapping[str, Entries]) -> Machine:
    """A mass on a spring, moved by a rig."""
    model = model_of(
        coordinates={"x": {"unit": "m", "imposed": True}},
        parameters={"m": (1.2, "kg"), "k": (90.0, "N/m")},
        bodies={"block": {"mass": "m", "at": ["x", "0"]}},
        elements={"hold": spring("k")},
        sensors=sensors,
    )
    return build(model)


PLACE: Entries = {"place": {"measures": "x", "unit": "m"}}
CELL: Entries = {"measures": "reaction(x)", "unit": "N"}


def test_the_reaction_of_a_rig_is_its_sensor_in_newtons() -> None:
    """recorded = gain·true + offset."""
    cell = {**CELL, "gain": 2.0, "offset": {"value": 0.5, "unit": "N"}}
    machine = rig({**PLACE, "cell": cell})
    force = 1.2 * A + 90 * X
    found = of(recording(T, {"x": X}, place=X, cell=2 * force + 0.5), machine)
    assert found.reaction[:, 0] == pytest.approx(force)
    assert found.states.shape == (600, 0)
    assert found.drive == pytest.approx(np.hstack([found.q, found.v, found.a]))


def test_a_reaction_that_is_not_measured_is_not_a_number() -> None:
    found = of(recording(T, {"x": X}, place=X), rig(PLACE))
    assert np.isnan(found.reaction).all()


def test_what_the_rig_feels_and_the_model_does_not_is_a_force_that_acts() -> None:
    """Dry friction that the model leaves out: the rig pulls against it, ΔF = −F sgn v."""
    machine = rig({**PLACE, "cell": CELL})
    felt = 1.2 * A + 90 * X + FORCE * np.sign(V)
    run = recording(T, {"x": X}, place=X, cell=felt)
    course = of(run, machine)
    force = discrepancy(machine, course, machine.values)
    assert force[INSIDE, 0] == pytest.approx(-FORCE * np.sign(V[INSIDE]), abs=0.02)
    assert compare(machine, run).force == pytest.approx(force)


def test_without_the_force_of_the_rig_nothing_is_known_to_lack() -> None:
    machine = rig(PLACE)
    course = of(recording(T, {"x": X}, place=X), machine)
    assert discrepancy(machine, course, machine.values) == pytest.approx(np.zeros((600, 1)))
