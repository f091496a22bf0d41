"""A CasADi function along N samples, as fast as the memory allows where that can be had.

    along(function, arguments, repeated)   in place of   call(mapped(function, N, repeated), …)

Three engines give the same numbers up to rounding. C code over columns (:mod:`vector_c`) where a
compiler is found and there is enough to do, NumPy in blocks (:mod:`vector_numpy`) otherwise, and
CasADi's virtual machine for little work and for functions that are not made of scalar operations.
Which one is chosen depends on the function, N and the machine alone, so a second run repeats the
first to the last bit. No argument is copied that is C-contiguous float64, or a column of such.
"""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from typing import TypeGuard

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from symhyb.numeric.kernels import vector_c, vector_numpy, vector_source
from symhyb.numeric.kernels.buffers import call, mapped
from symhyb.numeric.kernels.compiled import find_compiler
from symhyb.numeric.kernels.instructions import Program, program

Array = NDArray[np.float64]
Columns = Sequence[Array]
Argument = ArrayLike | Columns
Engine = vector_c.Kernel | vector_numpy.Plan

SAMPLES_NUMPY = 250  # below, a long function is quicker in CasADi: Python calls every operation
INSTRUCTIONS_NUMPY = 150  # and no function is long below this
WORK_C = 40_000_000  # samples times instructions; below, compiling never pays
WORK_C_INSTRUCTION = 300_000  # and so much more for every instruction that is to be compiled
INSTRUCTIONS_C_MOST = 20_000  # above, compiling takes minutes
SAMPLES_THREAD = 50_000  # a thread gets at least so many


def along(
    function: ca.Function,
    arguments: Sequence[Argument],
    repeated: Sequence[int] = (),
    samples: int | None = None,
    threads: int = 1,
) -> tuple[Array, ...]:
    """Evaluate ``function`` at N samples.

    An argument that CasADi declares with r rows is an array with N·r entries in the order (N, r),
    any strides if it has that shape, or a list of r columns (N,). The arguments ``repeated`` are
    given once, (r,). N follows from the first argument that varies and has rows, or is ``samples``.
    Each output (rows, columns) comes back dense as (N·columns, rows), as from
    ``call(mapped(function, N, repeated), arguments)``; with one column that is (N, rows).

    Raises:
        ValueError: an argument has not as many entries as the function declares.
    """
    held = frozenset(repeated)
    given = [_columns(function, i, argument) for i, argument in enumerate(arguments)]
    total = _samples(given, held) if samples is None else samples
    _require(function, given, held, total)
    sizes = [function.size_out(i) for i in range(function.n_out())]
    engine = _engine(function, held, total, given) if total else None
    if engine is None and total:
        return _interpreted(function, arguments, held, total)
    full = range(len(sizes)) if engine is None else engine.full
    results = tuple(
        (np.empty if i in full else np.zeros)((total * wide, rows))
        for i, (rows, wide) in enumerate(sizes)
    )
    if engine is not None:
        flat = [result.reshape(total, result.size // total) for result in results]
        outputs = [flat[i][:, entry] for i, entry, _ in engine.stores]
        inputs = [given[i][entry] for _, i, entry in engine.varying]
        fixed = np.array([given[i][entry][0] for _, i, entry in engine.fixed], dtype=np.float64)
        _shared(engine, inputs, fixed, outputs, min(threads, total // SAMPLES_THREAD))
    return results


def _columns(function: ca.Function, i: int, argument: Argument) -> list[Array]:
    """The columns of an argument, one for each entry that CasADi declares; no copy if possible."""
    rows = function.numel_in(i)
    if _is_listed(argument):
        columns = [_double(column) for column in argument]
        if len(columns) != rows:
            raise ValueError(_wrong(function, i, f"{len(columns)} columns", f"{rows}"))
        return columns
    array = _double(argument)
    if array.ndim != 2 or array.shape[1] != rows:
        if array.size and (rows == 0 or array.size % rows):
            raise ValueError(_wrong(function, i, f"{array.size} entries", f"a multiple of {rows}"))
        array = array.reshape(array.size // max(rows, 1), rows)
    return [array[:, entry] for entry in range(rows)]


def _double(values: ArrayLike) -> Array:
    """As float64, as it is if it is that already."""
    if isinstance(values, np.ndarray) and values.dtype == np.float64 and values.flags.aligned:
        return values
    return np.require(values, np.float64, "A")


def _is_listed(argument: Argument) -> TypeGuard[Columns]:
    if not isinstance(argument, list | tuple):
        return False
    return all(isinstance(column, np.ndarray) and column.ndim == 1 for column in argument)


def _samples(given: Sequence[Sequence[Array]], held: frozenset[int]) -> int:
    """N as the first argument says that varies and is not empty; 1 if there is none."""
    varying = (columns[0].size for i, columns in enumerate(given) if columns and i not in held)
    return next(varying, 1)


def _require(
    function: ca.Function, given: Sequence[Sequence[Array]], held: frozenset[int], total: int
) -> None:
    if len(given) != function.n_in():
        raise ValueError(f"{function.name()}: {len(given)} arguments, needs {function.n_in()}")
    for i, columns in enumerate(given):
        needed = 1 if i in held else total
        for column in columns:
            if column.size != needed:
                raise ValueError(_wrong(function, i, f"{column.size} samples", f"{needed}"))


def _wrong(function: ca.Function, i: int, found: str, needed: str) -> str:
    return f"{function.name()}: argument {function.name_in(i)} has {found}, needs {needed}"


def _engine(
    function: ca.Function, held: frozenset[int], total: int, given: Sequence[Sequence[Array]]
) -> Engine | None:
    """What evaluates this function at so many samples; None for CasADi's virtual machine."""
    instructions = function.n_instructions() if function.is_a("SXFunction") else 0
    if total < SAMPLES_NUMPY and instructions > INSTRUCTIONS_NUMPY:
        return None
    if (
        total * instructions >= WORK_C + WORK_C_INSTRUCTION * instructions
        and instructions <= INSTRUCTIONS_C_MOST
        and find_compiler() is not None
    ):
        arrays = (i for i in range(len(given)) if i not in held)
        packed = frozenset(i for i in arrays if given[i] and vector_c.packed(given[i]))
        if (kernel := _kernel(function, held, packed)) is not None:
            return kernel
    return _plan(function, held)


@lru_cache(maxsize=64)
def _program(function: ca.Function) -> Program | None:
    return program(function)  # a function is its own key: it is compared by identity


@lru_cache(maxsize=64)
def _kernel(
    function: ca.Function, held: frozenset[int], packed: frozenset[int]
) -> vector_c.Kernel | None:
    code = _program(function)
    return vector_c.build(code, held, packed) if code and vector_source.supported(code) else None


@lru_cache(maxsize=64)
def _plan(function: ca.Function, held: frozenset[int]) -> vector_numpy.Plan | None:
    code = _program(function)
    return vector_numpy.plan(code, held) if code and vector_numpy.supported(code) else None


def _shared(
    engine: Engine, inputs: Sequence[Array], fixed: Array, outputs: Sequence[Array], threads: int
) -> None:
    """Run the engine, on so many threads, each with its own stretch of the samples."""
    if threads < 2 or not outputs:
        engine(inputs, fixed, outputs)
        return
    # Whole vectors for each, so that every sample is computed the way it is without threads.
    bounds = np.linspace(0, outputs[0].size, threads + 1).astype(int)
    bounds[:-1] -= bounds[:-1] % 64
    with ThreadPoolExecutor(threads) as pool:
        parts = [slice(*bounds[i : i + 2]) for i in range(threads)]
        for done in [
            pool.submit(engine, [c[part] for c in inputs], fixed, [c[part] for c in outputs])
            for part in parts
        ]:
            done.result()


def _interpreted(
    function: ca.Function, arguments: Sequence[Argument], held: frozenset[int], total: int
) -> tuple[Array, ...]:
    """The same by CasADi."""
    dense = [np.stack(a, axis=1) if _is_listed(a) and a else np.asarray(a) for a in arguments]
    return call(mapped(_densified(function), total, repeated=tuple(held)), dense)


def _densified(function: ca.Function) -> ca.Function:
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    names = [function.name_in(i) for i in range(function.n_in())]
    arguments = [ca.MX.sym(name, *function.size_in(i)) for i, name in enumerate(names)]
    results = [ca.densify(result) for result in function.call(arguments)]
    return ca.Function(function.name(), arguments, results, names, function.name_out())
