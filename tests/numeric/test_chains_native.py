"""Chains as machine code of their own: bit by bit what the machine for instruction lists gives."""

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels import chains, chains_native
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.chains_source import LANES
from symhyb.numeric.kernels.compiled import find_compiler
from tests.numeric.test_chains import PAIRS, every_operation, function, symbols

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")

Given = tuple[Array, list[Array], Array]


def both(
    step: ca.Function, given: Given, monkeypatch: pytest.MonkeyPatch
) -> tuple[list[Array], list[Array]]:
    """The outputs by the machine and by a function's own code."""
    interpreted = Chains(step)(*given)
    monkeypatch.setattr(chains, "NATIVE_FROM", 1)
    compiled = Chains(step)
    made = compiled(*given)
    assert compiled._engine is not None
    assert compiled._engine._native is not None
    return interpreted, made


@pytest.mark.parametrize("count", [1, LANES - 1, LANES, 2 * LANES + 3])
def test_every_operation_is_the_same(count: int, monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(count)
    drives = np.stack([rng.normal(size=(count, 4)), rng.uniform(0.1, 3, (count, 4))], axis=2)
    given = np.zeros((count, 1)), [drives], np.zeros(1)
    for a, b in zip(*both(every_operation(), given, monkeypatch), strict=True):
        np.testing.assert_array_equal(a, b)


def test_random_programs_are_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    """With values of parameters alone, entries that nothing is stored in, and constants."""
    rng = np.random.default_rng(7)
    x, d, p = symbols(3, 2, 2)
    values = [*ca.vertsplit(x), *ca.vertsplit(d), *ca.vertsplit(p), ca.SX(0.5)]
    for _ in range(200):
        a, b = (values[i] for i in rng.integers(len(values), size=2))
        values.append(ca.tanh(list(PAIRS.values())[rng.integers(3)](a, b)))
    more = ca.vertcat(values[-4], 0, p[0] * p[1], 3.0)
    step = function(ca.vertcat(*values[-3:]), more, symbols=(x, d, p))
    given = rng.normal(size=(13, 3)), [rng.normal(size=(13, 5, 2))], rng.normal(size=2)
    for a, b in zip(*both(step, given, monkeypatch), strict=True):
        np.testing.assert_array_equal(a, b)


def test_what_runs_away_leaves_its_neighbours_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    x, d, p = symbols(1, 1, 1)
    step = function(x * x * d + p, symbols=(x, d, p))
    start = np.array([[1.0], [np.nan], [1e200]])
    given = start, [np.full((3, 4, 1), 0.5)], np.ones(1)
    interpreted, made = both(step, given, monkeypatch)
    np.testing.assert_array_equal(interpreted[0], made[0])
    assert np.isfinite(made[0][0]).all()
    assert np.isinf(made[0][2]).any()


def test_it_takes_over_where_a_function_has_run_long(monkeypatch: pytest.MonkeyPatch) -> None:
    x, d, p = symbols(1, 1, 1)
    run = Chains(function(x * d + p, symbols=(x, d, p)))
    engine = run._engine
    assert engine is not None
    monkeypatch.setattr(chains, "NATIVE_FROM", 3 * 6)
    given = np.ones((LANES + 1, 1)), [np.full((LANES + 1, 6, 1), 0.9)], np.ones(1)
    first = run(*given)  # two blocks of six steps
    assert engine._native is None
    second = run(*given)
    assert engine._native is not None
    np.testing.assert_array_equal(first[0], second[0])
    built = engine._native
    run(*given)
    assert engine._native is built


def test_without_it_the_machine_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    x, d, p = symbols(1, 1, 1)
    step = function(x * d + p, symbols=(x, d, p))
    given = np.ones((2, 1)), [np.full((2, 3, 1), 0.9)], np.ones(1)
    (expected,) = Chains(step)(*given)
    monkeypatch.setattr(chains, "NATIVE_FROM", 1)
    monkeypatch.setattr(chains_native, "shared_library", lambda *given, **about: None)
    run = Chains(step)
    np.testing.assert_array_equal(run(*given)[0], expected)
    assert run._engine is not None
    assert run._engine._native is None


def test_a_long_function_is_not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    x, d, p = symbols(1, 1, 1)
    code = chains.program(function(x * d + p, symbols=(x, d, p)))
    assert code is not None
    assert chains_native.native(code) is not None
    monkeypatch.setattr(chains_native, "INSTRUCTIONS_MOST", 1)
    assert chains_native.native(code) is None
