"""Every engine gives CasADi's numbers, whatever the shape of the arrays, special values too."""

import itertools
import os
import subprocess
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from symhyb.numeric.kernels import compiled, vector, vector_c, vector_numpy, vector_source
from symhyb.numeric.kernels.buffers import call, mapped
from symhyb.numeric.kernels.instructions import BINARY, UNARY, program
from symhyb.numeric.kernels.vector import along

NEVER = 10**12
ENGINES = ("c", "numpy", "casadi")
SPECIAL = (0.0, -0.0, 1.0, -1.0, 0.5, -2.5, 3.0, 1e-310, 1e300, -1e17, np.inf, -np.inf, np.nan)


@pytest.fixture(params=ENGINES)
def engine(request: pytest.FixtureRequest, only: Callable[[str], None]) -> str:
    if request.param == "c" and compiled.find_compiler() is None:
        pytest.skip("no C compiler")
    only(request.param)
    return str(request.param)


@pytest.fixture
def only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Make one engine do everything, however little there is to do."""
    monkeypatch.setattr(compiled, "cache_folder", lambda kind: tmp_path)

    def choose(name: str) -> None:
        monkeypatch.setattr(vector, "SAMPLES_NUMPY", NEVER if name == "casadi" else 1)
        monkeypatch.setattr(vector, "INSTRUCTIONS_NUMPY", -1)
        monkeypatch.setattr(vector, "WORK_C", 0 if name == "c" else NEVER)
        monkeypatch.setattr(vector, "WORK_C_INSTRUCTION", 0)

    return choose


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


def test_it_stands_in_for_call_and_mapped(engine: str) -> None:
    function, total = oscillator(), 20_001
    arguments = draw(function, total, (5,))
    arguments[5] = np.abs(arguments[5]) + 0.1
    (found,) = along(function, arguments, (5,))
    (wanted,) = call(mapped(function, total, (5,)), arguments)
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
    (wanted,) = call(mapped(function, x.size), (x, y))
    # 1e17 is a large angle: libraries agree on it to the last digits only
    np.testing.assert_allclose(found, wanted, rtol=2e-15, atol=1e-320, equal_nan=True)


def test_engines_do_what_they_are_asked_to(only: Callable[[str], None]) -> None:
    function, kinds = oscillator(), {"numpy": vector_numpy.Plan, "c": vector_c.Kernel}
    given = [[column] for column in np.ones((5, 10))] + [[np.ones(1)] * 5]
    for name, kind in kinds.items():
        if name == "c" and compiled.find_compiler() is None:
            continue
        only(name)
        assert isinstance(vector._engine(function, frozenset({5}), 10, given), kind)
    only("casadi")
    assert vector._engine(function, frozenset({5}), 10, given) is None


def test_only_much_work_is_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(vector, "_kernel", lambda *key: asked.append(key))
    monkeypatch.setattr(vector, "find_compiler", lambda: ("cc", "gcc"))
    function = oscillator()
    for total in (10, 100_000, 10_000_000):
        vector._engine(function, frozenset({5}), total, [[np.ones(1)]] * 6)
    assert len(asked) == 1


def test_strided_columns_and_lists_of_columns(engine: str) -> None:
    function, total = wide(), 5000
    random = np.random.default_rng(1)
    table = random.normal(size=(total, 16))
    q, v, p = table[:, 2:5], table[:, :15:3], np.array([0.3, -0.2])
    wanted = along(function, (q.copy(), v.copy(), p, []), (2,))
    backwards = [np.ascontiguousarray(c[::-1])[::-1] for c in v.T]
    for shape in (
        (q, v, p, []),
        (list(q.T), [c.copy() for c in v.T], p, np.zeros((total, 0))),
        (np.asfortranarray(q), backwards, list(p), ()),
        (q.reshape(50, 100, 3), v.reshape(50, 100, 5), p, []),
        ([c.astype(">f8") for c in q.T], v.astype(np.longdouble), p[:, None], []),
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


def test_threads_change_nothing(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(vector, "SAMPLES_THREAD", 10)
    function = wide()
    arguments = draw(function, 1001, (2,))
    one_thread = along(function, arguments, (2,))
    for found, wanted in zip(along(function, arguments, (2,), threads=3), one_thread, strict=True):
        np.testing.assert_array_equal(found, wanted)


def test_blocks_of_registers(only: Callable[[str], None], monkeypatch: pytest.MonkeyPatch) -> None:
    # A long function whose values live for different times, in blocks that do not divide N.
    only("numpy")
    monkeypatch.setattr(vector_numpy, "BLOCK_LEAST", 64)
    monkeypatch.setattr(vector_numpy, "BUFFER", 0)
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
    plan = vector_numpy.plan(program(function), frozenset())
    assert plan.registers < len(plan.steps) / 2


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


def test_tanh_is_accurate(only: Callable[[str], None]) -> None:
    if compiled.find_compiler() is None:
        pytest.skip("no C compiler")
    only("c")
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
        ((np.ones((9, 2)), np.ones((9, 5)), np.ones(2), []), "v has 9 samples, needs 6"),
        ((np.ones((9, 3)), np.ones((8, 5)), np.ones(2), []), "v has 8 samples, needs 9"),
        ((np.ones((9, 3)), np.ones((9, 5)), np.ones(3), []), "p has 3 entries, needs"),
        ((np.ones((9, 3)), np.ones((9, 5)), np.ones(4), []), "p has 2 samples, needs 1"),
        ((np.ones((9, 3)), [np.ones(9)] * 4, np.ones(2), []), "v has 4 columns, needs 5"),
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


def test_nothing_is_copied(engine: str) -> None:
    function, total = oscillator(), 300_000
    if engine == "casadi":  # which does little work only: it needs no more than what it was before
        total = 1000
    arguments = [*np.ones((5, total)), np.ones(5)]
    along(function, [a[:2000] if i < 5 else a for i, a in enumerate(arguments)], (5,))
    tracemalloc.start()
    along(function, arguments, (5,))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 8 * total + 1_500_000  # the output, and registers


def test_a_library_that_cannot_be_loaded_is_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "text.so").write_text("no machine code")
    monkeypatch.setattr(vector_c, "find_compiler", lambda: ("cc", "gcc"))
    monkeypatch.setattr(vector_c, "shared_library", lambda *given: tmp_path / "text.so")
    assert vector_c.build(program(oscillator()), frozenset()) is None


@pytest.mark.parametrize("compiler", ["false", "gone"])
def test_without_a_working_compiler_numpy_does_it(
    only: Callable[[str], None], monkeypatch: pytest.MonkeyPatch, compiler: str
) -> None:
    only("c")
    found = None if compiler == "gone" else (compiler, "broken")
    for module in (compiled, vector, vector_c):
        monkeypatch.setattr(module, "find_compiler", lambda: found)
    function = oscillator()
    given = [[column] for column in np.ones((5, 10))] + [[np.ones(1)] * 5]
    chosen = vector._engine(function, frozenset({5}), 10, given)
    assert isinstance(chosen, vector_numpy.Plan)


def test_a_library_without_vector_forms_gives_the_same(tmp_path: Path) -> None:
    if compiled.find_compiler() is None:
        pytest.skip("no C compiler")
    function = wide()
    code = vector_source.source(program(function), frozenset({2}), frozenset({0}), frozenset())
    assert "__simd__" not in code
    (tmp_path / "code.c").write_text(code)
    flags = [*vector_c.FLAGS, "-Wall", "-Wextra", "-Werror", "-Wno-unknown-pragmas", "-std=gnu11"]
    command = [compiled.find_compiler()[0], *flags, "-c", "code.c"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_a_second_process_finds_the_library(tmp_path: Path) -> None:
    if compiled.find_compiler() is None:
        pytest.skip("no C compiler")
    script = """
import casadi as ca, numpy as np
from symhyb.numeric.kernels import vector
vector.WORK_C = vector.WORK_C_INSTRUCTION = 0
x = ca.SX.sym("x", 2)
f = ca.Function("f", [x], [ca.sin(x[0]) * ca.exp(x[1])])
print(vector.along(f, [np.linspace(0, 1, 4000).reshape(-1, 2)])[0].sum().hex())
"""
    said = set()
    for _ in range(2):
        done = subprocess.run(
            [sys.executable, "-c", script],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "XDG_CACHE_HOME": str(tmp_path), "HOME": str(tmp_path)},
        )
        said.add(done.stdout)
        libraries = list(tmp_path.rglob("*.so"))
        assert len(libraries) == 1
    assert len(said) == 1
