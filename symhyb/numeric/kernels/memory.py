"""What was lowered before, kept in memory: a diagnosis builds the same structures many times."""

from collections.abc import Callable, Hashable
from typing import TypeVar

MOST = 200

Value = TypeVar("Value")

_kept: dict[Hashable, object] = {}


def kept(key: Hashable, make: Callable[[], Value]) -> Value:
    """The value under ``key``, made if it is not there; the oldest are forgotten."""
    value = _kept.pop(key) if key in _kept else make()
    _kept[key] = value
    while len(_kept) > MOST:
        _kept.pop(next(iter(_kept)))
    return value  # type: ignore[return-value]
