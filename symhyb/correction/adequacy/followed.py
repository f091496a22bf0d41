"""A decided structure along whole recordings, from the trajectories that its windows found.

The likelihood is linear about a trajectory. Where a law is steep, dry friction above all, the
smoothed motion is no such trajectory: its rates are off by far more than friction takes to turn
over, so that it shows neither when a place sticks nor which way it slides. The windows of the
search, simulated from their fitted initial states, do.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.adequacy.evidence import evidence
from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, Row, fitted
from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.discrepancy.places.hypotheses import Hypothesis
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.model.vocabulary import KINDS, steep
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.runs.windows import WindowModel

Along = tuple[Refined, Sequence[Cut]]
"""A structure as it was fitted on windows, and these."""


def followed(ground: Recorded, trial: Refined, along: Along) -> Fitted:
    """A structure fitted along whole recordings, with its evidence. One with a steep law begins
    along its windows."""
    states = trajectories(ground, *along) if steep(trial.machine.model) else None
    return likeliest(ground, trial.causes, grouped(trial), states)


def likeliest(
    ground: Recorded,
    causes: Sequence[Hypothesis],
    rows: Sequence[Row],
    states: Sequence[Array] | None = None,
) -> Fitted:
    """Causes fitted from an unknown force without memory, which finds what is steep, or from a
    slow one, which finds a force that is slow: from the likelier of the two, with its evidence.
    Beside a steep law, where the end of a fit depends on its beginning, from each of them.
    ``states`` (N, X) of every stretch begin the trajectories, in SI; ``rows`` the numbers."""
    quick, slow = ground.first_noise(), ground.first_noise(slow=True)
    if not _steep(ground, causes):
        return scored(ground, fitted(ground, causes, rows, quick, states, others=[slow]))
    found = [scored(ground, fitted(ground, causes, rows, one, states)) for one in (quick, slow)]
    return max(found, key=lambda one: one.evidence)


def part_of(ground: Recorded, trial: Fitted, stays: Callable[[Hypothesis], bool]) -> Fitted:
    """What is left of a fitted structure with the causes that stay, fitted again."""
    kept = [pair for pair in zip(trial.causes, grouped(trial), strict=True) if stays(pair[0])]
    return likeliest(ground, [cause for cause, _ in kept], [row for _, row in kept])


def fitted_on(
    ground: Recorded,
    start: Fitted,
    causes: Sequence[Hypothesis],
    rows: Sequence[Row],
    extra: Generic | None = None,
) -> Fitted:
    """Causes, and a class beside them, fitted from where the noise and the trajectories of another
    structure ended, with the evidence; ``rows`` begin the numbers, SI."""
    noise = ground.revived(start.fit.noise)
    return scored(ground, fitted(ground, causes, rows, noise, start.fit.states, extra=extra))


def _steep(ground: Recorded, causes: Sequence[Hypothesis]) -> bool:
    """Whether a law of the model, or of a cause, needs finer steps near reversals."""
    laws = (KINDS[cause.kind] for cause in causes if cause.kind in KINDS)
    return steep(ground.windows.machine.model) or any(law.steep for law in laws)


def scored(ground: Recorded, trial: Fitted) -> Fitted:
    """A fitted structure with its evidence."""
    return replace(trial, evidence=evidence(ground, trial))


def trajectories(ground: Recorded, trial: Refined, cuts: Sequence[Cut]) -> tuple[Array, ...]:
    """Trajectories (N, X) of every stretch, SI: the simulated windows, and the measured motion
    where there is none or one runs away."""
    model, found = WindowModel(trial.machine), []
    for stretch in ground.items:
        states = stretch.suited(trial.machine).states[0].copy()
        first = int(stretch.rows[0, 0])
        for item, starts in zip(cuts, trial.fit.starts, strict=True):
            if item.source[0] is not stretch.source[0]:
                continue
            suited = item.suited(trial.machine)
            with np.errstate(over="ignore", invalid="ignore"):
                x, _ = model.simulate(suited.block, starts, trial.of(item.source[0]))
            for window, rows in zip(x, suited.rows - first, strict=True):
                inside = (rows >= 0) & (rows < len(states))
                if np.isfinite(window).all():
                    states[rows[inside]] = window[inside]
        found.append(states)
    return tuple(found)
