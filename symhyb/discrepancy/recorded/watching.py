"""The sensors of a model that show its motion, and gauges for what is known of it without any."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from symhyb.data.recording import Recording
from symhyb.model.expression import names, parse_expression, readings
from symhyb.model.turned import Quaternion
from symhyb.model.types import Model, Sensor
from symhyb.numeric.kernels.buffers import Array
from symhyb.units import ONE


def watching_model(model: Model, recording: Recording) -> tuple[Model, Recording]:
    """The model with the sensors that show its motion (those of forces and of declared states left
    out), and one more for each imposed coordinate and each quaternion; and the recording with
    these channels."""
    states = {state.name for state in model.states}
    kept = tuple(s for s in model.sensors if not (_shows_force(s) or _shown_names(s) & states))
    imposed = [c for c in model.coordinates if c.imposed]
    lengths = length_gauges(model)
    if len(kept) == len(model.sensors) and not imposed and not lengths:
        return model, recording
    gauges = tuple(Sensor(f"imposed {c.name}", parse_expression(c.name), c.unit) for c in imposed)
    more = {f"imposed {c.name}": recording.inputs[c.name] for c in imposed}
    more |= {gauge.name: np.ones(recording.t.size) for gauge in lengths}
    channels = {**recording.sensors, **more}
    watching = replace(model, sensors=(*kept, *gauges, *lengths))
    return watching, replace(recording, sensors=channels)


def shown_states(model: Model, y: Array) -> NDArray[np.bool_]:
    """Which declared states (S,) are shown by sensors that have samples among ``y`` (…, m)."""
    columns = np.reshape(y, (-1, len(model.sensors))).T
    pairs = zip(model.sensors, columns, strict=True)
    seen = frozenset[str]().union(*(_shown_names(s) for s, one in pairs if np.isfinite(one).any()))
    return np.array([state.name in seen for state in model.states], dtype=bool)


def length_gauges(model: Model) -> tuple[Sensor, ...]:
    """A sensor that shows 1 for each quaternion: no other one shows its length."""
    found = []
    for body in model.bodies:
        if isinstance(body.turned, Quaternion):
            squares = " + ".join(f"{name}**2" for name in body.turned.parts)
            found.append(Sensor(f"length of {body.name}", parse_expression(squares), ONE))
    return tuple(found)


def _shown_names(sensor: Sensor) -> frozenset[str]:
    return frozenset(name.name for name in names(sensor.measures))


def _shows_force(sensor: Sensor) -> bool:
    return any(r.what in ("force", "reaction") for r in readings(sensor.measures))
