"""Where the mismatch sits: how much of it any smooth force of one place's own motion explains.

For every place a force surface over (stretch, rate), piecewise linear in both, is fitted to the
linearised windows and judged on windows that were held out. Sizes: W windows, L samples.
"""

from collections.abc import Sequence

import numpy as np

from symhyb.discrepancy.hypotheses import Library
from symhyb.discrepancy.results import Activity, PlaceShare
from symhyb.discrepancy.windows import Laid, merge, reduce
from symhyb.numeric.buffers import Array
from symhyb.numeric.windows import WindowModel

KNOTS = (5, 9)  # of the surface along stretch and rate
RIDGE = 1e-4  # of the mean column power
ACTIVE_SHARE = 0.1  # of the largest force: acting


def locate(
    library: Library, model: WindowModel, laid: Sequence[Laid], p: Array, sd: Array
) -> tuple[PlaceShare, ...]:
    """The map of places, each with the explained share on held windows and where it is active.

    ``p`` (P,) and ``sd`` (m,) in SI. The share is None where no window is held or nothing is left.
    """
    laid = [item.suited(model.machine) for item in laid]
    linears = [model.along(item.block, item.states, p) for item in laid]
    result = []
    for index, place in enumerate(library.places):
        motions = [_motion(library, item, index) for item in laid]
        corners = [knots([m[i] for m in motions], KNOTS[i]) for i in (0, 1)]
        parts, surfaces = [], []
        for item, linear, (stretch, rate, unit) in zip(laid, linears, motions, strict=True):
            basis = surface(stretch, rate, corners)
            forces = unit[..., None] * basis[:, :, None, :]
            residual = item.block.y - linear.output - linear.from_defect()
            columns = linear.from_forces(forces)
            parts.append(reduce(residual, linear.from_start(), columns, sd, item.held))
            surfaces.append(basis)
        grams, count, held = merge(parts)
        values = _ridge(grams[~held].sum(axis=0))
        share = explained(grams[held].sum(axis=0), values, float(count[held].sum()))
        acting = [surface @ values for surface in surfaces]
        active = _activity(laid, motions, acting) if share and share > ACTIVE_SHARE else None
        result.append(PlaceShare(place, share, active))
    return tuple(sorted(result, key=lambda item: -(item.explained or 0.0)))


def activity(t: Array, stretch: Array, rate: Array, force: Array) -> Activity | None:
    """Where and when a force (N,) acts: ranges of stretch and rate (N,) SI, spans of time (s)."""
    size = np.abs(force)
    acting = size > ACTIVE_SHARE * np.quantile(size, 0.99) if size.max(initial=0.0) > 0 else None
    if acting is None or not acting.any():
        return None
    times = t[acting]
    pause = max(0.02 * (t[-1] - t[0]), 3 * float(np.median(np.diff(t))))
    breaks = np.flatnonzero(np.diff(times) > pause)
    begins = np.concatenate([[0], breaks + 1])
    ends = np.concatenate([breaks, [times.size - 1]])
    spans = tuple((float(times[a]), float(times[b])) for a, b in zip(begins, ends, strict=True))
    s, r = stretch[acting], rate[acting]
    ranges = (float(s.min()), float(s.max())), (float(r.min()), float(r.max()))
    return Activity(*ranges, spans[:50])


def _motion(library: Library, item: Laid, index: int) -> tuple[Array, Array, Array]:
    """Stretch and rate (W, L) of a place and the generalized unit force there (W, L, n)."""
    course, rows = item.course(library.machine), item.rows
    stretch, rate = library.motion(course)
    return stretch[rows, index], rate[rows, index], library.directions(course)[rows][..., index]


def knots(values: Sequence[Array], count: int) -> Array:
    """Knots at quantiles of all windows, closest where the motion is most."""
    joined = np.concatenate([value.reshape(-1) for value in values])
    at = np.unique(np.quantile(joined, np.linspace(0, 1, count)))
    return at if at.size > 1 else np.array([at[0] - 1, at[0] + 1])


def surface(stretch: Array, rate: Array, corners: Sequence[Array]) -> Array:
    """Tensor products of hat functions (W, L, B) over stretch and rate (W, L)."""
    along, across = hats(stretch, corners[0]), hats(rate, corners[1])
    product = along[..., :, None] * across[..., None, :]
    return product.reshape(*stretch.shape, -1)


def hats(x: Array, at: Array) -> Array:
    """Hat functions (…, B) over knots ``at`` (B,), constant beyond them."""
    inside = np.clip(x, at[0], at[-1])
    return np.stack([np.interp(inside, at, row) for row in np.eye(at.size)], axis=-1)


def _ridge(gram: Array) -> Array:
    block, right = gram[:-1, :-1], gram[:-1, -1]
    mean = float(np.trace(block)) / block.shape[0]
    return np.linalg.solve(block + (RIDGE * mean + 1e-300) * np.eye(block.shape[0]), right)


def explained(gram: Array, values: Array, floor: float) -> float | None:
    """The share of a residual beyond its noise ``floor`` that coefficients (C,) explain, by the
    Gram matrix (C + 1, C + 1) of other windows; None where nothing is left."""
    mix = np.append(-values, 1.0)
    before, after = float(gram[-1, -1]), float(mix @ gram @ mix)
    if before <= floor or before == 0:
        return None
    return float(np.clip((before - after) / (before - min(floor, after)), 0.0, 1.0))


def _activity(
    laid: Sequence[Laid], motions: Sequence[tuple[Array, Array, Array]], acting: Sequence[Array]
) -> Activity | None:
    """Activity over the first recording (times of several recordings do not join)."""
    item, (stretch, rate, _), force = laid[0], motions[0], acting[0]
    flat = [part.reshape(-1) for part in (item.block.t, stretch, rate, force)]
    return activity(*flat)
