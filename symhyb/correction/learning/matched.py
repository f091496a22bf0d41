"""Learned elements held against simulations: values refined, terms dropped, worth on held windows.

What a regression says of forces is not yet what a simulation needs: noise of the motion biases it,
and correlated columns share. Here the coefficients are fitted by simulation error over windows,
initial states projected out. A term stays where dropping it would cost more than an extended
Bayesian information criterion allows, (value/sd)² > ln N + 2 ln T for N independent samples and T
candidates (Chen & Chen, Biometrika 95, 2008), and all of it stays only where windows that nothing
was fitted to are significantly better than without.
Sizes: F free values.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symhyb.correction.search.preparing import Prepared, last_windows
from symhyb.discrepancy.fitting.matching import fit
from symhyb.discrepancy.fitting.task import Fit, Task
from symhyb.judgement import SIGNIFICANT
from symhyb.model.types import Element
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import build
from symhyb.numeric.runs.windows import WindowModel


@dataclass(frozen=True, slots=True)
class Worth:
    """What held windows say: χ² per sample with nothing and with what was learned (NaN where it
    cannot be simulated), and whether the latter is significantly better."""

    nothing: float
    learned: float
    better: bool


@dataclass(frozen=True, slots=True)
class Signs:
    """The parameters to fit, by path, and which of them may not become negative."""

    paths: tuple[str, ...]
    positive: tuple[bool, ...]


def matched(
    prepared: Prepared, elements: Sequence[Element], free: Signs, everything: bool = False
) -> Fit:
    """Fit parameters of more ``elements`` by simulation error; with ``everything`` to all windows,
    else to those that are not held. Values and covariance (F,) in SI."""
    whole = replace(prepared.model, elements=(*prepared.model.elements, *elements))
    machine = build(whole, keep=False)
    columns = tuple(machine.column(path) for path in free.paths)
    cuts = tuple(item.suited(machine) for item in last_windows(prepared, spread=not everything))
    lower = np.where(free.positive, 0.0, -np.inf) if columns else np.zeros(0)
    count = len(columns)
    task = Task(
        cuts,
        prepared.sd,
        lower,
        np.full(count, np.inf),
        np.zeros(count),
        np.full(count, np.inf),
        everything=everything,
    )
    with np.errstate(over="ignore", invalid="ignore"):
        return fit(WindowModel(machine, columns), task, machine.values)


def worth(prepared: Prepared, nothing: Fit, learned: Fit) -> Worth:
    """Whether held windows are better with what was learned, by ten units of χ² of independent
    samples; a unit is not smaller than the noise, for below it nothing is known."""
    count = max(float(nothing.count[nothing.held].sum()), 1.0)
    if learned.reason:
        return Worth(nothing.validation / count, float("nan"), False)
    unit = max(learned.scale, 1.0) * learned.correlation
    gain = (nothing.validation - learned.validation) / unit
    return Worth(nothing.validation / count, learned.validation / count, bool(gain > SIGNIFICANT))


def weakest(found: Fit, tried: int) -> int | None:
    """The value whose loss costs least, if the criterion would rather be without it."""
    sd = np.sqrt(np.diag(found.covariance))
    size: Array = np.square(found.values / np.where(sd > 0, sd, np.inf))
    least = int(np.argmin(size))
    return least if size[least] < price_of(found, tried) else None


def price_of(found: Fit, tried: int) -> float:
    """What a term must take off χ², in units of χ² of an independent sample."""
    samples = float(found.count[~found.held].sum()) / found.correlation
    return float(np.log(max(samples, 2.0)) + 2 * np.log(max(tried, 1)))
