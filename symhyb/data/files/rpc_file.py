"""RPC III files of test rigs (.rsp, .rpc): time histories, all channels at one step.

MTS Systems: RPC III file format. A header of records of 128 bytes, a key in 32 and its value in 96,
four records a block; then groups, each with PTS_PER_GROUP points of the first channel, then of the
second, and so on. FRAMES times PTS_PER_FRAME points of each channel count; the rest of the last
group is padding. Whole numbers are multiplied by the SCALE of their channel.

No kept package reads this format, so this does.
"""

from collections import Counter
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.table import Column, Table, headed, refusal
from symhyb.errors import InputError, Problem
from symhyb.limits import COLUMNS, ROWS

RECORD, KEY, BLOCK = 128, 32, 512  # bytes
FIRST = ("FORMAT", "NUM_HEADER_BLOCKS", "NUM_PARAMS")
ORDERS = {"BINARY_IEEE_LITTLE_END": "<", "BINARY_IEEE_BIG_END": ">", "BINARY": "<"}
KINDS = {"SHORT_INTEGER": "i2", "FLOATING_POINT": "f4"}
VAX = "FORMAT is BINARY: its floating-point numbers are read as IEEE, not as those of a VAX"


def read_rpc(content: bytes, file: str) -> Table:
    """Read the channels (N,) in the units that the header states, and their times in s.

    Raises:
        InputError: another format, no time history, cut off, or counts that fit neither each other
            nor the file.
    """
    if content[:KEY].rstrip(b"\0 ") != FIRST[0].encode():
        raise refusal(file, "is not an RPC III file, although its name says so")
    head, begin = _header(content, file)
    order, kind = _numbers(head, file)
    counts = ("CHANNELS", "FRAMES", "PTS_PER_FRAME", "PTS_PER_GROUP")
    channels, frames, of_frame, of_group = (_count(head, key, file) for key in counts)
    points = frames * of_frame
    if channels > COLUMNS or points > ROWS:
        text = (
            f"states {channels} channels of {points} points; at most {COLUMNS} of {ROWS} are read"
        )
        raise refusal(file, text)
    groups = -(-points // of_group)
    stored = np.dtype(order + kind)
    needed = groups * of_group * channels * stored.itemsize
    if len(content) - begin < needed:
        text = f"states {needed} bytes of data, of which {len(content) - begin} are there"
        raise refusal(file, f"is cut off: its header {text}")
    step = _float(head, "DELTA_T", file)
    if not 0 < step < np.inf:
        raise refusal(file, f"DELTA_T must be a step in s above 0, not '{head['DELTA_T']}'")
    data = np.frombuffer(content, stored, needed // stored.itemsize, begin)
    values = data.reshape(groups, channels, of_group).transpose(1, 0, 2).reshape(channels, -1)
    if "SAMPLES" in head:  # the points that are no padding, as some programs state
        points = min(points, _count(head, "SAMPLES", file))
    columns = _columns(head, values[:, :points], kind, file)
    time = Column("t [s]", step * np.arange(points, dtype=np.float64))
    said = (VAX,) if kind == "f4" and head["FORMAT"] == "BINARY" else ()
    return Table(file, (time, *columns), said)


def _header(content: bytes, file: str) -> tuple[Mapping[str, str], int]:
    """The values of a header by key, and where the data begin."""
    begun = dict(_record(content, number) for number in range(len(FIRST)))
    blocks, records = (_count(begun, key, file) for key in FIRST[1:])
    size = blocks * BLOCK
    if size > len(content) or records * RECORD > size:
        text = f"states {blocks} blocks of header with {records} values in {len(content)} bytes"
        raise refusal(file, f"is cut off or damaged: it {text}")
    return dict(_record(content, number) for number in range(records)), size


def _record(content: bytes, number: int) -> tuple[str, str]:
    record = content[number * RECORD : (number + 1) * RECORD]
    key, value = (one.split(b"\0")[0].strip() for one in (record[:KEY], record[KEY:]))
    return key.decode("latin-1"), value.decode("latin-1")


def _numbers(head: Mapping[str, str], file: str) -> tuple[str, str]:
    """The order of bytes and the kind of the numbers."""
    problems = []
    for key, known, usual in (
        ("FILE_TYPE", ("TIME_HISTORY",), "TIME_HISTORY"),
        ("FORMAT", tuple(ORDERS), ""),
        ("DATA_TYPE", tuple(KINDS), "SHORT_INTEGER"),
    ):
        if head.get(key, usual) not in known:
            text = f"{key} is '{head.get(key, '')}'; readable is {' or '.join(known)}"
            problems.append(Problem(text, file=file))
    if problems:
        raise InputError(problems)
    return ORDERS[head["FORMAT"]], KINDS[head.get("DATA_TYPE", "SHORT_INTEGER")]


def _count(head: Mapping[str, str], key: str, file: str) -> int:
    text = head.get(key, "")
    if not (text.isascii() and text.isdecimal() and len(text) < 16 and int(text) > 0):
        said = f"must be a count above 0, not '{text}'" if key in head else "is missing"
        raise refusal(file, f"is damaged: {key} {said}")
    return int(text)


def _float(head: Mapping[str, str], key: str, file: str) -> float:
    try:
        return float(head[key])
    except (KeyError, ValueError):
        said = f"is no number: '{head[key]}'" if key in head else "is missing"
        raise refusal(file, f"is damaged: {key} {said}") from None


def _columns(
    head: Mapping[str, str], values: NDArray[np.generic], kind: str, file: str
) -> tuple[Column, ...]:
    names = [head.get(f"DESC.CHAN_{k}") or f"CHAN_{k}" for k in range(1, len(values) + 1)]
    often = Counter(names)
    columns = []
    for number, (name, points) in enumerate(zip(names, values, strict=True), start=1):
        numbers = points.astype(np.float64)
        if kind == "i2":
            numbers *= _float(head, f"SCALE.CHAN_{number}", file)
        text = "stands more than once in the header"
        problem = Problem(text, f"column '{name}'", file) if often[name] > 1 else None
        columns.append(Column(headed(name, head.get(f"UNITS.CHAN_{number}", "")), numbers, problem))
    return tuple(columns)
