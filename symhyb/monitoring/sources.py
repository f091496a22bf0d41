"""Where lines come from while a machine runs: a file that grows, standard input, datagrams.

Each yields lines of text without their end, and None where for a moment there is none.
"""

import socket
import sys
import time
from collections.abc import Generator
from pathlib import Path
from typing import TextIO

from symhyb.errors import InputError, Problem, visible

WAIT_S = 0.1  # until it is looked again for what a source has
LOOPBACK = "127.0.0.1"
CHUNK = 1 << 20  # bytes that are read of a file at once
DATAGRAM = 65_536  # bytes that one may have
LINE_MOST = 100_000  # characters: what is longer is no row of numbers
UDP = "udp:"
PORTS = 65_536


def of_file(path: Path, *, follow: bool) -> Generator[str | None, None, None]:
    """The lines of a file, and those that are written to it from now on where one is to
    ``follow`` it; begins anew where the file has become shorter.

    Raises:
        InputError: there is no such file, or it cannot be read.
    """
    position, rest = 0, ""
    while True:
        try:
            with path.open("rb") as file:
                size = file.seek(0, 2)
                position, rest = (0, "") if size < position else (position, rest)
                file.seek(position)
                content = file.read(CHUNK)
        except OSError as error:
            raise InputError(Problem(error.strerror or "cannot be read", file=str(path))) from error
        position += len(content)
        *lines, rest = (rest + content.decode("utf-8", "replace")).split("\n")
        yield from map(_clean, lines)
        if not content and not follow:
            yield from [_clean(rest)] if rest else []
            return
        if not content:
            yield None
            time.sleep(WAIT_S)
        _require_short(rest, str(path))


def of_stream(stream: TextIO, name: str) -> Generator[str | None, None, None]:
    """The lines of a stream until it ends."""
    while line := stream.readline(LINE_MOST):
        _require_short(line.rstrip("\r\n"), name)
        yield _clean(line)


def of_datagrams(port: int) -> Generator[str | None, None, None]:
    """The lines of datagrams that arrive at a port of this machine, from this machine alone.

    Raises:
        InputError: the port cannot be listened at.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        try:
            listening.bind((LOOPBACK, port))
        except (OSError, OverflowError) as error:
            text = f"cannot listen at port {port}: {error}"
            raise InputError(Problem(text, file=f"{UDP}{port}")) from error
        listening.settimeout(WAIT_S)
        while True:
            try:
                content = listening.recv(DATAGRAM)
            except TimeoutError:
                yield None
                continue
            yield from map(_clean, content.decode("utf-8", "replace").splitlines())


def _clean(line: str) -> str:
    return line.rstrip("\r\n")


def _require_short(line: str, name: str) -> None:
    if len(line) >= LINE_MOST:
        raise InputError(Problem(f"a line is longer than {LINE_MOST} characters", file=name))


def source_of(text: str, *, follow: bool) -> Generator[str | None, None, None]:
    """The lines of what a person names: a file, ``-`` for standard input, or ``udp:PORT``.

    Raises:
        InputError: a port that is none.
    """
    if text == "-":
        return of_stream(sys.stdin, "standard input")
    if not text.startswith(UDP):
        return of_file(Path(text), follow=follow)
    port = text.removeprefix(UDP)
    if not port.isdecimal() or not 0 < int(port) < PORTS:
        text = f"'{visible(port)}' is no port; write udp: and a number from 1 to {PORTS - 1}"
        raise InputError(Problem(text))
    return of_datagrams(int(port))
