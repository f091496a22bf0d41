"""Functions that numba compiles, once for all machines."""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., Any])


def jitted(function: Function) -> Function:
    """A function that is compiled when it is first called. Sums keep their order: in any order they
    would depend on where in memory the arrays lie. Later processes load it, unless there is no
    folder where numba may keep it: then each compiles it anew."""
    try:
        made: Function = njit(cache=True, error_model="numpy")(function)
    except RuntimeError:  # numba's way to say that it finds no such folder
        made = njit(error_model="numpy")(function)
    return made
