"""Bags piece by piece: the same rows as of the whole file."""

import numpy as np
import pytest

from symhyb.data.files import bag_pieces
from symhyb.data.pieces import pieces_of
from symhyb.data.recording import read_recording
from symhyb.errors import InputError
from tests.data.bags import KINDS, MAP, SECOND, Made, bag_in, single

T = np.arange(1000) / 100


@pytest.fixture(autouse=True)
def here(monkeypatch):
    """Read in this process, which is quicker, and hold back half a second."""
    monkeypatch.setattr(bag_pieces, "OVERLAP_NS", SECOND // 2)
    monkeypatch.setattr(
        "symhyb.data.pieces.pieces_apart",
        lambda reader, path, file, rows, _: reader(path, file, rows),
    )


def place(t):
    return np.sin(2 * np.pi * 0.3 * t)


def fill(made: Made, pause=(np.inf, np.inf), back=np.inf) -> None:
    """A joint at 100 Hz but for a pause, logged late, and a force at 20 Hz; stamps jump back at a
    time."""
    late = np.random.default_rng(1).uniform(1e-3, 3e-3, T.size)
    for k, t in enumerate(T):
        stamp = t - 0.1 if abs(t - back) < 1e-6 else t
        if not pause[0] <= t < pause[1]:
            made.joints("/arm/joint_states", t + late[k], stamp, x=place(t))
        if k % 5 == 0:
            made.number("/drive/force", t, np.cos(t))


@pytest.mark.parametrize("kind", KINDS)
def test_pieces_together_are_the_whole(model, tmp_path, kind):
    path = bag_in(tmp_path, kind, fill)
    found = list(pieces_of(single(path), model, MAP, rows=120, overlap=20))
    own = [
        one.recording.t[(one.recording.t >= one.first) & (one.recording.t < one.last)]
        for one in found
    ]
    whole = read_recording(path, model, MAP)
    assert len(found) > 4
    np.testing.assert_array_equal(np.concatenate(own), whole.t)
    for one in found:
        at = np.searchsorted(whole.t, one.recording.t)
        laser, f = one.recording.sensors["laser"], one.recording.inputs["f"]
        np.testing.assert_array_equal(laser, whole.sensors["laser"][at])
        inner = slice(5, -5)
        np.testing.assert_allclose(f[inner], whole.inputs["f"][at][inner], atol=1e-9)


def test_a_folder_is_one_bag(model, tmp_path):
    path = bag_in(tmp_path, "mcap", fill)
    *_, last = pieces_of(path, model, MAP, rows=300)
    assert last.recording.t[-1] == read_recording(path, model, MAP).t[-1]
    with pytest.raises(InputError, match="is a folder that holds no bag of ROS 2"):
        list(pieces_of(tmp_path, model, MAP, rows=300))


def test_memory_does_not_grow_with_the_file(model, tmp_path, monkeypatch):
    most = 0
    plain = bag_pieces.table_of

    def table_of(topics, *arguments, **options):
        nonlocal most
        most = max([most, *(len(topic.logged) for topic in topics.values())])
        return plain(topics, *arguments, **options)

    monkeypatch.setattr(bag_pieces, "table_of", table_of)
    path = bag_in(tmp_path, "mcap", fill)
    assert len(list(pieces_of(path, model, MAP, rows=100))) > 5
    assert most <= 100 + 2 * 60  # a piece, and twice what is held back


def test_a_topic_that_pauses_for_a_piece_goes_on(model, tmp_path):
    path = bag_in(tmp_path, "mcap", lambda made: fill(made, pause=(1.0, 9.0)))
    also = {"accel": "drive.force.data [m/s^2]"}
    found = list(pieces_of(path, model, MAP | also, rows=60, overlap=10))
    assert any("laser" not in one.recording.sensors for one in found)
    seen = [
        one.recording.sensors["laser"][
            (one.recording.t >= one.first) & (one.recording.t < one.last)
        ]
        for one in found
        if "laser" in one.recording.sensors
    ]
    laser = np.concatenate(seen)
    expected = place(T[((T < 1) | (T >= 9)) & (T <= 9.95)])  # where the force ends
    np.testing.assert_allclose(laser[np.isfinite(laser)], expected, atol=1e-9)


def test_a_clock_that_changes_along_the_file_is_refused(model, tmp_path):
    path = bag_in(tmp_path, "mcap", lambda made: fill(made, back=6.0))
    with pytest.raises(InputError, match="stamps can be used in one piece and not in another"):
        list(pieces_of(path, model, MAP, rows=120))


def test_cuts_are_one_sentence(model, tmp_path):
    path = single(bag_in(tmp_path, "mcap", fill))
    path.write_bytes(path.read_bytes()[:-300])
    with pytest.raises(InputError, match="is a damaged or cut off bag"):
        list(pieces_of(path, model, MAP, rows=120))


def test_what_is_no_bag(model, write):
    with pytest.raises(InputError, match="is not a bag of ROS, although its name says so"):
        list(pieces_of(write("run.mcap", b"t,f"), model, MAP, rows=120))
