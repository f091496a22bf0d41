"""Functions that numba compiles, once for all machines."""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

_OPTIONS: dict[str, Any] = {
    "error_model": "numpy",
    # sums in any order and products joined; numbers that are not finite stay what they are
    "fastmath": {"contract", "reassoc", "nsz", "arcp"},
}

Function = TypeVar("Function", bound=Callable[..., Any])


def jitted(function: Function) -> Function:
    """A function that is compiled when it is first called. Later processes load it, unless there
    is no folder where numba may keep it: then each compiles it anew."""
    try:
        made: Function = njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:  # numba's way to say that it finds no such folder
        made = njit(**_OPTIONS)(function)
    return made
