"""Where the mismatch sits: how much of it any smooth force of one place's own motion explains.

For every place a force surface over (stretch, rate), piecewise linear in both, is fitted to the
linearised windows and judged on windows that were held out. Sizes: W windows, L samples.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symhyb.discrepancy.places.candidates import lacking
from symhyb.discrepancy.places.hypotheses import CHUNK, Library
from symhyb.discrepancy.places.occurrence import (
    Placed,
    band_of,
    beyond_of,
    change_of,
    costs,
    sharpened,
    spectrum,
    still,
)
from symhyb.discrepancy.recorded.residual import discrepancy
from symhyb.discrepancy.recorded.windows import Cut, merge, reduce
from symhyb.discrepancy.results import Activity, Change, Occurrence, PlaceShare
from symhyb.discrepancy.words.occurrence_words import occurrence_sentence
from symhyb.judgement import SMALL
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.lowered.machine import Machine
from symhyb.numeric.runs.windows import Linear, WindowModel

KNOTS = (5, 9)  # of the surface along stretch and rate
RIDGE = 1e-4  # of the mean column power


def locate(
    library: Library,
    model: WindowModel,
    cuts: Sequence[Cut],
    p: Array,
    sd: Array,
    fine: Sequence[Cut] = (),
) -> tuple[PlaceShare, ...]:
    """The map of places, each with the explained share on held windows, where it is active, and
    when, at which frequencies and beyond which amplitude.

    ``p`` (P,) and ``sd`` (m,) in SI; on ``fine``, shorter windows, the moment of a change is found.
    The share is None where no window is held or nothing is left.
    """
    seen = _Seen.of(library, model, cuts, p)
    short = _Seen.of(library, model, fine, p) if fine else None
    result = []
    for index, place in enumerate(library.places):
        motions = seen.motions(index)
        corners = [knots([m[i] for m in motions], KNOTS[i]) for i in (0, 1)]
        placed = seen.placed(index, corners, sd)
        values = ridge(placed.grams[~placed.held].sum(axis=0))
        total, count = placed.grams[placed.held].sum(axis=0), placed.count[placed.held].sum()
        share = explained(total, values, float(count))
        change = None if share is None else change_of(placed, ridge, seen.names)
        if change is None and (not share or share <= SMALL):
            result.append(PlaceShare(place, share))
            continue
        if change is not None:  # what it takes where it acts
            on = ~still(placed, change, seen.names)
            values = ridge(placed.grams[on & ~placed.held].sum(axis=0))
            total = placed.grams[on & placed.held].sum(axis=0)
            share = explained(total, values, float(placed.count[on & placed.held].sum()))
        if change is not None and short is not None:
            change = sharpened(change, short.placed(index, corners, sd), ridge, short.names)
        acting = [surface(s, r, corners) @ values for s, r, _ in motions]
        if change is not None:
            calm = still(placed, change, seen.names)
            acting = [
                np.where(calm[placed.recording == i][:, None], 0.0, force)
                for i, force in enumerate(acting)
            ]
        active = _activity(seen.cuts, motions, acting)
        occurrence = _occurrence(seen, index, corners, values, placed, change)
        result.append(PlaceShare(place, share, active, occurrence))
    return tuple(sorted(result, key=lambda item: -(item.explained or 0.0)))


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """Windows of all recordings with the dynamics linearised along the measured motion, and the
    motion of all places (``moved``)."""

    library: Library
    machine: Machine
    cuts: tuple[Cut, ...]
    linears: tuple[Linear, ...]
    moved: tuple[tuple[Array, Array, Array], ...]

    @classmethod
    def of(cls, library: Library, model: WindowModel, cuts: Sequence[Cut], p: Array) -> "_Seen":
        suited = tuple(item.suited(model.machine) for item in cuts)
        linears = tuple(model.along(item.block, item.states, p) for item in suited)
        moved = tuple(_moved(library, item) for item in suited)
        return cls(library, model.machine, suited, linears, moved)

    @property
    def names(self) -> list[str]:
        return [item.source[0].name for item in self.cuts]

    def motions(self, index: int) -> list[tuple[Array, Array, Array]]:
        """Stretch, rate and generalized unit force at a place, recording by recording."""
        return [(s[..., index], r[..., index], unit[..., index]) for s, r, unit in self.moved]

    def placed(self, index: int, corners: Sequence[Array], sd: Array) -> Placed:
        """The windows reduced to the force surface of one place."""
        parts = []
        motions = self.motions(index)
        for item, linear, (stretch, rate, unit) in zip(
            self.cuts, self.linears, motions, strict=True
        ):
            forces = unit[..., None] * surface(stretch, rate, corners)[:, :, None, :]
            residual = item.block.y - linear.output - linear.from_defect()
            columns = linear.from_forces(forces)
            parts.append(reduce(item, residual, linear.from_start(), columns, sd))
        grams, count, held = merge(parts)
        times = [item.block.t[:, [0, -1]] for item in self.cuts]
        which = [np.full(len(t), i) for i, t in enumerate(times)]
        return Placed(grams, count, held, np.concatenate(which), np.concatenate(times))


def _occurrence(
    seen: _Seen,
    index: int,
    corners: Sequence[Array],
    values: Array,
    placed: Placed,
    change: Change | None,
) -> Occurrence:
    """When and how the mismatch acts at a place, along the first recording."""
    first, library = seen.cuts[0], seen.library
    course = first.course(library.machine)
    stretch, rate = (part[:, index] for part in library.motion(course))
    bare = first.course(seen.machine)
    lacks = discrepancy(seen.machine, bare, seen.machine.values)
    missing = lacking(lacks, library.directions(course), index)
    acting = _along_surface(stretch, rate, corners, values)
    lines, power = spectrum(course.t, missing, acting)
    band, beyond = band_of(lines, power), beyond_of(stretch, missing)
    active = activity(course.t, stretch, rate, acting)
    spans = () if active is None else active.time
    duty = sum(b - a for a, b in spans) / max(float(np.ptp(course.t)), 1e-300)
    line = float(lines[1]) if lines.size > 1 else 0.0
    said = occurrence_sentence(
        seen.machine.model, library.places[index], change, band, line, beyond, spans, duty
    )
    mine = placed.recording == 0
    count = np.maximum(placed.count[mine], 1)
    before = placed.grams[mine][:, -1, -1] / count
    after = costs(placed.grams[mine], values) / count
    if change is not None:
        after = np.where(still(placed, change, seen.names)[mine], before, after)
    shown = power > 0.003 * power.max(initial=0.0)
    last = int(np.flatnonzero(shown)[-1]) + 1 if shown.any() else 0
    return Occurrence(
        change,
        band,
        beyond,
        placed.t[mine].mean(axis=1),
        before,
        after,
        lines[:last],
        power[:last] / max(power.max(initial=0.0), 1e-300),
        said,
    )


def activity(t: Array, stretch: Array, rate: Array, force: Array) -> Activity | None:
    """Where and when a force (N,) acts: ranges of stretch and rate (N,) SI, spans of time (s)."""
    size = np.abs(force)
    acting = size > SMALL * np.quantile(size, 0.99) if size.max(initial=0.0) > 0 else None
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


def _moved(library: Library, item: Cut) -> tuple[Array, Array, Array]:
    """Stretch and rate (W, L, places) of all places and the generalized unit forces there (W, L, n,
    places)."""
    course = item.course(library.machine)
    return *library.motion(course, item.rows), library.directions(course)[item.rows]


def _along_surface(stretch: Array, rate: Array, corners: Sequence[Array], values: Array) -> Array:
    """The force (N,) of a surface with these ``values`` (B,) at its corners along a recording, in
    their unit; bit by bit, for the hat functions are many."""
    parts = [slice(begin, begin + CHUNK) for begin in range(0, stretch.size, CHUNK)]
    return np.concatenate([surface(stretch[i], rate[i], corners) @ values for i in parts])


def knots(values: Sequence[Array], count: int) -> Array:
    """Knots (B,) at quantiles of all windows (W, L), closest where the motion is most; SI."""
    joined = np.concatenate([value.reshape(-1) for value in values])
    at = np.unique(np.quantile(joined, np.linspace(0, 1, count)))
    return at if at.size > 1 else np.array([at[0] - 1, at[0] + 1])


def surface(stretch: Array, rate: Array, corners: Sequence[Array]) -> Array:
    """Tensor products of hat functions (W, L, B) over stretch and rate (W, L), SI."""
    along, across = hats(stretch, corners[0]), hats(rate, corners[1])
    product = along[..., :, None] * across[..., None, :]
    return product.reshape(*stretch.shape, -1)


def hats(x: Array, at: Array) -> Array:
    """Hat functions (…, B), dimensionless, over knots ``at`` (B,), constant beyond them."""
    inside = np.clip(x, at[0], at[-1])
    return np.stack([np.interp(inside, at, row) for row in np.eye(at.size)], axis=-1)


def ridge(gram: Array) -> Array:
    """The coefficients (C,) of a Gram matrix (C + 1, C + 1) whose last row and column are those of
    the residual, in units of the noise; held towards 0 by a small part of its mean diagonal."""
    block, right = gram[:-1, :-1], gram[:-1, -1]
    mean = float(np.trace(block)) / block.shape[0]
    return np.linalg.solve(block + (RIDGE * mean + 1e-300) * np.eye(block.shape[0]), right)


def explained(gram: Array, values: Array, floor: float) -> float | None:
    """The share of a residual beyond its noise ``floor`` that coefficients (C,) explain, by the
    Gram matrix (C + 1, C + 1) of other windows, all in units of the noise; None where nothing is
    left."""
    mix = np.append(-values, 1.0)
    before, after = float(gram[-1, -1]), float(mix @ gram @ mix)
    if before <= floor or before == 0:
        return None
    return float(np.clip((before - after) / (before - min(floor, after)), 0.0, 1.0))


def _activity(
    cuts: Sequence[Cut], motions: Sequence[tuple[Array, Array, Array]], acting: Sequence[Array]
) -> Activity | None:
    """Activity over the first recording (times of several recordings do not join)."""
    item, (stretch, rate, _), force = cuts[0], motions[0], acting[0]
    flat = [part.reshape(-1) for part in (item.block.t, stretch, rate, force)]
    return activity(*flat)
