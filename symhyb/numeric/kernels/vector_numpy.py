"""A program over many samples in NumPy, block by block, so that what is between stays in cache: the
way without a C compiler."""

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.instructions import NOTHING, Program

BLOCK = 8192  # samples: fewer, and Python takes longer than the numbers

Work = Callable[..., Any]


def _error_function(value: Any) -> Any:
    from scipy.special import erf

    return erf(value)


WORK: dict[int, Work] = {
    ca.OP_ADD: np.add,
    ca.OP_SUB: np.subtract,
    ca.OP_MUL: np.multiply,
    ca.OP_DIV: np.divide,
    ca.OP_NEG: np.negative,
    ca.OP_EXP: np.exp,
    ca.OP_LOG: np.log,
    ca.OP_POW: np.power,
    ca.OP_CONSTPOW: np.power,
    ca.OP_SQRT: np.sqrt,
    ca.OP_SQ: np.square,
    ca.OP_TWICE: lambda value: np.add(value, value),
    ca.OP_SIN: np.sin,
    ca.OP_COS: np.cos,
    ca.OP_TAN: np.tan,
    ca.OP_ASIN: np.arcsin,
    ca.OP_ACOS: np.arccos,
    ca.OP_ATAN: np.arctan,
    ca.OP_LT: np.less,
    ca.OP_LE: np.less_equal,
    ca.OP_EQ: np.equal,
    ca.OP_NE: np.not_equal,
    ca.OP_NOT: np.logical_not,
    ca.OP_AND: np.logical_and,
    ca.OP_OR: np.logical_or,
    ca.OP_FLOOR: np.floor,
    ca.OP_CEIL: np.ceil,
    ca.OP_FMOD: np.fmod,
    ca.OP_FABS: np.fabs,
    ca.OP_SIGN: np.sign,
    ca.OP_COPYSIGN: np.copysign,
    # a NaN that is not chosen does not count
    ca.OP_IF_ELSE_ZERO: lambda chosen, value: np.where(np.not_equal(chosen, 0.0), value, 0.0),
    ca.OP_ERF: _error_function,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    ca.OP_INV: lambda value: np.divide(1.0, value),
    ca.OP_SINH: np.sinh,
    ca.OP_COSH: np.cosh,
    ca.OP_TANH: np.tanh,
    ca.OP_ASINH: np.arcsinh,
    ca.OP_ACOSH: np.arccosh,
    ca.OP_ATANH: np.arctanh,
    ca.OP_ATAN2: np.arctan2,
    ca.OP_LOG1P: np.log1p,
    ca.OP_EXPM1: np.expm1,
    ca.OP_HYPOT: np.hypot,
}


def supported(program: Program) -> bool:
    """Whether every operation has a NumPy form here."""
    return program.operations() <= WORK.keys()


def blocks(program: Program, given: Sequence[Array], p: Array, samples: int) -> list[Array]:
    """All outputs (N, entries) of a program whose last argument ``p`` (P,) is the same for all
    samples, from the others (N, rows); in the units of the function."""
    made = [np.zeros((samples, entries)) for entries in program.results]
    last = len(program.arguments) - 1
    values: list[Any] = [None] * program.size
    wanted = {value for _, _, value in program.stores}
    done: dict[int, list[int]] = {}  # the values that nothing asks for after a step
    for value, _, left, right in reversed(program.steps):
        done[value] = [one for one in (left, right) if one not in wanted and one != NOTHING]
        wanted.update(done[value])
    with np.errstate(all="ignore"):  # CasADi says nothing either
        for start in range(0, samples, BLOCK):
            part = slice(start, start + BLOCK)
            for value, number in program.constants:
                values[value] = np.float64(number)
            for value, argument, entry in program.loads:
                values[value] = p[entry] if argument == last else given[argument][part, entry]
            for value, operation, left, right in program.steps:
                more = () if right == NOTHING else (values[right],)
                values[value] = WORK[operation](values[left], *more)
                for one in done[value]:  # its memory serves the next
                    values[one] = None
            for output, entry, value in program.stores:
                made[output][part, entry] = values[value]
    return made
