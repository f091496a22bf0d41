"""MDF files piece by piece: the rows of every group between two times."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from symhyb.data.files.extras import first_line, needed
from symhyb.data.files.mdf_file import group_columns, parts_of, quiet, without_formulas
from symhyb.data.files.table import Column, Table, refusal


def mdf_pieces(path: str, file: str, rows: int) -> Iterator[Table]:
    """Read the channels (N,) of all groups in their physical units, about so many ``rows`` of the
    fastest group at a time; invalid samples are NaN.

    Raises:
        InputError: as :func:`.read_mdf`.
    """
    with open(path, "rb") as stream:
        if not stream.read(7).startswith((b"MDF ", b"UnFinMF")):
            raise refusal(file, "is not an MDF file, although its name says so")
    asammdf = needed("asammdf", "mdf", file)
    with quiet(), without_formulas():
        try:
            with asammdf.MDF(path) as measurement:
                parts = list(parts_of(measurement))
                first = 0
                for cuts in _cuts(measurement, [number for number, _ in parts], rows):
                    columns: list[Column] = []
                    notes: list[str] = []
                    for (number, part), (begin, end) in zip(parts, cuts, strict=True):
                        some = begin, end - begin
                        columns += group_columns(measurement, number, part, file, notes, some)
                    yield Table(file, tuple(columns), tuple(notes), first=first)
                    first += max((end - begin for begin, end in cuts), default=0)
        except Exception as error:  # damaged bytes make the reader raise errors of many kinds
            why = first_line(error) or type(error).__name__
            raise refusal(file, f"is a damaged or cut off MDF file: {why}") from error
    if first == 0:
        raise refusal(file, "holds no channel with numbers and times")


def _cuts(measurement: Any, groups: list[int], rows: int) -> Iterator[list[tuple[int, int]]]:
    """The first row of each group in a piece and the one behind its last."""
    counts = [int(measurement.groups[one].channel_group.cycles_nr) for one in groups]
    if not counts:
        return
    fastest = int(np.argmax(counts))
    begins = [0] * len(groups)
    while begins[fastest] < counts[fastest]:
        last = min(begins[fastest] + rows, counts[fastest])
        until = _time(measurement, groups[fastest], last) if last < counts[fastest] else np.inf
        ends = [
            _row(measurement, one, until, begin, count)
            for one, begin, count in zip(groups, begins, counts, strict=True)
        ]
        yield list(zip(begins, ends, strict=True))
        begins = ends


def _row(measurement: Any, group: int, until: float, first: int, count: int) -> int:
    """The first row of a group, from row ``first`` on, that is no earlier than a time in s."""
    if np.isinf(until):
        return count
    low, high = first, count
    while low < high:
        middle = (low + high) // 2
        if _time(measurement, group, middle) < until:
            low = middle + 1
        else:
            high = middle
    return low


def _time(measurement: Any, group: int, row: int) -> float:
    times = measurement.get_master(group, record_offset=row, record_count=1)
    return float(times[0])
