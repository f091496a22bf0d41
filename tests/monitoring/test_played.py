"""A bag is watched while it is written: the rows are those of the complete one."""

import json
from collections.abc import Callable, Generator
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from command import Call

from symhyb.errors import InputError
from symhyb.monitoring import played
from symhyb.monitoring.played import is_bag, of_bag
from tests.pushed import DRIVEN_MASS, STEP, STIFFNESS, pushed, pushed_model

rosbag2 = pytest.importorskip("rosbags.rosbag2", reason="the extra rosbag is not installed")
typesys = pytest.importorskip("rosbags.typesys", reason="the extra rosbag is not installed")

SECOND = 1_000_000_000
MAP = {"laser": "arm.laser.data [m]", "f": "drive.data [N]"}
OPTIONS = [f"--map={channel}={column}" for channel, column in MAP.items()]
Bag = Callable[..., Path]


@pytest.fixture
def bag(tmp_path: Path) -> Bag:
    """``bag(stiffness, …)``: a bag of a push, at ``every`` few samples, and a position, some
    seconds of each stiffness, in chunks of 2 s."""

    def written(
        *stiffness: float, seconds: float = 30.0, form: str = "MCAP", every: int = 1
    ) -> Path:
        store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
        number = store.types["std_msgs/msg/Float64"]
        path = tmp_path / "run"
        writer = rosbag2.Writer(path, version=9, storage_plugin=rosbag2.StoragePlugin[form])
        first = 0.0
        with writer:
            topics = [
                writer.add_connection(name, number.__msgtype__, typestore=store)
                for name in ("/arm/laser", "/drive")
            ]
            for seed, one in enumerate(stiffness):
                run = pushed(seed, samples=round(seconds / STEP), stiffness=one)
                channels = run.sensors["laser"], run.inputs["f"]
                for i, t in enumerate(run.t + first):
                    for topic, values in zip(topics, channels, strict=True):
                        if topic is topics[1] and i % every:
                            continue
                        message = store.serialize_cdr(number(values[i]), number.__msgtype__)
                        writer.write(topic, round((100 + t) * SECOND), message)
                    if form == "MCAP" and i % 100 == 99:
                        writer.storage.close_chunk()
                first += seconds
        return path

    return written


def file_of(folder: Path) -> Path:
    (found,) = (one for one in folder.iterdir() if one.name != "metadata.yaml")
    return found


def numbers(lines: list[str | None]) -> np.ndarray:
    return np.array([line.split(",") for line in lines if line][1:], dtype=float)


def test_a_complete_bag_is_played_in_the_units_of_the_model(bag: Bag) -> None:
    folder = bag(STIFFNESS)
    for source in (folder, file_of(folder)):
        lines = list(of_bag(str(source), pushed_model(), MAP, follow=True))
        assert lines[0] == "t [s],f [N],laser [m]"
        run, rows = pushed(0, samples=round(30 / STEP)), numbers(lines)
        np.testing.assert_allclose(rows[:, 0], run.t, atol=1e-9)
        np.testing.assert_allclose(
            rows[:, 1:], np.stack([run.inputs["f"], run.sensors["laser"]], 1)
        )


def test_a_bag_in_sqlite_is_played_once_it_is_complete(bag: Bag) -> None:
    lines = list(of_bag(str(bag(STIFFNESS, form="SQLITE3")), pushed_model(), MAP, follow=True))
    assert len(lines) == 1 + round(30 / STEP)


@pytest.fixture
def growing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[Path, int], Path]:
    """``growing(folder, parts)``: a bag without an end that grows at every look; its last part
    completes it."""

    def begun(folder: Path, parts: int) -> Path:
        content = file_of(folder).read_bytes()
        edges = np.linspace(0, len(content), parts + 1).astype(int).tolist()
        rest = [content[first:last] for first, last in pairwise(edges)]
        path = tmp_path / "live.mcap"
        path.write_bytes(rest.pop(0))
        apart = played.pieces_apart

        def grown(*order: object) -> Generator[object, None, None]:
            for table in apart(*order):  # type: ignore[arg-type]
                yield table
                if rest:
                    with path.open("ab") as stream:
                        stream.write(rest.pop(0))

        monkeypatch.setattr(played, "pieces_apart", grown)
        return path

    return begun


@pytest.mark.parametrize("every", [1, 7])
def test_a_bag_that_is_being_written_is_followed_to_its_end(
    bag: Bag, growing: Callable[[Path, int], Path], every: int
) -> None:
    folder = bag(STIFFNESS, every=every)
    whole = numbers(list(of_bag(str(folder), pushed_model(), MAP, follow=True)))
    live = growing(folder, 7)
    lines = list(of_bag(str(live), pushed_model(), MAP, follow=True))
    np.testing.assert_allclose(numbers(lines), whole, atol=1e-9)
    assert None in lines


def test_a_bag_that_was_not_finished_is_played_as_far_as_it_goes(bag: Bag, tmp_path: Path) -> None:
    folder = bag(STIFFNESS)
    content = file_of(folder).read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[: len(content) * 2 // 3])
    rows = numbers(list(of_bag(str(cut), pushed_model(), MAP, follow=False)))
    assert 0.3 * 30 / STEP < len(rows) < 0.8 * 30 / STEP


@pytest.mark.slow
def test_a_change_in_a_bag_is_told(bag: Bag, tmp_path: Path, symhyb: Call) -> None:
    model = tmp_path / "mass.toml"
    model.write_text(DRIVEN_MASS, encoding="utf-8")
    folder = bag(STIFFNESS, 1.1 * STIFFNESS)
    done = symhyb("watch", model, folder, *OPTIONS, "--reference", "29", "--json")
    kinds = [json.loads(line)["kind"] for line in done.out.splitlines()]
    assert kinds[:3] == ["ready", "changed", "named"]
    assert done.status == 1


def test_what_cannot_be_followed_says_what_to_do(bag: Bag, tmp_path: Path) -> None:
    folder = bag(STIFFNESS, form="SQLITE3")
    (folder / "metadata.yaml").unlink()
    with pytest.raises(InputError, match="record with 'ros2 bag record -s mcap'"):
        list(of_bag(str(folder), pushed_model(), MAP, follow=False))
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="holds no bag that is complete"):
        list(of_bag(str(tmp_path / "empty"), pushed_model(), MAP, follow=True))
    with pytest.raises(InputError, match="does not exist"):
        list(of_bag(str(tmp_path / "none.mcap"), pushed_model(), MAP, follow=True))


@pytest.mark.parametrize(
    "content",
    [b"no bag", b"\x89MCAP0\r\n" + b"\x05" + b"\xff" * 8, b"\x89MCAP0\r\n\x06" + 8 * b"\1"],
)
def test_a_damaged_beginning_is_one_sentence(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "bad.mcap"
    path.write_bytes(content + bytes(64))
    with pytest.raises(InputError, match=r"bad\.mcap"):
        list(of_bag(str(path), pushed_model(), MAP, follow=False))


def test_a_channel_that_is_missing_is_said(bag: Bag, tmp_path: Path) -> None:
    content = file_of(bag(STIFFNESS)).read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(content[:-40])
    with pytest.raises(InputError, match="laser"):
        list(of_bag(str(cut), pushed_model(), {"f": "drive.data [N]"}, follow=False))


def test_what_a_bag_is() -> None:
    assert [is_bag(one) for one in ("a.mcap", "b.DB3", "c.bag#arm", "d.csv", "-", "udp:1")] == [
        True,
        True,
        True,
        False,
        False,
        False,
    ]
