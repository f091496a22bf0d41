"""How badly a model and its sensors fit the motion that recordings show, without simulating.

Two numbers. ``forces``: what ΔF holds of all forces, inertia included, that act on a coordinate, as
it is and after every ordinary cause took what it could: laws of the coordinate's own motion with
the signs that physics allows, and every force of the model wrong by up to half. ``senses``: how far
the sensors contradict each other, whatever the forces are. Sizes: N samples, n coordinates.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import lsq_linear

from symhyb.discrepancy.course import Course, course_of
from symhyb.discrepancy.hypotheses import GAIN_REACH
from symhyb.discrepancy.motion import noise_level
from symhyb.discrepancy.residual import discrepancy
from symhyb.discrepancy.runs import Run
from symhyb.numeric.buffers import Array
from symhyb.numeric.machine import Machine
from symhyb.numeric.vector import along

TRIMMED = 0.04  # of a recording at either end, where splines are wild
MASS_MOST = 2.0  # times the inertia of the model: more mass than that is no oversight
ROWS_MOST = 3000  # samples of a recording that are looked at

Limited = tuple[Array, float, float]


@dataclass(frozen=True, slots=True)
class Misfit:
    """Shares of squares, dimensionless: ΔF against all forces (``plain``, the sum over coordinates)
    and after ordinary causes (``ordinary``); ``senses``, the worst sensor against its spread."""

    plain: float
    ordinary: float
    senses: float

    @property
    def worst(self) -> float:
        """What neither ordinary physics nor consistent sensors explain."""
        return max(self.ordinary, self.senses)


def misfit(machine: Machine, runs: Sequence[Run]) -> Misfit:
    """The misfit of a model, with ``machine.values``, along the smoothed motion of recordings."""
    parts = [list(_rows(machine, course_of(r.recording, machine, r.motion))) for r in runs]
    plain = ordinary = 0.0
    for rows in zip(*parts, strict=True):  # one coordinate at a time, over all recordings
        lacking = np.concatenate([row[0] for row in rows])
        size = sum(float(row[1]) for row in rows)
        if size <= 0 or not np.isfinite(size):
            plain, ordinary = plain + float(size > 0), ordinary + float(size > 0)
            continue
        columns = [np.concatenate(pair) for pair in zip(*(row[2] for row in rows), strict=True)]
        plain += float(lacking @ lacking) / size
        ordinary += _left(lacking, columns, rows[0][3]) / size
    return Misfit(plain, ordinary, senses(machine, runs))


def senses(machine: Machine, runs: Sequence[Run]) -> float:
    """The largest share of a sensor's variance, beyond its noise, that a motion common to all
    sensors leaves."""
    worst = 0.0
    for run in runs:
        for sensor, sd in zip(machine.model.sensors, run.motion.sd, strict=True):
            values = run.recording.sensors.get(sensor.name)
            spread = 0.0 if values is None else float(np.nanstd(values))
            if values is None or not spread > 0 or not np.isfinite(sd):
                continue
            noise = noise_level(values)
            beyond = sd**2 - (noise**2 if np.isfinite(noise) else 0.0)
            worst = max(worst, float(beyond / spread**2))
    return worst


def _rows(
    machine: Machine, c: Course
) -> Iterator[tuple[Array, float, list[Array], tuple[Array, Array]]]:
    """Of every free coordinate ΔF (N,), the sum of squares of all that acts, and columns of the
    ordinary causes with their bounds."""
    size = c.t.size
    inner = slice(int(TRIMMED * size), size - int(TRIMMED * size), max(size // ROWS_MOST, 1))
    given = c.q, c.v, c.z, c.u, c.t, machine.values
    (k_e,) = along(machine.k_e, given, (5,), size)
    (flat,) = along(machine.elements, given, (5,), size)
    forces = flat.reshape(size, -1, machine.n).swapaxes(1, 2)
    lacking = discrepancy(machine, c, machine.values)
    inertia = lacking + k_e
    rest = k_e - forces.sum(axis=2)
    for i in machine.free:
        acting = [forces[inner, i, e] for e in range(forces.shape[2])]
        acting += [inertia[inner, i], rest[inner, i]]
        acting = [force for force in acting if np.any(force)]
        limited = [*_laws(c, i, inner, inertia[inner, i]), *((f, -GAIN_REACH, GAIN_REACH) for f in acting)]
        columns = [column for column, _, _ in limited]
        bounds = np.array([low for _, low, _ in limited]), np.array([up for *_, up in limited])
        total = sum(float(force @ force) for force in acting)
        yield lacking[inner, i], total, columns, bounds


def _laws(c: Course, i: int, rows: slice, inertia: Array) -> Iterator[Limited]:
    """Forces (N,) of unit laws on a coordinate, with the bounds of their coefficients: a passive
    machine only loses energy."""
    q, v, a = c.q[rows, i], c.v[rows, i], c.a[rows, i]
    centred, fast = q - q.mean(), max(float(np.abs(v).max()), 1e-300)
    yield np.ones_like(q), -np.inf, np.inf
    for held in (centred, centred**3, np.sin(q), np.cos(q)):
        yield held, -np.inf, np.inf
    for lost in (v, np.abs(v) * v, np.tanh(100 * v / fast)):
        yield -lost, 0.0, np.inf
    pull = float(np.linalg.norm(a))
    mass = float(np.linalg.norm(inertia)) / pull if pull > 0 else 0.0
    if mass > 0:
        yield -a, 0.0, MASS_MOST * mass
    for j in range(c.q.shape[1]):
        if j != i:
            yield q - c.q[rows, j], -np.inf, np.inf
            yield c.v[rows, j] - v, 0.0, np.inf


def _left(lacking: Array, columns: Sequence[Array], bounds: tuple[Array, Array]) -> float:
    """The squares of ``lacking`` (N,) that columns within bounds of their coefficients leave."""
    matrix = np.column_stack([*columns, lacking])
    scale = np.linalg.norm(matrix, axis=0)
    seen = scale > 0
    if not seen[-1]:
        return 0.0
    scale = np.where(seen, scale, 1.0)
    factor = np.linalg.qr(matrix / scale, mode="r")
    used = seen[:-1]
    low, high = (bound[used] * scale[:-1][used] / scale[-1] for bound in bounds)
    fitted = lsq_linear(factor[:, :-1][:, used], factor[:, -1], (low, high), method="bvls")
    return float(2 * fitted.cost * scale[-1] ** 2)
