"""ULog files, written byte by byte as PX4 does: topics, instances, sent and measured."""

import struct

import numpy as np
import pytest

from symhyb.data.files import apart
from symhyb.data.files.formats import read_table
from symhyb.data.files.ulog_file import MAGIC, read_ulog
from symhyb.data.recording import read_recording
from symhyb.errors import InputError

pytest.importorskip("pyulog", reason="the extra ulog is not installed")

ROD = "uint64_t timestamp;uint64_t timestamp_sample;float[2] q;"
DRIVE = "uint64_t timestamp;double force;uint8_t[4] _padding0;"


def record(kind, data):
    return struct.pack("<HB", len(data), ord(kind)) + data


class Log:
    """The bytes of a log, with the formats of its topics first."""

    def __init__(self, **formats):
        self.bytes = MAGIC + b"\1" + struct.pack("<Q", 5)
        self.bytes += record("B", bytes(40))
        for name, fields in formats.items():
            self.bytes += record("F", f"{name}:{fields}".encode())
        self.topics = {}

    def write(self, topic, layout, *values, instance=0):
        if (topic, instance) not in self.topics:
            self.topics[topic, instance] = len(self.topics)
            number = self.topics[topic, instance]
            self.bytes += record("A", struct.pack("<BH", instance, number) + topic.encode())
        number = self.topics[topic, instance]
        self.bytes += record("D", struct.pack("<H" + layout, number, *values))


def us(seconds):
    return 3_000_000 + round(1e6 * seconds)


@pytest.fixture
def content(signals):
    log = Log(rod=ROD, drive=DRIVE)
    for k, t in enumerate(signals["t"]):
        log.write("rod", "QQ2f", us(t) + 1500, us(t), 1.0, signals["laser"][k])
        if k % 5 == 0:
            log.write("drive", "Qd", us(t), signals["f"][k])
    return log.bytes


def test_topics_are_parts_and_what_was_measured_counts(model, write, content, signals):
    path = write("run.ulg", content)
    recording = read_recording(path, model, {"laser": "rod.q.2", "f": "drive.force"})
    np.testing.assert_allclose(recording.t, signals["t"][:96], atol=1e-9)
    expected = signals["laser"][:96] / 1e3
    np.testing.assert_allclose(recording.sensors["laser"], expected, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(recording.inputs["f"][::5], signals["f"][:96:5])
    said = " ".join(recording.notes)
    assert "as stamped: rod (logged 1.5 ms later, 1.5 ms to 1.5 ms)" in said
    assert "without stamps: drive" in said
    names = ["drive.t", "drive.force", "rod.t", "rod.t_log", "rod.q.1", "rod.q.2"]
    assert read_table(path).names() == names


def test_instances_are_numbered_as_px4_does_and_nested_fields_by_dots():
    log = Log(one="uint64_t timestamp;esc[2] esc;", esc="float rpm;")
    for k in range(3):
        for instance in range(2):
            log.write("one", "Q2f", us(k), 10.0 + instance, 20.0, instance=instance)
    table = read_ulog(log.bytes, "a.ulg")
    assert table.names() == [
        f"one_{k}.{name}" for k in range(2) for name in ("t", "esc.1.rpm", "esc.2.rpm")
    ]
    assert table.find("one_1.esc.1.rpm")[0].values.tolist() == [11.0] * 3


def test_a_message_alone_is_a_number():
    log = Log(drive=DRIVE)
    log.write("drive", "Qd", us(1), 7.5)
    (column,) = read_ulog(log.bytes, "a.ulg").columns
    assert (column.header, column.values.shape) == ("drive.force", ())


def test_a_log_that_ends_in_mid_air_is_read_and_dropouts_are_said(content):
    """The battery was pulled: what was written counts."""
    cut = read_ulog(content[:-2000], "a.ulg")
    assert 0 < cut.find("rod.q.1")[0].values.size < 100
    lost = read_ulog(content + record("O", struct.pack("<H", 250)), "a.ulg")
    assert "the logger was too slow 1 times and lost 0.25 s" in lost.notes


def test_times_that_jump_back_are_said_when_they_are_used(model, write):
    log = Log(drive=DRIVE)
    for k in [*range(30), *range(30)]:
        log.write("drive", "Qd", us(k), float(k))
    with pytest.raises(InputError, match="time does not increase at row 31") as caught:
        read_recording(write("a.ulg", log.bytes), model, {"laser": "drive.force", "f": "0*index"})
    assert len(caught.value.problems) == 1


def test_times_beyond_all_counting():
    log = Log(drive=DRIVE)
    log.write("drive", "Qd", 2**64 - 1, 1.0)
    with pytest.raises(InputError, match="the times of drive are later than any clock counts"):
        read_ulog(log.bytes, "a.ulg")


@pytest.mark.parametrize("content", [Log().bytes, Log(drive=DRIVE).bytes, Log().bytes[:10]])
def test_nothing_in_it(content):
    with pytest.raises(InputError, match=r"holds no message|is a damaged ULog file") as caught:
        read_ulog(content, "a.ulg")
    assert len(caught.value.problems) == 1


def test_what_is_no_ulog(write):
    with pytest.raises(InputError, match=r"is not a ULog file, although its name ends in \.ulg"):
        read_table(write("run.ulg", b"t,f\n0,1\n"))


def test_nested_formats_without_end_are_one_sentence(write, monkeypatch):
    """Each level has 60 000 of the next."""
    monkeypatch.setattr(apart, "READER_SECONDS", 2)
    log = Log(a="uint64_t timestamp;b[60000] x;", b="c[60000] x;", c="d[60000] x;", d="float x;")
    log.bytes += record("A", struct.pack("<BH", 0, 0) + b"a")
    with pytest.raises(InputError, match=r"takes longer to read|GiB of memory") as caught:
        read_table(write("bomb.ulg", log.bytes))
    assert len(caught.value.problems) == 1


def test_damage_inside_is_a_sentence_and_nothing_is_printed(content, capfd):
    said = []
    for place in [*range(16, 250), *range(250, len(content), 37)]:
        broken = bytearray(content)
        broken[place] ^= 0x4D
        try:
            said += read_ulog(bytes(broken), "a.ulg").notes
        except InputError as error:
            said.append(str(error))
    assert "the file is damaged in places, messages may be missing" in said
    assert any("its records lead back to where they begin" in text for text in said)
    assert all("\n" not in text for text in said)
    assert capfd.readouterr() == ("", "")
