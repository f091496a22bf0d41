"""A recording: time, inputs and sensors of one run in SI, and what was done to get them."""

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from symhyb.asked import asked
from symhyb.data.channels import Channels, take
from symhyb.data.columns import map_columns
from symhyb.data.files.formats import read_table
from symhyb.data.files.table import Table
from symhyb.data.frames import table_of_dataset, table_of_frame
from symhyb.data.groups import group_note, groups_in
from symhyb.data.inspection import input_notes, sampling_notes, sensor_notes
from symhyb.data.known import known_in, known_note
from symhyb.data.rows import SHORTEST, Span, tidy, without_silent_sensors
from symhyb.data.samples import digest, require_samples
from symhyb.drawn import drawn
from symhyb.errors import InputError, Problem, UnknownNameError, did_you_mean, visible
from symhyb.framed import SI, Signal, dataset_of, frame_of
from symhyb.model.types import Model
from symhyb.shown import card, counted
from symhyb.units import ONE, Unit

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Recording:
    """One run of a machine, N samples, all in coherent SI; the arrays are read-only.

    ``recording["laser"]`` is a channel (N,) in SI, ``len(recording)`` is N, and iterating gives the
    names of the channels. What is made by hand must be clean: finite inputs, time that increases;
    :meth:`from_frame` takes what loggers write.

    Attributes:
        name: name of the file, for sentences.
        t: (N,) in s, strictly increasing, finite.
        inputs: by name, (N,), finite; among them the motion of imposed coordinates.
        sensors: by name, (N,); NaN where a sample is missing.
        notes: sentences on everything that was noticed, left out or filled in.
        sha256: of the bytes of the file; of the samples, where there is no file.
        units: by channel the unit of the model file, in which frames and pictures show it.
        parameters: by path what is known of parameters in this recording, in place of the values
            of the model.
        groups: by grouping (``mount``) the group of which this recording is, whose recordings share
            numbers that others have other values of.
    """

    name: str
    t: NDArray[np.float64]
    inputs: Mapping[str, NDArray[np.float64]]
    sensors: Mapping[str, NDArray[np.float64]]
    notes: tuple[str, ...] = ()
    sha256: str = ""
    units: Mapping[str, Unit] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)
    groups: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        require_samples(self)
        if not self.sha256:
            object.__setattr__(self, "sha256", digest(self.t, self.inputs, self.sensors))

    def __len__(self) -> int:
        return int(self.t.size)

    def __iter__(self) -> Iterator[str]:
        return iter(self.channels)

    def __contains__(self, name: object) -> bool:
        return name == "t" or name in self.inputs or name in self.sensors

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        if name == "t":
            return self.t
        for group in (self.sensors, self.inputs):
            if name in group:
                return group[name]
        known = ("t", *self.channels)
        near = did_you_mean(name, known) if isinstance(name, str) else ""
        raise UnknownNameError(
            f"{self.name} has no channel {name!r}{near if 'mean' in near else ''}; "
            f"there are: {', '.join(known)}"
        )

    def __repr__(self) -> str:
        parts = (counted("input", list(self.inputs)), counted("sensor", list(self.sensors)))
        span = f"{self.t[0]:g} … {self.t[-1]:g} s" if len(self) else "no time"
        return f"<Recording '{self.name}': {len(self)} samples, {span}, {', '.join(parts)}>"

    def _repr_html_(self) -> str:
        rows = [("t", "s", *_spread(self.t))]
        for name, values, unit in self.signals():
            rows.append((name, unit, *_spread(values)))
        head = ("channel", "unit", "smallest", "largest", "missing")
        text = f"{len(self)} samples, {self.duration:g} s"
        return card(self.name, text, head, rows, self.notes)

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of the inputs, then of the sensors, each once."""
        return tuple(dict.fromkeys((*self.inputs, *self.sensors)))

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

    @classmethod
    @asked
    def from_frame(
        cls,
        frame: "pd.DataFrame | Mapping[str, Any]",
        model: Model,
        columns: Mapping[str, str] | None = None,
        *,
        units: Mapping[str, str] | None = None,
        name: str = "frame",
        span: Span = (None, None),
        parameters: Mapping[str, float] | None = None,
        groups: Mapping[str, str] | None = None,
    ) -> "Recording":
        """A recording from a frame of pandas, or from a mapping of names to columns.

        Time is the column that is called so, else the index: numbers in s, dates or durations. The
        rest is as for files (:func:`read_recording`): channels are found by name or through the map
        ``columns``, and cleaned with notes. The unit of a column is that in ``units`` = {"laser":
        "mm"}, else that behind its name (``laser [mm]``), else that in ``frame.attrs["units"]``,
        else that of the model. ``span`` = (start, end) in s; ``parameters`` and
        ``groups`` as for files.

        Raises:
            InputError: as :func:`read_recording`.
        """
        table = table_of_frame(frame, units, visible(name))
        known = known_in(model, parameters, visible(name))
        within = groups_in(groups, visible(name))
        channels = map_columns(table, model, columns)
        return recorded(table, channels, model, span, visible(name), known, within)

    def to_frame(self) -> "pd.DataFrame":
        """The channels in the units of the model file, as columns over the index ``t`` in s;
        ``attrs["units"]`` says which, and :meth:`from_frame` reads it."""
        return frame_of(self.t, self.signals(), name=self.name)

    @classmethod
    @asked
    def from_xarray(
        cls,
        dataset: "xr.Dataset | xr.DataArray",
        model: Model,
        columns: Mapping[str, str] | None = None,
        *,
        units: Mapping[str, str] | None = None,
        name: str = "dataset",
        span: Span = (None, None),
        parameters: Mapping[str, float] | None = None,
        groups: Mapping[str, str] | None = None,
    ) -> "Recording":
        """A recording from a dataset of xarray along one dimension, the time (in s, dates or
        durations); as :meth:`from_frame`, with the units in ``attrs["units"]`` of each variable.

        Raises:
            InputError: as :func:`read_recording`; xarray is not installed.
        """
        table = table_of_dataset(dataset, units, visible(name))
        known = known_in(model, parameters, visible(name))
        within = groups_in(groups, visible(name))
        channels = map_columns(table, model, columns)
        return recorded(table, channels, model, span, visible(name), known, within)

    def to_xarray(self) -> "xr.Dataset":
        """The channels in the units of the model file along ``t`` in s, as a dataset of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        return dataset_of(self.t, self.signals(), name=self.name)

    def plot(self, *channels: str, ax: Any = None) -> Any:
        """Draw channels over time, all by default: returns the axes of matplotlib, one a channel;
        what is given as ``ax`` is drawn on (:mod:`symhyb.report.axes`)."""
        return drawn("recording", self, ax, channels=channels)

    def signals(self) -> Iterator[Signal]:
        """Every channel with its values (N,) in the unit of the model file, and that unit. Motion
        that a sensor of the same name shows as well is left out."""
        for group, other in ((self.inputs, self.sensors), (self.sensors, {})):
            for name, values in group.items():
                shown = name
                if name in other:
                    if np.array_equal(values, other[name], equal_nan=True):
                        continue
                    shown = f"{name} (coordinate)"
                unit = self.units.get(name)
                yield shown, values / (unit or ONE).factor, unit.text if unit else SI

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
        return _recording(self.name, part, self.sha256, self.units, self.parameters, self.groups)

    def _outside(self, verb: str, limit: float) -> InputError:
        text = f"cannot {verb} at {limit:g} s: the recording is {self.t[0]:g} … {self.t[-1]:g} s"
        return InputError(Problem(text, file=self.name))


@asked
def read_recording(
    path: str | os.PathLike[str],
    model: Model,
    columns: Mapping[str, str] | None = None,
    *,
    span: Span = (None, None),
    parameters: Mapping[str, float] | None = None,
    groups: Mapping[str, str] | None = None,
) -> Recording:
    """Read a recording of the machine that ``model`` describes: CSV, MAT, JSON, Parquet,
    Excel, MDF, TDMS, RPC III, ULog or a bag of ROS, by its suffix; ``FILE#PART`` is one sheet,
    structure, cell, group, topic or run of it.

    Columns are found by the names of the model's inputs and sensors and ``t`` (s), or through
    ``columns`` = {"laser": "qm [mm]", "f": "gtau*vir", "t": "index/610.35"}; the built-in ``index``
    is the row number from 0. Values are in the unit in brackets, else that of the header, else
    that of the model. Channels sampled at different times are put on the union of their times,
    which ``"accel": "acc @ t_acc"`` names where they do not stand beside the channel. ``span`` =
    (start, end) in s drops the rest of the file before it is judged. ``parameters`` = {"m": 0.5}
    are those of which this recording has a known value of its own, in the units of the model;
    ``groups`` = {"mount": "A"} are those of recordings that share numbers with it
    (``own={"coulomb": "mount"}`` of :func:`symhyb.diagnose`).

    Raises:
        InputError: the file, the map or a known value is wrong, a needed channel is missing, time
            does not increase, an input has a hole or stops early, or fewer than 20 samples are
            left.
    """
    known = known_in(model, parameters, visible(os.fspath(path)))
    within = groups_in(groups, visible(os.fspath(path)))
    table = read_table(path)
    channels = map_columns(table, model, columns)
    return recorded(table, channels, model, span, known=known, groups=within)


def recorded(
    table: Table,
    channels: Channels,
    model: Model,
    span: Span = (None, None),
    name: str = "",
    known: Mapping[str, float] | None = None,
    groups: Mapping[str, str] | None = None,
) -> Recording:
    """The recording that the ``channels`` of a ``table`` are, with notes on them; its ``name`` is
    that of the table's file unless given; ``known`` are values of parameters, SI, ``groups`` those
    of which it is.

    Raises:
        InputError: as :func:`read_recording`, but for the map.
    """
    channels = tidy(channels, table, span, _held(model))
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
    shown = {**driving, **units}
    used = {name: shown[name] for name in (*noted.inputs, *noted.sensors)}
    called = name or visible(Path(table.file).name)
    if known:
        noted = replace(noted, notes=(*noted.notes, known_note(model, known)))
    if groups:
        noted = replace(noted, notes=(*noted.notes, group_note(groups)))
    return _recording(called, noted, table.sha256, used, known or {}, groups or {})


def recorded_part(table: Table, channels: Channels, model: Model) -> Recording:
    """The recording that the ``channels`` of a piece of a file are, without notes on what is
    peculiar about its samples.

    Raises:
        InputError: as :func:`read_recording`, but for the map.
    """
    channels = tidy(channels, table, held=_held(model))
    units = {channel.name: channel.unit for channel in model.inputs}
    units |= {channel.name: channel.unit for channel in model.sensors}
    called = visible(Path(table.file).name)
    return _recording(called, channels, "-", units, {}, {})


def _held(model: Model) -> frozenset[str]:
    return frozenset(item.name for item in model.inputs if item.between == "held")


def _recording(
    name: str,
    channels: Channels,
    sha256: str,
    units: Mapping[str, Unit],
    parameters: Mapping[str, float],
    groups: Mapping[str, str],
) -> Recording:
    """Freeze what was read: the arrays of a value must not change under its feet."""
    recording = Recording(
        name,
        np.ascontiguousarray(channels.t),
        {key: np.ascontiguousarray(values) for key, values in channels.inputs.items()},
        {key: np.ascontiguousarray(values) for key, values in channels.sensors.items()},
        channels.notes,
        sha256,
        units,
        parameters,
        groups,
    )
    for array in (recording.t, *recording.inputs.values(), *recording.sensors.values()):
        array.setflags(write=False)
    return recording


def _spread(values: NDArray[np.float64]) -> tuple[str, str, str]:
    """The smallest and largest of some values, and how many are missing, in words."""
    known = values[np.isfinite(values)]
    missing = str(values.size - known.size or "")
    if not known.size:
        return "", "", missing
    return f"{known.min():.5g}", f"{known.max():.5g}", missing


def several(recordings: Recording | Sequence[Recording]) -> tuple[Recording, ...]:
    """One recording or many, as a tuple."""
    return (recordings,) if isinstance(recordings, Recording) else tuple(recordings)
