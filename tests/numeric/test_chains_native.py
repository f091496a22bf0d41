"""Chains as machine code of their own: bit by bit what the machine for instruction lists gives."""

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels import chains_native, chains_text, compiled
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains import Chains
from symhyb.numeric.kernels.chains_source import LANES
from symhyb.numeric.kernels.compiled import find_compiler
from symhyb.numeric.kernels.instructions import program
from tests.numeric.test_chains import PAIRS, every_operation, function, symbols

pytestmark = pytest.mark.skipif(find_compiler() is None, reason="needs a C compiler")

Given = tuple[Array, list[Array], Array]


def both(
    step: ca.Function, given: Given, monkeypatch: pytest.MonkeyPatch
) -> tuple[list[Array], list[Array]]:
    """The outputs by the machine and by a function's own code."""
    begin_from(10**9, monkeypatch)
    interpreted = Chains(step)(*given)
    begin_from(0, monkeypatch)
    run = Chains(step)
    run(*given)
    built(run)
    return interpreted, run(*given)


def begin_from(work: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compile as soon as so many instructions were run, whatever is in the cache."""
    monkeypatch.setattr(chains_native, "BEGIN_FROM", work)
    monkeypatch.setattr(chains_native, "BEGIN_FROM_EACH", 0)
    made = compiled.file_of
    monkeypatch.setattr(
        chains_native,
        "file_of",
        lambda code, level, ready=False: None if ready else made(code, level),
    )


def built(run: Chains) -> chains_native.Run | None:
    """The code that a compiler is at work on, when it is done."""
    assert run._engine is not None
    native = run._engine.native
    assert native.thread is not None
    native.thread.join()
    return native.after(0)


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


def simple() -> ca.Function:
    x, d, p = symbols(1, 1, 1)
    return function(x * d + p, symbols=(x, d, p))


def test_it_takes_over_where_a_function_has_run_long(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Chains(simple())  # of two instructions
    assert run._engine is not None
    native = run._engine.native
    begin_from(3 * 6 * 2, monkeypatch)
    given = np.ones((LANES + 1, 1)), [np.full((LANES + 1, 6, 1), 0.9)], np.ones(1)
    first = run(*given)  # two blocks of six steps
    assert native.thread is None
    second = run(*given)
    done = built(run)
    assert done is not None
    third = run(*given)
    for made in (second, third):
        np.testing.assert_array_equal(first[0], made[0])
    assert native.run is done


def test_one_function_is_compiled_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    begin_from(0, monkeypatch)
    run = Chains(simple())
    given = np.ones((2, 1)), [np.full((2, 3, 1), 0.9)], np.ones(1)
    assert run._engine is not None
    with chains_native._compiler:
        run(*given)
        assert run._engine.native.thread is None
    run(*given)
    assert built(run) is not None


def test_what_was_compiled_before_is_taken_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    given = np.ones((2, 1)), [np.full((2, 3, 1), 0.9)], np.ones(1)
    with monkeypatch.context() as first:
        begin_from(0, first)
        run = Chains(simple())
        (expected,) = run(*given)
        built(run)
    again = Chains(simple())
    np.testing.assert_array_equal(again(*given)[0], expected)
    assert again._engine is not None
    assert again._engine.native.run is not None
    assert again._engine._listed is None


def test_without_it_the_machine_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    given = np.ones((2, 1)), [np.full((2, 3, 1), 0.9)], np.ones(1)
    (expected,) = Chains(simple())(*given)
    begin_from(0, monkeypatch)
    monkeypatch.setattr(chains_native, "file_of", lambda *task, ready=False: None)
    run = Chains(simple())
    np.testing.assert_array_equal(run(*given)[0], expected)
    assert built(run) is None
    np.testing.assert_array_equal(run(*given)[0], expected)


def test_a_long_function_is_not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    code = program(simple())
    assert code is not None
    begin_from(0, monkeypatch)
    monkeypatch.setattr(chains_native, "INSTRUCTIONS_MOST", 1)
    native = chains_native.Native(code)
    assert native.after(1) is None
    assert native.thread is None


def test_a_step_of_several_functions_is_the_same(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(chains_text, "TOGETHER", 3)
    test_random_programs_are_the_same(monkeypatch)
    test_every_operation_is_the_same(LANES + 1, monkeypatch)
