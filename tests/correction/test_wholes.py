"""An arm that nothing in its model holds up: windows are as long as what forces show foresees."""

import numpy as np
import pytest
from builders import driven_joints

import symhyb as sh
from symhyb.correction.search.preparing import foresees, last_windows, prepare, settle
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.wholes import at_level_of_forces
from symhyb.data.recording import Recording
from symhyb.model.types import Model, On

JOINTS = 4
INERTIA = np.array([0.5, 0.4, 0.2, 0.1])  # kg·m²
DAMPING = np.array([40.0, 30.0, 20.0, 10.0])  # N·m·s/rad
FALLS = 60.0  # N·m/rad: gravity of a joint that stands upright


def arm() -> Model:
    """Four upright joints, each driven, that know no loss: alone each falls within 0.1 s."""
    return driven_joints(INERTIA, -FALLS)


def recorded(damping: np.ndarray) -> Recording:
    """A motion under control, with the torques that it takes."""
    random = np.random.default_rng(4)
    t = np.arange(0, 20.0, 0.01)
    turn = 2 * np.pi * np.linspace(0.1, 0.6, 5)[:, None]
    angle = turn * t + random.uniform(0, 2 * np.pi, (JOINTS, 5, 1))
    q, v, a = (
        0.1 * part.sum(axis=1)
        for part in (np.sin(angle), turn * np.cos(angle), -(turn**2) * np.sin(angle))
    )
    pushed = INERTIA[:, None] * a + damping[:, None] * v - FALLS * q
    seen = q + 1e-4 * random.standard_normal(q.shape)
    return Recording(
        "arm.csv",
        t,
        {f"tq{i}": pushed[i] for i in range(JOINTS)},
        {f"encoder{i}": seen[i] for i in range(JOINTS)},
        (),
        "",
    )


def shown(setting: Setting) -> float:
    """The part of the recording that the windows hold which decide."""
    cuts = setting.stages[-1].cuts
    return sum(cut.rows.shape[0] * (cut.rows.shape[1] - 1) for cut in cuts) / 2000


@pytest.mark.slow
def test_losses_that_forces_show_hold_up_what_falls_in_the_model() -> None:
    prepared = prepare(arm(), recorded(DAMPING))
    before = settle(prepared)
    assert not foresees(prepared)
    assert shown(before) > 0.9
    known, after, forces = at_level_of_forces(prepared, before, ())
    assert forces is not None
    assert known.steady is not None
    assert shown(after) > 0.9
    assert after.stages[-1].length_s > 3 * before.stages[-1].length_s
    last = last_windows(known, spread=True)
    assert [cut.rows.shape for cut in last] == [c.rows.shape for c in after.stages[-1].cuts]


@pytest.mark.slow
def test_windows_stay_short_where_forces_show_nothing_that_holds() -> None:
    prepared = prepare(arm(), recorded(np.zeros(JOINTS)))
    before = settle(prepared)
    _, after, _ = at_level_of_forces(prepared, before, ())
    assert [one.length_s for one in after.stages] == [one.length_s for one in before.stages]


@pytest.mark.thorough
def test_the_damping_of_every_joint_is_named_and_measured() -> None:
    """Before windows became shorter the arm was refused as recorded too shortly."""
    result = sh.diagnose(arm(), recorded(DAMPING))
    found = {(one.element.kind, one.element.place): one for one in result.found}
    assert found.keys() == {("damper", On(f"q{i}")) for i in range(JOINTS)}
    for i in range(JOINTS):
        assert found["damper", On(f"q{i}")].damping.value == pytest.approx(DAMPING[i], rel=0.01)
