"""A smooth force of stretch and rate at a place, of no shape that has a name."""

from collections.abc import Callable, Sequence

import numpy as np

from symhyb.correction.adequacy.classes.columns import motions, pushing, smooth_options
from symhyb.correction.adequacy.classes.worth import Around, best_of
from symhyb.correction.adequacy.structure import Generic
from symhyb.numeric.kernels.buffers import Array

PRODUCTS = 6  # of the directions of a smooth function of each, in their products


def law(start: Around, which: int) -> Generic:
    """A function of the stretch or of the rate, at one of several lengths, of both as a sum, or of
    both together."""
    recorded = start.recorded
    parts = motions(recorded)
    toward = [directions[:, :, which, None] for _, _, directions in parts]
    by_stretch = smooth_options([s[:, which] for s, _, _ in parts])
    by_rate = smooth_options([r[:, which] for _, r, _ in parts])
    options = [*by_stretch, *by_rate]
    options += [_each(_sum, by_stretch[1], by_rate[1]), _each(_sum, by_stretch[2], by_rate[1])]
    options.append(_each(_product, by_stretch[0], by_rate[0]))
    place = recorded.library.places[which]
    return best_of(
        start,
        [
            pushing(
                recorded,
                "law",
                place,
                [d * columns[:, None] for d, columns in zip(toward, option, strict=True)],
                joint=True,
            )
            for option in options
        ],
    )


def _each(
    join: Callable[[Array, Array], Array], first: Sequence[Array], second: Sequence[Array]
) -> list[Array]:
    return [join(a, b) for a, b in zip(first, second, strict=True)]


def _sum(first: Array, second: Array) -> Array:
    return np.concatenate([first, second], axis=1)


def _product(first: Array, second: Array) -> Array:
    both = first[:, :PRODUCTS, None] * second[:, None, :PRODUCTS]
    return both.reshape(len(first), -1)
