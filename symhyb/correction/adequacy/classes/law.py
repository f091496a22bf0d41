"""A smooth force of stretch and rate at a place, of no shape that has a name."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from symhyb.correction.adequacy.classes.columns import SIZE, motions, pushing, smooth_options
from symhyb.correction.adequacy.classes.worth import Around, best_of, joined
from symhyb.correction.adequacy.structure import Generic
from symhyb.numeric.kernels.buffers import Array

PRODUCTS = 6  # of the directions of a smooth function of each, in their products

Columns = Sequence[Array]
Over = Literal["", "stretch", "rate"]


def law(start: Around, which: int, alone: Over = "") -> Generic:
    """A function of the stretch or of the rate, at one of several lengths, of both as a sum, or of
    both together, or, ``alone``, of one of the two; each beside a straight line, as steep as a
    spring or a damper may be (Rasmussen & Williams, Gaussian Processes for Machine Learning, 2006,
    §2.7), or these would be needed beside the class."""
    recorded = start.recorded
    parts = motions(recorded)
    toward = [directions[:, :, which, None] for _, _, directions in parts]
    stretch = [s[:, which] - s[:, which].mean() for s, _, _ in parts]
    rate = [r[:, which] for _, r, _ in parts]
    by_stretch = smooth_options([s[:, which] for s, _, _ in parts])
    by_rate = smooth_options(rate)
    both = [np.stack(pair, axis=1) for pair in zip(stretch, rate, strict=True)]
    options: list[tuple[Over, Columns, Columns]] = [
        ("stretch", [s[:, None] for s in stretch], c) for c in by_stretch
    ]
    options += [("rate", [r[:, None] for r in rate], c) for c in by_rate]
    options += [("", both, _each(_sum, by_stretch[i], by_rate[1])) for i in (1, 2)]
    options.append(("", both, _each(_product, by_stretch[0], by_rate[0])))
    place = recorded.library.places[which]

    def pushed(columns: Columns, joint: bool) -> Generic:
        forces = [d * c[:, None] for d, c in zip(toward, columns, strict=True)]
        return pushing(recorded, "law", place, forces, joint=joint)

    def made(over: Over, straight: Columns, curved: Columns) -> Generic:
        line = pushed(straight, joint=False)
        line = replace(line, spread=line.spread / SIZE, over=over)
        return joined([line, pushed(curved, joint=True)])

    return best_of(start, [made(*option) for option in options if alone in ("", option[0])])


def _each(join: Callable[[Array, Array], Array], first: Columns, second: Columns) -> list[Array]:
    return [join(a, b) for a, b in zip(first, second, strict=True)]


def _sum(first: Array, second: Array) -> Array:
    return np.concatenate([first, second], axis=1)


def _product(first: Array, second: Array) -> Array:
    both = first[:, :PRODUCTS, None] * second[:, None, :PRODUCTS]
    return both.reshape(len(first), -1)
