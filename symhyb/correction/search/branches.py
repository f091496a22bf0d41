"""Further branches of a ladder at a place where one was found: faster, slower, and between two.

The linear problem has a few time constants at each place. A ladder has its own, and of a branch
that is much faster than the motion a damper is left, so that the branch comes in its place.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from symhyb.correction.search.trajectory import Refined, grouped
from symhyb.correction.search.trials import Row, Trials
from symhyb.discrepancy.places.hypotheses import Hypothesis

BRANCHES_MOST = 3  # at one place
APART = 6.0  # times: how much faster, or slower, the next branch is tried
PART = 0.1  # of the softest branch: how stiff one begins that stands for nothing yet


def branches_of(trials: Trials, base: Refined) -> Iterator[tuple[tuple[int, ...], list[Row]]]:
    """A structure with one branch more, at each place where there is one: in place of the damper
    that stands beside it, faster than that has been seen, or beside what there is; and without the
    numbers of the model and of channels, which may only stand for it."""
    own, rows = trials.causes(base), grouped(base)
    numbers = {i for i, cause in enumerate(base.causes) if cause.place is None}
    for place in dict.fromkeys(cause.place for cause in base.causes if cause.several):
        here = [i for i, cause in enumerate(base.causes) if cause.place == place]
        found = [i for i in here if base.causes[i].several]
        if len(found) >= BRANCHES_MOST:
            continue
        times = sorted(rows[i]["damping"] / rows[i]["stiffness"] for i in found)
        softest = min(rows[i]["stiffness"] for i in found)
        dampers = [i for i in here if base.causes[i].keys == ("damping",)]
        for time_s in _times(times):
            fresh = trials.index(_branch(base.causes[found[0]], time_s))
            gone = {*dampers[:1]} if time_s < times[0] else set()
            stiffness = rows[dampers[0]]["damping"] / time_s if gone else PART * softest
            row = {"stiffness": stiffness, "damping": stiffness * time_s}
            for out in [gone, gone | numbers] if numbers else [gone]:
                kept = [i for i in range(len(own)) if i not in out]
                yield (*(own[i] for i in kept), fresh), [*(rows[i] for i in kept), row]


def _times(times: list[float]) -> list[float]:
    """Time constants, s, apart from those there are (in order): faster, slower, and between."""
    between = [
        float(np.sqrt(fast * slow)) for fast, slow in pairwise(times) if slow > APART**2 * fast
    ]
    return [times[0] / APART, times[-1] * APART, *between]


def _branch(like: Hypothesis, time_s: float) -> Hypothesis:
    return replace(like, shape=(("damping", time_s),))
