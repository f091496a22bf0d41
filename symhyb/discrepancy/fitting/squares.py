"""How well windows are met from given initial states, and the best of several for each of them."""

from collections.abc import Sequence

import numpy as np

from symhyb.discrepancy.fitting.anchors import Anchor, anchored, off_anchor
from symhyb.discrepancy.recorded.windows import Cut
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains_source import LANES
from symhyb.numeric.runs.windows import WindowModel


def squares(
    model: WindowModel,
    item: Cut,
    p: Array,
    start: Array,
    sd: Array,
    prior: Anchor | None = None,
) -> Array:
    """Squared whitened residuals of each window (W,) that begins at ``start`` (W, X), priors
    of inner states included; ``p`` (P,) and noise ``sd`` (m,) in SI. The ``prior`` is that of the
    windows under ``p``, if it is known already."""
    with np.errstate(over="ignore", invalid="ignore"):
        _, y = model.simulate(item.block, start, p)
        residual = np.where(np.isfinite(item.block.y), item.block.y - y, 0.0)
        shown: Array = np.sum(item.white(residual[..., None], sd) ** 2, axis=(1, 2))
        if model.remembers:
            shown += off_anchor(model, start, prior or anchored(model, item, p))
        return shown


def best_of(
    model: WindowModel,
    item: Cut,
    p: Array,
    begins: Sequence[Array],
    sd: Array,
) -> tuple[Array, Array]:
    """Of several initial states (W, X) the best of each window, and its squares (W,), inf where
    none stays bounded; in SI."""
    windows = len(item.start)
    if windows < LANES:  # simulated together they cost as much as one of them
        wide = item.chosen(np.tile(np.arange(windows), len(begins)))
        shown = squares(model, wide, p, np.concatenate(begins), sd).reshape(-1, windows)
    else:
        prior = anchored(model, item, p) if model.remembers else None
        shown = np.stack([squares(model, item, p, begin, sd, prior) for begin in begins])
    costs = np.where(np.isfinite(shown), shown, np.inf)
    return np.choose(np.argmin(costs, axis=0)[:, None], begins), costs.min(axis=0)
