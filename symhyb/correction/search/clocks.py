"""Clocks that run apart: a channel whose delay grows along a recording.

In every window the delay of a channel is a column of the linear problem along the measured motion;
its delay d and drift r are the columns c and τ·c, with τ the time since the start of the recording.
Sizes: W windows, L samples a window, m sensors.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from symhyb.correction.search.selection import solve
from symhyb.correction.search.setting import Setting, Stage, along_motion
from symhyb.discrepancy.recorded.windows import merge, reduce
from symhyb.discrepancy.results import RecordingFault
from symhyb.discrepancy.words.wording import joined, percent_text
from symhyb.judgement import (
    ALIKE,
    DRIFT_LEAST,
    DRIFT_MOST,
    LARGE,
    NEAR_NOISE,
    NOTABLE,
    SIGNIFICANT,
    SMALL,
    WINDOWS_LEAST,
)
from symhyb.model.types import Model
from symhyb.numeric.kernels.buffers import Array

RIVALS_MOST = 2
ROUNDS = 4  # of putting right: a delay of half a period is no small change
STANDS = 0.02  # of the drift: smaller changes end the rounds

Again = Callable[[tuple[RecordingFault, ...]], Setting]


@dataclass(frozen=True, slots=True)
class _Fit:
    """The drift of a channel in s/s, with χ² on fitted and held windows that a constant delay and
    a growing one leave."""

    drift: float
    constant: float
    left: float
    held_constant: float
    held_left: float
    floor: float
    held_floor: float

    def takes(self, begun: "_Fit", part: float) -> bool:
        """Whether a growing delay takes this part of what noise and a constant one left when it
        was ``begun``, on fitted and on held windows, and does so significantly."""
        pairs = (
            (begun.constant, self.left, self.floor),
            (begun.held_constant, self.held_left, self.held_floor),
        )
        return all(
            before - after > max(SIGNIFICANT, part * (before - min(floor, after)))
            for before, after, floor in pairs
        )


def drifting(setting: Setting, again: Again) -> RecordingFault | None:
    """The clock that explains most of the mismatch, if one does and no other cause comes close.

    ``again`` prepares the recordings anew with clocks put right.
    """
    stage = _stage(setting)
    every = setting.parametric
    names = [every[i].path.removesuffix(".delay") for i in _own_delays(setting)]
    first = _fits(setting, stage)
    if not first:
        return None
    best = min(range(len(names)), key=lambda i: first[i].left)
    begun = first[best]
    if not DRIFT_LEAST < abs(begun.drift) < DRIFT_MOST or not begun.takes(begun, SMALL):
        return None
    limit = max(
        ALIKE * (begun.left - begun.floor),
        NOTABLE * (begun.constant - begun.floor),
        (NEAR_NOISE - 1) * begun.floor,
    )
    near = [i for i, fit in enumerate(first) if fit.left - fit.floor < limit]
    near.sort(key=lambda i: first[i].left)
    # stretching the time of one channel or of the other differs in second order: try them
    found = [(i, *_followed(names[i], i, first[i], again)) for i in near[:RIVALS_MOST]]
    best, drift, last = min(found, key=lambda one: one[2].left + one[2].held_left)
    left = max(last.left - last.floor, (NEAR_NOISE - 1) * last.floor)
    if not last.takes(begun, 1 - LARGE) or _rival(setting, stage) - begun.floor < ALIKE * left:
        return None
    apart = {i for i, _, fit in found if fit.left - fit.floor > ALIKE * left}
    equals = [names[i] for i in near if i != best and i not in apart]
    return _named(setting.windows.machine.model, names[best], drift, equals)


def _followed(name: str, index: int, begun: _Fit, again: Again) -> tuple[float, _Fit]:
    """The drift of one channel, put right and measured anew until it stands, and the last fit."""
    drift, last = begun.drift, begun
    for _ in range(ROUNDS):
        fits = _fits(*_staged(again((RecordingFault("clock", (name,), drift, claimed=True),))))
        if not fits:
            break
        last = fits[index]
        drift += last.drift
        if abs(last.drift) < STANDS * abs(drift):
            break
    return drift, last


def _stage(setting: Setting) -> Stage:
    return setting.stages[min(1, len(setting.stages) - 1)]


def _staged(setting: Setting) -> tuple[Setting, Stage]:
    return setting, _stage(setting)


def _fits(setting: Setting, stage: Stage) -> list[_Fit]:
    """The drift of every channel, fitted by itself; none where too few windows show one."""
    delays = _own_delays(setting)
    grams, held, times, count = _windows(setting, stage, delays)
    if times.size < WINDOWS_LEAST or not held.any() or not np.isfinite(grams).all():
        return []
    return [_fitted(grams[:, [[i], [-1]], [i, -1]], held, times, count) for i in range(len(delays))]


def _own_delays(setting: Setting) -> list[int]:
    """The delays of channels by themselves, by their place among the parametric causes."""
    every = enumerate(setting.parametric)
    return [i for i, cause in every if cause.kind == "delay" and not cause.options]


def _fitted(grams: Array, held: NDArray[np.bool_], times: Array, count: NDArray[np.int64]) -> _Fit:
    """Fit delay and drift; ``grams`` (W, 2, 2) of the delay and the residual, ``times`` (W,), s."""
    inner, cross, power = grams[:, 0, 0], grams[:, 0, 1], grams[:, 1, 1]
    moments = [float((inner * times**k)[~held].sum()) for k in range(3)]
    right = [float((cross * times**k)[~held].sum()) for k in range(2)]
    constant = right[0] / moments[0] if moments[0] > 0 else 0.0
    matrix = np.array([[moments[0], moments[1]], [moments[1], moments[2]]])
    scale = np.sqrt(np.maximum(np.diag(matrix), 1e-300))
    solved = np.linalg.lstsq(matrix / np.outer(scale, scale), np.array(right) / scale, rcond=None)
    delay, drift = (float(value) for value in solved[0] / scale)

    def left(first: float, slope: float, rows: NDArray[np.bool_]) -> float:
        d = first + slope * times
        return float((power - 2 * d * cross + d**2 * inner)[rows].sum())

    return _Fit(
        drift,
        left(constant, 0, ~held),
        left(delay, drift, ~held),
        left(constant, 0, held),
        left(delay, drift, held),
        float(count[~held].sum()),
        float(count[held].sum()),
    )


def _windows(
    setting: Setting, stage: Stage, delays: Sequence[int]
) -> tuple[Array, NDArray[np.bool_], Array, NDArray[np.int64]]:
    """Grams (W, D + 1, D + 1) of the delays and the residual, held flags, times since the start of
    the recording in s, and counts (W,)."""
    model, parts, times = setting.windows, [], []
    for item in stage.cuts:
        item = item.suited(model.machine)
        linear = model.along(item.block, item.states, model.machine.values)
        residual = item.block.y - linear.output - linear.from_defect()
        starts = linear.from_start()[..., : model.form.moving]
        columns = linear.from_free()[..., list(delays)]
        parts.append(reduce(item, residual, starts, columns, setting.sd))
        times.append(item.block.t.mean(axis=1) - item.source[0].t[0])
    grams, count, held = merge(parts)
    return grams, held, np.concatenate(times), count


def _rival(setting: Setting, stage: Stage) -> float:
    """χ² of the fitted windows that the best single cause leaves."""
    problem = along_motion(setting, stage)
    found = [solve(problem, (i,)) for i in range(len(problem.hypotheses))]
    return min((one.chi2 for one in found if one is not None), default=np.inf)


def _named(model: Model, best: str, drift: float, equals: Sequence[str]) -> RecordingFault:
    """A clock that is claimed: ``drift`` is how much the delay of ``best`` grows, s/s; ``equals``
    would show in the same way."""
    rivals = tuple(RecordingFault("clock", (other,), drift) for other in equals)
    sentence = f"the clocks of {joined([best, *equals])} run apart by {percent_text(abs(drift))}"
    if not equals:
        speed = drift if best in {sensor.name for sensor in model.sensors} else -drift
        way = "fast" if speed > 0 else "slow"
        sentence = f"the clock of {best} runs {percent_text(abs(speed))} {way} against all others"
    return RecordingFault("clock", (best,), drift, "", True, sentence, rivals)
