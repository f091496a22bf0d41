"""Motions that go one way: how often a place is passed, and at which speeds.

A ball that falls, a valve that closes once: nothing comes back, so there is no period, however long
one records. On a single passage place, speed and time are functions of each other, and
so is every force of them; what distinguishes them is another passage at another speed.
Sizes: N samples, n coordinates.
"""

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from symhyb.discrepancy.recorded.motion import Motion
from symhyb.discrepancy.recorded.runs import Run
from symhyb.judgement import SMALL
from symhyb.numeric.kernels.buffers import Array

PLACES = 32  # of the common way, at which speeds are compared


def one_way(motion: Motion) -> bool:
    """Whether no coordinate comes back: its way from the first to the last place is nearly the
    whole path that it covers."""
    path = np.sum(np.abs(np.diff(motion.q, axis=0)), axis=0)
    way = np.abs(motion.q[-1] - motion.q[0])
    moves = path > 0
    return bool(moves.any() and np.all(way[moves] >= (1 - SMALL) * path[moves]))


def passed_at_one_speed(runs: Sequence[Run]) -> bool:
    """Whether all runs go one way and pass every place at much the same speed."""
    motions = [run.motion for run in runs]
    if not all(map(one_way, motions)):
        return False
    return not any(_differ(first, second) for first, second in combinations(motions, 2))


def _differ(first: Motion, second: Motion) -> bool:
    """Whether two passages differ in the speed of a coordinate at the same places."""
    for i in range(first.q.shape[1]):
        low = max(first.q[:, i].min(), second.q[:, i].min())
        high = min(first.q[:, i].max(), second.q[:, i].max())
        if not high > low:
            continue
        places = np.linspace(low, high, PLACES)
        one, other = _speed(first, i, places), _speed(second, i, places)
        size = np.sqrt((np.mean(one**2) + np.mean(other**2)) / 2)
        if np.sqrt(np.mean((one - other) ** 2)) > SMALL * size:
            return True
    return False


def _speed(motion: Motion, i: int, places: Array) -> Array:
    """The speed of a coordinate at ``places``, SI."""
    rows = np.argsort(motion.q[:, i])
    return np.asarray(np.interp(places, motion.q[rows, i], motion.v[rows, i]))
