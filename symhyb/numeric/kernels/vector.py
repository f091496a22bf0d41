"""A CasADi function along N samples.

    along(function, arguments, repeated)

Samples are chains of one step (:mod:`chains`): with a C compiler eight are computed at once, by the
machine for instruction lists and, for what is computed over and over, by code of its own, with the
same result bit by bit. Without one NumPy does it in blocks (:mod:`vector_numpy`). CasADi's virtual
machine is left few samples of a long function, and functions that are not made of scalar
operations. Which one it is depends on the function, N and the machine alone, so a second run
repeats the first to the last bit.
"""

from collections.abc import Callable, Sequence
from functools import lru_cache, partial

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from symhyb.numeric.kernels import expressions, vector_numpy
from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains import Engine
from symhyb.numeric.kernels.chains_listed import machine
from symhyb.numeric.kernels.instructions import program

# the arguments that vary, (N, rows), the others in one, (P,), and N -> outputs (N, entries)
Work = Callable[[Sequence[Array], Array, int], list[Array]]

SAMPLES_LEAST = 250  # below, a long function is quicker in CasADi: laying out its list takes longer
INSTRUCTIONS_SHORT = 150  # and no function is long below this


def along(
    function: ca.Function,
    arguments: Sequence[ArrayLike],
    repeated: Sequence[int] = (),
    samples: int | None = None,
) -> tuple[Array, ...]:
    """Evaluate ``function`` at N samples.

    An argument that CasADi declares with r rows has N·r entries in the order (N, r). The arguments
    ``repeated`` are given once, (r,). N follows from the first argument that varies and has rows,
    or is ``samples``. Each output (rows, columns) comes back dense as (N·columns, rows); with one
    column that is (N, rows).

    Raises:
        ValueError: an argument has not as many entries as the function declares.
    """
    held = frozenset(repeated)
    if len(arguments) != function.n_in():
        raise ValueError(f"{function.name()}: {len(arguments)} arguments, needs {function.n_in()}")
    given = [np.asarray(argument, dtype=np.float64) for argument in arguments]
    total = _samples(function, given, held) if samples is None else samples
    given = [_rows(function, i, a, 1 if i in held else total) for i, a in enumerate(given)]
    sizes = [function.size_out(i) for i in range(function.n_out())]
    if not total:
        return tuple(np.empty((0, rows)) for rows, _ in sizes)
    work = _work(function, held, total)
    if work is None:
        wide = [np.repeat(a, total, 0) if i in held else a for i, a in enumerate(given)]
        return call(_mapped(function, total), wide)
    moving = [a for i, a in enumerate(given) if i not in held]
    fixed = [given[i].reshape(-1) for i in sorted(held)]
    made = work(moving, np.concatenate([*fixed, np.empty(0)]), total)
    return tuple(
        one.reshape(total * wide, rows) for one, (rows, wide) in zip(made, sizes, strict=True)
    )


def _samples(function: ca.Function, given: Sequence[Array], held: frozenset[int]) -> int:
    """N as the first argument says that varies and has rows; 1 if there is none."""
    rows = ((i, function.numel_in(i)) for i in range(len(given)) if i not in held)
    return next((given[i].size // wide for i, wide in rows if wide), 1)


def _rows(function: ca.Function, i: int, argument: Array, total: int) -> Array:
    """An argument as (N, rows)."""
    needed = total * function.numel_in(i)
    if argument.size != needed:
        name = f"{function.name()}: argument {function.name_in(i)}"
        raise ValueError(f"{name} has {argument.size} entries, needs {needed}")
    return argument.reshape(total, function.numel_in(i))


def _work(function: ca.Function, held: frozenset[int], total: int) -> Work | None:
    """What evaluates this function at so many samples; None for CasADi's virtual machine."""
    instructions = function.n_instructions() if function.is_a("SXFunction") else 0
    if total < SAMPLES_LEAST and instructions > INSTRUCTIONS_SHORT:
        return None
    return _chained(function, held)


@lru_cache(maxsize=64)
def _chained(function: ca.Function, held: frozenset[int]) -> Work | None:
    """The same for any number of samples; a function is its own key, compared by identity."""
    code, run = program(function), machine()
    if code is None:
        return None
    code = code.gathered(held)
    if run is not None and expressions.supported(code):
        return partial(Engine(code, run), steps=1)
    return partial(vector_numpy.blocks, code) if vector_numpy.supported(code) else None


@lru_cache(maxsize=64)
def _mapped(function: ca.Function, total: int) -> ca.Function:
    """The same function of so many samples, its outputs dense."""
    return _dense(function).map(total)


def _dense(function: ca.Function) -> ca.Function:
    if all(function.sparsity_out(i).is_dense() for i in range(function.n_out())):
        return function
    arguments = [
        ca.MX.sym(function.name_in(i), *function.size_in(i)) for i in range(function.n_in())
    ]
    results = [ca.densify(result) for result in function.call(arguments)]
    return ca.Function(function.name(), arguments, results)
