"""Bags of ROS 1 and ROS 2 for tests, written by rosbags."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

rosbag1 = pytest.importorskip("rosbags.rosbag1", reason="the extra rosbag is not installed")
rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="the extra rosbag is not installed")
typesys = pytest.importorskip("rosbags.typesys", reason="the extra rosbag is not installed")

SECOND = 1_000_000_000
START = 1_709_646_312 * SECOND
STORES = {False: typesys.Stores.ROS1_NOETIC, True: typesys.Stores.ROS2_HUMBLE}
KINDS = ("bag", "mcap", "db3")
STATES, NUMBER = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"
VECTOR = "geometry_msgs/msg/Vector3"


class Made:
    """A bag that is being written: messages of a topic, of joints or of a number."""

    def __init__(self, writer, ros2):
        self.writer, self.ros2 = writer, ros2
        self.store = typesys.get_typestore(STORES[ros2])
        self.known = {}

    def write(self, topic, time, message):
        """A message that is logged at ``time`` in s."""
        kind = message.__msgtype__
        if topic not in self.known:
            self.known[topic] = self.writer.add_connection(topic, kind, typestore=self.store)
        serialize = self.store.serialize_cdr if self.ros2 else self.store.serialize_ros1
        self.writer.write(self.known[topic], START + round(time * SECOND), serialize(message, kind))

    def joints(self, topic, logged, stamp, **position):
        """Positions of joints by name, measured at ``stamp`` in s."""
        types = self.store.types
        time = types["builtin_interfaces/msg/Time"](*divmod(START + round(stamp * SECOND), SECOND))
        more = {} if self.ros2 else {"seq": 0}
        header = types["std_msgs/msg/Header"](**more, stamp=time, frame_id="base")
        none = np.empty(0)
        values = np.array([*position.values()], dtype=float)
        self.write(topic, logged, types[STATES](header, [*position], values, none, none))

    def number(self, topic, logged, value):
        """A number without a stamp."""
        self.write(topic, logged, self.store.types[NUMBER](value))


MAP = {"laser": "arm.joint_states.position.x", "f": "drive.force.data [N]"}
"""Columns of the joint and the force of a mass that is driven, by channel."""


def bag_in(
    folder: Path, kind: str, fill: Callable[[Made], None], name: str = "run", **more
) -> Path:
    """The path of a bag of that kind, into which ``fill(made)`` writes."""
    if kind == "bag":
        path = folder / f"{name}.bag"
        writer = rosbag1.Writer(path)
        for packed in more.values():
            packed(writer)
        with writer:
            fill(Made(writer, False))
        return path
    plugin = rosbag2.StoragePlugin.MCAP if kind == "mcap" else rosbag2.StoragePlugin.SQLITE3
    path = folder / name
    writer = rosbag2.Writer(path, version=9, storage_plugin=plugin)
    for mode in more.values():
        writer.set_compression(mode, rosbag2.CompressionFormat.ZSTD)
    with writer:
        fill(Made(writer, True))
    return path


def single(path: Path) -> Path:
    """The one file that holds the messages of a bag."""
    if path.is_file():
        return path
    (found,) = (one for one in path.iterdir() if one.suffix in (".mcap", ".db3"))
    return found
