"""Splines that are factored once for all pieces: the motion of plain smoothing."""

from dataclasses import replace

import numpy as np
import pytest
from rigs import spring_model, spring_recording

from symhyb.discrepancy.recorded import even
from symhyb.discrepancy.recorded.even import even_of, is_even, smoothed
from symhyb.discrepancy.recorded.motion import motion_of
from symhyb.model.read import parse_model
from symhyb.model.write import text_of
from symhyb.numeric.lowered.machine import build


@pytest.fixture(scope="module")
def rig():
    machine = build(spring_model())
    recording = spring_recording(1, {"drag": 2.0})
    return machine, recording, motion_of(recording, machine)


def test_the_motion_is_that_of_plain_smoothing(rig, monkeypatch):
    machine, recording, like = rig
    same = even_of(recording, machine, like)
    assert same is not None
    other = spring_recording(2, {"drag": 2.0})
    plain = motion_of(other, machine, [like.spacing_s])
    monkeypatch.setattr(even, "motion_of", None)  # not asked
    quick = smoothed(other, machine, same, like)
    for name in ("q", "v", "a"):
        size = np.abs(getattr(plain, name)).max()
        np.testing.assert_allclose(getattr(quick, name), getattr(plain, name), atol=1e-6 * size)
    np.testing.assert_array_equal(quick.t, other.t)


def test_a_piece_with_a_hole_is_smoothed_by_itself(rig):
    machine, recording, like = rig
    same = even_of(recording, machine, like)
    laser = recording.sensors["laser"].copy()
    laser[100:110] = np.nan
    holed = replace(recording, sensors={"laser": laser})
    plain = motion_of(holed, machine, [like.spacing_s])
    np.testing.assert_array_equal(smoothed(holed, machine, same, like).q, plain.q)


def test_uneven_times_and_bent_sensors_have_none(rig):
    machine, recording, like = rig
    t = recording.t.copy()
    t[50] += 0.002
    assert not is_even(t, 0.005)
    assert even_of(replace(recording, t=t), machine, like) is None
    text = text_of(spring_model()).replace(
        'measures = "x", unit = "m"', 'measures = "x**2", unit = "m^2"'
    )
    bent = build(parse_model(text, "bent.toml"))
    assert even_of(recording, bent, like) is None
