"""What an optimiser asks for: a number that depends on a run, with its gradient.

    goal = Objective(rollout, squares(measured, sd))
    scipy.optimize.minimize(goal, goal.begin, jac=True)          # value and gradient
    black_box(goal.value)                                        # the value alone
    values(goal, points, threads=2)                              # many at once

Sizes: N outputs, m sensors, D numbers that vary, S points.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass

import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.optimisation.rollout import NAMES, Rollout, Slopes, varying

Cost = Callable[[Array], tuple[float, Array]]
Watch = Callable[[int, float], bool | None]


class Stopped(Exception):  # noqa: N818  # not an error: it was asked for
    """Raised where a watch asks to stop; ``at`` (D,) and ``value`` are the best so far, in the
    units of the objective."""

    def __init__(self, at: Array, value: float):
        super().__init__(f"stopped on request at the value {value:.6g}")
        self.at, self.value = at, value


@dataclass(slots=True)
class _Best:
    """What an objective has seen."""

    count: int
    at: Array
    value: float


class Objective:
    """A number that depends on a run through what its sensors record.

    ``cost`` takes y (N, m), SI, and returns the number and its slopes (N, m); ``vary`` names what
    the optimiser changes, of "free" (parameters), "start" and "inputs", one vector in this order.
    After each evaluation ``watch`` is given how many there were and the lowest value so far; if it
    returns True, the optimiser is left through
    :class:`~symhyb.optimisation.objective.Stopped`. Nothing is printed.

    Attributes:
        begin: (D,) the nominal values, SI, each divided by ``scale``.
        scale: (D,) SI value of one unit of each number: its nominal size, or 1.
    """

    def __init__(
        self,
        rollout: Rollout,
        cost: Cost,
        vary: Sequence[str] = ("free",),
        watch: Watch | None = None,
    ):
        self.rollout, self._cost, self._watch = rollout, cost, watch
        self._vary = varying(vary)
        nominal = Slopes(rollout.theta, rollout.start, rollout.inputs)
        flat = self._flat(nominal)
        self.scale = np.where(flat != 0, np.abs(flat), 1.0)
        self.begin = flat / self.scale
        self._best = _Best(0, self.begin, np.inf)

    def __call__(self, at: Array) -> tuple[float, Array]:
        """The value and its gradient (D,) per unit of each number, at ``at`` (D,); a run that
        fails has the value inf and no gradient (NaN)."""
        y, reversal = self.rollout.taped(**self.parts(at))
        value, weights = self._cost(y) if not reversal.run.reason else (np.inf, np.zeros_like(y))
        slopes = self._flat(reversal(weights)) * self.scale
        self._seen(np.asarray(at, float), value)
        return value, slopes

    def value(self, at: Array) -> float:
        """The value alone at ``at`` (D,), in units of ``scale``; inf for a run that fails."""
        value = self.quiet(at)
        self._seen(np.asarray(at, float), value)
        return value

    def quiet(self, at: Array) -> float:
        """The same without calling the watch, for any thread; ``at`` (D,) in units of ``scale``."""
        y = self.rollout(**self.parts(at))
        return self._cost(y)[0] if np.isfinite(y).all() else np.inf

    def parts(self, at: Array) -> dict[str, Array]:
        """What the rollout takes, in SI, for ``at`` (D,) in units of ``scale``."""
        rollout, parts = self.rollout, {}
        rest = np.asarray(at, float) * self.scale
        for kind in self._vary:
            shape = getattr(rollout, NAMES[kind]).shape
            size = int(np.prod(shape))
            parts[NAMES[kind]], rest = rest[:size].reshape(shape), rest[size:]
        return parts

    def _flat(self, slopes: Slopes) -> Array:
        return np.concatenate([getattr(slopes, kind).ravel() for kind in self._vary])

    def _seen(self, at: Array, value: float) -> None:
        best = self._best
        best.count += 1
        if value < best.value:
            best.at, best.value = at.copy(), value
        if self._watch is not None and self._watch(best.count, best.value):
            raise Stopped(best.at, best.value)


def squares(measured: Array, sd: Array) -> Cost:
    """½ Σ ((y − measured)/sd)² over samples and sensors, ``measured`` (N, m) SI, ``sd`` (m,) SI;
    samples that are NaN do not count."""

    def cost(y: Array) -> tuple[float, Array]:
        error = np.where(np.isnan(measured), 0.0, (y - measured) / sd)
        return float(0.5 * np.sum(error**2)), error / sd

    return cost


def values(
    objective: Objective, points: Array, threads: int = 1, watch: Watch | None = None
) -> Array:
    """The values (S,) of an objective at many ``points`` (S, D), both in its own units, on several
    threads; the numbers do not depend on how many.

    ``watch`` is given, in this thread, how many are done and the lowest so far; if it returns True,
    those that have not begun are left out (NaN)."""
    points, found = np.asarray(points, float), np.full(len(points), np.nan)
    with ThreadPoolExecutor(max(threads, 1)) as pool:
        jobs: dict[Future[float], int] = {}
        waiting, stopped = iter(range(len(points))), False
        for done in range(len(points) + 1):
            while not stopped and len(jobs) < 2 * max(threads, 1):
                i = next(waiting, None)
                if i is None:
                    break
                jobs[pool.submit(objective.quiet, points[i])] = i
            if not jobs:
                break
            ready = next(iter(wait(jobs, return_when=FIRST_COMPLETED).done))
            found[jobs.pop(ready)] = ready.result()
            if watch is not None and not stopped:
                stopped = bool(watch(done + 1, float(np.nanmin(found))))
    return found
