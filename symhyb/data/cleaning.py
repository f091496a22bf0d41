"""Recordings without the samples that their sensors got wrong."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from symhyb.data.faults import faulty
from symhyb.data.own_clock import on_stamps
from symhyb.data.recording import Recording
from symhyb.data.rows import SHORTEST, blocks
from symhyb.errors import InputError, Problem
from symhyb.model.expression import names, readings
from symhyb.model.types import Model, Sensor

SUDDEN = ("accelerometer_x", "accelerometer_y", "accelerometer_z", "force", "reaction")


def cleaned(recordings: Sequence[Recording], model: Model) -> tuple[Recording, ...]:
    """Recordings of one machine :func:`without_faults`, and with the samples of sensors that are
    refreshed by a clock of their own at the times that they are stamped with.

    Raises:
        InputError: as :func:`without_faults`.
    """
    names = [sensor.name for sensor in model.sensors if not _sudden(sensor)]
    return on_stamps([without_faults(one, model) for one in recordings], names)


def without_faults(recording: Recording, model: Model) -> Recording:
    """The recording without dead sensors, spikes, dropouts and saturated samples, with a note on
    each.

    A sensor that never changes is dead where another one moves. A spike of an accelerometer or of a
    force sensor may be an impact: there it stays.

    Raises:
        InputError: one column stands for two sensors that measure different things.
    """
    sensors, notes = dict(recording.sensors), []
    for pair in combinations(model.sensors, 2):
        _require_two(recording, *pair)
    dead = [n for n, values in sensors.items() if np.isfinite(values).any() and not moves(values)]
    for name in dead if len(dead) < len(sensors) else []:
        del sensors[name]
        notes.append(
            f"{recording.name}: sensor {name} is constant while others move, so it is dead; it is "
            "left out"
        )
    for sensor in model.sensors:
        values = sensors.get(sensor.name)
        if values is None:
            continue
        for words, flags in faulty(values):
            kept = int(np.isfinite(values[~flags]).sum())
            if kept < SHORTEST or (words == "has spikes" and _sudden(sensor)):
                continue
            values = np.where(flags, np.nan, values)
            when = blocks(flags)[0].span(recording.t)
            notes.append(
                f"{recording.name}: sensor {sensor.name} {words}: {flags.sum()} of {flags.size} "
                f"samples, first at {when}; they are left out"
            )
        sensors[sensor.name] = values
    if not notes:
        return recording
    return replace(recording, sensors=sensors, notes=(*recording.notes, *notes))


def _require_two(recording: Recording, first: Sensor, second: Sensor) -> None:
    one, other = (recording.sensors.get(sensor.name) for sensor in (first, second))
    if one is None or other is None or first.measures == second.measures or not moves(one):
        return
    if np.array_equal(one, other, equal_nan=True):
        text = (
            f"{first.name} and {second.name} hold the same samples, though they measure different "
            "things; map each of them to its own column"
        )
        raise InputError(Problem(text, "sensors", recording.name))


def moves(values: NDArray[np.float64]) -> bool:
    """Whether a signal (N,), in any unit, changes at all."""
    known = values[np.isfinite(values)]
    return bool(known.size and np.ptp(known) > 0)


def still(recordings: Sequence[Recording]) -> bool:
    """Whether there are recordings, and no sensor changes in any of them."""
    values = [column for one in recordings for column in one.sensors.values()]
    return bool(recordings) and not any(map(moves, values))


def _sudden(sensor: Sensor) -> bool:
    """Whether what a sensor measures may jump: an acceleration or a force."""
    pulled = any(name.order == 2 for name in names(sensor.measures))
    return pulled or any(reading.what in SUDDEN for reading in readings(sensor.measures))
