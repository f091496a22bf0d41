"""A wrist whose motor turns at the sum of two rates: friction there is seen at the level of forces,
and diagnosed at that place."""

from functools import cache

import numpy as np
import pytest
from builders import driven_joints
from scipy.integrate import solve_ivp

import symhyb as sh
from symhyb.correction.search.preparing import Prepared, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.wholes import at_level_of_forces
from symhyb.data.recording import Recording
from symhyb.discrepancy.places.placements import places_of
from symhyb.model.types import Model, On

JOINTS = 4
INERTIA = (1.0, 0.8, 0.3, 0.2)  # kg·m²
BEARINGS = (2.0, 1.5, 0.6, 0.5)  # N·m·s/rad
SHARED = 1.2  # N·m·s/rad, at q2 + q3
DRY = 0.8  # N·m, at q2 + q3
SPRING = 20.0  # N·m/rad, of each joint


def arm() -> Model:
    """Four joints with springs, each driven, that know no loss."""
    return driven_joints(INERTIA, SPRING)


def recorded(shared: float, dry: float) -> Recording:
    random = np.random.default_rng(4)
    t = np.arange(0, 10.0, 0.01)
    lines = np.linspace(0.3, 3.0, 9)
    phases = random.uniform(0, 2 * np.pi, (JOINTS, 9))
    inertia, bearings = np.array(INERTIA), np.array(BEARINGS)

    def torque(time: float) -> np.ndarray:
        return 1.5 * np.sin(2 * np.pi * lines * time + phases).sum(axis=1)

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        q, v = state[:JOINTS], state[JOINTS:]
        lost = bearings * v
        joint = v[2] + v[3]
        lost[2:] += shared * joint + dry * np.tanh(joint / 1e-3)
        return np.concatenate([v, (torque(time) - SPRING * q - lost) / inertia])

    start = np.zeros(2 * JOINTS)
    run = solve_ivp(rate, (0, t[-1]), start, t_eval=t, method="LSODA", rtol=1e-8, atol=1e-10)
    q = run.y[:JOINTS]
    seen = q + 1e-3 * q.std() * random.standard_normal(q.shape)
    pushed = np.array([torque(time) for time in t]).T
    return Recording(
        "arm.csv",
        t,
        {f"tq{i}": pushed[i] for i in range(JOINTS)},
        {f"encoder{i}": seen[i] for i in range(JOINTS)},
        (),
        "",
    )


@cache
def begun(shared: float, dry: float) -> tuple[Prepared, Setting, Setting]:
    prepared = prepare(arm(), recorded(shared, dry))
    before = settle(prepared)
    prepared, after, forces = at_level_of_forces(prepared, before, ())
    assert forces is not None
    assert forces.hypotheses == after.library.hypotheses
    return prepared, before, after


@pytest.mark.slow
def test_the_sum_of_two_rates_becomes_a_place() -> None:
    prepared, before, after = begun(SHARED, DRY)
    assert On("q2 + q3") not in places_of(prepared.model)
    assert {*after.library.places} - {*before.library.places} == {On("q2 + q3")}


@pytest.mark.slow
def test_losses_of_single_joints_make_no_place() -> None:
    _, before, after = begun(0.0, 0.0)
    assert after.library.places == before.library.places


@pytest.mark.slow
def test_windows_are_no_finer_than_the_whole_asks_for() -> None:
    prepared, before, after = begun(SHARED, DRY)
    was, now = (item.stages[-1].cuts[0].fine for item in (before, after))
    assert 1 <= now <= was
    assert prepared.runs[0].fine == now
    assert all(cut.fine == now for stage in after.stages for cut in stage.cuts)


@pytest.mark.thorough
def test_every_loss_of_the_arm_is_named_and_measured() -> None:
    found = sh.diagnose(arm(), recorded(SHARED, DRY)).found
    values = {(one.element.kind, one.element.place): one for one in found}
    assert len(values) == len(found) == JOINTS + 2
    assert values.keys() == {
        *(("damper", On(f"q{i}")) for i in range(JOINTS)),
        ("damper", On("q2 + q3")),
        ("friction", On("q2 + q3")),
    }
