"""A recording without the samples that its sensors got wrong."""

from dataclasses import replace

import numpy as np

from symhyb.data.faults import faulty
from symhyb.data.recording import Recording
from symhyb.data.rows import SHORTEST, blocks
from symhyb.model.expression import names, readings
from symhyb.model.types import Model, Sensor

SUDDEN = ("accelerometer_x", "accelerometer_y", "force", "reaction")


def without_faults(recording: Recording, model: Model) -> Recording:
    """The recording without spikes, dropouts and saturated samples, with a note on each.

    A spike of an accelerometer or of a force sensor may be an impact: there it stays.
    """
    sensors, notes = dict(recording.sensors), []
    for sensor in model.sensors:
        values = sensors.get(sensor.name)
        if values is None:
            continue
        for words, flags in faulty(values):
            kept = int(np.isfinite(values[~flags]).sum())
            if kept < SHORTEST or (words == "has spikes" and _sudden(sensor)):
                continue
            values = np.where(flags, np.nan, values)
            first = blocks(flags)[0].span(recording.t)
            notes.append(
                f"{recording.name}: sensor {sensor.name} {words}: {flags.sum()} of {flags.size} "
                f"samples, first at {first}; they are left out"
            )
        sensors[sensor.name] = values
    if not notes:
        return recording
    return replace(recording, sensors=sensors, notes=(*recording.notes, *notes))


def _sudden(sensor: Sensor) -> bool:
    """Whether what a sensor measures may jump: an acceleration or a force."""
    pulled = any(name.order == 2 for name in names(sensor.measures))
    return pulled or any(reading.what in SUDDEN for reading in readings(sensor.measures))
