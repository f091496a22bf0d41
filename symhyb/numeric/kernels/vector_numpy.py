"""A program over many samples in NumPy, block by block, so that what is between stays in cache.

The program becomes a list of (ufunc, operands, result); results live in a few block-sized
registers that are used again as soon as their value is no longer needed, or where they are wanted.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.instructions import NOTHING, Program

BLOCK_MOST = 32_768  # samples; above, nothing is gained
BLOCK_LEAST = 4096  # below, Python takes longer than the numbers
BUFFER = 3 * 1024 * 1024  # bytes of all registers together, between these bounds

Array = NDArray[np.float64]
Work = Callable[..., Any]


def _chosen(condition: Any, value: Any, out: Any = None) -> Any:
    """``value`` where ``condition`` is not 0, else 0; a NaN that is not chosen does not count."""
    result = np.where(np.not_equal(condition, 0.0), value, 0.0)
    if out is None:
        return result
    out[...] = result
    return out


def _one_over(value: Any, out: Any = None) -> Any:
    return np.divide(1.0, value, out=out)


def _twice(value: Any, out: Any = None) -> Any:
    return np.add(value, value, out=out)


def _error_function(value: Any, out: Any = None) -> Any:
    from scipy.special import erf

    return erf(value, out=out)


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
    ca.OP_TWICE: _twice,
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
    ca.OP_IF_ELSE_ZERO: _chosen,
    ca.OP_ERF: _error_function,
    ca.OP_FMIN: np.fmin,
    ca.OP_FMAX: np.fmax,
    ca.OP_INV: _one_over,
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


@dataclass(frozen=True, slots=True)
class Plan:
    """A program laid out on registers.

    Every value has one place in a list: columns of the inputs, then of the outputs, then registers,
    then numbers. Sizes: I varying inputs, O stores.

    Attributes:
        varying: (value, argument, entry) of the inputs that vary, in the order of the places.
        fixed: the same for those that do not.
        before: (work, left, right, place) done once, on numbers.
        steps: the same for every block.
        copies: (from place, to place) of stores that no step writes to directly.
        constants: (place, number).
        given: the places of ``fixed``.
        stores: (output, entry, value) in the order of the places.
        full: the outputs of which every entry is stored.
        registers: how many registers there are.
        places: how many places there are.
    """

    varying: tuple[tuple[int, int, int], ...]
    fixed: tuple[tuple[int, int, int], ...]
    before: tuple[tuple[Work, int, int, int], ...]
    steps: tuple[tuple[Work, int, int, int], ...]
    copies: tuple[tuple[int, int], ...]
    constants: tuple[tuple[int, float], ...]
    given: tuple[int, ...]
    stores: tuple[tuple[int, int, int], ...]
    full: frozenset[int]
    registers: int
    places: int

    def __call__(self, inputs: Sequence[Array], fixed: Array, outputs: Sequence[Array]) -> None:
        """Fill ``outputs`` (one column (N,) a store) from columns (N,) in the order of ``varying``
        and the numbers ``fixed``."""
        if not outputs:
            return
        total = outputs[0].size
        block = min(max(BUFFER // 8 // max(self.registers, 1), BLOCK_LEAST), BLOCK_MOST, total)
        at: list[Any] = [None] * self.places
        for place, number in (*self.constants, *zip(self.given, fixed, strict=True)):
            at[place] = np.array(number)  # NumPy takes it quicker than a number
        memory = np.empty((self.registers, block))
        first, count = len(inputs), len(outputs)
        with np.errstate(all="ignore"):  # CasADi says nothing either
            for work, left, right, place in self.before:
                at[place] = work(at[left]) if right == NOTHING else work(at[left], at[right])
            for start in range(0, total, block):
                stop = min(start + block, total)
                at[:first] = [
                    column[start:stop] if column.strides[0] == 8 else column[start:stop].copy()
                    for column in inputs
                ]
                at[first : first + count] = [column[start:stop] for column in outputs]
                at[first + count : first + count + self.registers] = memory[:, : stop - start]
                for work, left, right, place in self.steps:
                    if right == NOTHING:
                        work(at[left], out=at[place])
                    else:
                        work(at[left], at[right], out=at[place])
                for origin, place in self.copies:
                    at[place][...] = at[origin]


def plan(program: Program, repeated: frozenset[int]) -> Plan:
    """Lay a program out on registers."""
    same = program.invariant(repeated)
    varying = tuple(load for load in program.loads if load[1] not in repeated)
    fixed = tuple(load for load in program.loads if load[1] in repeated)
    place: dict[int, int] = {load[0]: i for i, load in enumerate(varying)}
    stored: list[tuple[int, int]] = []
    computed = {step[0] for step in program.steps if not same[step[0]]}
    for i, (_, _, value) in enumerate(program.stores):
        if value in computed and value not in place:
            place[value] = len(varying) + i  # the step writes where the value is wanted
        else:
            stored.append((value, len(varying) + i))
    bottom = len(varying) + len(program.stores)
    registers = _allocate(program, computed, place, bottom)
    numbers = [load[0] for load in fixed] + [value for value, _ in program.constants]
    numbers += [step[0] for step in program.steps if same[step[0]]]
    place.update({value: bottom + registers + i for i, value in enumerate(numbers)})
    copies = [(place[value], target) for value, target in stored]
    return Plan(
        varying,
        fixed,
        tuple(_placed(program, place, (v for v in range(program.size) if same[v]))),
        tuple(_placed(program, place, computed)),
        tuple(copies),
        tuple((place[value], number) for value, number in program.constants),
        tuple(place[load[0]] for load in fixed),
        program.stores,
        program.full(),
        registers,
        bottom + registers + len(numbers),
    )


def _allocate(program: Program, computed: set[int], place: dict[int, int], bottom: int) -> int:
    """Give every computed value without a place a register; returns how many were needed."""
    last = {}
    for number, (_, _, left, right) in enumerate(program.steps):
        last[left] = last[right] = number
    free: list[int] = []
    registers = 0
    for number, (value, _, left, right) in enumerate(program.steps):
        if value not in computed:
            continue
        ending = {v for v in (left, right) if last.get(v) == number and place.get(v, -1) >= bottom}
        free += sorted(place[v] for v in ending)
        if value not in place:
            # an element is read before it is written, so a register may be both
            place[value] = free.pop() if free else bottom + registers
            registers = max(registers, place[value] - bottom + 1)
        if value not in last and place[value] >= bottom:
            free.append(place[value])
    return registers


def _placed(
    program: Program, place: dict[int, int], wanted: Iterable[int]
) -> Iterator[tuple[Work, int, int, int]]:
    chosen = set(wanted)
    for value, operation, left, right in program.steps:
        if value in chosen:
            second = NOTHING if right == NOTHING else place[right]
            yield WORK[operation], place[left], second, place[value]
