"""What the columns of a class are worth around a structure, in the linear problem.

Sizes: N samples, m sensors, F numbers of the structure, K columns.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from symhyb.correction.adequacy.recorded import Recorded
from symhyb.correction.adequacy.structure import Fitted, Generic, tracks_of
from symhyb.discrepancy.likelihood.noise import NoiseModel
from symhyb.discrepancy.likelihood.track import Extra, Track, white_columns, white_problem
from symhyb.numeric.kernels.buffers import Array

SHARES = (1.0, 0.1, 0.01)  # of unknown force and colour that may be left beside a class


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """The linear problem with one noise model, dimensionless: the white residual (N·m,) of every
    stretch and an orthonormal basis (N·m, F) of what the structure's own numbers would take, and ln
    L (but for a constant) without that."""

    noise: NoiseModel
    parts: tuple[tuple[Array, Array], ...]
    likely: float


@dataclass(frozen=True, slots=True, eq=False)
class Around:
    """A fitted structure, linearised, with all of the unknown force and with less of it: while it
    acts in full it explains what the columns of a class would."""

    recorded: Recorded
    tracks: tuple[Track, ...]
    levels: tuple[Level, ...]

    def computed(self, which: int) -> Array:
        """What the sensors should show (N, m), SI, along the trajectory of a stretch."""
        return np.asarray(self.tracks[which].linear.output[0])


def around(recorded: Recorded, trial: Fitted) -> Around:
    """Linearise a fitted structure."""
    tracks, full = tuple(tracks_of(recorded, trial)), trial.fit.noise
    levels = [_level(tracks, noise) for noise in less_of(full)]
    return Around(recorded, tracks, tuple(levels))


def less_of(full: NoiseModel) -> list[NoiseModel]:
    """A noise model, and the same with less of the unknown force and of the colour, if any."""
    shares = SHARES if full.coloured or np.any(full.force > 0) else SHARES[:1]
    return [replace(full, force=share * full.force, colour=share * full.colour) for share in shares]


def _level(tracks: Sequence[Track], noise: NoiseModel) -> Level:
    parts, likely = [], 0.0
    for one in tracks:
        residual, own, logs = white_problem(one, noise)
        basis = np.linalg.qr(own)[0] if own.size else np.zeros((residual.size, 0))
        residual = residual - basis @ (basis.T @ residual)
        likely -= 0.5 * float(logs + residual @ residual)
        parts.append((residual, basis))
    return Level(noise, tuple(parts), likely)


def worth_of(start: Around, columns: Generic) -> float:
    """What a class would add to ln evidence around a structure: the best over some sizes of the
    unknown force that is left beside it."""
    return float(worths_of(start, columns, [range(columns.spread.size)])[0])


def worths_of(start: Around, columns: Generic, groups: Sequence[Sequence[int]]) -> Array:
    """What each group of columns would add to ln evidence by itself (G,), dimensionless."""
    found, means = [], [columns.mean[list(rows)] for rows in groups]
    driven = [
        extra.driving(one.linear) for one, extra in zip(start.tracks, columns.each, strict=True)
    ]
    for level in start.levels:
        products = _products(start.tracks, level, driven, columns.spread, groups)
        more = level.likely - start.levels[0].likely
        found.append([_gain(*one, mean) + more for one, mean in zip(products, means, strict=True)])
    return np.asarray(np.max(np.array(found), axis=0))


def _products(
    tracks: Sequence[Track],
    level: Level,
    driven: Sequence[tuple[Array, Array]],
    spread: Array,
    groups: Sequence[Sequence[int]],
) -> list[tuple[Array, Array]]:
    """Products (C, C) of the C white columns of each group with each other, and (C,) with the
    residual; columns are for one prior deviation (``spread``, K). Of each stretch it is given what
    the columns drive. No group asks for its products with another."""
    blocks = [np.zeros((len(rows), len(rows))) for rows in groups]
    toward = np.zeros(spread.size)
    for one, (pushed, shown), (residual, own) in zip(tracks, driven, level.parts, strict=True):
        begin = np.zeros((one.x.shape[1], spread.size))
        white = white_columns(one, level.noise, pushed, -shown, begin)
        white *= spread
        white -= own @ (own.T @ white)
        toward += white.T @ residual
        for rows, block in zip(groups, blocks, strict=True):
            # columns side by side are not copied
            mine = white[:, rows[0] : rows[-1] + 1] if isinstance(rows, range) else white[:, rows]
            block += mine.T @ mine
    return [(block, toward[list(rows)]) for rows, block in zip(groups, blocks, strict=True)]


def _gain(block: Array, toward: Array, begin: Array) -> float:
    """ln of the evidence that columns add, from their products with each other and with the
    residual; their coefficients have a mean ``begin`` (C,), in prior deviations."""
    right = toward + block @ begin
    moved = float(begin @ toward + 0.5 * begin @ block @ begin)
    seen = block + np.eye(begin.size)
    solved = float(0.5 * right @ np.linalg.solve(seen, right))
    return solved - moved - 0.5 * float(np.linalg.slogdet(seen)[1])


def best_of(start: Around, options: Sequence[Generic]) -> Generic:
    """The class with the columns that are worth most out of several, which it pays for."""
    together = joined(options)
    ends = np.cumsum([0, *(one.spread.size for one in options)])
    groups = [range(a, b) for a, b in pairwise(ends)]
    return replace(options[int(np.argmax(worths_of(start, together, groups)))], tried=len(options))


def joined(options: Sequence[Generic]) -> Generic:
    """The columns of several classes."""
    each = tuple(
        Extra(
            np.concatenate([part.force for part in parts], axis=2),
            np.concatenate([part.output for part in parts], axis=2),
            np.concatenate([part.arriving for part in parts], axis=2)
            if any(part.before is not None for part in parts)
            else None,
        )
        for parts in zip(*(one.each for one in options), strict=True)
    )
    spread = np.concatenate([one.spread for one in options])
    mean = np.concatenate([one.mean for one in options])
    return replace(options[0], each=each, spread=spread, mean=mean)
