"""What each cause is worth on unseen windows, and what is left: the unseen recordings prove."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.naming.findings import Named
from symhyb.correction.search.preparing import Prepared
from symhyb.correction.search.selection import many
from symhyb.correction.search.setting import Setting, Stage
from symhyb.correction.search.trajectory import Refined, delayed, grouped, own_values, refine
from symhyb.deadline import OutOfTimeError, within
from symhyb.discrepancy.fitting.matching import TRIAL_DECREASE, TRIAL_ITERATIONS, fit
from symhyb.discrepancy.fitting.task import Task, starts_only
from symhyb.discrepancy.recorded.runs import cut_within, has_many
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array, mean_of_seen
from symhyb.numeric.runs.windows import WindowModel
from symhyb.steps import Say, counted, silent


@dataclass(frozen=True, slots=True)
class Proof:
    """By unseen windows: the ``share`` of each effect, the ``remainder`` (both of the squared
    error before correction; None where not computable), and the mean window NRMSE ``before`` and
    ``after``."""

    shares: tuple[float | None, ...]
    remainder: float | None
    before: float
    after: float


@dataclass(frozen=True, slots=True)
class _Unseen:
    """Whitened squared error and samples on unseen windows, and NRMSE averaged over sensors."""

    cost: float
    count: float
    nrmse: float


def prove(
    prepared: Prepared,
    setting: Setting,
    final: Refined,
    stage: Stage,
    items: Sequence[Named],
    say: Say = silent,
) -> Proof:
    """Remove each reported effect once, refit the rest on the training windows, and see.

    Without unseen recordings the windows that were held out of the fit stand in for them.
    ``say`` gets each removal, counted. Of many causes in a machine of many coordinates shares are
    left out: each takes a fit of all others; and so they are where no time is left for that.
    """
    everything = tuple(range(len(final.causes)))
    with within(None):  # claims rest on it
        before = _unseen(prepared, stage, _refitted(prepared, setting, stage, final, ()))
        kept = _refitted(prepared, setting, stage, final, everything)
        after = _unseen(prepared, stage, kept)
    dear = many(final.causes) and has_many(final.machine)
    shares: list[float | None] = [None] * len(items) if dear else []
    removed = () if dear else items
    try:
        for item in counted(say, "removing each cause once, for its share", removed):
            rest = tuple(i for i in everything if i not in item.causes)
            without = _unseen(prepared, stage, _refitted(prepared, setting, stage, final, rest))
            shares.append(_ratio(without.cost - after.cost, before.cost))
    except OutOfTimeError:
        shares = [None] * len(items)  # all of them, or they could not be compared
    remainder = _ratio(max(after.cost - after.count, 0.0), before.cost) if items else None
    if final.causes and not items:
        remainder = _ratio(max(after.cost - after.count, 0.0), before.cost)
    return Proof(tuple(shares), remainder, before.nrmse, after.nrmse)


def _refitted(
    prepared: Prepared, setting: Setting, stage: Stage, final: Refined, chosen: Sequence[int]
) -> Refined:
    causes = [final.causes[i] for i in chosen]
    rows = grouped(final)
    first = [rows[j] for j in chosen]
    cuts = zip(final.fit.starts, stage.cuts, strict=True)
    here = all(len(start) == len(item.start) for start, item in cuts)  # fitted in these windows
    starts = None if final.machine.inner_states or not here else final.fit.starts
    everything = bool(prepared.holdout)
    return refine(prepared.model, causes, first, stage.cuts, setting.sd, starts, everything)


def _unseen(prepared: Prepared, stage: Stage, trial: Refined) -> _Unseen:
    """Errors of a fitted structure on the unseen recordings, or on the held windows."""
    cuts = stage.cuts
    if prepared.holdout:
        found = [cut_within(run, trial.machine, stage.length_s) for run in prepared.holdout]
        cuts = tuple(item for item in found if item is not None)
    cuts = tuple(item.suited(trial.machine) for item in cuts)
    if not cuts:
        return _Unseen(float("nan"), float("nan"), float("nan"))
    late = delayed(trial)
    model = WindowModel(trial.machine, late=late)
    residual, measured, cost, count = [], [], 0.0, 0.0
    any_held = any(item.held.any() for item in cuts)
    for item in cuts:
        p = own_values(trial, item, prepared.sd) if prepared.holdout else trial.of(item.source[0])
        item = item.in_time(model, p)
        fitted = fit(model, _still(item, prepared.sd), p)
        (start,) = fitted.starts
        chosen = np.ones(len(start), bool) if prepared.holdout or not any_held else item.held
        cost += float(fitted.chi2[chosen].sum())
        count += float(fitted.count[chosen].sum())
        _, y = model.simulate(item.block, start, p)
        shown = np.ones(len(start), bool) if prepared.holdout else item.held
        residual.append((item.block.y - y)[shown].reshape(-1, y.shape[2]))
        measured.append(item.block.y[shown].reshape(-1, y.shape[2]))
    nrmse = _nrmse(np.concatenate(residual), np.concatenate(measured))
    return _Unseen(cost, count, nrmse)


def _still(item: Cut, sd: Array) -> Task:
    """The windows of one recording with no number to fit but their initial states."""
    return replace(starts_only(item, sd), decrease=TRIAL_DECREASE, iterations=TRIAL_ITERATIONS)


def _nrmse(residual: Array, measured: Array) -> float:
    """RMSE over range, averaged over the sensors that recorded something."""
    seen = np.isfinite(measured).any(axis=0)
    if not seen.any():
        return float("nan")
    with np.errstate(invalid="ignore", over="ignore"):
        rmse = np.sqrt(mean_of_seen(residual[:, seen] ** 2))
        reach = np.nanmax(measured[:, seen], axis=0) - np.nanmin(measured[:, seen], axis=0)
        return float(np.mean(rmse / reach))


def _ratio(part: float, whole: float) -> float | None:
    ratio = part / whole if whole else float("nan")
    return float(ratio) if np.isfinite(ratio) else None
