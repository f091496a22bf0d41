"""A structure (a set of causes) fitted on trajectories, at full nonlinearity.

The model with its candidate elements is an ordinary model; its terms, the shapes that are worth a
number and the dull parameters are fitted by :mod:`symhyb.discrepancy.matching`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.discrepancy.hypotheses import GAIN_REACH, Hypothesis
from symhyb.discrepancy.matching import TRIAL_DECREASE, TRIAL_ITERATIONS, Fit, Task, fit
from symhyb.discrepancy.windows import Laid
from symhyb.model.types import Element, Model
from symhyb.numeric.buffers import Array
from symhyb.numeric.machine import Machine, build
from symhyb.numeric.windows import WindowModel

DELAY_REACH = 30  # samples, either way


@dataclass(frozen=True, slots=True)
class Refined:
    """A fitted structure: its causes, the lowered model, the parameter columns of each number
    (``paths``), the full parameter vector ``p`` (P,) in SI with the fitted values,
    and the fit."""

    causes: tuple[Hypothesis, ...]
    machine: Machine
    paths: tuple[str, ...]
    p: Array
    fit: Fit
    accuracy: float = 0.0

    @property
    def numbers(self) -> int:
        """How many numbers were fitted."""
        return len(self.paths)

    def value(self, path: str) -> tuple[float, float]:
        """Fitted value and one standard deviation of a parameter, SI; the relative ``accuracy``
        of the numerics is part of the deviation of a force, not of a time or a place."""
        i = self.paths.index(path)
        value, spread = float(self.fit.values[i]), float(np.sqrt(self.fit.covariance[i, i]))
        if path.rpartition(".")[2] in EXACT:
            return value, spread
        return value, float(np.hypot(spread, self.accuracy * abs(value)))


EXACT = ("frequency", "period", "phase", "delay", "clearance")  # keys that no gain can feign


def element_name(index: int) -> str:
    """Name of the element of the i-th cause while it is on trial."""
    return f"cause{index}"


def refine(
    model: Model,
    causes: Sequence[Hypothesis],
    start: Sequence[Mapping[str, float]],
    laid: Sequence[Laid],
    sd: Array,
    starts: Sequence[Array] | None = None,
    everything: bool = False,
    careful: bool = False,
) -> Refined:
    """Fit the causes on windows; ``start`` has the first guess of each cause by key, SI (of a
    parameter its change under "value").

    ``model`` states its channels' gains and offsets (:func:`with_channels`); ``starts`` are initial
    states (W, X) of each recording to begin with; ``everything`` fits the held windows too;
    ``careful`` iterates until the values stand.
    """
    elements: list[Element] = []
    for i, cause in enumerate(causes):
        if cause.place is not None:
            elements.append(cause.element(model, element_name(i), start[i]))
    extended = replace(model, elements=(*model.elements, *elements))
    machine = build(extended, keep=False)
    paths = tuple(path for i, cause in enumerate(causes) for path in _paths(i, cause))
    free = tuple(machine.column(path) for path in paths)
    p = machine.values.copy()
    for i, cause in enumerate(causes):
        if cause.place is None:
            p[machine.column(cause.path)] += start[i]["value"]
    laid = [item.suited(machine) for item in laid]
    step = float(np.median(np.diff(laid[0].block.t, axis=1)))
    lower, upper, mean, spread = _limits(machine, causes, step)
    task = Task(tuple(laid), sd, lower, upper, mean, spread, everything)
    if not careful:
        task = replace(task, decrease=TRIAL_DECREASE, iterations=TRIAL_ITERATIONS)
    begun = None if starts is None else [_begun(*pair) for pair in zip(laid, starts, strict=True)]
    fitted = fit(WindowModel(machine, free), task, p, begun)
    p[list(free)] = fitted.values
    return Refined(tuple(causes), machine, paths, p, fitted)


def _begun(item: Laid, start: Array) -> Array:
    """Initial states of another structure for windows of this one, which may have other inner
    states."""
    full = item.start.copy()
    shared = min(full.shape[1], start.shape[1])
    full[:, :shared] = start[:, :shared]
    return full


def grouped(trial: Refined) -> list[dict[str, float]]:
    """Fitted values by key, SI, cause by cause; of a parameter its change."""
    rows, i = [], 0
    for cause in trial.causes:
        values = [float(v) for v in trial.fit.values[i : i + cause.numbers]]
        if cause.place is None:
            declared = trial.machine.values[trial.machine.column(cause.path)]
            rows.append({"value": values[0] - float(declared)})
        else:
            rows.append(dict(zip(cause.keys, values, strict=True)))
        i += cause.numbers
    return rows


def _paths(index: int, cause: Hypothesis) -> list[str]:
    if cause.place is None:
        return [cause.path]
    return [f"{element_name(index)}.{key}" for key in cause.keys]


def _limits(
    machine: Machine, causes: Sequence[Hypothesis], step: float
) -> tuple[Array, Array, Array, Array]:
    """Bounds, prior means and prior deviations of the fitted numbers, SI; samples lie ``step``
    seconds apart."""
    declared = {item.path: item for item in machine.model.all_parameters()}
    rows: list[tuple[float, float, float, float]] = []
    for cause in causes:
        if cause.place is None:
            value, sd = declared[cause.path].si, declared[cause.path].si_sd
            low, high = 1e-6 * value if cause.positive[0] else -np.inf, np.inf
            if cause.kind == "gain":
                reach = GAIN_REACH * abs(value)
                low, high = value - reach, value + reach
            if cause.kind == "delay":
                low, high = value - DELAY_REACH * step, value + DELAY_REACH * step
            rows.append((low, high, value, np.inf if sd is None else sd))
            continue
        rows += [(*cause.limits(key), 0.0, np.inf) for key in cause.keys]
    if not rows:
        empty = np.zeros(0)
        return empty, empty, empty, empty
    lower, upper, mean, spread = (np.array(column) for column in zip(*rows, strict=True))
    return lower, upper, mean, spread
