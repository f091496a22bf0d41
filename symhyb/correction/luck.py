"""What noise alone may do to the comparison of two structures.

The initial states of the windows are free, and those of two structures fit different parts of the
noise: of a damper and a delay the free motion decays differently. With the subspaces A and B that
the initial states of a window span, nᵀ(P_A − P_B)n of white noise n has the variance 4 Σ sin²θ over
the principal angles θ between A and B (Seber & Lee, Linear Regression Analysis, 2003, for the
variance of a quadratic form).
"""

from dataclasses import replace

import numpy as np

from symhyb.correction.conventions import RIVAL
from symhyb.correction.decide import Decision
from symhyb.correction.setting import Setting
from symhyb.correction.trajectory import Refined
from symhyb.discrepancy.windows import Laid
from symhyb.numeric.buffers import Array
from symhyb.numeric.windows import WindowModel

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
    own = _bases(setting, decision.winner)
    spreads = tuple((trial, _spread(own, _bases(setting, trial))) for trial in near)
    return replace(decision, luck=spreads)


def _spread(first: list[Array], second: list[Array]) -> float:
    """One deviation of Δχ², from bases (W, Lm, k) of the fitted windows of each recording."""
    total = 0.0
    for a, b in zip(first, second, strict=True):
        shared = np.sum((a.swapaxes(1, 2) @ b) ** 2, axis=(1, 2))
        total += float(np.sum(np.maximum(min(a.shape[2], b.shape[2]) - shared, 0.0)))
    return 2 * float(np.sqrt(total)) if np.isfinite(total) else 0.0


def _bases(setting: Setting, trial: Refined) -> list[Array]:
    """Orthonormal bases of what the initial states of every fitted window span, by recording."""
    machine = trial.machine
    model = WindowModel(machine, tuple(machine.column(path) for path in trial.paths))
    laid = setting.stages[-1].laid
    return [_basis(model, item, trial, i, setting.sd) for i, item in enumerate(laid)]


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
