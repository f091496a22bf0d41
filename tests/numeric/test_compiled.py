"""Compiled functions say the same as CasADi's, and their absence is silent."""

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric import compiled as module
from symhyb.numeric.buffers import call


def large() -> ca.Function:
    """A function long enough to be worth compiling."""
    x = ca.SX.sym("x", 3)
    y = x
    for i in range(400):
        y = ca.sin(y) * x[i % 3] + ca.tanh(y / (1 + i))
    return ca.Function("large", [x], [y])


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(module, "_folder", lambda: tmp_path)
    return tmp_path


def test_compiled_and_interpreted_agree(cache: Path) -> None:
    function = large()
    assert function.n_instructions() > module.INSTRUCTIONS_LEAST
    result = module.compiled({"large": function})["large"]
    x = np.array([0.3, -0.7, 1.1])
    assert np.allclose(call(result, (x,))[0], call(function, (x,))[0], rtol=1e-13, atol=0)
    if module._compiler() is not None:
        assert len(list(cache.glob("*.so"))) == 1
        module.compiled({"large": large()})
        assert len(list(cache.glob("*.so"))) == 1  # found by its content


def test_without_a_compiler_the_functions_stay(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_compiler", lambda: None)
    function = large()
    assert module.compiled({"large": function})["large"] is function
    assert not list(cache.iterdir())


def test_a_compiler_that_fails_leaves_nothing_behind(
    cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_compiler", lambda: ("false", "broken"))
    function = large()
    assert module.compiled({"large": function})["large"] is function
    assert not list(cache.iterdir())


def test_a_small_function_is_not_worth_it(cache: Path) -> None:
    x = ca.SX.sym("x")
    small = ca.Function("small", [x], [x**2])
    assert module.compiled({"small": small})["small"] is small
    assert not list(cache.iterdir())
