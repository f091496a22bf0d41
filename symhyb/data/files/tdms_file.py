"""TDMS files of LabVIEW and its relatives (.tdms), by nptdms.

A group is a part of the file if there are several: named as in the file, else numbered from 1. The
times of its channels follow from the step, offset and start that they state, else they are a column
beside them. Channels of one group that were sampled at other times are parts ``group.1``,
``group.2``. Units are those that the channels state.
"""

import io
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.extras import first_line, needed
from symhyb.data.files.table import Column, Table, headed, in_part, refusal
from symhyb.errors import Problem
from symhyb.limits import COLUMNS

MAGICS = (b"TDSm", b"TDEm")
STEP, OFFSET, START = "wf_increment", "wf_start_offset", "wf_start_time"
UNITS = ("unit_string", "NI_UnitDescription", "Unit")
_Clock = tuple[float, float, int] | None
"""The step and the offset in s, and the number of samples, of a channel that states them."""


def read_tdms(content: bytes, file: str) -> Table:
    """Read the channels (N,) of all groups, scaled, in the units that they state.

    Raises:
        InputError: nptdms is not installed, the file is another format, damaged or cut off, or no
            group holds a sample.
    """
    if not content.startswith(MAGICS):
        raise refusal(file, "is not a TDMS file, although its name ends in .tdms")
    nptdms = needed("nptdms", "tdms", file)
    try:
        measured = nptdms.TdmsFile(io.BytesIO(content))
        cut = bool(measured.file_status.incomplete_final_segment)
        groups = {group.name: _channels(group) for group in measured.groups()}
    except MemoryError:
        raise
    except Exception as error:  # damaged bytes make nptdms raise errors of many kinds
        why = (first_line(error) or type(error).__name__)[:200]
        raise refusal(file, f"is a damaged or cut off TDMS file: {why}") from error
    filled = {name: channels for name, channels in groups.items() if channels}
    if sum(map(len, filled.values())) > COLUMNS:
        raise refusal(file, f"has more than {COLUMNS} channels")
    notes = ["the file is cut off: what was written last is missing"] if cut else []
    columns = list(_columns(filled, file, notes))
    if not columns:
        why = "".join(f"; {note}" for note in notes)
        raise refusal(file, f"holds no channel with numbers{why}")
    return Table(file, tuple(columns), tuple(notes))


def _channels(group: Any) -> list[tuple[str, Any, Mapping[str, Any]]]:
    """The channels of a group that hold samples: names, values, and what they state."""
    every = [(one.name, one[:], dict(one.properties)) for one in group.channels()]
    return [one for one in every if len(one[1])]


def _columns(
    groups: Mapping[str, Sequence[tuple[str, Any, Mapping[str, Any]]]],
    file: str,
    notes: list[str],
) -> Iterator[Column]:
    """The columns of all groups, those with the same times together, behind these times."""
    begins = _begins([about for group in groups.values() for _, _, about in group])
    for number, (group, channels) in enumerate(groups.items(), start=1):
        own = group if group and "." not in group else str(number)
        part = own if len(groups) > 1 else ""
        often = Counter(name for name, _, _ in channels)
        clocks: dict[tuple[_Clock, str], list[Column]] = {}
        for name, values, about in channels:
            numbers, note = _numbers(values)
            if numbers is None:
                notes.append(f"channel {name} is {note}: left out")
                continue
            text = "stands more than once in its group"
            problem = Problem(text, f"channel '{name}'", file) if often[name] > 1 else None
            header = headed(name, "s" if note else _unit(about))
            notes += [f"channel {name} {note}"] if note else []
            key = _clock(about, numbers.size), str(about.get(START, ""))
            clocks.setdefault(key, []).append(Column(header, numbers, problem))
        timed = [key for key in clocks if key[0] is not None]
        for (clock, start), found in clocks.items():
            place = part
            if len(timed) > 1 and clock is not None:
                place = f"{part}.{timed.index((clock, start)) + 1}".lstrip(".")
            if clock is not None:
                step, offset, size = clock
                t = begins.get(start, 0.0) + offset + step * np.arange(size, dtype=np.float64)
                yield in_part("t [s]", t, place)
            for one in found:
                yield in_part(one.header, one.values, place, one.problem)


def _clock(about: Mapping[str, Any], size: int) -> _Clock:
    """The step, offset and size of a channel that states a step of time, else None."""
    step, offset = _float(about.get(STEP)), _float(about.get(OFFSET, 0.0))
    if not np.isfinite(step) or step <= 0 or not np.isfinite(offset):
        return None
    return step, offset, size


def _float(value: Any) -> float:
    return float(value) if isinstance(value, int | float | np.number) else np.nan


def _begins(about: Sequence[Mapping[str, Any]]) -> dict[str, float]:
    """When the channels of each start time begin, in s after the first of them; none if some
    channels state no date."""
    dates = {str(one[START]): np.datetime64(one[START], "us") for one in about if START in one}
    if len(dates) < 2 or any(STEP in one and START not in one for one in about):
        return {}
    first, second = min(dates.values()), np.timedelta64(1, "s")
    return {text: float((date - first) / second) for text, date in dates.items()}


def _numbers(values: Any) -> tuple[NDArray[np.float64] | None, str]:
    """The values of a channel as numbers, None if they are none; and what is to be said of them."""
    array = np.asarray(values)
    if array.dtype.kind == "M":
        known = array[~np.isnat(array)]
        if not known.size:
            return None, "empty"
        seconds = (array - known[0]) / np.timedelta64(1, "ns") / 1e9
        return np.asarray(seconds, np.float64), "holds dates: counted in s from the first"
    if array.dtype.kind == "c":
        return None, "complex"
    if array.dtype.kind not in "buif" or array.ndim != 1:
        return None, "text"
    return array.astype(np.float64), ""


def _unit(about: Mapping[str, Any]) -> str:
    stated = (about.get(name) for name in UNITS)
    return next((one.strip() for one in stated if isinstance(one, str) and one.strip()), "")
