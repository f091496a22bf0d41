"""The force that the model lacks along a recording, and what it is within a range of time."""

from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.recorded.motion import Motion, motion_of
from symhyb.discrepancy.recorded.residual import Discrepancy, compared_along
from symhyb.discrepancy.recorded.sampling import as_sampled
from symhyb.model.expression import names
from symhyb.model.types import Model, On
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.report.tables import place_units
from symhyb.units import Unit
from symhyb.workbench.simulated import Prepared

Span = tuple[float, float]


@dataclass(frozen=True, slots=True, eq=False)
class Lacking:
    """ΔF on one coordinate, in the units of the file: ``force`` and its ``band`` (one deviation),
    the ``applied`` force, and ``place`` and ``rate`` of the motion, each (N,) at ``t`` (N,), s."""

    coordinate: str
    t: Array
    force: Array
    band: Array
    applied: Array
    place: Array
    rate: Array
    force_unit: Unit
    place_unit: Unit
    rate_unit: Unit


@dataclass(frozen=True, slots=True)
class Within:
    """ΔF on one coordinate within a range of time: RMS and mean of it, RMS of its band and of the
    applied force, and the ranges (low, high) of place and rate."""

    samples: int
    rms: float
    mean: float
    band: float
    applied: float
    place: Span
    rate: Span


def lacking(prepared: Prepared, model: Model) -> tuple[Lacking, ...]:
    """ΔF of a recording on every coordinate of a model.

    The motion is that of the file's model, unless what was changed has a part in it: where no
    sensor shows a place, along constraints, and where sensors measure otherwise.
    """
    machine = build(as_sampled(model, [prepared.recording]), keep=False)
    motion = prepared.motion
    if not _same_motion(prepared, model, motion):
        motion = motion_of(prepared.recording, machine)
    gap = compared_along(machine, prepared.recording, motion)
    return tuple(_lacking(gap, i) for i in range(machine.n))


def _same_motion(prepared: Prepared, model: Model, motion: Motion) -> bool:
    """Whether the motion does not depend on what was changed."""
    if model == prepared.model:
        return True
    if motion.blind or model.constraints or model.sensors != prepared.model.sensors:
        return False
    before = {item.path: item.value for item in prepared.model.all_parameters()}
    moved = {item.path for item in model.all_parameters() if item.value != before[item.path]}
    used = {one.name for sensor in model.sensors for one in names(sensor.measures)}
    return not moved & used


def _lacking(gap: Discrepancy, i: int) -> Lacking:
    coordinate = gap.model.coordinates[i]
    units = place_units(gap.model, On(coordinate.name))
    return Lacking(
        coordinate.name,
        gap.motion.t,
        gap.force[:, i] / units.force.factor,
        gap.band[:, i] / units.force.factor,
        gap.applied[:, i] / units.force.factor,
        gap.motion.q[:, i] / units.stretch.factor,
        gap.motion.v[:, i] / units.rate.factor,
        units.force,
        units.stretch,
        units.rate,
    )


def rows_within(one: Lacking, span: Span | None) -> Array:
    """Which samples (N,) are within a range of time, s; all without one."""
    if span is None:
        return np.ones(one.t.size, dtype=bool)
    return np.asarray((one.t >= span[0]) & (one.t <= span[1]))


def within(one: Lacking, span: Span | None) -> Within | None:
    """What ΔF is within a range of time, s; None where no sample lies in it."""
    rows = rows_within(one, span)
    if not rows.any():
        return None
    force, place, rate = one.force[rows], one.place[rows], one.rate[rows]
    return Within(
        int(rows.sum()),
        _rms(force),
        float(force.mean()),
        _rms(one.band[rows]),
        _rms(one.applied[rows]),
        (float(place.min()), float(place.max())),
        (float(rate.min()), float(rate.max())),
    )


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
