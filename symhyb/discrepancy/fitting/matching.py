"""Trajectory matching: parameters fitted by simulation error over windows.

Every window has its own initial state, eliminated in each Gauss–Newton step by variable
projection, so a record of any length costs one sweep a step (multiple shooting: Bock 1983; the
projection: Golub & Pereyra 1973). Residuals are whitened by the measured noise.
Sizes: F free parameters, W windows, L samples a window, m sensors, X states.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import is_

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.fitting.anchors import anchored
from symhyb.discrepancy.fitting.gentle import gentle
from symhyb.discrepancy.fitting.normal import bounded_step, inverse_of
from symhyb.discrepancy.fitting.squares import best_of, squares
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.discrepancy.recorded.runs import has_many
from symhyb.discrepancy.recorded.windows import Cut, correlation_time
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


@dataclass(frozen=True, slots=True)
class _Part:
    """One recording, whitened: residual (W, L·m), by starts (W, L·m, X), by parameters
    (W, L·m, F); ``used`` (W,), True where a window determines the parameters. With constraints
    starts move along R directions only, those of ``lift`` (W, X, R)."""

    residual: Array
    by_start: Array
    by_free: Array
    used: NDArray[np.bool_]
    lift: Array | None = None

    def lifted(self, step: Array) -> Array:
        """A step of the initial states (W, X) from one along their free directions."""
        return step if self.lift is None else (self.lift @ step[..., None])[..., 0]


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
    for i in range(ROUNDS + LATE_ROUNDS):
        values, now, shown = _descended(model, task, p, values, now, shown)
        cost = _total(task, values, shown)
        now, shown = _settled(model, task, p, values, now, shown)
        timed = _in_time(model, task, p, values)
        if timed is not task:
            task, shown = timed, _shown(model, timed, p, values, now)
        elif _total(task, values, shown) >= (1 - SETTLED) * cost or i >= ROUNDS - 1:
            break
    inner = model.machine.inner_states
    return _finish(task, _linearise(model, task, p, values, now), values, now, inner)


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
) -> tuple[Array, list[Array], list[Array]]:
    """Parameters, initial states and squares (W,) of the windows of each recording after damped
    Gauss–Newton steps, while they pay."""
    damping, gained, cost = 0.0, 0.0, _total(task, values, shown)
    count = _samples(task)
    for _ in range(task.iterations):
        rough = task.rough and cost > UNEXPLAINED * count
        least = cost * (ROUGHLY if rough else task.decrease)
        parts = _linearise(model, task, p, values, now)
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
                break
            damping = max(10 * damping, 1e-3)
        if not accepted or gained <= least:
            break
    return values, now, shown


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
) -> tuple[list[Array], list[Array]]:
    """Initial states for the parameters as they stand, and the squares (W,) of the windows of each
    recording, ``begun`` of them at ``starts``. They are taken from the measured motion where that
    is better: held windows had no say in which steps were taken, and one bad one may hold up
    all."""
    now = list(starts)
    fulls = [task.filled(i, p, model.free, values) for i in range(len(now))]
    shown = []
    for i, (item, full) in enumerate(zip(task.cuts, fulls, strict=True)):
        measured = model.closed(item.block, item.start, full)
        known = now[i], begun[i]
        now[i], costs = best_of(model, item, full, (measured,), task.sd, known)
        shown.append(costs)
    for _ in range(HELD_ROUNDS):
        parts = _linearise(model, task, p, values, now)
        for i, (item, full) in enumerate(zip(task.cuts, fulls, strict=True)):
            move = _start_step(parts[i], np.zeros_like(values), 0.0)[0]
            steps = [model.closed(item.block, now[i] + x * move, full) for x in SHARES_ALONE[:-1]]
            known = now[i], shown[i]
            now[i], shown[i] = best_of(model, item, full, steps, task.sd, known)
    return now, shown


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


def _linearise(
    model: WindowModel, task: Task, p: Array, values: Array, starts: Sequence[Array]
) -> list[_Part]:
    parts = []
    for i, (item, start) in enumerate(zip(task.cuts, starts, strict=True)):
        full = task.filled(i, p, model.free, values)
        with np.errstate(over="ignore", invalid="ignore"):  # a window that runs away
            linear = model.differentiate(item.block, start, full)
            by_start, by_free = linear.from_start_and_free()
        residual = np.where(np.isfinite(item.block.y), item.block.y - linear.output, 0.0)
        used = np.ones(len(start), bool) if task.everything else ~item.held
        part = _Part(
            item.white(residual[..., None], task.sd)[..., 0],
            item.white(by_start, task.sd),
            item.white(by_free, task.sd),
            used,
            linear.begin,
        )
        part = _held_back(part, model, item, full, start)
        parts.append(_spread_out(part, task.own[i], values.size) if task.own else part)
    return parts


def _spread_out(part: _Part, own: Sequence[int], size: int) -> _Part:
    """The columns of a recording's free parameters among those of all numbers (``size``)."""
    wide = np.zeros((*part.by_free.shape[:2], size))
    wide[:, :, list(own)] = part.by_free
    return replace(part, by_free=wide)


def _held_back(part: _Part, model: WindowModel, item: Cut, p: Array, start: Array) -> _Part:
    """With one row more for each inner state, which ties its start to its prior."""
    first = 2 * len(model.form.free)
    windows, states = start.shape
    if states == first:
        return part
    anchor, inner = anchored(model, item, p, slopes=True), states - first
    columns = part.by_start.shape[2]
    by_start = np.zeros((windows, inner, columns))
    by_start[:, :, columns - inner :] = np.diag(1 / anchor.spread)
    return _Part(
        np.concatenate([part.residual, (anchor.z - start[:, first:]) / anchor.spread], axis=1),
        np.concatenate([part.by_start, by_start], axis=1),
        np.concatenate([part.by_free, -anchor.by_free / anchor.spread[:, None]], axis=1),
        part.used,
        part.lift,
    )


def _project(part: _Part) -> tuple[Array, Array, Array, Array]:
    """QR of the initial-state columns: basis, scaled triangle, scale, and [columns, residual]
    with the initial states projected out; not finite for a window that ran away."""
    with np.errstate(over="ignore", invalid="ignore"):
        scale = np.linalg.norm(part.by_start, axis=1, keepdims=True)
    scale = np.where(scale > 0, scale, 1.0)
    windows, _, states = part.by_start.shape
    ridge = np.broadcast_to(1e-7 * np.eye(states), (windows, states, states))
    basis, triangle = np.linalg.qr(np.concatenate([part.by_start / scale, ridge], axis=1))
    basis = basis[:, : part.by_start.shape[1]]
    joined = np.concatenate([part.by_free, part.residual[..., None]], axis=2)
    return basis, triangle, scale, joined - basis @ (basis.transpose(0, 2, 1) @ joined)


def _step(
    task: Task, parts: Sequence[_Part], values: Array, damping: float
) -> tuple[Array, list[Array], float]:
    """Bounded Gauss–Newton step of the parameters, and of the initial states that go with it."""
    count = values.size
    gram, right = np.diag(1 / task.spread**2), (task.mean - values) / task.spread**2
    for part in parts:
        used = _project(part)[3][part.used]
        gram = gram + np.einsum("wai,waj->ij", used[..., :count], used[..., :count])
        right = right + np.einsum("wai,wa->i", used[..., :count], used[..., count])
    change = bounded_step(gram, right, damping, task.lower - values, task.upper - values)
    predicted = float(2 * right @ change - change @ gram @ change) if change.any() else 0.0
    steps = [_start_step(part, change, damping) for part in parts]
    predicted += sum(gain for _, gain in steps)
    return change, [moved for moved, _ in steps], predicted


def _start_step(part: _Part, change: Array, damping: float) -> tuple[Array, float]:
    """Step of the initial states (W, X): their whole reply to a ``change`` of the parameters, and
    a damped one to the residual; and the decrease of the fitted windows' cost that it predicts. Not
    finite for a held window that ran away."""
    basis, triangle, scale, _ = _project(part)
    across = basis.transpose(0, 2, 1)
    share = 1 / (1 + damping)
    with np.errstate(over="ignore", invalid="ignore"):
        along = (across @ part.residual[..., None])[..., 0]
        reply = (across @ (part.by_free @ change)[..., None])[..., 0]
        solved = np.linalg.solve(triangle, (share * along - reply)[..., None])[..., 0]
    gain = (1 - (1 - share) ** 2) * float(np.sum(along[part.used] ** 2))
    return part.lifted(solved / scale[:, 0]), gain


def _finish(
    task: Task, parts: Sequence[_Part], values: Array, starts: list[Array], inner: int
) -> Fit:
    """What a fit says at the end; the last ``inner`` rows of a window tie its inner states."""
    count = values.size
    joined = [_project(part)[3] for part in parts]
    with np.errstate(over="ignore", invalid="ignore"):
        chi2 = np.concatenate([np.sum(j[..., count] ** 2, axis=1) for j in joined])
    chi2 = np.where(np.isfinite(chi2), chi2, np.inf)
    seen = np.concatenate([np.isfinite(i.block.y).sum(axis=(1, 2)) for i in task.cuts])
    held = np.concatenate([~part.used for part in parts])
    states = parts[0].by_start.shape[2] - inner
    used = [j[part.used] for j, part in zip(joined, parts, strict=True)]
    shown = [j[:, : j.shape[1] - inner, count] for j in used]
    correlation = correlation_time(shown, task.cuts[0].block.y.shape[2])
    gram = np.diag(1 / task.spread**2)
    for j in used:
        gram = gram + np.einsum("wai,waj->ij", j[..., :count], j[..., :count])
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
