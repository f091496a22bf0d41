"""Files of formats with a native parser are read in a process of their own; FMUs and MuJoCo run
in one.

A damaged or hostile file can crash such a parser, or make it ask for memory and time without bound.
The process has limits of both; its end by a signal becomes a sentence. It gets the bytes of the
file and gives back numbers and text: a header in JSON and the columns behind it as they lie in
memory, so that nothing that a stranger wrote is executed on this side either.
"""

import json
import os
import struct
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib import import_module
from signal import Signals
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.table import Column, Table, refusal
from symhyb.errors import InputError, Problem
from symhyb.limits import (
    READER_BYTES_A_SECOND,
    READER_MEMORY,
    READER_MEMORY_EACH,
    READER_SECONDS,
    READER_WAITS,
)

PIPE_BYTES = 1 << 20  # that a reader of pieces is ahead
_LENGTH = struct.Struct("<Q")  # of the header, before it
_START = "from symhyb.data.files.apart import serve; serve()"
_START_PIECES = "from symhyb.data.files.apart import serve_pieces; serve_pieces()"
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "ARROW_IO_THREADS")


@dataclass(frozen=True, slots=True)
class Allowed:
    """How many ``seconds`` of a processor a process gets, and what is said where it needs more
    (``slow``, with {} for the seconds) or ends (``ended``, with {} for how)."""

    seconds: int
    slow: str
    ended: str


def read_apart(
    reader: Callable[[bytes, str], Table],
    content: bytes,
    file: str,
    allowed: Allowed | None = None,
) -> Table:
    """What ``reader``, a function of a module, makes of the ``content`` of a ``file``; by default
    in as much time as a file of this size gets.

    Raises:
        InputError: what the reader says; or it crashed, or took more memory or time than it gets.
    """
    allowed = allowed or _allowed(READER_SECONDS + len(content) // READER_BYTES_A_SECOND)
    seconds, memory = allowed.seconds, READER_MEMORY + READER_MEMORY_EACH * len(content)
    order = [reader.__module__, reader.__name__, file, str(seconds), str(memory)]
    try:
        done = subprocess.run(
            _command(_START, order),
            input=content,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env=_environment(),
            timeout=READER_WAITS * seconds,
            check=False,
        )
    except subprocess.TimeoutExpired:
        said = _said(allowed.slow, READER_WAITS * seconds)
        raise refusal(file, said) from None
    if done.returncode:
        raise refusal(file, _ended(done.returncode, allowed))
    return _unpacked(done.stdout, file)


def pieces_apart(
    reader: Callable[[str, str, int], Iterator[Table]], path: str, file: str, rows: int, size: int
) -> Iterator[Table]:
    """The tables that ``reader``, a function of a module, makes one after the other of the file at
    ``path``, of ``size`` bytes, each of about so many ``rows``; its process reads ahead of what is
    asked for by what a pipe holds, and ends with the iterator.

    Raises:
        InputError: what the reader says; or it crashed, or took more memory or time than it gets.
    """
    allowed = _allowed(READER_SECONDS + size // READER_BYTES_A_SECOND)
    names = [reader.__module__, reader.__name__]
    order = [*names, path, file, str(rows), str(allowed.seconds), str(READER_MEMORY)]
    with subprocess.Popen(
        _command(_START_PIECES, order),
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env=_environment(),
        pipesize=PIPE_BYTES,
    ) as process:
        try:
            assert process.stdout is not None
            while packed := process.stdout.read(_LENGTH.size):
                (length,) = _LENGTH.unpack(packed.ljust(_LENGTH.size, b"\0"))
                yield _unpacked(process.stdout.read(length), file)
            if process.wait():
                raise refusal(file, _ended(process.returncode, allowed))
        finally:
            process.kill()


def _command(start: str, order: list[str]) -> list[str]:
    return [sys.executable, "-P", "-c", start, *order]  # -P: no module of the folder it runs in


def _environment() -> dict[str, str]:
    return {
        **os.environ,
        **dict.fromkeys(_THREADS, "1"),
        "PYTHONPATH": os.pathsep.join(folder or os.getcwd() for folder in sys.path),
    }


def serve() -> None:
    """Read the file on standard input as the command line orders, within its limits."""
    module, name, file, seconds, memory = sys.argv[1:]
    out = _output()
    reader = getattr(import_module(module), name)
    _limit(int(seconds), int(memory))
    try:
        packed = _packed(reader(sys.stdin.buffer.read(), file))
    except InputError as error:
        packed = _refused(error)
    except MemoryError:
        packed = _refused(_too_large(file, memory))
    out.write(packed)
    out.flush()


def serve_pieces() -> None:
    """Read the file that the command line names, piece by piece, within its limits: each piece with
    its length before it."""
    module, name, path, file, rows, seconds, memory = sys.argv[1:]
    out = _output()
    reader = getattr(import_module(module), name)
    _limit(int(seconds), int(memory))
    try:
        for table in reader(path, file, int(rows)):
            _write_piece(out, _packed(table))
    except InputError as error:
        _write_piece(out, _refused(error))
    except MemoryError:
        _write_piece(out, _refused(_too_large(file, memory)))


def _output() -> BinaryIO:
    """Where the answer goes. What native code prints is no part of it."""
    out, sys.stdout = os.fdopen(os.dup(1), "wb"), sys.stderr
    os.dup2(2, 1)
    return out


def _write_piece(out: BinaryIO, packed: bytes) -> None:
    out.write(_LENGTH.pack(len(packed)))
    out.write(packed)
    out.flush()


def _too_large(file: str, memory: str) -> InputError:
    most = f"{int(memory) / 2**30:.1f} GiB"
    return refusal(file, f"needs more than the {most} of memory that a file of its size gets")


def _limit(seconds: int, memory: int) -> None:
    """Bound this process; where the system has no such limits only the clock does."""
    try:
        import resource
    except ImportError:
        return
    for what, most in (
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_DATA, memory),
        (resource.RLIMIT_CORE, 0),
    ):
        _, hard = resource.getrlimit(what)
        most = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(what, (most, hard))


def _packed(table: Table) -> bytes:
    columns, values = [], []
    for column in table.columns:
        numbers = np.ascontiguousarray(column.values, float)
        problem = None if column.problem is None else asdict(column.problem)
        about = {"header": column.header, "part": column.part, "inside": column.inside}
        columns.append({**about, "problem": problem, "shape": column.values.shape})
        values.append(numbers.tobytes())
    header = {"columns": columns, "notes": table.notes, "first": table.first}
    return _with_length(header) + b"".join(values)


def _refused(error: InputError) -> bytes:
    return _with_length({"problems": [asdict(problem) for problem in error.problems]})


def _with_length(header: dict[str, Any]) -> bytes:
    text = json.dumps(header).encode()
    return _LENGTH.pack(len(text)) + text


def _unpacked(packed: bytes, file: str) -> Table:
    try:
        (length,) = _LENGTH.unpack_from(packed)
        position = _LENGTH.size + length
        header = json.loads(packed[_LENGTH.size : position])
        problems = [Problem(**problem) for problem in header.get("problems", ())]
        columns = []
        for about in header.get("columns", ()):
            shape = tuple(about.pop("shape"))
            values: NDArray[np.float64] = np.frombuffer(
                packed, np.float64, int(np.prod(shape)), position
            ).reshape(shape)
            position += values.nbytes
            problem = about.pop("problem")
            known = None if problem is None else Problem(**problem)
            columns.append(Column(**about, values=values.copy(), problem=known))
    except (ValueError, TypeError, KeyError, struct.error):
        raise refusal(file, "its reader gave back what is no table: the file is damaged") from None
    if problems:
        raise InputError(problems)
    return Table(file, tuple(columns), tuple(header["notes"]), first=header["first"])


def _ended(code: int, allowed: Allowed) -> str:
    """Why a process ended, from its exit status."""
    if code < 0 and Signals(-code).name in ("SIGXCPU", "SIGKILL"):
        return _said(allowed.slow, allowed.seconds)
    how = f"by signal {Signals(-code).name}" if code < 0 else f"with exit status {code}"
    return _said(allowed.ended, how)


def _allowed(seconds: int) -> Allowed:
    """What the reader of a file gets."""
    return Allowed(
        seconds,
        "takes longer to read than the {} s that a file of its size gets",
        "its reader ended {}: the file is damaged, or made to harm; save it once more",
    )


def _said(text: str, part: object) -> str:
    return text.replace("{}", str(part))
