"""What a recording holds for a machine: measurements and inputs in its order, and their noise.

Sizes: N samples, m sensors, k inputs.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.data.recording import Recording
from symhyb.judgement import FEW
from symhyb.numeric.kernels.buffers import Array, held_at, later
from symhyb.numeric.lowered.acting import acting_inputs, moves
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.between import bent_columns, finer, held_columns, with_jumps


def measured(recording: Recording, machine: Machine) -> Array:
    """The measurements (N, m), SI, in the order of the model's sensors, NaN where missing; a delay
    that the model states is taken back."""
    missing = np.full(recording.t.size, np.nan)
    columns = []
    for sensor in machine.model.sensors:
        column = recording.sensors.get(sensor.name, missing)
        if sensor.delay is not None and sensor.delay.si != 0:
            later = recording.t + sensor.delay.si
            column = np.interp(later, recording.t, column, left=np.nan, right=np.nan)
        columns.append(column)
    return np.column_stack(columns) if columns else np.empty((recording.t.size, 0))


def acting(recording: Recording, machine: Machine) -> Array:
    """The recorded inputs (N, k), SI, in the order of the model's inputs, as their actuators pass
    them on, delays applied."""
    columns = []
    passed = _passed(recording, machine)
    for i, item in enumerate(machine.model.inputs):
        column = passed[i] if i in passed else recording.inputs[item.name]
        if item.delay is not None and item.delay.si != 0:
            if item.between == "held":
                column = held_at(recording.t, column, recording.t - item.delay.si)
            else:
                column = later(recording.t, column, item.delay.si)
        columns.append(column)
    return _columns(recording, columns)


def _passed(recording: Recording, machine: Machine) -> dict[int, Array]:
    """Of each input that has an actuator what it passes on (N,), SI, at the samples."""
    inputs = machine.model.inputs
    if not any(item.actuator for item in inputs):
        return {}
    t, u = recording.t, _columns(recording, [recording.inputs[item.name] for item in inputs])
    smooth, held = bent_columns(inputs)
    acted = acting_inputs(machine, machine.values, *finer(t, u, smooth, held), bool(smooth))
    return {i: one.at(t) for i, one in acted.items()}


def driving(recording: Recording, machine: Machine) -> tuple[Array, Array]:
    """The inputs (K, k), SI, as actuators get them, delays applied, with the times (K,), s, between
    which a simulation may follow them: those of the recording, and those at which delayed held
    inputs jump. (Delays and actuators may change places.)"""
    inputs, columns = machine.model.inputs, []
    held = held_columns(inputs)
    for i, item in enumerate(inputs):
        column, late = recording.inputs[item.name], item.delay.si if item.delay else 0.0
        columns.append(column if i in held else later(recording.t, column, late))
    delays = [item.delay.si if item.delay else 0.0 for item in inputs]
    return with_jumps(recording.t, _columns(recording, columns), held, delays)


def _columns(recording: Recording, columns: Sequence[Array]) -> Array:
    """Signals (N,) side by side (N, k)."""
    return np.column_stack(columns) if columns else np.empty((recording.t.size, 0))


def centred(recording: Recording, machine: Machine) -> Array:
    """The recorded inputs (N, k), SI, as a smoothed motion sees them: what is held counts at a jump
    with the mean of both sides."""
    u = acting(recording, machine)
    for i in held_columns(machine.model.inputs):
        if moves(machine.model.inputs[i]):
            continue
        u[1:, i] = (u[1:, i] + u[:-1, i]) / 2
    return u


def noise_level(values: Array) -> float:
    """Standard deviation of the noise of an evenly sampled signal, from high differences.

    The d-th difference of white noise has variance σ²·C(2d, d), that of a smooth signal vanishes as
    d grows; the smallest estimate over d = 2 … 10 is taken (Gasser, Sroka, Jennen-Steinmetz,
    Biometrika 73, 1986, for d = 2). ``values`` (N,), missing samples NaN, and the result have the
    same unit; NaN if fewer than 20 differences are left.
    """
    from scipy.special import comb

    estimates = []
    for order in range(2, 11):
        difference = np.diff(values, n=order)
        difference = difference[np.isfinite(difference)]
        if difference.size < FEW:
            break
        estimates.append(np.sqrt(np.mean(difference**2) / comb(2 * order, order)))
    return float(min(estimates)) if estimates else float("nan")
