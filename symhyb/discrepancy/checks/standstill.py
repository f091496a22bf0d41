"""Is the rest position right: stretches in which a machine stands still, held against the model.

Sizes: N samples, n coordinates.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.checks.modes import rest_position, still_force
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.words.wording import joined, quantity_text
from symhyb.judgement import OUTSTANDING, SLOW
from symhyb.model.types import Model, On
from symhyb.model.vocabulary import force_unit
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.machine import Machine


@dataclass(frozen=True, slots=True)
class Standstill:
    """A machine that stood still from ``span[0]`` to ``span[1]`` s: by coordinate and in its unit
    how far from the model's place of rest (``off``, one ``sd``), and the static ``force`` that the
    model lacks there. ``held``: dry friction of the model may explain it; ``off`` is empty where
    the model has no place of rest."""

    span: tuple[float, float]
    off: Mapping[str, float]
    sd: Mapping[str, float]
    force: Mapping[str, float]
    held: bool
    right: bool
    sentence: str


def standstill_of(
    machine: Machine, dryless: Machine, motion: Motion, course: Course
) -> Standstill | str:
    """The longest standstill of a recording, or why none is judged. ``dryless`` is the machine
    without dry friction, whose place of rest is one place."""
    rows = longest_still(motion)
    if rows is None:
        return "the machine does not stand still for one period in this recording"
    if motion.blind:
        return f"no sensor shows the place of {joined(motion.blind)}"
    free, model = list(machine.free), machine.model
    place, u = motion.q[rows].mean(axis=0), course.u[rows].mean(axis=0)
    rest = rest_position(dryless, place, u, float(motion.t[rows][0]))
    force = -still_force(dryless, place, u, float(motion.t[rows][0]))
    dry = [i for i, e in enumerate(model.elements) if e.name not in _names(dryless.model)]
    held = bool(dry) and bool(np.all(np.abs(force) <= _level(machine, course, dry)))
    off, sd, lacks = {}, {}, {}
    for i in free:
        coordinate = model.coordinates[i]
        unit = coordinate.unit.factor
        sd[coordinate.name] = float(motion.q_sd[i]) / unit
        lacks[coordinate.name] = float(force[i]) / force_unit(model, On(coordinate.name)).factor
        if rest is not None:
            off[coordinate.name] = float(place[i] - rest[i]) / unit
    right = rest is not None and all(abs(off[n]) <= OUTSTANDING * sd[n] for n in off)
    span = float(motion.t[rows][0]), float(motion.t[rows][-1])
    said = _sentence(model, span, off, sd, lacks, held, right)
    return Standstill(span, off, sd, lacks, held, right, said)


def longest_still(motion: Motion) -> slice | None:
    """The longest stretch of samples in which nothing moves, None if it is shorter than a period
    of the motion."""
    limit = np.maximum(OUTSTANDING * motion.v_sd, SLOW * np.abs(motion.v).max(axis=0))
    still = np.concatenate([[False], np.all(np.abs(motion.v) <= limit, axis=1), [False]])
    edges = np.flatnonzero(np.diff(still.astype(int))).reshape(-1, 2)
    if not edges.size:
        return None
    first, last = max(edges, key=lambda pair: pair[1] - pair[0])
    lasts = float(motion.t[last - 1] - motion.t[first])
    return slice(int(first), int(last)) if lasts >= motion.periods().max() else None


def _names(model: Model) -> set[str]:
    return {element.name for element in model.elements}


def _level(machine: Machine, course: Course, dry: list[int]) -> Array:
    """The largest force (n,) of dry elements along a course, SI: what they can hold."""
    c = course
    (parts,) = along(machine.elements, (c.q, c.v, c.z, c.u, c.t, c.values(machine)), (5,), c.t.size)
    forces = parts.reshape(c.t.size, -1, machine.n)[:, dry]
    return np.asarray(np.abs(forces).sum(axis=1).max(axis=0))


def _sentence(
    model: Model,
    span: tuple[float, float],
    off: Mapping[str, float],
    sd: Mapping[str, float],
    lacks: Mapping[str, float],
    held: bool,
    right: bool,
) -> str:
    units = {c.name: c.unit.text for c in model.coordinates}
    when = f"stands still from {span[0]:.4g} to {span[1]:.4g} s"
    if not off:
        forces = [
            f"{quantity_text(value, force_unit(model, On(name)).text, digits=2)} on {name}"
            for name, value in lacks.items()
        ]
        why = "its dry friction may" if held else "nothing in the model does"
        said = f"{when}, where the model has no place of rest: {joined(forces)} must hold it there"
        return f"{said}; {why}"
    parts = [f"{name} {quantity_text(value, units[name], sd[name])}" for name, value in off.items()]
    begin = f"{when}; off the model's place of rest by {joined(parts)}"
    if right:
        return f"{begin}: right within the noise"
    return f"{begin}: {'dry friction of the model may hold it' if held else 'not explained'}"
