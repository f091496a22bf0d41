"""Long series made fit for a picture: thinned, zoomed, binned and scaled (NumPy only)."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from symhyb.discrepancy.words.wording import power_text, unit_text

Array = NDArray[np.float64]

BINS = 300  # of a drawn line: two points each, about one a pixel
_CELLS = 160  # of a law drawn through a cloud
_SHARP = 0.02  # of its variance, that a law which is a function of x has within a cell
_SCATTER = 0.5  # of its variance, that a law may have within a cell and still be drawn
_CYCLES_LONG, _CYCLES_SHOWN = 12.0, 4.0
_PREFIXES = {-9: "n", -6: "µ", -3: "m", 3: "k", 6: "M"}
_PREFIXED = frozenset({"m", "N", "V", "A", "s", "W", "J", "Pa"})


def envelope(t: Array, y: Array, bins: int = BINS) -> tuple[Array, Array]:
    """Thin a series to the smallest and the largest value of each bin, in the order met.

    ``t``, ``y``: (N,) in any unit; returns at most 2·bins points, so no peak is lost. A bin without
    any finite value becomes one NaN: a gap stays a gap.
    """
    if len(y) <= 2 * bins:
        return np.asarray(t, dtype=float), np.asarray(y, dtype=float)
    edges = np.linspace(0, len(y), bins + 1).astype(int)
    begins, ends = edges[:-1, None], edges[1:, None]
    at = begins + np.arange(np.diff(edges).max())
    values = y[np.minimum(at, len(y) - 1)]
    seen = (at < ends) & np.isfinite(values)
    low = np.argmin(np.where(seen, values, np.inf), axis=1)  # 0 without any
    high = np.argmax(np.where(seen, values, -np.inf), axis=1)
    kept = np.unique(edges[:-1] + np.stack([low, high]))
    return t[kept], y[kept]


def extremes(columns: Sequence[Array], bins: int = BINS) -> NDArray[np.intp]:
    """The samples (K,), in order, at which any of the ``columns`` (N,), in any unit, is smallest or
    largest in its bin, and the first and the last: series that keep common times and no peak less.
    """
    length = len(columns[0]) if columns else 0
    if length <= 2 * bins:
        return np.arange(length)
    where = np.arange(length, dtype=float)
    kept = [np.array([0.0, length - 1.0]), *(envelope(where, y, bins)[0] for y in columns)]
    return np.unique(np.concatenate(kept)).astype(np.intp)


def zoom_window(t: Array, y: Array) -> tuple[float, float] | None:
    """Choose a few cycles where ``y`` moves most, or None if the series has few cycles anyway.

    ``t``, ``y``: (N,) in any unit. A cycle is two crossings of the mean by a third of the standard
    deviation, so that noise about the mean makes no cycles.
    """
    known = np.isfinite(y)
    t, y = t[known], y[known]
    if len(t) < 50:
        return None
    away = y - y.mean()
    above = away[np.abs(away) > away.std() / 3.0] > 0.0
    cycles = np.count_nonzero(above[1:] != above[:-1]) / 2.0
    if cycles < _CYCLES_LONG:
        return None
    length = (t[-1] - t[0]) * _CYCLES_SHOWN / cycles
    starts = np.linspace(t[0], t[-1] - length, 40)
    spans = [np.searchsorted(t, (start, start + length)) for start in starts]
    ranges = [np.ptp(y[first : last + 1]) if last > first else 0.0 for first, last in spans]
    start = float(starts[int(np.argmax(ranges))])
    return start, start + float(length)


def shown_unit(size: float, unit: str) -> tuple[float, str]:
    """Choose a factor and a unit in which numbers of this size read well: (1e-3, ``mm``)."""
    known = size > 0.0 and np.isfinite(size)
    exponent = int(np.floor((np.log10(size) + 1.0) / 3.0)) * 3 if known else 0
    if exponent == 0 or 0.1 <= size < 1e5:
        return 1.0, unit_text(unit)
    head, mark, rest = unit.partition("/")
    if head in _PREFIXED and exponent in _PREFIXES:
        return 10.0**exponent, _PREFIXES[exponent] + unit_text(head + mark + rest)
    return 10.0**exponent, f"{power_text(exponent)} {unit_text(unit)}".rstrip()


def shortened(name: str, length: int = 60) -> str:
    """Make a name fit for a picture: printable, one line, at most ``length`` characters."""
    clean = "".join(
        letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in name
    )
    return clean if len(clean) <= length else f"{clean[: length - 1]}…"


def binned(x: Array, law: Array, band: Array) -> tuple[Array, Array, Array, Array]:
    """Sum up a law in narrow bins of x: medians of x and of the law, and of law ± band.

    ``x``, ``law``, ``band``: (N,) in any unit. Returns four arrays, one entry a bin that holds
    samples.
    """
    known = np.isfinite(x) & np.isfinite(law) & np.isfinite(band)
    x, law, band = x[known], law[known], band[known]
    if not x.size:
        return (np.empty(0),) * 4
    cells = _cells(x, 20)
    if _scatter(law, cells) > _SHARP * _scatter(law, np.zeros_like(cells)):
        cells = _cells(x)  # no function of x alone: a median needs more samples
    rows = [
        (
            np.median(x[cell]),
            np.median(law[cell]),
            np.median(law[cell]) - np.median(band[cell]),
            np.median(law[cell]) + np.median(band[cell]),
        )
        for cell in (cells == index for index in np.unique(cells))
    ]
    centre, middle, lower, upper = np.array(rows, dtype=float).T
    return centre, middle, lower, upper


def passages(x: Array, y: Array, bins: int = 24) -> tuple[Array, Array, Array]:
    """The mean of y in bins of x, and one standard deviation of that mean: (B,) each.

    ``x``, ``y``: (N,) in the order of time, in any unit. Samples of one passage of a bin are alike,
    whatever their number: passages are averaged, and their scatter says how well. Bins of less
    than three passages are left out.
    """
    known = np.isfinite(x) & np.isfinite(y)
    x, y = x[known], y[known]
    if not x.size:
        return (np.empty(0),) * 3
    edges = np.linspace(x.min(), x.max(), bins + 1)
    cells = np.digitize(x, edges[1:-1])
    run = np.concatenate([[0], np.cumsum(np.diff(cells) != 0)])
    size = np.bincount(run)
    of_run, at = np.bincount(run, y) / size, np.bincount(run, x) / size
    of_cell = cells[np.concatenate([[True], np.diff(cells) != 0])]
    count = np.bincount(of_cell, minlength=bins)
    told = np.flatnonzero(count >= 3)
    mean, centre = (
        np.bincount(of_cell, v, minlength=bins) / np.maximum(count, 1) for v in (of_run, at)
    )
    square = np.bincount(of_cell, (of_run - mean[of_cell]) ** 2, minlength=bins)
    spread = np.sqrt(square[told] / (count[told] - 1) / count[told])
    return centre[told], mean[told], spread


def follows(x: Array, law: Array, parts: Sequence[NDArray[np.bool_]]) -> bool:
    """Whether a law is roughly a function of x on every part of its samples: less than half of its
    variance is left within bins of x. ``x``, ``law``: (N,) in any unit."""
    known = np.isfinite(x) & np.isfinite(law)
    left = sum(_scatter(law[part & known], _cells(x[part & known])) for part in parts)
    return left <= _SCATTER * _scatter(law[known], np.zeros(np.count_nonzero(known), dtype=int))


def _cells(x: Array, samples: int = 50) -> NDArray[np.intp]:
    """The narrow bin of each of the finite samples x (N,), some ``samples`` a bin."""
    if not x.size:
        return np.zeros(0, dtype=int)
    count = int(np.clip(x.size // samples, 30, _CELLS))
    return np.digitize(x, np.linspace(x.min(), x.max(), count + 1)[1:-1])


def _scatter(y: Array, cells: NDArray[np.intp]) -> float:
    """The sum of squares of y (N,) about its means in cells."""
    means = np.bincount(cells, y) / np.maximum(np.bincount(cells), 1)
    return float(np.sum((y - means[cells]) ** 2))


def halves(y: Array) -> tuple[NDArray[np.bool_], ...]:
    """Split samples (N,) in any unit by sign, or at the median if a sign is rare: two masks."""
    known = y[np.isfinite(y)]
    mixed = not known.size or 0.1 < np.mean(known > 0.0) < 0.9
    above = y > (0.0 if mixed else np.median(known))
    return ~above, above


def spread(series: Sequence[Array]) -> float:
    """The size of series (N,), in their unit, but for rare peaks: 0 if nothing is finite."""
    known = np.concatenate([values[np.isfinite(values)] for values in series])
    return float(np.percentile(np.abs(known), 99.0)) if known.size else 0.0
