"""Bags of ROS 1 and ROS 2: topics are parts with times of their own."""

import sqlite3
from functools import partial

import numpy as np
import pytest

from symhyb.data.files.bag_file import folder_of_bag, read_bag
from symhyb.data.files.formats import read_table
from symhyb.data.recording import read_recording
from symhyb.data.whole_file import whole_file
from symhyb.errors import InputError
from tests.data.bags import KINDS, MAP, bag_in, rosbag1, rosbag2, single


@pytest.fixture
def bag(tmp_path):
    """``bag(kind, fill)``: the path of a bag of that kind, into which ``fill(made)`` writes."""
    return partial(bag_in, tmp_path)


@pytest.fixture
def run(signals):
    """A run at 100 Hz: a joint, and the force that drives it at 20 Hz; both are logged late."""

    def fill(made):
        late = np.random.default_rng(1).uniform(1e-3, 3e-3, 100)
        for k, t in enumerate(signals["t"]):
            made.joints("/arm/joint_states", t + late[k], t, x=signals["laser"][k] / 1e3)
            if k % 5 == 0:
                made.number("/drive/force", t, signals["f"][k])

    return fill


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("whole", [True, False], ids=["bag", "file of it"])
def test_topics_are_parts_with_times_of_their_own(model, bag, run, signals, kind, whole):
    path = bag(kind, run)
    recording = read_recording(path if whole else single(path), model, MAP)
    zero = 0.0  # the force of the first row is logged at once, so that time is counted from there
    t = signals["t"][:96]
    np.testing.assert_allclose(recording.t, zero + t, atol=1e-8)
    np.testing.assert_allclose(recording.sensors["laser"], signals["laser"][:96] / 1e3, rtol=1e-9)
    slow = np.interp(t, signals["t"][::5], signals["f"][::5])
    np.testing.assert_allclose(recording.inputs["f"], slow, atol=1e-9)
    said = " ".join(recording.notes)
    assert "as stamped: arm.joint_states (logged 2" in said
    assert "t is when it was logged, without stamps: drive.force" in said
    assert "input f: 20 Hz beside rows at 100 Hz" in said


@pytest.mark.parametrize("kind", KINDS)
def test_a_topic_is_read_alone_and_the_time_of_logging_can_be_asked_for(model, bag, run, kind):
    path = bag(kind, run)
    table = read_table(f"{path}#arm.joint_states")
    assert table.names() == ["t", "t_log", "position.x"]
    t, logged = (table.columns[k].values for k in (0, 1))
    assert 1e-3 <= (logged - t).min() <= (logged - t).max() <= 3e-3
    late = {**MAP, "laser": "arm.joint_states.position.x @ arm.joint_states.t_log"}
    assert read_recording(path, model, late).t[1] > 0.0005


@pytest.mark.parametrize("kind", KINDS)
def test_a_bag_is_looked_at_without_a_model(bag, run, kind):
    seen = whole_file(read_table(bag(kind, run)))
    assert dict(seen.units) == {"arm.joint_states.position.x": "SI", "drive.force.data": None}


def test_a_slow_bus_that_jitters_is_a_rate_and_no_loss(model, bag, signals):
    """Commands every 50 ms, logged up to 12 ms late, beside joints at 100 Hz."""

    def fill(made):
        late = np.random.default_rng(5).uniform(0, 12e-3, 100)
        for k, t in enumerate(signals["t"]):
            made.joints("/joints", t, t, x=signals["laser"][k])
            if k % 5 == 0:
                made.number("/force", t + late[k], signals["f"][k])

    columns = {"laser": "joints.position.x", "f": "force.data"}
    recording = read_recording(bag("mcap", fill), model, columns)
    assert recording.t.size > 90
    assert any(note.startswith("input f: 20.") for note in recording.notes)


def test_joints_of_two_senders_on_one_topic_are_two_rates(bag):
    def fill(made):
        for k in range(50):
            made.joints("/joints", k / 100, k / 100, left=k)
            made.joints("/joints", k / 100 + 4e-3, k / 100 + 4e-3, right=-k)

    table = read_table(f"{bag('bag', fill)}#joints")
    left, right = (table.find(f"position.{name}")[0].values for name in ("left", "right"))
    assert np.isnan(left).tolist() == [False, True] * 50
    np.testing.assert_array_equal(right[1::2], -np.arange(50.0))


def test_a_split_recording_of_ros2_is_one(bag, run, tmp_path):
    """The files of a folder follow on each other by their numbers."""
    folder = bag("mcap", lambda made: [made.number("/a", k, k) for k in range(3)], "split_9")
    last = bag("mcap", lambda made: [made.number("/a", k, k) for k in (3, 4)], "split_10")
    single(last).rename(folder / "split_10.mcap")
    table = read_table(folder)
    np.testing.assert_array_equal(table.find("a.data")[0].values, np.arange(5.0))
    np.testing.assert_allclose(table.find("a.t")[0].values, np.arange(5.0))
    assert folder_of_bag(tmp_path) is None
    with pytest.raises(InputError, match="is a folder, not a recording"):
        read_table(tmp_path)


def test_types_that_a_file_does_not_define_are_those_of_humble(bag):
    path = single(bag("db3", lambda made: [made.number("/a", k, k) for k in range(3)]))
    with sqlite3.connect(path) as base:
        base.execute("UPDATE schema SET schema_version = 3")
    base.close()
    table = read_table(path)
    assert table.names() == ["a.t", "a.data"]
    assert "those of ROS 2 Humble are taken" in table.notes[0]


def test_a_message_alone_is_a_number_and_a_long_array_is_left_out(bag):
    def fill(made):
        types = made.store.types
        made.number("/mass", 0.5, 7.5)
        layout = types["std_msgs/msg/MultiArrayLayout"]([], 0)
        kind = types["std_msgs/msg/Float64MultiArray"]
        for k in range(3):
            made.write("/map", k, kind(layout, np.arange(65.0)))
            made.write("/few", k, kind(layout, np.arange(2.0)))

    table = read_table(bag("db3", fill))
    assert table.names() == ["few.t", "few.data.1", "few.data.2", "mass.data"]
    assert table.find("mass.data")[0].values.shape == ()
    assert table.notes[-1] == "map.data has more than 64 elements: left out"


@pytest.mark.slow
def test_packed_bags_are_read_or_said(bag, run):
    plain = read_table(bag("bag", run)).find("drive.force.data")[0].values
    for fmt in rosbag1.Writer.CompressionFormat:
        packed = partial(rosbag1.Writer.set_compression, fmt=fmt)
        packed = read_table(bag("bag", run, f"run_{fmt.name}", packed=packed))
        np.testing.assert_array_equal(packed.find("drive.force.data")[0].values, plain)
    mode = rosbag2.CompressionMode
    storage = bag("mcap", run, "storage", mode=mode.STORAGE)
    np.testing.assert_array_equal(read_table(storage).find("drive.force.data")[0].values, plain)
    with pytest.raises(InputError, match="are packed one by one; unpack the bag: ros2 bag convert"):
        read_table(bag("mcap", run, "messages", mode=mode.MESSAGE))
    with pytest.raises(InputError, match="files are packed; unpack them: zstd -d"):
        read_table(bag("db3", run, "files", mode=mode.FILE))


@pytest.mark.parametrize("kind", KINDS)
def test_an_empty_bag(bag, kind):
    with pytest.raises(InputError, match="holds no message with numbers"):
        read_table(bag(kind, lambda made: None))


@pytest.mark.parametrize("kind", KINDS)
def test_a_topic_that_is_not_there_is_one_sentence(model, bag, run, kind):
    with pytest.raises(InputError, match=r"there is no column 'joints\.x'; known: arm") as caught:
        read_recording(bag(kind, run), model, {**MAP, "laser": "joints.x"})
    assert len(caught.value.problems) == 1


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_no_bag(write, kind):
    with pytest.raises(InputError, match="is not a bag of ROS, although its name says so"):
        read_table(write(f"run.{kind}", b"t,f\n0,1\n"))


@pytest.mark.parametrize(
    ("kind", "cure"), [("bag", "rosbag reindex"), ("mcap", "mcap recover"), ("db3", "ros2 bag")]
)
def test_cuts_are_one_sentence(bag, run, kind, cure):
    whole = single(bag(kind, run)).read_bytes()
    for part in (0.1, 0.5, 0.98):
        with pytest.raises(InputError) as caught:
            read_bag(whole[: int(part * len(whole))], f"run.{kind}")
        (problem,) = caught.value.problems
        assert "is a damaged or cut off bag: " in problem.text
        assert cure in problem.text
        assert "\n" not in problem.text


@pytest.mark.parametrize("kind", KINDS)
def test_damage_inside_is_a_sentence_and_nothing_is_printed(bag, run, kind, capfd):
    whole = single(bag(kind, run)).read_bytes()
    said = []
    for place in range(8, len(whole), len(whole) // 60):
        broken = bytearray(whole)
        broken[place] ^= 0xF1
        try:
            read_bag(bytes(broken), f"run.{kind}")
        except InputError as error:
            said.append(str(error))
    assert said
    assert all("\n" not in text for text in said)
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
def test_a_chunk_that_unpacks_to_more_than_memory_is_one_sentence(bag, run):
    """Two gigabytes of zeros in eight megabytes."""
    lz4 = pytest.importorskip("lz4.frame")

    def zeros(_):
        with lz4.LZ4FrameCompressor() as packer:
            block = bytes(1 << 24)
            parts = [packer.begin(), *(packer.compress(block) for _ in range(128)), packer.flush()]
        return b"".join(parts)

    def packed(writer):
        writer.set_compression(rosbag1.Writer.CompressionFormat.LZ4)
        writer.compressor = zeros

    with pytest.raises(InputError, match=r"damaged or cut off bag|GiB of memory") as caught:
        read_table(bag("bag", run, packed=packed))
    assert len(caught.value.problems) == 1
