"""Messages of ROS as numbers: rosbags writes what is read here along its definitions."""

import struct

import numpy as np
import pytest

from symhyb.data.files.ros_message import UnreadableError, decoder

interfaces = pytest.importorskip("rosbags.interfaces", reason="the extra rosbag is not installed")
typesys = pytest.importorskip("rosbags.typesys", reason="the extra rosbag is not installed")

ROS1 = typesys.get_typestore(typesys.Stores.ROS1_NOETIC)
ROS2 = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)


def read(store, message, ros2):
    kind = message.__msgtype__
    write = store.serialize_cdr if ros2 else store.serialize_ros1
    return decoder(kind, store.fielddefs, ros2)(bytes(write(message, kind)))


def header(store, ros2, frame="base_link"):
    stamp = store.types["builtin_interfaces/msg/Time"](17, 250_000_000)
    more = {} if ros2 else {"seq": 3}
    return store.types["std_msgs/msg/Header"](**more, stamp=stamp, frame_id=frame)


@pytest.mark.parametrize(("store", "ros2"), [(ROS1, False), (ROS2, True)])
@pytest.mark.parametrize("frame", ["", "a", "base_link", "odd"])  # texts of every alignment
def test_joints_are_called_by_their_names(store, ros2, frame):
    q, v = np.array([0.5, -1.5, 2.0]), np.array([3.0, 4.0, 5.0])
    names = ["shoulder", "elbow", "hand"]
    kind = store.types["sensor_msgs/msg/JointState"]
    message = read(store, kind(header(store, ros2, frame), names, q, v, np.empty(0)), ros2)
    assert message.stamp == 17_250_000_000
    assert message.numbers == {
        **{f"position.{name} [SI]": x for name, x in zip(names, q, strict=True)},
        **{f"velocity.{name} [SI]": x for name, x in zip(names, v, strict=True)},
    }


@pytest.mark.parametrize("names", [["a", "a"], ["a [mm]", "b"], ["", "b"]])
def test_names_that_cannot_call_a_channel_leave_numbers(names):
    kind = ROS2.types["sensor_msgs/msg/JointState"]
    made = kind(header(ROS2, True), names, np.array([1.0, 2.0]), np.empty(0), np.empty(0))
    assert read(ROS2, made, True).numbers == {"position.1 [SI]": 1.0, "position.2 [SI]": 2.0}


@pytest.mark.parametrize(("store", "ros2"), [(ROS1, False), (ROS2, True)])
def test_an_imu_has_units_and_no_covariances(store, ros2):
    vector = store.types["geometry_msgs/msg/Vector3"]
    turn = store.types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.6, 0.8)
    nine = np.arange(9.0)
    made = store.types["sensor_msgs/msg/Imu"](
        header(store, ros2), turn, nine, vector(1, 2, 3), nine, vector(4, 5, 6), nine
    )
    assert read(store, made, ros2).numbers == {
        "orientation.x": 0.0,
        "orientation.y": 0.0,
        "orientation.z": 0.6,
        "orientation.w": 0.8,
        "angular_velocity.x [rad/s]": 1.0,
        "angular_velocity.y [rad/s]": 2.0,
        "angular_velocity.z [rad/s]": 3.0,
        "linear_acceleration.x [m/s^2]": 4.0,
        "linear_acceleration.y [m/s^2]": 5.0,
        "linear_acceleration.z [m/s^2]": 6.0,
    }


@pytest.mark.parametrize(("store", "ros2"), [(ROS1, False), (ROS2, True)])
def test_transforms_are_called_by_their_frames(store, ros2):
    types = store.types
    made = []
    for k, child in enumerate(("left/wheel", "right")):
        move = types["geometry_msgs/msg/Vector3"](k + 1.0, 0.0, 0.0)
        turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
        moved = types["geometry_msgs/msg/Transform"](move, turn)
        stamped = types["geometry_msgs/msg/TransformStamped"]
        made.append(stamped(header(store, ros2), child, moved))
    stamped = made[0].__msgtype__
    known = dict(store.fielddefs)
    known |= typesys.get_types_from_msg(f"{stamped}[] transforms\n", "a/msg/All")
    if ros2:
        own = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        own.register({"a/msg/All": known["a/msg/All"]})
        data = own.serialize_cdr(own.types["a/msg/All"](made), "a/msg/All")
    else:
        data = struct.pack("<I", 2) + b"".join(
            bytes(store.serialize_ros1(one, stamped)) for one in made
        )
    message = decoder("a/msg/All", known, ros2)(bytes(data))
    assert message.numbers["transforms.left/wheel.transform.translation.x [m]"] == 1.0
    assert message.numbers["transforms.right.transform.translation.x [m]"] == 2.0
    assert message.stamp == 17_250_000_000


@pytest.mark.parametrize("order", ["<", ">"])
def test_cdr_aligns_and_says_its_order(order):
    """Bytes by hand: bool, int16, float64, uint8[3], float32[], string, int64, an empty type."""
    types = typesys.get_types_from_msg(
        "bool on\nint16 n\nfloat64 x\nuint8[3] raw\nfloat32[] list\nstring name\nint64 big\n"
        "a/Nothing none\nuint8 last\n" + "=" * 80 + "\nMSG: a/Nothing\n",
        "a/msg/Odd",
    )
    body = struct.pack(f"{order}?xhxxxxd3BxI2f", True, -2, 1.5, 7, 8, 9, 2, 0.25, 0.5)
    body += struct.pack(f"{order}I3s", 3, b"hi\0")
    body += bytes(-len(body) % 8) + struct.pack(f"{order}qBB", -(2**40), 0, 5)
    head = b"\0\1\0\0" if order == "<" else b"\0\0\0\0"
    assert decoder("a/msg/Odd", types, True)(head + body).numbers == {
        "on": 1.0,
        "n": -2.0,
        "x": 1.5,
        "raw.1": 7.0,
        "raw.2": 8.0,
        "raw.3": 9.0,
        "list.1": 0.25,
        "list.2": 0.5,
        "big": -(2.0**40),
        "last": 5.0,
    }


@pytest.mark.parametrize("ros2", [False, True])
def test_long_arrays_are_named_and_walked_over(ros2):
    types = typesys.get_types_from_msg("uint8[] picture\nfloat64 x\n", "a/msg/Seen")
    body = struct.pack("<I100x", 100) + bytes(4 if ros2 else 0) + struct.pack("<d", 2.5)
    # behind 104 bytes a double is aligned already
    body = body[:104] + struct.pack("<d", 2.5)
    message = decoder("a/msg/Seen", types, ros2)((b"\0\1\0\0" if ros2 else b"") + body)
    assert message.numbers == {"x": 2.5}
    assert message.wide == {"picture"}


def test_a_definition_is_not_run(tmp_path, monkeypatch):
    """rosbags makes programs of definitions; here they are walked along."""
    from rosbags.typesys import store

    def refuse(*_):
        raise AssertionError("a program was made of a definition")

    monkeypatch.setattr(store, "generate_python_code", refuse)
    monkeypatch.setattr(store.Typestore, "get_msgdef", refuse)
    types = typesys.get_types_from_msg("string EVIL=__import__('os')\nfloat64 x\n", "a/msg/A")
    assert decoder("a/msg/A", types, False)(struct.pack("<d", 4.0)).numbers == {"x": 4.0}


def test_what_cannot_be_read_is_a_sentence():
    types = {
        **typesys.get_types_from_msg("a/Loop again\n", "a/msg/Loop"),
        **typesys.get_types_from_msg("b/Gone gone\n", "a/msg/Lacks"),
        **typesys.get_types_from_msg("float64 x\nfloat64[] more\n", "a/msg/Short"),
        **typesys.get_types_from_msg("a/None[] many\n", "a/msg/Many"),
        "a/msg/None": ([], []),
        "a/msg/Wide": ([], [("text", (interfaces.Nodetype.BASE, ("wstring", 0)))]),
    }
    for kind, text in (
        ("a/msg/Loop", "nested too deeply"),
        ("a/msg/Lacks", "does not define its type b/msg/Gone"),
        ("a/msg/Wide", "field of type wstring"),
    ):
        with pytest.raises(UnreadableError, match=text):
            decoder(kind, types, False)
    short = "shorter than its definition says"
    for data in (b"", bytes(7), struct.pack("<dI", 1.0, 2**31), struct.pack("<dI", 1.0, 1)):
        with pytest.raises(UnreadableError, match=short):
            decoder("a/msg/Short", types, False)(data)
    with pytest.raises(UnreadableError, match=short):
        decoder("a/msg/Many", types, False)(b"\xff\xff\xff\xff")
    for data in (b"", b"\0\3\0\0" + bytes(8), b"\x01\1\0\0"):
        with pytest.raises(UnreadableError, match="not encoded as plain CDR"):
            decoder("a/msg/Short", types, True)(data)
