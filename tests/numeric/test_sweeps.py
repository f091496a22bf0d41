"""Slopes of integration steps joined from sample to sample, and what they do to the outputs."""

import numpy as np
import pytest

from symhyb.numeric.kernels.sweeps import joined, responses


def test_slopes_join_as_the_steps_follow_each_other() -> None:
    """Two intervals, of one step and of three, against the steps taken one by one."""
    chance = np.random.default_rng(2)
    parts, first = np.array([1, 3]), np.array([0, 1])
    steps = [chance.standard_normal((4, 2, count)) for count in (2, 3, 1)]
    slopes = np.concatenate(steps, axis=2).swapaxes(1, 2)
    transition, left, right, free = joined(np.ascontiguousarray(slopes), 3, first, parts)
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


def test_outputs_respond_as_the_states_follow_each_other() -> None:
    """Two windows of four samples; the last two of three columns are added to on the way."""
    chance = np.random.default_rng(3)
    transition, added = chance.standard_normal((2, 3, 2, 2)), chance.standard_normal((2, 3, 2, 2))
    by_state, begin = chance.standard_normal((2, 4, 3, 2)), chance.standard_normal((2, 2, 3))
    seen = responses(transition, by_state, begin, added)
    state = begin
    for i in range(4):
        assert seen[:, i] == pytest.approx(by_state[:, i] @ state)
        if i < 3:
            state = transition[:, i] @ state
            state[..., 1:] += added[:, i]
