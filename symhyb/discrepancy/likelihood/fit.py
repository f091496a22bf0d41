"""Parameters, trajectory and noise of a structure by maximum posterior likelihood.

Gauss–Newton on parameters and trajectory together: linearise along the trajectory, whiten by the
Kalman filter, step the parameters, smooth, and again (an iterated extended Kalman smoother: Bell,
SIAM J. Optim. 4, 1994; with the noise sizes by maximum likelihood in between).
Sizes: F numbers, N samples, X states, m sensors, P parameters.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.deadline import require_time
from symhyb.discrepancy.fitting.normal import bounded_step, inverse_of
from symhyb.discrepancy.likelihood.horizon import maximised, total
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import (
    Extra,
    Track,
    smoothed,
    still,
    track,
    white_problem,
)
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

ITERATIONS = 30
HALVINGS = 4
LEAPS = 1  # whole steps that are taken though ln L falls
FAR = 2.0  # of ln L: steps that gain more are on the way
SETTLED, SETTLED_SHARE = 0.2, 1e-5  # of ln L, and a share of it: steps that gain less end the fit
SHARE = 0.01  # of what a step of the parameters gained: so exactly the noise follows
FAILED = "the likelihood is not finite along any trajectory"


@dataclass(frozen=True, slots=True)
class Task:
    """What to fit, SI: stretches ``items`` (one window each) with the number of the ``recording``
    that each is of, least white noise ``floor`` (m,), bounds ``lower`` and ``upper`` (F,), Gaussian
    priors ``mean`` and ``spread`` (F,; inf for none). ``own`` has for each recording which of the
    numbers its free parameters are, where recordings have numbers of their own; the sizes of the
    columns of ``extra`` (one for each stretch, or none) are the last numbers, shared by all."""

    items: tuple[Cut, ...]
    recording: tuple[int, ...]
    floor: Array
    lower: Array
    upper: Array
    mean: Array
    spread: Array
    own: tuple[tuple[int, ...], ...] = ()
    extra: tuple[Extra, ...] = ()

    @property
    def more(self) -> int:
        """K, how many columns the extras have."""
        return self.extra[0].force.shape[2] if self.extra else 0

    def rows(self, which: int) -> list[int]:
        """Which of the numbers are those of one recording."""
        size = self.mean.size
        mine = list(self.own[which]) if self.own else list(range(size - self.more))
        return [*mine, *range(size - self.more, size)]

    def filled(self, which: int, p: Array, free: Sequence[int], values: Array) -> Array:
        """The parameters (P,) of one recording."""
        full = p.copy()
        full[list(free)] = values[self.rows(which)[: len(free)]]
        return full

    def part(self, which: int, values: Array) -> Array:
        """The numbers of one recording among all of them (F,)."""
        return values[self.rows(which)]


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """Fitted ``values`` (F,) with ``covariance`` (F, F) and its inverse, the ``information``, SI,
    the most likely ``noise``, ``logl`` the log-likelihood and ``prior`` the χ² of the values
    against their priors, the ``states`` (N, X) of every stretch. ``logls`` is the log-likelihood
    of each stretch; ``force`` (n,) and ``colour`` (m,) are the RMS of the unknown force and of the
    coloured noise as the sensors show them (smoothed), SI. ``reason`` is empty, or why the fit
    failed."""

    values: Array
    covariance: Array
    information: Array
    noise: NoiseModel
    logl: float
    prior: float
    states: tuple[Array, ...]
    count: int
    logls: tuple[float, ...]
    force: Array
    colour: Array
    reason: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _Now:
    """Where a fit has come to: numbers (F,), trajectories, tracks along them, noise, and ln L less
    half of the prior χ²."""

    values: Array
    states: tuple[Array, ...]
    tracks: tuple[Track, ...]
    noise: NoiseModel
    score: float

    @property
    def worth(self) -> float:
        """The score less the price of the sizes of noise, ½ ln N each: fewer may be worth more."""
        count = max(sum(one.count for one in self.tracks), 2)
        return float(self.score - 0.5 * self.noise.numbers * np.log(count))


def fit(
    model: WindowModel,
    task: Task,
    p: Array,
    noise: NoiseModel,
    first: Array | None = None,
    states: Sequence[Array] | None = None,
    known_noise: bool = False,
    others: Sequence[NoiseModel] = (),
) -> Fit:
    """Fit the free parameters of ``model`` from ``p`` (P,), or all numbers from ``first`` (F,), SI.

    ``states`` (N, X) of every stretch begin the trajectories, by default the measured motion;
    ``noise`` begins the noise model, or one of ``others`` if that is likelier there once its sizes
    are fitted: sizes that are 0 in it stay 0; one that is ``known_noise`` stays as it is.
    """
    values = np.clip(p[list(model.free)] if first is None else first, task.lower, task.upper)
    begun = tuple(states or (item.states[0] for item in task.items))
    now = _at(model, task, p, values, begun, noise)
    if others:
        starts = [now, *(_under(task, now, other) for other in others)]
        now = max((_with_noise(task, one, True, 0.0) for one in starts), key=lambda one: one.worth)
    if not np.isfinite(now.score):
        return _failed(task, values, noise, begun)
    rough = not known_noise  # while parameters move far, the sizes of noise need only follow
    best, leaps, here, ahead = now, LEAPS, None, now
    for _ in range(ITERATIONS):
        require_time()
        if now is not here:  # else the step is known already
            ahead = _step(model, task, p, now) or now
        before, here = now.worth, now
        leapt = ahead is not now and ahead.score <= now.score and leaps > 0 and not rough
        now = ahead if leapt or ahead.score > now.score else now
        leaps -= leapt
        within = SHARE * max(now.score - here.score, 0.0)
        now = now if known_noise else _with_noise(task, now, rough, within)
        gained = now.worth - before
        best = max(best, now, key=lambda one: one.worth)
        enough = max(SETTLED, SETTLED_SHARE * abs(now.worth))
        if gained < enough and not (rough or leapt):
            break
        rough = rough and gained > FAR
    return _finished(task, best)


def _at(
    model: WindowModel,
    task: Task,
    p: Array,
    values: Array,
    states: tuple[Array, ...],
    noise: NoiseModel,
) -> _Now:
    tracks = []
    sizes = values[values.size - task.more :]
    for i, (item, which, x) in enumerate(zip(task.items, task.recording, states, strict=True)):
        full = task.filled(which, p, model.free, values)
        extra = task.extra[i] if task.extra else None
        tracks.append(track(model, item.in_time(model, full), x, full, extra, sizes))
    score = total(tracks, noise) - 0.5 * _prior(task, values)
    return _Now(values, states, tuple(tracks), noise, score if np.isfinite(score) else -np.inf)


def _under(task: Task, now: _Now, noise: NoiseModel) -> _Now:
    """The same under another noise."""
    score = total(now.tracks, noise) - 0.5 * _prior(task, now.values)
    return replace(now, noise=noise, score=score if np.isfinite(score) else -np.inf)


def _prior(task: Task, values: Array) -> float:
    return float(np.sum(((values - task.mean) / task.spread) ** 2))


def _normal(task: Task, now: _Now) -> tuple[Array, Array]:
    """Normal matrix (F, F) and right side (F,) of a step, priors included."""
    gram = np.diag(1 / task.spread**2)
    right = (task.mean - now.values) / task.spread**2
    for one, which in zip(now.tracks, task.recording, strict=True):
        residual, columns, _ = white_problem(one, now.noise)
        rows = task.rows(which)
        gram[np.ix_(rows, rows)] += columns.T @ columns
        right[rows] -= columns.T @ residual
    return gram, right


def _step(model: WindowModel, task: Task, p: Array, now: _Now) -> _Now | None:
    """A step of parameters and trajectory: of the whole one and its parts the largest that makes
    the posterior more likely, else the whole one; None if there is none."""
    gram, right = _normal(task, now)
    if not (np.isfinite(gram).all() and np.isfinite(right).all()):
        return None
    low, high = task.lower - now.values, task.upper - now.values
    change = bounded_step(gram, right, 0.0, low, high)
    moved = [
        smoothed(one, now.noise, task.part(which, change)).state
        for one, which in zip(now.tracks, task.recording, strict=True)
    ]
    whole: _Now | None = None
    for halving in range(HALVINGS + 1):
        share = 0.5**halving
        states = tuple(one.x + share * x for one, x in zip(now.tracks, moved, strict=True))
        trial = _at(model, task, p, now.values + share * change, states, now.noise)
        if trial.score > now.score:
            return trial
        if whole is None and np.isfinite(trial.score):
            whole = trial
    return whole


def _with_noise(task: Task, now: _Now, roughly: bool, within: float) -> _Now:
    """The same with the most likely noise, ``within`` some ln L."""
    noise, logl = maximised(now.tracks, now.noise, task.floor, roughly=roughly, within=within)
    fresh = replace(now, noise=noise, score=logl - 0.5 * _prior(task, now.values))
    return fresh if fresh.worth > now.worth else now


def _finished(task: Task, now: _Now) -> Fit:
    gram, _ = _normal(task, now)
    prior = _prior(task, now.values)
    parts = [smoothed(one, now.noise, still(one)) for one in now.tracks]
    colour = np.zeros_like(now.noise.colour)
    if now.noise.coloured:
        colour = _rms([part.colour for part in parts])
    return Fit(
        now.values,
        inverse_of(gram),
        gram,
        now.noise,
        now.score + 0.5 * prior,
        prior,
        now.states,
        sum(one.count for one in now.tracks),
        tuple(part.logl for part in parts),
        _rms([part.force for part in parts]),
        colour,
    )


def _rms(parts: Sequence[Array]) -> Array:
    """The RMS (K,) of the columns of some signals (N, K), all samples together."""
    return np.asarray(np.sqrt(np.mean(np.concatenate(parts) ** 2, axis=0)))


def _failed(task: Task, values: Array, noise: NoiseModel, states: tuple[Array, ...]) -> Fit:
    unknown, none = np.full((values.size, values.size), np.inf), np.zeros_like(noise.force)
    logls, quiet = (-np.inf,) * len(states), np.zeros_like(noise.colour)
    least = np.zeros_like(unknown)
    return Fit(values, unknown, least, noise, -np.inf, 0.0, states, 1, logls, none, quiet, FAILED)
