"""Linear algebra on one thread, and as it was afterwards."""

import numpy as np
from threadpoolctl import threadpool_info, threadpool_limits

from symhyb.numeric.kernels.threads import one_thread


def threads() -> set[int]:
    return {int(library["num_threads"]) for library in threadpool_info()}


def test_libraries_use_one_thread_within_and_what_they_used_afterwards() -> None:
    assert np.ones(2) @ np.ones(2) == 2  # the library of linear algebra is there
    with threadpool_limits(2):
        before = threads()
        with one_thread():
            assert threads() == {1}
        assert threads() == before
