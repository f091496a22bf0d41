"""Functions that numba compiles, once for all machines."""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def jitted(function: Function) -> Function:
    """A function that is compiled when it is first called; sums keep their order. Later processes
    load it, unless there is no folder where numba may keep it: then each compiles it anew."""
    return _made(function, {})


def jitted_in_any_order(function: Function) -> Function:
    """The same, with sums in any order and products joined, which is faster; numbers that are not
    finite stay what they are."""
    return _made(function, {"fastmath": {"contract", "reassoc", "nsz", "arcp"}})


def _made(function: Function, options: dict[str, Any]) -> Function:
    try:
        made: Function = njit(cache=True, error_model="numpy", **options)(function)
    except RuntimeError:  # numba's way to say that it finds no such folder
        made = njit(error_model="numpy", **options)(function)
    return made
