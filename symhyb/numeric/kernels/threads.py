"""Linear algebra on one thread.

Problems are small here: threads that wait for each other cost more than they bring. Whoever calls
symhyb from a process of their own gets the same speed as on the command line.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from symhyb.numeric.kernels.compiled import LOADING


@contextmanager
def one_thread() -> Iterator[None]:
    """Let the libraries of linear algebra and OpenMP use one thread within."""
    from threadpoolctl import threadpool_limits

    with LOADING:
        limits = threadpool_limits(1)
    with limits:
        yield
