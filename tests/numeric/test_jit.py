"""Functions that numba compiles, with and without a folder to keep them in."""

from collections.abc import Callable
from typing import Any

import pytest
from numba import njit

from symhyb.numeric.kernels import jit


def squared(x: float) -> float:
    return x * x


def test_a_function_is_compiled_and_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def noted(cache: bool = False, **options: Any) -> Callable[..., Any]:
        asked.append(cache)
        return njit(**options)  # type: ignore[no-any-return]

    monkeypatch.setattr(jit, "njit", noted)
    assert jit.jitted(squared)(3.0) == 9.0
    assert asked == [True]


def test_without_a_folder_to_keep_it_in_a_function_is_compiled_all_the_same(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def homeless(cache: bool = False, **options: Any) -> Callable[..., Any]:
        if cache:
            raise RuntimeError("cannot cache function: no locator available")
        return njit(**options)  # type: ignore[no-any-return]

    monkeypatch.setattr(jit, "njit", homeless)
    assert jit.jitted(squared)(3.0) == 9.0
