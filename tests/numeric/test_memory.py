"""What is kept in memory, and how often Python's collector runs."""

import gc

import pytest

from symhyb.numeric.kernels.memory import SELDOM, seldom_collected


def test_the_collector_runs_as_before_afterwards() -> None:
    before = gc.get_threshold()
    with seldom_collected():
        assert gc.get_threshold() == SELDOM
    assert gc.get_threshold() == before
    with pytest.raises(ValueError, match="it failed"), seldom_collected():
        raise ValueError("it failed")
    assert gc.get_threshold() == before
