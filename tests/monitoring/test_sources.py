"""Files that grow or shrink, streams and datagrams."""

import io
import socket
from pathlib import Path

import pytest

from symhyb.errors import InputError
from symhyb.monitoring.sources import LINE_MOST, of_datagrams, of_file, of_stream, source_of


def test_a_file_is_followed_as_it_grows_and_begun_anew_when_it_shrinks(tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    file.write_text("one\ntw")
    lines = of_file(file, follow=True)
    assert next(lines) == "one"
    with file.open("a") as more:
        more.write("o\r\nthree\n")
    assert [next(lines) for _ in range(2)] == ["two", "three"]
    assert next(lines) is None
    file.write_text("new\n")
    assert next(lines) == "new"


def test_a_file_that_is_not_followed_ends_with_its_last_line(tmp_path: Path) -> None:
    file = tmp_path / "rig.csv"
    file.write_text("one\ntwo")
    assert list(of_file(file, follow=False)) == ["one", "two"]


def test_a_file_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="No such file"):
        next(of_file(tmp_path / "none.csv", follow=True))


def test_a_stream_ends() -> None:
    assert list(of_stream(io.StringIO("a\r\nb\n\nc"), "pipe")) == ["a", "b", "", "c"]


def test_a_line_without_an_end_is_refused() -> None:
    with pytest.raises(InputError, match="longer than"):
        list(of_stream(io.StringIO("9" * (LINE_MOST + 1)), "pipe"))


def test_datagrams_of_this_machine_are_heard() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    lines = of_datagrams(port)
    assert next(lines) is None
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.sendto(b"t,f\n0,1\n", ("127.0.0.1", port))
    heard = [next(lines) for _ in range(2)]
    lines.close()
    assert heard == ["t,f", "0,1"]


@pytest.mark.parametrize("port", ["", "0", "65536", "-1", "nine"])
def test_a_port_that_is_none_is_an_error(port: str) -> None:
    with pytest.raises(InputError, match="is no port"):
        source_of(f"udp:{port}", follow=True)
