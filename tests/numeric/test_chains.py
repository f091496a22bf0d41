"""Chains of steps in machine code give what CasADi gives, step by step."""

import itertools
import os
from collections.abc import Callable

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels import chains, chains_listed
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.chains_source import JOINED, LANES
from symhyb.numeric.kernels.instructions import program

PAIRS: dict[int, Callable[[ca.SX, ca.SX], ca.SX]] = {
    ca.OP_ADD: lambda a, b: a + b,
    ca.OP_SUB: lambda a, b: a - b,
    ca.OP_MUL: lambda a, b: a * b,
}


def function(*results: ca.SX, symbols: tuple[ca.SX, ...]) -> ca.Function:
    return ca.Function("step", list(symbols), [ca.densify(result) for result in results])


def symbols(states: int, driven: int, parameters: int) -> tuple[ca.SX, ca.SX, ca.SX]:
    names = (("x", states), ("d", driven), ("p", parameters))
    x, d, p = (ca.SX.sym(name, size) for name, size in names)
    return x, d, p


def one_by_one(step: ca.Function, start: Array, varying: Array, p: Array) -> list[Array]:
    """The outputs (C, S, entries) of CasADi, called for every step of every chain."""
    rows: list[list[list[Array]]] = []
    for x, drives in zip(start, varying, strict=True):
        steps = []
        for drive in drives:
            outputs = call(step, (x, drive, p))
            x = outputs[0].reshape(-1)
            steps.append([output.reshape(-1) for output in outputs])
        rows.append(steps)
    return [np.array([[one[i] for one in chain] for chain in rows]) for i in range(step.n_out())]


def every_operation() -> ca.Function:
    """A step (x, d, p) with a result of each operation that CasADi's SX knows, d[1] positive."""
    x, d, p = symbols(1, 2, 1)
    a, b = d[0], d[1]
    forms = [
        -a,
        ca.exp(a),
        ca.log(b),
        ca.sqrt(b),
        a**2,
        a + a,
        ca.sin(a),
        ca.cos(a),
        ca.tan(a),
        ca.asin(a / 9),
        ca.acos(a / 9),
        ca.atan(a),
        ca.floor(a),
        ca.ceil(a),
        ca.fabs(a),
        ca.sign(a),
        ca.erf(a),
        1 / b,
        ca.sinh(a),
        ca.cosh(a),
        ca.tanh(a),
        ca.asinh(a),
        ca.acosh(1 + b),
        ca.atanh(a / 9),
        ca.log1p(b),
        ca.expm1(a),
        a / b,
        b**a,
        a < b,
        a <= b,
        ca.eq(a, b),
        ca.ne(a, b),
        ca.logic_and(a > 0, b > 1),
        ca.logic_or(a > 0, b > 1),
        ca.logic_not(a > 0),
        ca.fmod(a, b),
        ca.copysign(b, a),
        ca.if_else(a > 0, b, a),
        ca.fmin(a, b),
        ca.fmax(a, b),
        ca.atan2(a, b),
        ca.hypot(a, b),
        ca.remainder(a, b),
    ]
    return function(x + 1, ca.vertcat(*forms), symbols=(x, d, p))


def test_there_is_a_machine_where_there_is_a_compiler() -> None:
    assert (chains_listed.machine() is None) == (chains_listed.library_of("") is None)


@pytest.mark.parametrize("count", [1, LANES - 1, LANES, LANES + 1, 3 * LANES + 2])
def test_any_number_of_chains_gives_what_casadi_gives(count: int) -> None:
    x, d, p = symbols(2, 1, 2)
    after = ca.vertcat(x[0] + 0.1 * x[1], x[1] - 0.1 * (p[0] * ca.sin(x[0]) + p[1] * x[1] - d[0]))
    step = function(after, ca.jacobian(after, x), ca.norm_2(after), symbols=(x, d, p))
    rng = np.random.default_rng(count)
    given = rng.normal(size=(count, 2)), rng.normal(size=(count, 7, 1)), np.array([2.0, 0.3])
    made = Chains(step)(given[0], [given[1]], given[2])
    for ours, theirs in zip(made, one_by_one(step, *given), strict=True):
        assert ours.shape == theirs.shape
        np.testing.assert_allclose(ours, theirs, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("first", PAIRS)
@pytest.mark.parametrize("second", PAIRS)
def test_joined_sums_and_products_are_rounded_one_by_one(first: int, second: int) -> None:
    """On the right and on the left, asked for once and twice: bit by bit what CasADi computes."""
    x, d, p = symbols(2, 3, 1)
    inner, other = PAIRS[first](d[0], x[0]), PAIRS[first](x[1], d[1])
    after = ca.vertcat(PAIRS[second](inner, d[2]), PAIRS[second](d[2], other))
    twice = PAIRS[first](d[1], d[2])
    more = ca.vertcat(PAIRS[second](twice, p[0]), twice, PAIRS[second](twice, twice))
    step = function(after, more, symbols=(x, d, p))
    rng = np.random.default_rng(10 * first + second)
    given = rng.normal(size=(5, 2)), rng.normal(size=(5, 3, 3)), np.array([0.7])
    made = Chains(step)(given[0], [given[1]], given[2])
    for ours, theirs in zip(made, one_by_one(step, *given), strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_pairs_are_joined_at_all() -> None:
    x, d, p = symbols(1, 2, 1)
    step = function(x * d[0] + d[1], d[1] - x * d[0], symbols=(x, d, p))
    code, machine = program(step), chains_listed.machine()
    assert code is not None
    assert machine is not None
    assert {row[0] for row in chains_listed.Listed(code, machine)._inside.tolist()} & set(
        JOINED.values()
    )
    assert {key[:2] for key in JOINED} == set(itertools.product(PAIRS, PAIRS))


def test_every_operation_of_casadi_means_the_same() -> None:
    step = every_operation()
    rng = np.random.default_rng(1)
    drives = np.stack([rng.normal(size=(9, 4)), rng.uniform(0.1, 3, (9, 4))], axis=2)
    given = np.zeros((9, 1)), drives, np.zeros(1)
    made = Chains(step)(given[0], [given[1]], given[2])
    for ours, theirs in zip(made, one_by_one(step, *given), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-14, atol=1e-15)


def test_without_a_compiler_casadi_gives_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    x, d, p = symbols(2, 1, 1)
    step = function(ca.vertcat(x[1], d * p - x[0] * x[1]), x[0] + d, symbols=(x, d, p))
    rng = np.random.default_rng(3)
    given = rng.normal(size=(11, 2)), [rng.normal(size=(11, 4, 1))], np.array([0.4])
    ours = Chains(step)(*given)
    monkeypatch.setattr(chains, "machine", lambda: None)
    for a, b in zip(ours, Chains(step)(*given), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-14, atol=1e-15)


def test_threads_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    x, d, p = symbols(2, 1, 1)
    step = function(ca.vertcat(x[1], d * p - x[0] * ca.tanh(x[1])), x[0] * d, symbols=(x, d, p))
    rng = np.random.default_rng(4)
    count = 5 * LANES + 3
    given = rng.normal(size=(count, 2)), [rng.normal(size=(count, 6, 1))], np.array([0.4])
    alone = Chains(step)(*given)
    monkeypatch.setattr(chains, "WORK_LEAST", 1)
    monkeypatch.setattr(os, "cpu_count", lambda: 3)
    for a, b in zip(alone, Chains(step)(*given), strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_chain_that_is_no_number_leaves_its_neighbours_alone() -> None:
    x, d, p = symbols(1, 1, 1)
    step = function(1 / (x - d) + p, symbols=(x, d, p))
    start = np.array([[1.0], [2.0], [np.nan]])
    varying = np.array([[[1.0], [0.5]], [[0.5], [0.25]], [[0.0], [0.0]]])
    (made,) = Chains(step)(start, [varying], np.zeros(1))
    assert np.isinf(made[0, 0, 0])
    assert np.isfinite(made[1]).all()
    assert np.isnan(made[2]).all()


def test_slots_are_shared_but_no_value_is_overwritten_too_soon() -> None:
    """Random programs with few states and many values, asked for once, twice and never."""
    rng = np.random.default_rng(5)
    for _ in range(20):
        x, d, p = symbols(3, 2, 2)
        values = [*ca.vertsplit(x), *ca.vertsplit(d), *ca.vertsplit(p)]
        for _ in range(60):
            a, b = (values[i] for i in rng.integers(len(values), size=2))
            values.append(list(PAIRS.values())[rng.integers(3)](a, b) * 0.5)
        chosen = [values[i] for i in rng.integers(len(values), size=6)]
        step = function(ca.tanh(ca.vertcat(*chosen[:3])), *chosen[3:], symbols=(x, d, p))
        given = rng.normal(size=(4, 3)), rng.normal(size=(4, 3, 2)), rng.normal(size=2)
        made = Chains(step)(given[0], [given[1]], given[2])
        for ours, theirs in zip(made, one_by_one(step, *given), strict=True):
            np.testing.assert_allclose(ours, theirs, rtol=1e-11, atol=1e-12)
