"""Several structures of one model, fitted to the same windows and compared: a ladder of laws.

A structure is a set of numbers that are fitted; those that only others fit are held at values of
its own, a friction that it does not have at 0. All are fitted to the windows that are made for the
one with most numbers, so that their misfits are of the same samples, and compared by the score of a
diagnosis,

    ln p(recordings | structure) = −(χ²/u + k ln N)/2 + a constant

with k numbers, N samples and χ² = u of one independent piece of what the structure leaves that fits
best, its numbers paid (Schwarz, Annals of Statistics 6, 1978). Sizes: S structures.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.correction.calibration import (
    Calibrated,
    all_windows,
    chosen,
    moved,
    on_windows,
    require_shown,
    unstated,
)
from symhyb.correction.search.preparing import Prepared, prepare
from symhyb.correction.search.score import piece
from symhyb.data.recording import Recording
from symhyb.discrepancy.fitting.task import Fit
from symhyb.discrepancy.places.hypotheses import with_channels
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.errors import NumericsError
from symhyb.model.types import Model, Parameter
from symhyb.model.write import set_parameters
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.threads import one_thread

Asked = tuple[Sequence[str], Mapping[str, float]]
"""The names of the numbers that a structure fits, and where numbers stand in it, in their units: at
the begin of the fit, or throughout if they are not fitted."""


@dataclass(frozen=True, slots=True, eq=False)
class Structured:
    """What each structure fitted (None: it cannot be simulated), and ``ln_evidence`` (S,),
    dimensionless, 0 of the likeliest and −inf of one that cannot be simulated."""

    fits: tuple[Calibrated | None, ...]
    ln_evidence: Array

    @property
    def probabilities(self) -> Array:
        """The posterior probability (S,), dimensionless, of each, equal ones before."""
        return shares(self.ln_evidence)

    @property
    def likeliest(self) -> int:
        """The place of the likeliest."""
        return int(np.argmax(self.ln_evidence))


def shares(ln_evidence: Array) -> Array:
    """Probabilities (S,), dimensionless, of structures that were equally probable before."""
    weights = np.exp(ln_evidence - np.max(ln_evidence))
    return np.asarray(weights / weights.sum())


def structured(
    model: Model, recordings: Recording | Sequence[Recording], asked: Sequence[Asked]
) -> Structured:
    """Fit each of some structures of a model to recordings; a stated sd is no evidence.

    Raises:
        InputError: an unknown name, one whose value recordings state as known, or recordings in
            which no sensor changes.
        NumericsError: none of the structures can be simulated along them.
    """
    models = [set_parameters(model, dict(values)) for _, values in asked]
    free = [unstated(chosen(one, names)) for one, (names, _) in zip(models, asked, strict=True)]
    every = list(dict.fromkeys(item.path for items in free for item in items))
    require_shown(model, recordings, every)
    widest = max(range(len(free)), key=lambda i: len(free[i]))
    with one_thread():
        start = models[widest]
        prepared = prepare(start, recordings)
        cuts = all_windows(prepared)
        first, _ = _tried(start, free[widest], prepared, cuts, prepared.machine.values)
        if first is not None and moved(first.parameters, start):
            prepared = prepare(first.model, recordings)
            cuts = all_windows(prepared)
        done = []
        for one, items in zip(models, free, strict=True):
            begin = _beginning(prepared, one, items, every, free[widest])
            done.append(_tried(one, items, prepared, cuts, begin))
    if all(fit is None for _, fit in done):
        raise NumericsError("none of the structures can be simulated along these recordings")
    return Structured(tuple(one for one, _ in done), _evidence([fit for _, fit in done]))


def _beginning(
    prepared: Prepared,
    model: Model,
    free: Sequence[Parameter],
    every: Sequence[str],
    widest: Sequence[Parameter],
) -> Array:
    """Where the numbers of a structure begin (P,), SI: those that it fits where the structure with
    most numbers has them, the others where the ``model`` of the structure holds them."""
    stated = {item.path: item.si for item in with_channels(model).all_parameters()}
    known = {item.path for item in free} & {item.path for item in widest}
    p = prepared.machine.values.copy()
    for path in every:
        if path not in known:
            p[prepared.machine.column(path)] = stated[path]
    return np.asarray(p)


def _tried(
    model: Model,
    free: Sequence[Parameter],
    prepared: Prepared,
    cuts: tuple[Cut, ...],
    begin: Array,
) -> tuple[Calibrated | None, Fit | None]:
    try:
        return on_windows(model, free, prepared, cuts, begin)
    except NumericsError:
        return None, None


def _evidence(every: Sequence[Fit | None]) -> Array:
    """ln of the evidence of each structure (S,), less that of the likeliest."""
    fits = [fit for fit in every if fit is not None]
    price = math.log(fits[0].samples)

    def left(fit: Fit, unit: float) -> float:
        return fit.left / unit + price * fit.values.size

    unit = piece(min(fits, key=lambda fit: piece(fit) * left(fit, piece(fit))))
    logs = np.array([-math.inf if fit is None else -left(fit, unit) / 2 for fit in every])
    return np.asarray(logs - logs.max())
