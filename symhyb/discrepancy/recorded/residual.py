"""The force discrepancy ΔF = M q'' + k_c − k_e along a recording, with its band.

ΔF is a force that *acts*: friction shows as −F_c sgn q', and a host adds +ΔF.
Sizes: N samples, n coordinates, m sensors.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.words.wording import percent_text, quantity_text
from symhyb.judgement import NOISE_FACTOR
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import free_part


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
    course = course_of(recording, machine, motion)
    force, applied = discrepancy(machine, course, machine.values), applied_force(machine, course)
    sensors = machine.model.sensors
    noise = {
        sensor.name: float(sd / sensor.unit.factor)
        for sensor, sd in zip(sensors, motion.sd, strict=True)
        if np.isfinite(sd)
    }
    notes = (
        *held_notes(machine),
        *recording.notes,
        *blind_notes(motion),
        *noise_notes(machine.model, noise),
    )
    return Discrepancy(
        machine.model,
        recording.name,
        motion,
        force,
        force_band(machine, motion, course),
        applied,
        noise,
        notes,
    )


def discrepancy(machine: Machine, course: Course, p: Array) -> Array:
    """ΔF (N, n) along a course with parameters p (P,), SI. Of an imposed coordinate it is what the
    measured reaction has less than the model says; zero where the reaction was not measured."""
    c = course
    given = c.q, c.v, c.a, c.z, c.u, c.t, p
    (force,) = along(machine.discrepancy, given, (6,), c.t.size)
    lacking = force - c.reaction
    return np.where(np.isfinite(c.reaction), lacking, 0.0)


def applied_force(machine: Machine, course: Course) -> Array:
    """k_e (N, n) along a course, SI; with constraints without the reactions that it calls up."""
    c = course
    (force,) = along(machine.k_e, (c.q, c.v, c.z, c.u, c.t, machine.values), (5,), c.t.size)
    return free_part(machine, c.q, c.t, machine.values, force)


def force_band(machine: Machine, motion: Motion, course: Course) -> Array:
    """One standard deviation of ΔF (N, n) from the bands of q, v and a, to first order, SI."""
    c = course
    given = c.q, c.v, c.a, c.z, c.u, c.t, machine.values
    slopes = along(machine.discrepancy_slopes, given, (6,), c.t.size)
    bands = (motion.q_sd, motion.v_sd, motion.a_sd)
    total = np.zeros((c.t.size, machine.n))
    for slope, sd in zip(slopes, bands, strict=True):
        by = slope.reshape(c.t.size, machine.n, machine.n)  # ∂ΔF/∂q column by column
        total += np.sum((by * sd[:, None]) ** 2, axis=1)
    return np.where(np.isfinite(c.reaction), np.sqrt(total), 0.0)


def held_notes(machine: Machine) -> tuple[str, ...]:
    """Say which constraints are left out because they repeat others."""
    found = machine.model.assembly
    return () if found is None else found.notes


def blind_notes(motion: Motion) -> tuple[str, ...]:
    """Say which coordinates no sensor places, so that the model had to tell their motion."""
    return tuple(
        f"no sensor shows the place of {name}: its motion is estimated with the model, and what it "
        "lacks shows on other coordinates too"
        for name in motion.blind
    )


def noise_notes(model: Model, noise: Mapping[str, float]) -> tuple[str, ...]:
    """Say where the measured noise contradicts the sd that a sensor states."""
    notes = []
    for sensor in model.sensors:
        if sensor.sd is None or sensor.name not in noise:
            continue
        found = noise[sensor.name]
        if found > NOISE_FACTOR * sensor.sd or found < sensor.sd / NOISE_FACTOR:
            unit = sensor.unit.text
            notes.append(
                f"{sensor.name} states a noise of {quantity_text(sensor.sd, unit)}, "
                f"measured are {quantity_text(found, unit)}; the measured one is used"
            )
    return tuple(notes)


def _rms(values: Array) -> Array:
    return np.asarray(np.sqrt(np.mean(values**2, axis=0)))
