"""Which laws are tried at which place, in what shapes: the vocabulary scaled by the motion.

What is tried of a law stands in the file of the law; here it is put at every place.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from symhyb.discrepancy.places.hypotheses import Hypothesis, natural_length
from symhyb.discrepancy.places.standing import alike, flows_at
from symhyb.discrepancy.places.stiffness import stiffness_at
from symhyb.laws import LAWS
from symhyb.laws.base import STRETCHED, Law
from symhyb.laws.reach import TRANSITION_SHARE, Candidate, Reach
from symhyb.laws.sided import BESIDE
from symhyb.model.types import Between, Model, Place
from symhyb.numeric.kernels.buffers import Array

TRANSITION_LEAST = 1e-4  # of the largest rate
TRANSITION_NOISE = 0.3  # of the relative noise: the transition share


def force_hypotheses(
    model: Model, reaches: Mapping[Place, Reach], narrow: float = TRANSITION_SHARE
) -> tuple[Hypothesis, ...]:
    """Every law at every place, scaled by what the place moves through; ``narrow`` is the friction
    transition over the largest rate.

    Negative damping, drag and friction are not offered: a passive machine only loses energy.
    """
    return tuple(
        hypothesis
        for place, reach in reaches.items()
        for hypothesis in _at_place(model, place, replace(reach, narrow=narrow))
    )


def _at_place(model: Model, place: Place, reach: Reach) -> Iterator[Hypothesis]:
    reach = replace(reach, flows=flows_at(model, place), stiffness=stiffness_at(model, place))
    if isinstance(place, Between):
        reach = replace(reach, length=natural_length(model, place))
    tried = [law for law in _STRETCHED if law.at_rest or reach.speed > 0]
    for cause in in_order(tried, place, reach):
        sided = "asymmetry" in cause.keys and alike(model, cause.kind, place)
        yield replace(cause, bounds=_TAKES_BACK) if sided else cause


_STRETCHED = tuple(law for law in LAWS if {*law.placements} & {*STRETCHED})
_TAKES_BACK = (("asymmetry", -BESIDE, BESIDE),)
"""A loss that differs by direction beside one of the model: in one direction it may be less."""


def in_order(laws: Sequence[Law], place: Place, reach: Reach) -> Iterator[Hypothesis]:
    """The candidates of laws at a place, the simplest first, those alike in the order of laws."""
    tried = [(law, candidate) for law in laws for candidate in law.candidates(reach)]
    for law, candidate in sorted(tried, key=lambda pair: pair[1].order):
        yield hypothesis_of(law.name, place, candidate)


def hypothesis_of(kind: str, place: Place, candidate: Candidate) -> Hypothesis:
    """A candidate of a kind as a hypothesis at a place."""
    return Hypothesis(
        kind,
        place,
        candidate.terms,
        candidate.positive,
        candidate.shape,
        candidate.refined,
        tied=candidate.tied,
        options=candidate.options,
        own=candidate.own,
        bounds=candidate.bounds,
    )


def transition_share(noise: float) -> float:
    """The friction transition over the largest rate for a relative ``noise`` of the best sensor:
    its error stays below the noise, and it is wide enough for sticking to be fitted."""
    return float(np.clip(TRANSITION_NOISE * noise, TRANSITION_LEAST, TRANSITION_SHARE))


def lacking(forces: Array, directions: Array, index: int) -> Array:
    """The part of a lacking generalized force (N, n) that acts at a place, as its own force (N,):
    (dᵀΔF)/(dᵀd) with the direction d of that place in ``directions`` (N, n, places). SI."""
    d = directions[:, :, index]
    size = np.maximum(np.sum(d**2, axis=1), 1e-300)
    return np.asarray(np.sum(d * forces, axis=1) / size)


def joined(parts: Sequence[Reach]) -> Reach:
    """Reaches of several recordings as one."""
    stretch, rate, force, times = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("stretch", "rate", "force", "t")
    )
    return Reach(stretch, rate, force, times)
