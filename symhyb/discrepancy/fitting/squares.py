"""How well windows are met from given initial states, and the best of several for each of them."""

from collections.abc import Sequence

import numpy as np

from symhyb.discrepancy.fitting.anchors import off_anchor
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains_source import LANES
from symhyb.numeric.runs.windows import WindowModel


def squares(model: WindowModel, item: Cut, p: Array, start: Array, sd: Array) -> Array:
    """Squared whitened residuals of each window (W,) that begins at ``start`` (W, X), off-anchor
    inner states included; ``p`` (P,) and noise ``sd`` (m,) in SI."""
    with np.errstate(over="ignore", invalid="ignore"):
        _, y = model.simulate(item.block, start, p)
        residual = np.where(np.isfinite(item.block.y), item.block.y - y, 0.0)
        shown: Array = np.sum(item.white(residual[..., None], sd) ** 2, axis=(1, 2))
        return shown + off_anchor(model, item, p, start)


def best_of(
    model: WindowModel,
    item: Cut,
    p: Array,
    begins: Sequence[Array],
    sd: Array,
    enough: Array,
    known: tuple[Array, Array] | None = None,
) -> tuple[Array, Array]:
    """Of several initial states (W, X) the best of each window, and its squares (W,), inf where
    none stays bounded. They are tried in their order, on each window until its squares fall below
    ``enough`` (W,). ``known`` are more, whose squares (W,) are at hand; in SI."""
    windows = len(item.start)
    best, costs = (begins[0], np.full(windows, np.inf)) if known is None else known
    best, costs = best.copy(), np.where(np.isfinite(costs), costs, np.inf)
    left, begins = np.arange(windows), list(begins)
    while begins and left.size:
        together = max(LANES // left.size, 1)  # simulated side by side they cost as much as one
        tried, begins = begins[:together], begins[together:]
        wide = np.tile(left, len(tried))
        cut = item if wide.size == windows == left.size else item.chosen(wide)
        starts = np.concatenate([begin[left] for begin in tried])
        shown = squares(model, cut, p, starts, sd).reshape(len(tried), left.size)
        shown = np.where(np.isfinite(shown), shown, np.inf)
        which = np.argmin(shown, axis=0)
        least = shown[which, np.arange(left.size)]
        better = least < costs[left]
        rows = left[better]
        best[rows] = np.stack(tried)[which[better], rows]
        costs[rows] = least[better]
        left = left[~(costs[left] < enough[left])]
    return best, costs
