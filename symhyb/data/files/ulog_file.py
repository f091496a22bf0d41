"""ULog files of PX4 (.ulg), by pyulog.

A topic is a part of the file with times of its own; of several instances of a topic each is one
(``sensor_accel_0``, ``sensor_accel_1``, numbered as PX4 does). Fields are called by their names,
elements of arrays counted from 1 (``q.1``). ``timestamp`` is when a message was sent,
``timestamp_sample``, where there is one, when it was measured (:mod:`symhyb.data.files.stamps`);
both count from the start of the controller, t from the first message of the file. Units are not in
it.
"""

import io
import re
from collections import Counter
from collections.abc import Iterator
from contextlib import redirect_stdout
from typing import Any

import numpy as np

from symhyb.data.files.extras import first_line, needed
from symhyb.data.files.stamps import Nanoseconds, Times, time_notes, times_of
from symhyb.data.files.table import Column, Table, in_part, refusal
from symhyb.limits import COLUMNS

MAGIC = b"ULog\x01\x12\x35"
SENT, MEASURED = "timestamp", "timestamp_sample"
LEAST, TIMES = 100_000, 8  # bytes that are read of a file of any size, and times its own
LATEST = 2**63 // 1000  # us, as far as nanoseconds are counted


def read_ulog(content: bytes, file: str) -> Table:
    """Read the numbers (N,) of all topics; a topic of one message has numbers ().

    Raises:
        InputError: pyulog is not installed, the file is another format, damaged, or holds no
            message.
    """
    if not content.startswith(MAGIC):
        raise refusal(file, "is not a ULog file, although its name ends in .ulg")
    pyulog = needed("pyulog", "ulog", file)
    try:
        with redirect_stdout(io.StringIO()):
            log = pyulog.ULog(_Bounded(content))
    except MemoryError:
        raise
    except Exception as error:  # damaged bytes make pyulog raise errors of many kinds
        why = (first_line(error) or type(error).__name__)[:200]
        raise refusal(file, f"is a damaged ULog file: {why}") from error
    topics = [one for one in log.data_list if len(one.data.get(SENT, ()))]
    if not topics:
        raise refusal(file, "holds no message with a timestamp: the file is empty or damaged")
    if sum(len(one.data) for one in topics) > COLUMNS:
        raise refusal(file, f"has more than {COLUMNS} channels")
    notes = _complaints(log)
    late = [one.name for one in topics if int(one.data[SENT].max()) > LATEST]
    if late:
        raise refusal(
            file, f"the times of {late[0]} are later than any clock counts: it is damaged"
        )
    columns, times = _columns(topics)
    return Table(file, tuple(columns), (*notes, *time_notes(times)))


class _Bounded(io.BytesIO):
    """A file that is read a few times over at most: where it is damaged, pyulog may go back in it
    and come to the same place for ever."""

    def __init__(self, content: bytes) -> None:
        super().__init__(content)
        self.left = LEAST + TIMES * len(content)

    def read(self, size: int | None = -1) -> bytes:
        """As of any file; raises an error that pyulog does not take for damage to skip."""
        data = super().read(size)
        self.left -= max(len(data), 1)
        if self.left < 0:
            raise EOFError("its records lead back to where they begin")
        return data


def _complaints(log: Any) -> Iterator[str]:
    """What a controller could not log, and what cannot be read of it."""
    if log.file_corruption:
        yield "the file is damaged in places, messages may be missing"
    if log.dropouts:
        lost = sum(one.duration for one in log.dropouts)
        yield f"the logger was too slow {len(log.dropouts)} times and lost {lost / 1e3:.3g} s"


def _columns(topics: list[Any]) -> tuple[list[Column], list[Times]]:
    often = Counter(one.name for one in topics)
    zero = min(int(one.data[SENT].min()) for one in topics)
    lasting = max(int(one.data[SENT].max()) for one in topics) - zero
    columns: list[Column] = []
    times: list[Times] = []
    for topic in sorted(topics, key=lambda one: (one.name, one.multi_id)):
        part = f"{topic.name}_{topic.multi_id}" if often[topic.name] > 1 else topic.name
        alone = topic.data[SENT].size == 1
        if not alone:
            stamps = topic.data.get(MEASURED)
            given = None if stamps is None else _ns(np.minimum(stamps, LATEST))
            one = times_of(part, _ns(topic.data[SENT]), given, 1000 * zero, 1000 * lasting)
            times.append(one)
            columns.append(in_part("t [s]", one.t, part))
            if one.others is not None:
                columns.append(in_part(f"{one.unused} [s]", one.others, part))
        for name, values in topic.data.items():
            if name in (SENT, MEASURED) or "_padding" in name:
                continue
            numbers = np.asarray(values, dtype=np.float64)
            columns.append(in_part(_called(name), numbers.reshape(()) if alone else numbers, part))
    return columns, times


def _ns(microseconds: Any) -> Nanoseconds:
    return np.asarray(microseconds, dtype=np.int64) * 1000


def _called(field: str) -> str:
    """What a field is called: ``esc[0].rpm`` is ``esc.1.rpm``."""
    return re.sub(r"\[(\d+)\]", lambda found: f".{int(found[1]) + 1}", field)
