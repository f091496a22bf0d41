"""Slopes of integration steps joined from sample to sample."""

import numpy as np
import pytest

from symhyb.numeric.runs.window_steps import joined


def test_slopes_join_as_the_steps_follow_each_other() -> None:
    """Two intervals, of one step and of three, against the steps taken one by one."""
    chance = np.random.default_rng(2)
    parts, first = np.array([1, 3]), np.array([0, 1])
    steps = [chance.standard_normal((4, 2, count)) for count in (2, 3, 1)]
    transition, left, right, free = joined(steps, first, parts)
    step, by_free, kick = steps
    assert transition[0] == pytest.approx(step[0])
    assert left[0] == pytest.approx(kick[0] / 2)
    assert right[0] == pytest.approx(kick[0] / 2)
    state, theta, push = chance.standard_normal(2), chance.standard_normal(3), (1.3, -0.4)
    after = state
    for i in range(3):
        share = (i + 0.5) / 3
        force = np.array([(1 - share) * push[0] + share * push[1]])
        after = step[1 + i] @ after + by_free[1 + i] @ theta + kick[1 + i] @ force
    whole = transition[1] @ state + free[1] @ theta
    whole = whole + left[1] @ [push[0]] + right[1] @ [push[1]]
    assert whole == pytest.approx(after)
