"""Beside named laws, not in their place: forces that no change of a named value would make.

What is added to a corrected model without a name may only take what is orthogonal, along the
recorded motion, to the force that any change of a named value would make; else it would steal the
share of the laws. Here are these directions, and the linear problem of all terms on windows.
Sizes: N samples, n coordinates, W windows, T terms, D directions, K named values.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import starts_only
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut, correlation_time, merge, reduce
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.windows import WindowModel

NUDGE = 1e-4  # of a named value: the step of a one-sided difference of ΔF, which is linear in most
DEPENDENT = 1e-9  # of the largest singular value: directions that the motion does not tell apart


def beside(forces: Array, laws: Array) -> Array:
    """The directions (T, D) of the coefficients of ``forces`` (N, T) whose force is orthogonal to
    ``laws`` (N, K), what changes of the named values make; SI, scaled to forces of equal size."""
    size = np.sqrt(np.mean(forces**2, axis=0))
    scaled = forces / size
    strength = np.linalg.norm(laws, axis=0)
    laws = laws[:, strength > 0] / strength[strength > 0]
    _, singular, rows = np.linalg.svd(laws.T @ scaled)
    rank = int(np.sum(singular > DEPENDENT * singular.max(initial=0.0))) if singular.size else 0
    return np.asarray(rows[rank:].T / size[:, None])


def named_forces(machine: Machine, course: Course) -> Array:
    """The change of ΔF (N, n, K) by every value of a found law and every parameter that may be
    estimated, to first order, SI."""
    found = {element.name for element in machine.model.elements if element.found}
    base, columns = discrepancy(machine, course, machine.values), []
    for item in machine.model.all_parameters():
        if item.owner in found or (not item.owner and item.sd is not None):
            p = machine.values.copy()
            column = machine.column(item.path)
            p[column] += NUDGE * (abs(p[column]) or 1.0)
            columns.append(discrepancy(machine, course, p) - base)
    return np.stack(columns, axis=2) if columns else np.zeros((*base.shape, 0))


@dataclass(frozen=True, slots=True)
class Linear:
    """Normal equations of all terms: ``gram`` (T + 1, T + 1) of fitted and of ``held`` windows, the
    last row the residual; ``unit`` is χ² of one independent sample, ``samples`` of held windows."""

    gram: Array
    held: Array
    unit: float
    samples: float


def linear(model: WindowModel, cuts: Sequence[Cut], p: Array, sd: Array) -> Linear:
    """The reply of the windows to all terms around the simulation with ``p`` (P,), SI."""
    parts, residuals = [], []
    for item in cuts:
        starts = fit(WindowModel(model.machine), starts_only(item, sd), p).starts[0]
        slopes = model.differentiate(item.block, starts, p)
        residual = item.block.y - slopes.output
        columns = (item, residual, slopes.from_start(), slopes.from_free(), sd)
        parts.append(reduce(*columns))
        residuals.append(np.nan_to_num(residual / sd).reshape(len(residual), -1))
    grams, count, held = merge(parts)
    train = ~held if held.any() else np.ones_like(held)
    scale = float(grams[train, -1, -1].sum() / count[train].sum())
    unit = scale * correlation_time(residuals, len(sd))
    tried = held if held.any() else ~held
    samples = float(count[tried].sum())
    return Linear(grams[train].sum(axis=0), grams[tried].sum(axis=0), unit, samples)


def solved(gram: Array, basis: Array, ridge: float = 0.0) -> Array:
    """Coefficients (T,), SI, that lower the cost most within ``basis`` (T, D). A ``ridge`` adds so
    much of every direction's own part of the normal equations, and holds back the doubtful ones."""
    inner, right = basis.T @ gram[:-1, :-1] @ basis, basis.T @ gram[:-1, -1]
    scale = np.sqrt(np.maximum(np.diag(inner), 1e-300))
    unit = inner / np.outer(scale, scale) + ridge * np.eye(right.size)
    values = np.linalg.lstsq(unit, right / scale, rcond=DEPENDENT)[0]
    return np.asarray(basis @ (values / scale))


def on_held(step: Linear, basis: Array | None, ridge: float = 0.0) -> float:
    """χ² of the held windows with the terms of ``basis`` (T, D) fitted to the others, with a
    dimensionless ``ridge``."""
    values = np.zeros(len(step.gram) - 1) if basis is None else solved(step.gram, basis, ridge)
    full = np.append(-values, 1.0)
    return float(full @ step.held @ full)
