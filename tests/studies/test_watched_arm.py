"""The arm of the study of a watch: what its owner knows of it, and how it moves."""

from collections.abc import Iterator
from types import ModuleType

import numpy as np
import pytest

from tests.scripts import scripts


@pytest.fixture(scope="module")
def arm() -> Iterator[ModuleType]:
    with scripts("watch", ("in_c", "arm")) as found:
        yield found["arm"]


def test_losses_of_every_joint_may_change(arm: ModuleType) -> None:
    model = arm.arm_model()
    uncertain = [item.path for item in model.all_parameters() if item.sd is not None]
    wanted = [f"j_{i}_{what}" for i in range(1, 8) for what in ("damping", "friction")]
    assert sorted(uncertain) == sorted(wanted)


def test_it_stands_still_between_its_motions(arm: ModuleType) -> None:
    seconds = arm.MOVING_S + arm.STILL_S
    torques, angles = arm.moved(1, seconds, None)
    assert torques.shape == angles.shape == (round(seconds * arm.RATE), arm.JOINTS)
    still = angles[round((arm.MOVING_S + 0.8) * arm.RATE) :]
    assert np.all(np.ptp(still, axis=0) < 1e-3 * np.ptp(angles, axis=0))


def test_more_friction_takes_more_torque_from_then_on(
    arm: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(arm, "AT_S", 1.0)
    (before, _), (after, _) = (arm.moved(1, 3.0, change) for change in (None, arm.Drawn(4)))
    late = round(1.0 * arm.RATE)
    np.testing.assert_array_equal(before[:late], after[:late])
    more = np.abs(after - before)[late:].max(axis=0)
    assert more.argmax() == 4
    assert more[4] == pytest.approx(0.3, rel=0.5)  # of 1 N·m
