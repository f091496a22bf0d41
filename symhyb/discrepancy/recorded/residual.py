"""The force discrepancy ΔF = M q'' + k_c − k_e along a recording, with its band.

ΔF is a force that *acts*: friction shows as −F_c sgn q', and a host adds +ΔF.
Sizes: N samples, n coordinates, m sensors.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from symhyb.asked import asked
from symhyb.data.known import require_known
from symhyb.data.recording import Recording
from symhyb.discrepancy.recorded.course import Course, course_of
from symhyb.discrepancy.recorded.local import along_recordings
from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.words.wording import percent_text, quantity_text
from symhyb.drawn import drawn
from symhyb.framed import Signal, dataset_of, frame_of
from symhyb.judgement import NOISE_FACTOR
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.either import machine_of, model_of
from symhyb.numeric.lowered.known import machine_with, with_known
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.lowered.manifold import free_part
from symhyb.shown import card
from symhyb.units import parse_unit

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


@dataclass(frozen=True, slots=True, eq=False, repr=False)
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

    def __repr__(self) -> str:
        sizes = ", ".join(f"{name} {size:.4g} {unit}" for name, unit, size, _ in self._sizes())
        return f"<Discrepancy of '{self.recording}': {self.motion.t.size} samples, RMS of {sizes}>"

    def _repr_html_(self) -> str:
        rows = [
            (name, unit, f"{size:.4g}", f"{band:.2g}") for name, unit, size, band in self._sizes()
        ]
        head = ("force on", "unit", "RMS of ΔF", "of its noise")
        return card(f"ΔF of {self.recording}", "", head, rows, self.notes)

    def signals(self) -> Iterator[Signal]:
        """Of every coordinate x the smoothed motion ``x``, ``x'``, ``x''``, the missing force
        ``dF_x`` with one deviation ``dF_x_sd``, and the applied force ``k_e_x``: values (N,) in the
        units of the model file, and these."""
        second = parse_unit("s")
        for i, coordinate in enumerate(self.model.coordinates):
            name, unit = coordinate.name, coordinate.unit
            motion = (self.motion.q, self.motion.v, self.motion.a)
            for order, part in enumerate(motion):
                rate = unit / second**order
                yield name + "'" * order, part[:, i] / unit.factor, rate.text
            force = force_unit(self.model, On(name))
            parts = (f"dF_{name}", self.force), (f"dF_{name}_sd", self.band)
            for key, part in (*parts, (f"k_e_{name}", self.applied)):
                yield key, part[:, i] / force.factor, force.text

    def to_frame(self) -> "pd.DataFrame":
        """ΔF, its band, what is applied and the motion in the units of the model file, as columns
        over the index ``t`` in s (``dF_x``, ``dF_x_sd``, ``k_e_x``, ``x``, ``x'``, ``x''``);
        ``attrs["units"]`` says which units."""
        return frame_of(self.motion.t, self.signals(), name=self.recording)

    def to_xarray(self) -> "xr.Dataset":
        """As :meth:`to_frame`, as a dataset of xarray.

        Raises:
            InputError: xarray is not installed.
        """
        return dataset_of(self.motion.t, self.signals(), name=self.recording)

    def plot(self, *coordinates: str, ax: Any = None, over: str = "") -> Any:
        """Draw ΔF on ``coordinates`` or on all, over time and over the rate, or over one of
        ``over`` "time", "rate", "place": returns the axes of matplotlib; what is given as ``ax`` is
        drawn on, over time where nothing else is said (:mod:`symhyb.report.axes`)."""
        return drawn("discrepancy", self, ax, coordinates=coordinates, over=over)

    def _sizes(self) -> Iterator[tuple[str, str, float, float]]:
        """Of every coordinate the unit of its force, and the RMS of ΔF and of its band in it."""
        for i, coordinate in enumerate(self.model.coordinates):
            unit = force_unit(self.model, On(coordinate.name))
            size, band = _rms(self.force)[i] / unit.factor, _rms(self.band)[i] / unit.factor
            yield coordinate.name, unit.text, size, band


@asked
def compare(machine: Machine | Model, recording: Recording) -> Discrepancy:
    """ΔF of a recording with its band, from motion that all sensors determine together.

    Raises:
        InputError: too few samples, none of any sensor of motion, a known value of a parameter
            that the model has not, or an FMU or a file of MuJoCo that cannot be asked.
    """
    require_known(model_of(machine), [recording])
    if model_of(machine).engine is not None:
        machine, ((recording,),) = along_recordings(model_of(machine), [recording])
    machine = machine_of(machine)
    return compared_along(machine, recording, motion_of(recording, machine))


def compared_along(machine: Machine, recording: Recording, motion: Motion) -> Discrepancy:
    """ΔF of a recording with its band, along its ``motion``."""
    machine = machine_with(machine, recording.parameters)
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
    """ΔF (N, n) along a course with parameters p (P,), SI, but for those that its recording knows.
    Of an imposed coordinate it is what the measured reaction has less than the model says; zero
    where the reaction was not measured."""
    c = course
    given = c.q, c.v, c.a, c.z, c.u, c.t, with_known(machine, p, c.known)
    (force,) = along(machine.discrepancy, given, (6,), c.t.size)
    lacking = force - c.reaction
    return np.where(np.isfinite(c.reaction), lacking, 0.0)


def applied_force(machine: Machine, course: Course) -> Array:
    """k_e (N, n) along a course, SI; with constraints without the reactions that it calls up."""
    c = course
    p = c.values(machine)
    (force,) = along(machine.k_e, (c.q, c.v, c.z, c.u, c.t, p), (5,), c.t.size)
    return free_part(machine, c.q, c.t, p, force)


def force_band(machine: Machine, motion: Motion, course: Course) -> Array:
    """One standard deviation of ΔF (N, n) from the bands of q, v and a, to first order, SI."""
    c = course
    given = c.q, c.v, c.a, c.z, c.u, c.t, c.values(machine)
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
    """Say which coordinates no sensor places, so that the model had to determine their motion."""
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
