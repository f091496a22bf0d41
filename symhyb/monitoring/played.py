"""A bag as the source of a watch: its channels as rows, while it is written or once it is complete.

Rows are the times of all channels of the model together; an input that is slower than they are
runs straight between its samples, as in every recording. Of a bag that is being written a row is
there once every channel has a later sample.
"""

from collections.abc import Generator, Iterator, Mapping
from pathlib import Path

import numpy as np

from symhyb.data.channels import take
from symhyb.data.columns import map_columns
from symhyb.data.files.apart import pieces_apart
from symhyb.data.files.bag_growing import bag_so_far, growing_bag, mcap_files
from symhyb.data.files.formats import split_part
from symhyb.data.files.table import Table, refusal
from symhyb.data.recording import Recording, read_recording, recorded_part
from symhyb.data.rows import SHORTEST
from symhyb.errors import visible
from symhyb.limits import READER_BYTES_A_SECOND
from symhyb.model.types import Model

BAGS = (".bag", ".mcap", ".db3")
LASTING_S = 10**7  # of a processor, that following may take: months


def is_bag(source: str) -> bool:
    """Whether a source is a bag of ROS, or a folder, which can only be one."""
    path, _ = split_part(source)
    return path.suffix.lower() in BAGS or path.is_dir()


def of_bag(
    source: str, model: Model, columns: Mapping[str, str] | None, *, follow: bool
) -> Generator[str | None, None, None]:
    """The rows of a bag, the names of the channels of ``model`` first; those that are written from
    now on, too, where one is to ``follow`` it.

    Raises:
        InputError: there is no such bag, its storage cannot be followed while it is written, a
            channel is missing, or it cannot be read.
    """
    path, parts = split_part(source)
    if parts or _complete(path):
        yield from _rows(read_recording(source, model, columns), -np.inf, header=True)
        return
    if not mcap_files(path):
        text = (
            "holds no bag that is complete, and only MCAP can be followed while it is written; "
            "record with 'ros2 bag record -s mcap', or watch it when it is complete"
        )
        raise refusal(visible(source), text)
    reader = growing_bag if follow else bag_so_far
    size = LASTING_S * READER_BYTES_A_SECOND
    last, begun = -np.inf, False
    for table in pieces_apart(reader, str(path), visible(source), SHORTEST, size):
        recording = _recorded(table, model, columns) if table.columns else None
        if recording is None or not recording.t[-1] > last:
            yield None
            continue
        yield from _rows(recording, last, header=not begun)
        last, begun = float(recording.t[-1]), True


def _complete(path: Path) -> bool:
    """Whether a bag is written to its end."""
    if path.is_dir():
        return (path / "metadata.yaml").is_file()
    if path.suffix.lower() != ".mcap" or not path.exists():
        return True  # what is wrong with another one is said by its reader
    with path.open("rb") as stream:
        magic = stream.read(8)
        stream.seek(max(stream.seek(0, 2) - 8, 0))
        return stream.tell() > 8 and stream.read() == magic


def _recorded(table: Table, model: Model, columns: Mapping[str, str] | None) -> Recording | None:
    """What a piece of a bag holds of all channels together; None if that is too little yet."""
    channels = map_columns(table, model, columns)
    first, last = -np.inf, np.inf
    for values in (*channels.inputs.values(), *channels.sensors.values()):
        seen = channels.t[np.isfinite(values)]
        if seen.size:
            first, last = max(first, float(seen[0])), min(last, float(seen[-1]))
    within = (channels.t >= first) & (channels.t <= last)
    if np.count_nonzero(within) < SHORTEST:
        return None
    return recorded_part(table, take(channels, within), model)


def _rows(recording: Recording, last: float, *, header: bool) -> Iterator[str]:
    """The rows of a recording after a time, in the units of the model file."""
    columns = {}
    for name, values in {**recording.inputs, **recording.sensors}.items():
        unit = recording.units[name]
        columns[f"{name} [{unit.text}]"] = values / unit.factor
    if header:
        yield ",".join(["t [s]", *columns])
    whole = np.column_stack([recording.t, *columns.values()])
    for row in whole[recording.t > last].tolist():
        yield ",".join(map(repr, row))
