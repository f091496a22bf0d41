"""What was lowered before, kept in memory: a diagnosis builds the same structures many times; and
how often memory is searched for what is in use no more."""

import gc
from collections.abc import Callable, Hashable, Iterator
from contextlib import contextmanager
from typing import TypeVar

MOST = 200
SELDOM = (20_000, 20, 20)  # thresholds of Python's collector, which begin at (700, 10, 10)

Value = TypeVar("Value")

_kept: dict[Hashable, object] = {}


def kept(key: Hashable, make: Callable[[], Value]) -> Value:
    """The value under ``key``, made if it is not there; the oldest are forgotten."""
    value = _kept.pop(key) if key in _kept else make()
    _kept[key] = value
    while len(_kept) > MOST:
        _kept.pop(next(iter(_kept)))
    return value  # type: ignore[return-value]


@contextmanager
def seldom_collected() -> Iterator[None]:
    """Search for objects that refer to each other, and are in use no more, less often within. Each
    search passes all that SymPy, CasADi and others have made, and finds next to nothing; all other
    objects are freed at once, as always."""
    before = gc.get_threshold()
    gc.set_threshold(*SELDOM)
    try:
        yield
    finally:
        gc.set_threshold(*before)
