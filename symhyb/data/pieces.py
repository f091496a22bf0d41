"""Recordings larger than memory, piece by piece.

Each piece reaches into its neighbours by an overlap, so that what is estimated from samples on both
sides of a time (a smoothed motion) is as good at the ends of a piece as anywhere.

    pieces   |<----- first ----->|
                           |<----- second ----->|
    own      |<-------------->|<----------------->|
"""

import os
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from symhyb.data.channels import Channels, take
from symhyb.data.columns import map_columns
from symhyb.data.files.apart import pieces_apart
from symhyb.data.files.bag_file import files_of_bag
from symhyb.data.files.bag_pieces import bag_pieces
from symhyb.data.files.csv_pieces import csv_pieces
from symhyb.data.files.mdf_pieces import mdf_pieces
from symhyb.data.files.parquet_file import parquet_pieces
from symhyb.data.files.table import Table, refusal
from symhyb.data.recording import Recording, recorded_part
from symhyb.data.rows import Span, outside
from symhyb.errors import visible
from symhyb.model.types import Model

_READERS: Mapping[str, Callable[[str, str, int], Iterator[Table]]] = {
    ".parquet": parquet_pieces,
    ".csv": csv_pieces,
    ".mf4": mdf_pieces,
    ".mdf": mdf_pieces,
    ".bag": bag_pieces,
    ".mcap": bag_pieces,
    ".db3": bag_pieces,
}


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A ``recording`` of consecutive samples; those from ``first`` to before ``last``, in s, are of
    this piece alone, the others stand in its neighbours too."""

    recording: Recording
    first: float
    last: float


def pieces_of(
    path: str | os.PathLike[str],
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    rows: int,
    overlap: int = 1,
    span: Span = (None, None),
) -> Iterator[Piece]:
    """The recording of a machine in a Parquet, CSV or MDF file or a bag: so many
    ``rows`` at a time, each piece with ``overlap`` more samples of either neighbour, and the rest,
    up to twice as long; ``columns`` and ``span``, in s, as for :func:`.read_recording`.

    Raises:
        InputError: as :func:`.read_recording`; the format is not read in pieces; time starts anew
            or does not go on from piece to piece.
    """
    file, size = str(path), rows + 2 * overlap
    waiting: Channels | None = None  # a piece, and the beginning of the next one
    table, begin = None, -np.inf
    for table in _tables(Path(path), rows):
        channels = _within(map_columns(table, model, columns), span)
        if channels is None and waiting is not None:
            break  # beyond the span
        if channels is None:
            continue
        waiting = channels if waiting is None else _following(waiting, channels, file)
        while waiting.t.size >= 2 * size:
            recording = recorded_part(table, take(waiting, slice(size)), model)
            end = float(waiting.t[size - 1 - overlap])  # a recording ends with its slowest input
            yield Piece(recording, begin, end)
            begin, waiting = end, take(waiting, slice(rows, None))
    if table is None or waiting is None:
        raise refusal(file, "has no sample" + _of(span))
    yield Piece(recorded_part(table, waiting, model), begin, np.inf)


def _tables(path: Path, rows: int) -> Iterator[Table]:
    file = str(path)
    parts = files_of_bag(path) if path.is_dir() else (path,)
    if not parts:
        raise refusal(file, "is a folder that holds no bag of ROS 2")
    if not path.exists():
        raise refusal(file, "there is no such file")
    suffix = parts[0].suffix.lower()
    if suffix not in _READERS:
        known = ", ".join(_READERS)
        raise refusal(file, f"'{suffix}' is not read in pieces; {known} are")
    size = sum(part.stat().st_size for part in parts)
    for table in pieces_apart(_READERS[suffix], file, visible(file), rows, size):
        yield replace(table, partial=True)


def _within(channels: Channels, span: Span) -> Channels | None:
    """The rows within a span; None if there are none."""
    keep, _ = outside(channels, span)
    return take(channels, keep) if keep.any() else None


def _following(before: Channels, after: Channels, file: str) -> Channels:
    """Channels that follow each other; one that only one of them has is missing in the other.

    Raises:
        InputError: time does not go on.
    """
    last, first = float(np.nanmax(before.t)), float(np.nanmin(after.t))
    if not first > last:
        cure = "dates are counted from the first of each piece: state seconds"
        text = f"time goes from {last:.9g} s back to {first:.9g} s between two pieces; {cure}"
        raise refusal(file, text)

    def both(
        one: Mapping[str, NDArray[np.float64]], other: Mapping[str, NDArray[np.float64]]
    ) -> dict[str, NDArray[np.float64]]:
        none = np.full(before.t.size, np.nan), np.full(after.t.size, np.nan)
        return {
            name: np.concatenate([one.get(name, none[0]), other.get(name, none[1])])
            for name in dict.fromkeys((*one, *other))
        }

    return Channels(
        np.concatenate([before.t, after.t]),
        both(before.inputs, after.inputs),
        both(before.sensors, after.sensors),
        after.notes,
    )


def _of(span: Span) -> str:
    return "" if span == (None, None) else " in the span that is asked for"
