"""What noise alone may do to the comparison of two structures.

The initial states of the windows are free, and those of two structures fit different parts of the
noise: of a damper and a delay the free motion decays differently. With the subspaces A and B that
the initial states of a window span, nᵀ(P_A − P_B)n of white noise n has the variance 4 Σ sin²θ over
the principal angles θ between A and B (Seber & Lee, Linear Regression Analysis, 2003, for the
variance of a quadratic form).

A structure in which a sensor is late is held against samples that were taken later, by whole ones.
Where windows that are fitted end, others come in than without the delay: χ² of each has the
variance 2.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.search.conventions import RIVAL
from symhyb.correction.search.decide import Decision
from symhyb.correction.search.setting import Setting
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.recorded.windows import Laid
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

REACH = 3.0  # times the evidence at which a rival is told: further off no luck is that great


def with_luck(setting: Setting, decision: Decision) -> Decision:
    """The decision with what noise alone may do to its comparison with near rivals."""
    near = [
        trial
        for trial in decision.trials
        if trial is not decision.winner
        and trial.causes
        and not trial.fit.reason
        and decision.criterion(trial) < REACH * RIVAL
    ]
    if not near:
        return decision
    own = _views(setting, decision.winner)
    spreads = tuple((trial, _spread(own, _views(setting, trial))) for trial in near)
    return replace(decision, luck=spreads)


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """What of one recording a structure is fitted to: orthonormal bases (W, Lm, k) of what the
    initial states of every fitted window span, and the ``samples`` of every sensor."""

    bases: Array
    samples: tuple[NDArray[np.int64], ...]


def _spread(first: list[_View], second: list[_View]) -> float:
    """One deviation of Δχ², from the views of each recording."""
    variance = 0.0
    for one, other in zip(first, second, strict=True):
        a, b = one.bases, other.bases
        shared = np.sum((a.swapaxes(1, 2) @ b) ** 2, axis=(1, 2))
        variance += 4 * float(np.sum(np.maximum(min(a.shape[2], b.shape[2]) - shared, 0.0)))
        exchanged = zip(one.samples, other.samples, strict=True)
        variance += 2 * sum(np.setxor1d(mine, theirs).size for mine, theirs in exchanged)
    return float(np.sqrt(variance)) if np.isfinite(variance) else 0.0


def _views(setting: Setting, trial: Refined) -> list[_View]:
    machine = trial.machine
    model = WindowModel(machine, tuple(machine.column(path) for path in trial.paths))
    laid = setting.stages[-1].laid
    return [_view(model, item, trial, i, setting.sd) for i, item in enumerate(laid)]


def _view(model: WindowModel, item: Laid, trial: Refined, which: int, sd: Array) -> _View:
    suited = item.suited(trial.machine).in_time(model, trial.of(item.source[0]))
    step = float(np.median(np.diff(suited.block.t, axis=1)))
    rows = np.unique(item.rows[~item.held])
    late = suited.block.late or (0.0,) * sd.size
    seen = np.isfinite(suited.block.y)
    samples = tuple(
        rows + round(seconds / step) if seen[:, :, j].any() else rows[:0]
        for j, seconds in enumerate(late)
    )
    return _View(_basis(model, item, trial, which, sd), samples)


def _basis(model: WindowModel, item: Laid, trial: Refined, which: int, sd: Array) -> Array:
    suited = item.suited(trial.machine)
    if not model.form.moving:  # all motion is given: no initial state to fit
        return np.zeros((int((~item.held).sum()), 1, 0))
    start, p = trial.fit.starts[which], trial.of(item.source[0])
    suited = suited.in_time(model, p)
    with np.errstate(over="ignore", invalid="ignore"):
        reply = model.differentiate(suited.block, start, p).from_start()
    weight = np.where(np.isfinite(suited.block.y), 1 / sd, 0.0)[..., None]
    flat = (reply[..., : model.form.moving] * weight)[~suited.held]
    flat = flat.reshape(flat.shape[0], -1, flat.shape[3])
    scale = np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-300)
    return np.linalg.qr(np.nan_to_num(flat / scale))[0]
