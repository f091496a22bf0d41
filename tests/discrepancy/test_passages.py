"""Motions that go one way, and at which speeds they pass a place."""

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.passages import one_way, passed_at_one_speed
from symhyb.discrepancy.recorded.runs import Run

T = np.linspace(0, 3, 60)


def run(q: np.ndarray) -> Run:
    v = np.gradient(q, T)
    one = np.ones(1)
    motion = Motion(T, q[:, None], v[:, None], np.gradient(v, T)[:, None], one, one, one, one, 0.1)
    return Run(Recording("fall.csv", T, {}, {}, (), ""), motion, one)


def fall(pull: float) -> np.ndarray:
    return 45 - pull * T**2 / 2


def test_a_fall_goes_one_way_and_a_swing_does_not() -> None:
    assert one_way(run(fall(9.81)).motion)
    assert one_way(run(fall(9.81) + 0.05 * np.sin(40 * T)).motion)  # a slight shake is no return
    assert not one_way(run(np.cos(5 * T)).motion)
    assert not one_way(run(0 * T).motion)


def test_repeated_falls_pass_every_place_at_one_speed() -> None:
    assert passed_at_one_speed([run(fall(9.81))])
    assert passed_at_one_speed([run(fall(9.81)), run(fall(9.6))])
    assert not passed_at_one_speed([run(fall(9.81)), run(fall(5.0))])
    assert not passed_at_one_speed([run(np.cos(5 * T))])


def test_falls_that_share_no_place_tell_nothing_of_each_other() -> None:
    assert passed_at_one_speed([run(fall(9.81)), run(fall(5.0) - 500)])
