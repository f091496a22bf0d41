"""Every engine gives CasADi's numbers, whatever the shape of the arrays, special values too."""

import itertools
import tracemalloc
from functools import partial

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels import vector, vector_numpy
from symhyb.numeric.kernels.buffers import call
from symhyb.numeric.kernels.chains_listed import machine
from symhyb.numeric.kernels.instructions import BINARY, UNARY
from symhyb.numeric.kernels.vector import along

ENGINES = ("c", "numpy", "casadi")
SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 1e-310, 1e300, -1e17, np.inf, -np.inf, np.nan)


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """One engine does everything."""
    if request.param == "c" and machine() is None:
        pytest.skip("no C compiler")
    if request.param == "casadi":
        monkeypatch.setattr(vector, "_work", lambda *given: None)
    if request.param == "numpy":
        monkeypatch.setattr(vector, "machine", lambda: None)
    monkeypatch.setattr(vector, "SAMPLES_LEAST", 1)
    return str(request.param)


def oscillator() -> ca.Function:
    """ΔF of a mass on a spring with a damper and dry friction."""
    q, v, a, u, t = (ca.SX.sym(name) for name in "qvaut")
    p = ca.SX.sym("p", 5)
    force = p[0] * a + p[1] * q + p[2] * v + p[3] * ca.tanh(v / p[4]) - u
    return ca.Function("discrepancy", [q, v, a, u, t, p], [force])


def wide() -> ca.Function:
    """Several outputs: a matrix, one with gaps, constants, an argument handed through, an empty."""
    q, v, p, u = ca.SX.sym("q", 3), ca.SX.sym("v", 5), ca.SX.sym("p", 2), ca.SX.sym("u", 0)
    matrix = ca.vertcat(
        ca.horzcat(q[0] * v[4], ca.sin(q[1])), ca.horzcat(p[0], ca.exp(p[1]) + q[2])
    )
    gaps = ca.diag(ca.vertcat(q[1] * p[0], ca.cos(q[1])))
    same = ca.vertcat(q[0] * v[4], 7.0, q[2], p[1], v[1])
    return ca.Function("wide", [q, v, p, u], [matrix, gaps, same, ca.SX(0, 1), ca.SX(2, 2)])


def reference(function: ca.Function, arguments: list[np.ndarray], held: tuple[int, ...]):
    """CasADi sample by sample, through its own matrices."""
    total = next(len(a) for i, a in enumerate(arguments) if i not in held and np.size(a))
    parts = []
    for i in range(total):
        at = [a if j in held else a[i] for j, a in enumerate(arguments)]
        parts.append([np.array(ca.densify(r)).T for r in function.call(at)])
    return [np.concatenate(columns) for columns in zip(*parts, strict=True)]


def draw(function: ca.Function, total: int, held: tuple[int, ...]) -> list[np.ndarray]:
    random = np.random.default_rng(5)
    rows = [function.numel_in(i) for i in range(function.n_in())]
    return [random.normal(size=(r,) if i in held else (total, r)) for i, r in enumerate(rows)]


@pytest.mark.parametrize("total", [1, 7, 300])
@pytest.mark.parametrize("held", [(), (2,), (1, 2)])
def test_all_outputs_of_all_shapes(engine: str, total: int, held: tuple[int, ...]) -> None:
    function = wide()
    arguments = draw(function, total, held)
    results = along(function, arguments, held)
    expected = reference(function, arguments, held)
    assert [r.shape for r in results] == [
        (2 * total, 2),
        (2 * total, 2),
        (total, 5),
        (total, 0),
        (2 * total, 2),
    ]
    for found, wanted in zip(results, expected, strict=True):
        assert found.flags.c_contiguous
        np.testing.assert_allclose(found, wanted.reshape(found.shape), rtol=1e-14, atol=1e-15)


def test_many_samples_are_those_of_casadi(engine: str) -> None:
    function, total = oscillator(), 20_001
    arguments = draw(function, total, (5,))
    arguments[5] = np.abs(arguments[5]) + 0.1
    (found,) = along(function, arguments, (5,))
    wide = [*arguments[:5], np.repeat(arguments[5][None], total, axis=0)]
    (wanted,) = call(function.map(total), wide)
    assert found.shape == wanted.shape == (total, 1)
    np.testing.assert_allclose(found, wanted, rtol=1e-13, atol=1e-14)


def one(operation: int) -> ca.Function:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    binary = operation in BINARY
    result = ca.SX.binary(operation, x, y) if binary else ca.SX.unary(operation, x)
    return ca.Function("one", [x, y], [result])


@pytest.mark.parametrize("operation", sorted(UNARY | BINARY))
def test_every_operation_with_every_special_value(engine: str, operation: int) -> None:
    function = one(operation)
    pairs = np.array(list(itertools.product(SPECIAL, SPECIAL)))
    random = np.random.default_rng(7).normal(scale=3, size=(500, 2))
    x, y = np.concatenate([pairs, random]).T
    (found,) = along(function, (x, y))
    (wanted,) = call(function.map(x.size), (x, y))
    # 1e17 is a large angle: libraries agree on it to the last digits only
    np.testing.assert_allclose(found, wanted, rtol=2e-15, atol=1e-320, equal_nan=True)


def test_each_engine_does_what_is_its_own(engine: str) -> None:
    work = vector._work(oscillator(), frozenset({5}), 10)
    if engine == "casadi":
        assert work is None
    else:
        assert isinstance(work, partial)
        assert (work.func is vector_numpy.blocks) == (engine == "numpy")


def test_few_samples_of_a_long_function_are_casadis() -> None:
    x = ca.SX.sym("x")
    y = x
    for _ in range(200):
        y = ca.sin(y) + x
    function = ca.Function("long", [x], [y])
    assert vector._work(function, frozenset(), 100) is None
    assert vector._work(function, frozenset(), 1000) is not None


def test_arrays_of_any_layout(engine: str) -> None:
    function, total = wide(), 5000
    random = np.random.default_rng(1)
    table = random.normal(size=(total, 16))
    q, v, p = table[:, 2:5], table[:, :15:3], np.array([0.3, -0.2])
    wanted = along(function, (q.copy(), v.copy(), p, []), (2,))
    for shape in (
        (q, v, p, []),
        (np.asfortranarray(q), np.asfortranarray(v), list(p), ()),
        (q.reshape(50, 100, 3), v.reshape(50, 100, 5), p, np.zeros((total, 0))),
        (q.astype(">f8"), v.astype(np.longdouble), p[:, None], []),
    ):
        for found, other in zip(along(function, shape, (2,)), wanted, strict=True):
            np.testing.assert_array_equal(found, other)


def test_single_numbers_and_integers(engine: str) -> None:
    (force,) = along(
        oscillator(), (np.arange(4), [0, 0, 0, 0], *np.zeros((3, 4)), range(1, 6)), (5,)
    )
    np.testing.assert_allclose(force[:, 0], 2.0 * np.arange(4), rtol=1e-15)


def test_nothing_varies_and_no_samples(engine: str) -> None:
    function = oscillator()
    (single,) = along(function, (*np.ones(5), np.ones(5)), tuple(range(6)))
    assert single.shape == (1, 1)
    (several,) = along(function, (*np.ones(5), np.ones(5)), tuple(range(6)), samples=4)
    np.testing.assert_array_equal(several, np.repeat(single, 4, axis=0))
    (none,) = along(function, (*np.ones((5, 0)), np.ones(5)), (5,))
    assert none.shape == (0, 1)


def test_no_samples_as_a_user_has_them() -> None:
    for function in (oscillator(), wide()):
        rows = [function.numel_in(i) for i in range(function.n_in())]
        results = along(function, [np.empty((0, r)) for r in rows])
        assert [result.size for result in results] == [0] * function.n_out()


def test_a_long_function_in_blocks(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values that live for different times, and blocks that do not divide N."""
    monkeypatch.setattr(vector_numpy, "BLOCK", 64)
    x, random = ca.SX.sym("x", 4), np.random.default_rng(11)
    values = list(ca.vertsplit(x))
    for _ in range(300):
        i, j = random.integers(len(values), size=2)
        values.append(random.choice((ca.sin, ca.tanh, ca.fabs))(values[i]) + 0.5 * values[j])
    chosen = [values[i] for i in (-1, 0, 17, 200, -1)]
    function = ca.Function("long", [x], [ca.vertcat(*chosen), values[120] * 2])
    given = random.normal(size=(1000, 4))
    for found, wanted in zip(
        along(function, [given]), reference(function, [given], ()), strict=True
    ):
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12)


def test_functions_that_are_not_scalar_are_casadis(engine: str) -> None:
    x = ca.MX.sym("x", 3)
    function = ca.Function("norm", [x], [ca.norm_2(x), ca.MX(ca.DM(ca.Sparsity.diag(2)))])
    given = np.random.default_rng(2).normal(size=(400, 3))
    length, fixed = along(function, [given])
    np.testing.assert_allclose(length[:, 0], np.linalg.norm(given, axis=1), rtol=1e-14)
    np.testing.assert_array_equal(fixed.reshape(400, 2, 2), np.broadcast_to(np.eye(2), (400, 2, 2)))


def test_a_choice_that_is_not_taken_does_not_count(engine: str) -> None:
    x = ca.SX.sym("x")
    function = ca.Function("f", [x], [ca.if_else(x > 0, ca.log(x), -ca.sqrt(-x))])
    (found,) = along(function, [np.array([4.0, -4.0, 0.0, np.nan])])
    np.testing.assert_allclose(found[:2, 0], [np.log(4), -2])


def test_tanh_is_accurate() -> None:
    if machine() is None:
        pytest.skip("no C compiler")
    tiny = np.geomspace(1e-310, 40, 200_001)
    x = np.concatenate([tiny, -tiny, np.linspace(-21, 21, 200_001)])
    (found,) = along(one(ca.OP_TANH), (x, x))
    exact = np.tanh(x.astype(np.longdouble))
    assert np.max(np.abs(found[:, 0] - exact) / np.spacing(np.abs(np.tanh(x)))) < 3
    assert np.all(np.abs(found) <= 1)


def test_subnormal_numbers_stay_after_loading(engine: str) -> None:
    along(oscillator(), (*np.ones((5, 100)), np.ones(5)), (5,))
    assert np.array([2e-323])[0] * 0.5 != 0


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ((np.ones((9, 2)), np.ones((9, 5)), np.ones(2), []), "v has 45 entries, needs 30"),
        ((np.ones((9, 3)), np.ones((8, 5)), np.ones(2), []), "v has 40 entries, needs 45"),
        ((np.ones((9, 3)), np.ones((9, 5)), np.ones(3), []), "p has 3 entries, needs 2"),
        ((np.ones((9, 3)), np.ones((9, 5)), np.ones(2), np.ones(9)), "u has 9 entries"),
        ((np.ones((9, 3)), np.ones((9, 5)), np.ones(2)), "3 arguments, needs 4"),
    ],
)
def test_wrong_sizes_are_refused(arguments: tuple[np.ndarray, ...], text: str) -> None:
    function = wide()
    names = ["q", "v", "p", "u"]
    function = ca.Function(
        "wide", function.sx_in(), function.call(function.sx_in()), names, list("abcde")
    )
    with pytest.raises(ValueError, match=text):
        along(function, arguments, (2,))


def test_arrays_are_not_copied(engine: str) -> None:
    function, total = oscillator(), 300_000
    if engine == "casadi":  # which does little work only: it gets the parameters at every sample
        total = 1000
    arguments = [*np.ones((5, total)), np.ones(5)]
    along(function, [a[:2000] if i < 5 else a for i, a in enumerate(arguments)], (5,))
    tracemalloc.start()
    along(function, arguments, (5,))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8 * total + 1_500_000  # the output, and what is between
