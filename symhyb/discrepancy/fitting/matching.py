"""Trajectory matching: parameters fitted by simulation error over windows.

Every window has its own initial state, eliminated in each Gauss–Newton step by variable
projection, so a record of any length costs one sweep a step (multiple shooting: Bock 1983; the
projection: Golub & Pereyra 1973). Residuals are whitened by the measured noise.
Sizes: F free parameters, W windows, L samples a window, m sensors, X states.
"""

from collections.abc import Sequence
from dataclasses import replace
from operator import is_

import numpy as np
from numpy.typing import NDArray

from symhyb.deadline import require_time
from symhyb.discrepancy.fitting.gentle import gentle
from symhyb.discrepancy.fitting.normal import bounded_step, inverse_of
from symhyb.discrepancy.fitting.projection import Projected, projected
from symhyb.discrepancy.fitting.squares import best_of, squares
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.recorded.runs import has_many
from symhyb.discrepancy.recorded.windows import correlation_time
from symhyb.judgement import PIECES, UNEXPLAINED
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

TRIAL_DECREASE = 1e-4
TRIAL_ITERATIONS = 7  # a structure that needs more is not close
ROUGHLY = 0.1 / PIECES  # of the cost, where it is no noise: a tenth of what the score counts in
DAMPING_MOST = 1e8
UNBOUNDED = "the simulation grew without bound"
SHARES = (1.0, 0.0)  # of the step of a window's initial state: the best is taken
SHARES_ALONE = (1.0, 0.3, 0.0)  # where no parameter moves with it; the last is no step
HELD_ROUNDS = 2  # of steps for the initial states alone, when the parameters stand
ROUNDS = 3  # of both
LATE_ROUNDS = 3  # more, where the delay of a sensor moves by samples
SETTLED = 0.01  # of the cost: if settling takes more, the parameters move again


def fit(model: WindowModel, task: Task, p: Array, starts: Sequence[Array] | None = None) -> Fit:
    """Fit the free parameters of ``model`` from ``p`` (P,) in SI by damped Gauss–Newton steps.

    Initial states start at ``starts`` (W, X) of each recording (default: those of the smoothed
    motion) and are fitted on every window, parameters on those that are not held. With dry friction
    they begin where gentle friction ends, unless they explain the windows already, or are those of
    another fit of a machine of many coordinates, whose runs are dear.
    """
    first = p[list(model.free)] if task.first is None else task.first
    values = np.clip(first, task.lower, task.upper)
    begun = list(starts or [item.start for item in task.cuts])
    near = starts is not None and has_many(model.machine)
    softer = None if near else gentle(model.machine, task.cuts, p)
    if softer is not None and not _explained(model, task, p, values, begun):
        found = _fitted(model, task, softer.p, values, begun)
        if not found.reason:
            begun = list(found.starts)
            kept = [column in softer.kept for column in model.free]
            values = values if task.own else np.where(kept, values, found.values)
    return _fitted(model, task, p, values, begun)


def _explained(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> bool:
    """Whether all windows, held ones too, are met down to a few times their noise as they begin."""
    count = _samples(task)
    cost = _cost(model, replace(task, everything=True), p, values, starts)
    return bool(cost < UNEXPLAINED * count)


def _samples(task: Task) -> int:
    """How many measurements all windows hold."""
    return sum(int(np.isfinite(item.block.y).sum()) for item in task.cuts)


def _fitted(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> Fit:
    """Parameters from ``values`` and initial states from ``starts``, fitted as they are."""
    now = _on_constraints(model, task, p, values, starts)
    task = _in_time(model, task, p, values)
    shown = _shown(model, task, p, values, now)
    if not np.isfinite(_total(task, values, shown)):
        return _failed(task, now, values)
    parts: list[Projected] | None = None
    for i in range(ROUNDS + LATE_ROUNDS):
        values, now, shown, parts = _descended(model, task, p, values, now, shown, parts)
        cost = _total(task, values, shown)
        parts = parts or _linearised(model, task, p, values, now)
        now, shown, parts = _settled(model, task, p, values, now, shown, parts)
        timed = _in_time(model, task, p, values)
        if timed is not task:
            task, shown, parts = timed, _shown(model, timed, p, values, now), None
        elif _total(task, values, shown) >= (1 - SETTLED) * cost or i >= ROUNDS - 1:
            break
    parts = parts or _linearised(model, task, p, values, now)
    return _finish(task, parts, values, now, model.machine.inner_states)


def _in_time(model: WindowModel, task: Task, p: Array, values: Array) -> Task:
    """The task with signals of late sensors in time with the model; itself where they are."""
    full = (task.filled(i, p, model.free, values) for i in range(len(task.cuts)))
    cuts = tuple(item.in_time(model, one) for item, one in zip(task.cuts, full, strict=True))
    return task if all(map(is_, cuts, task.cuts)) else replace(task, cuts=cuts)


def _on_constraints(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> list[Array]:
    """Initial states moved onto the constraints of the machine, if it has any."""
    return [
        model.closed(item.block, start, task.filled(i, p, model.free, values))
        for i, (item, start) in enumerate(zip(task.cuts, starts, strict=True))
    ]


def _descended(
    model: WindowModel,
    task: Task,
    p: Array,
    values: Array,
    now: list[Array],
    shown: list[Array],
    parts: list[Projected] | None,
) -> tuple[Array, list[Array], list[Array], list[Projected] | None]:
    """Parameters, initial states and squares (W,) of the windows of each recording after damped
    Gauss–Newton steps, while they pay. ``parts`` are the windows linearised where they begin, and
    where they end, if that is known."""
    damping, gained, cost = 0.0, 0.0, _total(task, values, shown)
    count = _samples(task)
    for _ in range(task.iterations):
        require_time()
        rough = task.rough and cost > UNEXPLAINED * count
        least = cost * (ROUGHLY if rough else task.decrease)
        parts = parts or _linearised(model, task, p, values, now)
        accepted = False
        while damping <= DAMPING_MOST:
            change, moved, predicted = _step(task, parts, values, damping)
            if predicted <= least:
                break
            trial = values + change
            ahead, met = _tried(model, task, p, trial, now, moved)
            after = _total(task, trial, met)
            if after < cost:
                accepted, damping = True, damping / 10 if damping > 1e-4 else 0.0
                gained, values, now, shown, cost = cost - after, trial, ahead, met, after
                parts = None
                break
            damping = max(10 * damping, 1e-3)
        if not accepted or gained <= least:
            break
    return values, now, shown, parts


def _tried(
    model: WindowModel,
    task: Task,
    p: Array,
    values: Array,
    starts: Sequence[Array],
    moved: Sequence[Array],
) -> tuple[list[Array], list[Array]]:
    """Initial states and squares (W,) of the windows of each recording after a step; a window that
    it would throw off stays where it is, or takes a part of it."""
    chosen, shown = [], []
    for i, (item, start, move) in enumerate(zip(task.cuts, starts, moved, strict=True)):
        full = task.filled(i, p, model.free, values)
        shares = SHARES if values.size else SHARES_ALONE
        begins = [model.closed(item.block, start + share * move, full) for share in shares]
        best, costs = best_of(model, item, full, begins, task.sd)
        chosen.append(best)
        shown.append(costs)
    return chosen, shown


def _settled(
    model: WindowModel,
    task: Task,
    p: Array,
    values: Array,
    starts: Sequence[Array],
    begun: Sequence[Array],
    parts: Sequence[Projected],
) -> tuple[list[Array], list[Array], list[Projected]]:
    """Initial states for the parameters as they stand, the squares (W,) of the windows of each
    recording, ``begun`` of them at ``starts``, and the ``parts`` there. They are taken from the
    measured motion where that is better: held windows had no say in which steps were taken, and one
    bad one may hold up all."""
    now, shown, found = list(starts), list(begun), list(parts)
    for i, item in enumerate(task.cuts):
        full = task.filled(i, p, model.free, values)
        tried, some = np.arange(len(item.start)), item
        begins = [model.closed(item.block, item.start, full)]
        for _ in range(1 + HELD_ROUNDS):
            best, costs = best_of(model, some, full, begins, task.sd)
            better = costs < (1 - task.decrease) * shown[i][tried]
            fresh = tried[better]
            if fresh.size:
                now[i] = _put(now[i], fresh, best[better])
                shown[i] = _put(shown[i], fresh, costs[better])
                part = _part(model, task, i, p, values, now[i][fresh], fresh)
                found[i] = found[i].with_rows(fresh, part)
            move, gain = found[i].start_step(np.zeros_like(values), 0.0)
            tried = np.flatnonzero(gain > task.decrease * shown[i])  # others gain nothing
            if not tried.size:
                break
            some = item.chosen(tried)
            ahead = (now[i][tried] + share * move[tried] for share in SHARES_ALONE[:-1])
            begins = [model.closed(some.block, start, full) for start in ahead]
    return now, shown, found


def _put(whole: Array, rows: NDArray[np.int64], values: Array) -> Array:
    """A copy of an array with other rows."""
    changed = whole.copy()
    changed[rows] = values
    return changed


def _cost(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> float:
    """Squared whitened residuals of the fitted windows, plus the prior."""
    return _total(task, values, _shown(model, task, p, values, starts))


def _shown(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> list[Array]:
    """Squared whitened residuals of the windows (W,) of each recording."""
    return [
        squares(model, item, task.filled(i, p, model.free, values), start, task.sd)
        for i, (item, start) in enumerate(zip(task.cuts, starts, strict=True))
    ]


def _total(task: Task, values: Array, shown: Sequence[Array]) -> float:
    """The squares (W,) of the windows of each recording, of those that are fitted, plus the prior;
    inf where one does not stay bounded."""
    total = _prior(task, values)
    for item, costs in zip(task.cuts, shown, strict=True):
        total += float(np.sum(costs if task.everything else costs[~item.held]))
    return total if np.isfinite(total) else np.inf


def _prior(task: Task, values: Array) -> float:
    """χ² of the values against what was known of them before."""
    return float(np.sum(((values - task.mean) / task.spread) ** 2))


def _linearised(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> list[Projected]:
    """The windows of each recording, linearised."""
    every = (np.arange(len(start)) for start in starts)
    return [
        _part(model, task, i, p, values, start, which)
        for i, (start, which) in enumerate(zip(starts, every, strict=True))
    ]


def _part(
    model: WindowModel,
    task: Task,
    i: int,
    p: Array,
    values: Array,
    start: Array,
    which: NDArray[np.int64],
) -> Projected:
    """The windows ``which`` of a recording, linearised, all numbers among their columns."""
    full = task.filled(i, p, model.free, values)
    item = task.cuts[i] if which.size == len(task.cuts[i].start) else task.cuts[i].chosen(which)
    part = projected(model, item, full, start, task.sd)
    return part.spread_out(task.own[i], values.size) if task.own else part


def _step(
    task: Task, parts: Sequence[Projected], values: Array, damping: float
) -> tuple[Array, list[Array], float]:
    """Bounded Gauss–Newton step of the parameters, of the initial states that go with it, and the
    decrease of the cost that it predicts."""
    count = values.size
    gram, right = np.diag(1 / task.spread**2), (task.mean - values) / task.spread**2
    for part, item in zip(parts, task.cuts, strict=True):
        used = part.rest[task.used(item)]
        gram = gram + np.einsum("wai,waj->ij", used[..., :count], used[..., :count])
        right = right + np.einsum("wai,wa->i", used[..., :count], used[..., count])
    change = bounded_step(gram, right, damping, task.lower - values, task.upper - values)
    predicted = float(2 * right @ change - change @ gram @ change) if change.any() else 0.0
    moved = []
    for part, item in zip(parts, task.cuts, strict=True):
        step, gain = part.start_step(change, damping)
        moved.append(step)
        predicted += float(np.sum(gain[task.used(item)]))
    return change, moved, predicted


def _finish(
    task: Task, parts: Sequence[Projected], values: Array, starts: list[Array], inner: int
) -> Fit:
    """What a fit says at the end; the last ``inner`` rows of a window tie its inner states."""
    count = values.size
    with np.errstate(over="ignore", invalid="ignore"):
        chi2 = np.concatenate([np.sum(part.rest[..., count] ** 2, axis=1) for part in parts])
    chi2 = np.where(np.isfinite(chi2), chi2, np.inf)
    seen = np.concatenate([np.isfinite(i.block.y).sum(axis=(1, 2)) for i in task.cuts])
    held = np.concatenate([~task.used(item) for item in task.cuts])
    states = parts[0].scale.shape[1] - inner
    used = [part.rest[task.used(item)] for part, item in zip(parts, task.cuts, strict=True)]
    shown = [rest[:, : rest.shape[1] - inner, count] for rest in used]
    correlation = correlation_time(shown, task.cuts[0].block.y.shape[2])
    gram = np.diag(1 / task.spread**2)
    for rest in used:
        gram = gram + np.einsum("wai,waj->ij", rest[..., :count], rest[..., :count])
    if not np.isfinite(gram).all():
        return _failed(task, starts, values)
    degrees = max(float((seen - states)[~held].sum()) - count, 1.0)
    floor = max(item.floor for item in task.cuts)
    scale = max(float(chi2[~held].sum()) / degrees, floor)
    covariance = inverse_of(gram) * scale * correlation
    return Fit(
        values,
        covariance,
        chi2,
        seen - states,
        held,
        correlation,
        tuple(starts),
        floor=floor,
        prior=_prior(task, values),
    )


def _failed(task: Task, starts: list[Array], values: Array) -> Fit:
    seen = np.concatenate([np.isfinite(item.block.y).sum(axis=(1, 2)) for item in task.cuts])
    held = np.concatenate([item.held for item in task.cuts])
    worst, unknown = np.full(seen.size, np.inf), np.full((values.size, values.size), np.inf)
    return Fit(values, unknown, worst, seen, held, 1.0, tuple(starts), UNBOUNDED)
