"""MDF files of versions 3 and 4 (.mf4, .mdf), by asammdf.

Every group of channels is sampled at its own times. It is a part of the file if there are several:
named as in the file, else numbered from 1; its times are the column ``t``.

A channel may be converted by a formula that stands in the file, which asammdf runs as Python. Such
channels are left out, and while a file is read asammdf has nothing to run a formula with.
"""

import gc
import importlib
import io
import logging
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stdout
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symhyb.data.files.extras import first_line, needed
from symhyb.data.files.table import Column, Table, headed, in_part, refusal
from symhyb.errors import Problem

TIME = "t [s]"
CONVERTERS, RUNNERS = ("v4_blocks", "v2_v3_blocks"), ("evaluate", "lambdify")
FORMULA = "converted by a formula of the file, which is not run"


def read_mdf(content: bytes, file: str) -> Table:
    """Read the channels (N,) of all groups in their physical units; invalid samples are NaN.

    Raises:
        InputError: asammdf is not installed, the file is another format, damaged, cut off or
            not finalised, or no group holds a sample.
    """
    if not content.startswith((b"MDF ", b"UnFinMF")):
        raise refusal(file, "is not an MDF file, although its name says so")
    asammdf = needed("asammdf", "mdf", file)
    notes: list[str] = []
    columns: list[Column] = []
    why = ""
    with quiet() as complaints, without_formulas():
        try:
            with asammdf.MDF(io.BytesIO(content)) as measurement:
                for number, part in parts_of(measurement):
                    columns += group_columns(measurement, number, part, file, notes)
        except Exception as error:  # damaged bytes make the reader raise errors of many kinds
            why = first_line(error) or type(error).__name__
        if why:
            gc.collect()  # what is left of a reader goes here, not at some later moment
    if why:
        raise refusal(file, f"is a damaged or cut off MDF file: {why}")
    if complaints:
        notes.insert(0, f"the file is damaged in places, channels may be missing: {complaints[0]}")
    if not columns:
        raise refusal(file, "holds no channel with numbers and times")
    return Table(file, tuple(columns), tuple(notes))


@contextmanager
def without_formulas() -> Iterator[None]:
    """Take from asammdf what it runs text of a file with; its rational and polynomial conversions
    do without, by plain arithmetic."""

    def refuse(*_: object, **__: object) -> None:
        raise TypeError("a formula of a file is not run")

    blocks = [vars(importlib.import_module(f"asammdf.blocks.{name}")) for name in CONVERTERS]
    known = [{name: names[name] for name in RUNNERS if name in names} for names in blocks]
    try:
        for names in blocks:
            names.update(evaluate=refuse, lambdify=None)
        yield
    finally:
        for names, kept in zip(blocks, known, strict=True):
            names.update(kept)


def _has_formula(conversion: Any) -> bool:
    """Whether a conversion, or one that it refers to, is a formula."""
    if getattr(conversion, "formula", ""):
        return True
    inner = getattr(conversion, "referenced_blocks", None) or {}
    return any(_has_formula(one) for one in inner.values() if hasattr(one, "conversion_type"))


class _Complaints(logging.Handler):
    """Keeps the first lines of what the reader would print."""

    def __init__(self) -> None:
        super().__init__(logging.ERROR)
        self.said: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep one line of a complaint."""
        self.said.append(first_line(record.getMessage()))


@contextmanager
def quiet() -> Iterator[list[str]]:
    """Keep the reader from printing, and one that failed half-way from complaining, on its
    deletion, of what it lacks; yield the errors that it would have printed."""
    complaints, logger = _Complaints(), logging.getLogger("asammdf")
    handlers, propagates, hook = logger.handlers, logger.propagate, sys.unraisablehook
    logger.handlers, logger.propagate = [complaints], False
    sys.unraisablehook = lambda _: None
    try:
        with redirect_stdout(io.StringIO()):
            yield complaints.said
    finally:
        logger.handlers, logger.propagate = handlers, propagates
        sys.unraisablehook = hook


def parts_of(measurement: Any) -> Iterator[tuple[int, str]]:
    """Number and name the groups that hold samples; a single one is no part."""
    filled = [
        number
        for number, group in enumerate(measurement.groups)
        if int(getattr(group.channel_group, "cycles_nr", 0)) > 0
    ]
    names = [
        str(getattr(measurement.groups[n].channel_group, "acq_name", "") or "") for n in filled
    ]
    often = Counter(names)
    for number, name in zip(filled, names, strict=True):
        unique = name and often[name] == 1 and "." not in name
        yield number, "" if len(filled) == 1 else name if unique else str(number + 1)


def group_columns(
    measurement: Any,
    number: int,
    part: str,
    file: str,
    notes: list[str],
    some: tuple[int, int] = (0, -1),
) -> Iterator[Column]:
    """Read the channels of one group, its times first; append to ``notes`` what is left out.
    ``some`` is the first record and how many there are; -1: all from there on."""
    group = measurement.groups[number]
    master = measurement.masters_db.get(number)
    if master is None:
        notes.append(f"group {part or number + 1} has no times: left out")
        return
    if _has_formula(group.channels[master].conversion):
        notes.append(f"the times of group {part or number + 1} are {FORMULA}: left out")
        return
    offset, count = some[0], None if some[1] < 0 else some[1]
    rows = {"record_offset": offset, "record_count": count}
    times = np.asarray(measurement.get_master(number, **rows), dtype=np.float64)
    yield in_part(TIME, times, part)
    names = [str(channel.name) for channel in group.channels]
    often = Counter(names)
    for index, name in enumerate(names):
        if index == master:
            continue
        if _has_formula(group.channels[index].conversion):
            notes.append(f"channel {name} is {FORMULA}: left out")
            continue
        signal = measurement.get(group=number, index=index, ignore_invalidation_bits=True, **rows)
        values = _numbers(signal)
        if values is None or values.shape != times.shape:
            notes.append(f"channel {name} is no vector of numbers: left out")
            continue
        problem = None
        if often[name] > 1:
            text = "stands more than once in its group"
            problem = Problem(text, f"channel '{name}'", file)
        yield in_part(headed(name, str(signal.unit or "")), values, part, problem)


def _numbers(signal: Any) -> NDArray[np.float64] | None:
    """Return the samples with NaN where they are invalid, None if they are no real numbers."""
    samples = signal.samples
    if samples.dtype.names or samples.dtype.kind not in "buif" or samples.ndim != 1:
        return None
    values = np.array(np.ma.getdata(samples), dtype=np.float64)
    invalid = getattr(signal, "invalidation_bits", None)
    if invalid is not None:
        values[np.asarray(invalid, dtype=bool)] = np.nan
    mask = np.ma.getmaskarray(samples)
    values[mask] = np.nan
    return values
