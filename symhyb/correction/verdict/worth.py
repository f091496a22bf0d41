"""What found effects amount to along the recordings, and how their fitted numbers trade off."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from symhyb.correction.naming.findings import Named
from symhyb.correction.search.strength import element_forces
from symhyb.correction.search.trajectory import Refined
from symhyb.discrepancy.evidence import Correlations, Worth, correlation_of
from symhyb.discrepancy.recorded.runs import Run
from symhyb.model.vocabulary import KINDS
from symhyb.numeric.kernels.buffers import Array


def worth_of(final: Refined, items: Sequence[Named], runs: Sequence[Run]) -> tuple[Worth, ...]:
    """The worth of each effect along all ``runs``. An element dissipates what its forces take from
    the motion, over whole runs; a spring or a weight, which give it back, dissipate nothing."""
    causes = [i for i, cause in enumerate(final.causes) if cause.place is not None]
    own = len(final.machine.model.elements) - len(causes)
    groups = [[own + causes.index(i) for i in item.causes] for item in items]
    columns = [[e] for e in range(own)] + groups
    elements = final.machine.model.elements
    lossy = [KINDS[elements[members[0]].kind].energy != "conservative" for members in columns]
    taken, peaks = np.zeros(len(columns)), np.zeros((len(columns), final.machine.n))
    for run in runs:
        forces, _, _ = element_forces(final, run.recording, run.motion)
        for row, members in enumerate(columns):
            force = forces[:, :, members].sum(axis=2)
            power = np.sum(force * run.motion.v, axis=1)
            taken[row] -= lossy[row] * float(np.trapezoid(power, run.motion.t))
            peaks[row] = np.maximum(peaks[row], np.abs(force).max(axis=0))
    return tuple(_worth(taken, peaks, own + row, final.machine.free) for row in range(len(groups)))


def _worth(taken: Array, peaks: Array, row: int, free: Sequence[int]) -> Worth:
    """The worth of one row of what is ``taken`` (R,) from the motion, J, by forces with ``peaks``
    (R, n), SI."""
    lost = np.maximum(taken, 0.0)
    energy = float(lost[row] / lost.sum()) if lost[row] > 0 else None
    i = max(free, key=lambda j: float(peaks[row, j]), default=None)
    if i is None or not np.isfinite(peaks[:, i]).all() or peaks[row, i] <= 0:
        return Worth(energy, None)
    return Worth(energy, float(peaks[row, i] / peaks[:, i].max()))


def correlation_matrix(final: Refined) -> Array:
    """The correlations (F, F) of the numbers of a fitted structure, dimensionless."""
    size = len(final.paths)
    return correlation_of(final.fit.covariance[:size, :size])


def law_spread(final: Refined, run: Run, first: int, law: Array) -> Array | None:
    """One standard deviation (N, n), SI, of what the elements from number ``first`` on exert along
    a run (``law``, (N, n)), from that of their numbers; None where these have none."""
    matrix = correlation_matrix(final)
    if not final.paths or not np.isfinite(matrix).all():
        return None
    moves = []
    for path in final.paths:
        p = final.of(run.recording).copy()
        p[final.machine.column(path)] += final.value(path)[1]
        moved = replace(final, p=p, each=())
        forces = element_forces(moved, run.recording, run.motion)[0]
        moves.append(forces[:, :, first:].sum(axis=2) - law)
    spread = Correlations(final.paths, matrix).spread(np.array(moves))
    return spread if np.isfinite(spread).all() else None
