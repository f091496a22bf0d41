"""A recording: time, inputs and sensors of one run in SI, and what was done to get them."""

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from symhyb.data.channels import Channels, take
from symhyb.data.columns import map_columns
from symhyb.data.formats import read_table
from symhyb.data.inspection import input_notes, sampling_notes, sensor_notes
from symhyb.data.rows import SHORTEST, Span, tidy, without_silent_sensors
from symhyb.errors import InputError, Problem, visible
from symhyb.model.types import Model


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """One run of a machine, N samples, all in coherent SI; the arrays are read-only.

    Attributes:
        name: name of the file, for sentences.
        t: (N,) in s, strictly increasing, finite.
        inputs: by name, (N,), finite; among them the motion of imposed coordinates.
        sensors: by name, (N,); NaN where a sample is missing.
        notes: sentences on everything that was noticed, left out or filled in.
        sha256: of the bytes of the file.
    """

    name: str
    t: NDArray[np.float64]
    inputs: Mapping[str, NDArray[np.float64]]
    sensors: Mapping[str, NDArray[np.float64]]
    notes: tuple[str, ...]
    sha256: str

    @property
    def duration(self) -> float:
        """Time from the first to the last sample, in s."""
        return float(self.t[-1] - self.t[0])

    def split(self, at: float) -> "tuple[Recording, Recording]":
        """Return the part before ``at`` and the part from ``at`` on, in s; the time goes on.

        Raises:
            InputError: ``at`` is outside the recording, or a part has fewer than 20 samples.
        """
        if not self.t[0] < at <= self.t[-1]:
            raise self._outside("split", at)
        before = self._part(self.t < at, f"part of {self.name} before {at:g} s")
        return before, self._part(self.t >= at, f"part of {self.name} from {at:g} s on")

    def crop(self, start: float | None = None, end: float | None = None) -> "Recording":
        """Return the samples with ``start`` ≤ t ≤ ``end``, in s; None: to that end of the file.

        Raises:
            InputError: an end is outside the recording, or fewer than 20 samples are left.
        """
        slack = 2 * float(np.median(np.diff(self.t)))  # "to 20 s" may end with the sample at 19.99
        for limit in (start, end):
            if limit is not None and not self.t[0] - slack <= limit <= self.t[-1] + slack:
                raise self._outside("crop", limit)
        first = self.t[0] if start is None else start
        last = self.t[-1] if end is None else end
        if first >= last:
            text = f"crop from {first:g} to {last:g} s is empty: the start must come first"
            raise InputError(Problem(text, file=self.name))
        keep = (self.t >= first) & (self.t <= last)
        return self._part(keep, f"part of {self.name}, {first:g} … {last:g} s")

    def shares(self, other: "Recording") -> bool:
        """Whether samples of ``other`` are among these: the same file, times and values."""
        return self.common(other).size > 0

    def common(self, other: "Recording") -> NDArray[np.float64]:
        """Return the times (K,) in s of the samples of ``other`` that are among these.

        Two parts of a file may have the same times and still be different runs.
        """
        none = np.empty(0)
        if self.sha256 != other.sha256:
            return none
        both, mine, others = np.intersect1d(self.t, other.t, True, True)
        same = all(
            np.array_equal(self.sensors[name][mine], other.sensors[name][others], equal_nan=True)
            for name in self.sensors.keys() & other.sensors.keys()
        )
        return both if same else none

    def _part(self, keep: NDArray[np.bool_], note: str) -> "Recording":
        count = np.count_nonzero(keep)
        if count < SHORTEST:
            text = f"{note}: {count} samples are left; at least {SHORTEST} are needed"
            raise InputError(Problem(text, file=self.name))
        whole = Channels(self.t, self.inputs, self.sensors, self.notes)
        part = without_silent_sensors(take(whole, keep, note))
        return _recording(self.name, part, self.sha256)

    def _outside(self, verb: str, limit: float) -> InputError:
        text = f"cannot {verb} at {limit:g} s: the recording is {self.t[0]:g} … {self.t[-1]:g} s"
        return InputError(Problem(text, file=self.name))


def read_recording(
    path: str | os.PathLike[str],
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    span: Span = (None, None),
) -> Recording:
    """Read a recording of the machine that ``model`` describes: CSV, MAT, JSON, Parquet,
    Excel or MDF, by its suffix; ``FILE#PART`` is one sheet, structure, cell, group or run of it.

    Columns are found by the names of the model's inputs and sensors and ``t`` (s), or through
    ``columns`` = {"laser": "qm [mm]", "f": "gtau*vir", "t": "index/610.35"}; the built-in ``index``
    is the row number from 0. Values are in the unit in brackets, else that of the header, else
    that of the model. Channels sampled at different times are put on the union of their times,
    which ``"accel": "acc @ t_acc"`` names where they do not stand beside the channel. ``span`` =
    (start, end) in s drops the rest of the file before it is judged.

    Raises:
        InputError: the file or the map is wrong, a needed channel is missing, time does not
            increase, an input has a hole or stops early, or fewer than 20 samples are left.
    """
    table = read_table(path)
    held = frozenset(item.name for item in model.inputs if item.between == "held")
    channels = tidy(map_columns(table, model, columns), table, span, held)
    units = {channel.name: channel.unit for channel in model.sensors}
    driving = {channel.name: channel.unit for channel in model.coordinates}
    driving |= {channel.name: channel.unit for channel in model.inputs}
    notes = (
        *channels.notes,
        *sampling_notes(channels.t),
        *input_notes(channels.inputs, driving),
        *sensor_notes(channels.t, channels.sensors, units),
    )
    noted = Channels(channels.t, channels.inputs, channels.sensors, notes)
    return _recording(visible(Path(path).name), noted, table.sha256)


def _recording(name: str, channels: Channels, sha256: str) -> Recording:
    """Freeze what was read: the arrays of a value must not change under its feet."""
    recording = Recording(
        name,
        np.ascontiguousarray(channels.t),
        {key: np.ascontiguousarray(values) for key, values in channels.inputs.items()},
        {key: np.ascontiguousarray(values) for key, values in channels.sensors.items()},
        channels.notes,
        sha256,
    )
    for array in (recording.t, *recording.inputs.values(), *recording.sensors.values()):
        array.setflags(write=False)
    return recording


def several(recordings: Recording | Sequence[Recording]) -> tuple[Recording, ...]:
    """One recording or many, as a tuple."""
    return (recordings,) if isinstance(recordings, Recording) else tuple(recordings)
