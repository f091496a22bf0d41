"""The force discrepancy ΔF = M q'' + k_c − k_e along a recording, with its band.

ΔF is a force that *acts*: friction shows as −F_c sgn q', and a host adds +ΔF.
Sizes: N samples, n coordinates, m sensors.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.motion import Motion, acting, motion_of
from symhyb.discrepancy.wording import percent_text, quantity_text
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.buffers import Array, call, mapped
from symhyb.numeric.machine import Machine

NOISE_RATIO = 2.0  # measured noise this far from the stated sd is told


@dataclass(frozen=True, slots=True, eq=False)
class Discrepancy:
    """ΔF of one recording, SI: ``force`` and ``band`` (one sd) (N, n), ``applied`` k_e (N, n),
    along the smoothed ``motion``; ``noise`` by sensor in the sensor's unit."""

    model: Model
    recording: str
    motion: Motion
    force: Array
    band: Array
    applied: Array
    noise: Mapping[str, float]
    notes: tuple[str, ...]

    def summary(self) -> str:
        """Say how large ΔF is, against its noise and against what is applied."""
        lines = [f"{self.recording}: what the model lacks, as a force (ΔF = M q'' + k_c − k_e)"]
        for i, coordinate in enumerate(self.model.coordinates):
            unit = force_unit(self.model, On(coordinate.name))
            size, band = _rms(self.force)[i], _rms(self.band)[i]
            applied = _rms(self.applied)[i]
            share = f", {percent_text(size / applied)} of what is applied" if applied > 0 else ""
            judged = "structure, not noise" if size > 2 * band else "no larger than its noise"
            lines.append(
                f"  {coordinate.name}: {quantity_text(size / unit.factor, unit.text)} RMS"
                f" (noise {quantity_text(band / unit.factor, unit.text)}){share}: {judged}"
            )
        return "\n".join([*lines, *(f"  note: {note}" for note in self.notes)])

    def __str__(self) -> str:
        return self.summary()


def compare(machine: Machine, recording: Recording) -> Discrepancy:
    """ΔF of a recording with its band, from motion that all sensors determine together."""
    motion = motion_of(recording, machine)
    u = acting(recording, machine)
    force = discrepancy(machine, motion.q, motion.v, motion.a, u, motion.t, machine.values)
    (applied,) = call(
        mapped(machine.k_e, motion.t.size, repeated=(4,)),
        (motion.q, motion.v, u, motion.t, machine.values),
    )
    sensors = machine.model.sensors
    noise = {
        sensor.name: float(sd / sensor.unit.factor)
        for sensor, sd in zip(sensors, motion.sd, strict=True)
        if np.isfinite(sd)
    }
    return Discrepancy(
        machine.model, recording.name, motion, force, force_band(machine, motion, u), applied,
        noise, (*recording.notes, *noise_notes(machine.model, noise)),
    )  # fmt: skip


def discrepancy(
    machine: Machine, q: Array, v: Array, a: Array, u: Array, t: Array, p: Array
) -> Array:
    """ΔF (N, n) for motion q, v, a (N, n), inputs u (N, k) at t (N,), parameters p (P,), SI."""
    (force,) = call(mapped(machine.discrepancy, t.size, repeated=(5,)), (q, v, a, u, t, p))
    return force


def force_band(machine: Machine, motion: Motion, u: Array) -> Array:
    """One standard deviation of ΔF (N, n) from the bands of q, v and a, to first order, SI."""
    q, v, a = motion.q, motion.v, motion.a
    spreads = (motion.q_sd, motion.v_sd, motion.a_sd)
    base = discrepancy(machine, q, v, a, u, motion.t, machine.values)
    total = np.zeros_like(base)
    for which, spread in enumerate(spreads):
        for j in range(machine.n):
            moved = (q.copy(), v.copy(), a.copy())
            moved[which][:, j] += spread[j]
            total += (discrepancy(machine, *moved, u, motion.t, machine.values) - base) ** 2
    return np.sqrt(total)


def noise_notes(model: Model, noise: Mapping[str, float]) -> tuple[str, ...]:
    """Say where the measured noise contradicts the sd that a sensor states."""
    notes = []
    for sensor in model.sensors:
        if sensor.sd is None or sensor.name not in noise:
            continue
        found = noise[sensor.name]
        if found > NOISE_RATIO * sensor.sd or found < sensor.sd / NOISE_RATIO:
            unit = sensor.unit.text
            notes.append(
                f"{sensor.name} states a noise of {quantity_text(sensor.sd, unit)}, "
                f"measured are {quantity_text(found, unit)}; the measured one is used"
            )
    return tuple(notes)


def _rms(values: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))
