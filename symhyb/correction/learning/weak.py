"""The weak form of what a model lacks, at the level of forces or of rates, for a list of terms.

    force    ∫ φ (p' − ∂T/∂q − k_e) dt = −∫ φ' p dt − ∫ φ (∂T/∂q + k_e) dt = Σ c_j ∫ φ θ_j dt
    rates    ∫ φ (v' − f_v) dt         = −∫ φ' v dt − ∫ φ f_v dt           = Σ r_j ∫ φ θ_j dt

φ are the modulated windows of :mod:`symhyb.correction.search.force_screen`: no second derivative of
noisy data is formed. f_v = M⁻¹(k_e − k_c) are the accelerations of the model.
Sizes: N rows of all windows, T terms, f free coordinates.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.learning.corrected import Formulation, features
from symhyb.correction.search.force_screen import BAND, modulated
from symhyb.correction.search.preparing import Prepared
from symhyb.discrepancy.recorded.course import Course
from symhyb.discrepancy.recorded.runs import cut_within
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import InputError, Problem
from symhyb.judgement import FEWEST
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.vector import along
from symhyb.numeric.lowered.dynamics import state_form
from symhyb.numeric.lowered.machine import Machine

PERIODS = 1.5  # of the shortest motion: a window
WINDOWS_WANTED = 20  # over all recordings: each is held once


@dataclass(frozen=True, slots=True, eq=False)
class WeakForm:
    """Rows of the weak form: ``columns`` (N, T), each per SI unit of its coefficient, ``right``
    (N, f), SI, and the ``window`` (N,) that a row is of; ``texts`` are the terms."""

    texts: tuple[str, ...]
    columns: Array
    right: Array
    window: NDArray[np.int64]


def weak_form(prepared: Prepared, texts: Sequence[str], formulation: Formulation) -> WeakForm:
    """The weak form of terms, expressions in SI, along all training recordings.

    Raises:
        InputError: recordings too short or too full of gaps for windows.
    """
    machine = prepared.machine
    seen = features(machine, texts)
    parts: list[tuple[Array, Array]] = []
    count, windows = 0, []
    for item in _cut_into(prepared):
        c = item.course(machine)
        (values,) = along(seen, (c.q, c.v, c.u, c.t, c.values(machine)), (4,), c.t.size)
        carried, rest = _sides(machine, c, formulation)
        test, slope = modulated(item.block.t, BAND / prepared.shortest)
        right = -(slope @ carried[item.rows] + test @ rest[item.rows])
        columns = test @ values[item.rows]
        number, rows = right.shape[:2]
        parts.append((columns.reshape(-1, columns.shape[2]), right.reshape(-1, right.shape[2])))
        windows.append(np.repeat(count + np.arange(number), rows))
        count += number
    columns, right = (np.concatenate(part) for part in zip(*parts, strict=True))
    return WeakForm(tuple(texts), columns, right, np.concatenate(windows))


def _cut_into(prepared: Prepared) -> list[Cut]:
    total = sum(run.recording.duration for run in prepared.runs)
    length = min(PERIODS * prepared.shortest, total / WINDOWS_WANTED)
    cuts = [cut_within(run, prepared.machine, length) for run in prepared.runs]
    found = [item for item in cuts if item is not None]
    if sum(len(item.start) for item in found) < FEWEST:
        names = ", ".join(run.recording.name for run in prepared.runs)
        text = f"{names}: too short or too full of gaps for three windows of {length:.3g} s"
        raise InputError(Problem(text))
    return found


def _sides(machine: Machine, c: Course, formulation: Formulation) -> tuple[Array, Array]:
    """What is differentiated, p or v, and what the model says of its slope, (N, f) each, SI."""
    free = list(machine.free)
    if formulation == "force":
        given = c.q, c.v, c.z, c.u, c.t, c.values(machine)
        momentum, rest = along(machine.weak, given, (5,), c.t.size)
        return momentum[:, free], rest[:, free]
    form = state_form(machine)
    moving = c.states, c.drive, c.t, c.values(machine), np.zeros(machine.n)
    (rates,) = along(form.rates(), moving, (3, 4), c.t.size)
    return c.v[:, free], rates[:, : len(free)]
