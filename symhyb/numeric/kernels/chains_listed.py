"""A program laid out for the machine that runs instruction lists on eight chains at once.

The machine is compiled once for all programs (:mod:`chains_source`).
"""

import ctypes
from collections import Counter
from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array, aligned
from symhyb.numeric.kernels.chains_source import JOINED, LANES, machine_code
from symhyb.numeric.kernels.compiled import library_of
from symhyb.numeric.kernels.instructions import NOTHING, Program

Machine = Callable[..., None]
# the arrays given, those to be filled, the chains to advance, and their steps
Advance = Callable[[Sequence[Array], Sequence[Array], range, int], None]


class Listed:
    """A program as slots of values, instruction lists, loads and stores."""

    def __init__(self, code: Program, run: Machine):
        self._code, self._run = code, run
        fixed = frozenset({len(code.arguments) - 1})
        same = code.invariant(fixed)
        before = [_instruction(*step) for step in code.steps if same[step[0]]]
        inside = _joined(code, [step for step in code.steps if not same[step[0]]])
        slots = _slots(code, [one.value for one in before], inside)
        self._before, self._inside = _rows(before, slots), _rows(inside, slots)
        self._slots = max(slots, default=-1) + 1
        self._constants = [(slots[value], number) for value, number in code.constants]
        self._fixed = [(slots[v], entry) for v, arg, entry in code.loads if arg in fixed]
        loads = [(slots[v], arg, entry) for v, arg, entry in code.loads if arg not in fixed]
        self._loads = np.array(loads, dtype=np.int32).reshape(-1, 3)
        stores = [(slots[value], output, entry) for output, entry, value in code.stores]
        self._stores = np.array(stores, dtype=np.int32).reshape(-1, 3)

    def under(self, p: Array) -> Advance:
        """What advances a part of the chains with the last argument ``p`` (P,), in the units of the
        function."""
        registers = aligned(self._slots, LANES)
        for slot, number in self._constants:
            registers[slot] = number
        for slot, entry in self._fixed:
            registers[slot] = p[entry]
        return lambda *part: self._interpret(registers, *part)

    def _interpret(
        self,
        registers: Array,
        given: Sequence[Array],
        made: Sequence[Array],
        chains: range,
        steps: int,
    ) -> None:
        registers = aligned(len(registers), LANES, registers)  # of this thread
        address, widths = ctypes.c_void_p, [*self._code.arguments[:-1], *self._code.results]
        self._run(
            chains.start,
            chains.stop,
            steps,
            registers.ctypes.data,
            len(self._before),
            self._before.ctypes.data,
            len(self._inside),
            self._inside.ctypes.data,
            len(self._loads),
            self._loads.ctypes.data,
            len(self._stores),
            self._stores.ctypes.data,
            (address * len(given))(*(a.ctypes.data for a in given)),
            (address * len(made))(*(a.ctypes.data for a in made)),
            (ctypes.c_longlong * len(widths))(*widths),
            len(given),
        )


class _Instruction(NamedTuple):
    """What the machine does in one go: ``operation`` on the values ``operands`` makes ``value``."""

    operation: int
    value: int
    operands: tuple[int, ...]


def _instruction(value: int, operation: int, left: int, right: int) -> _Instruction:
    return _Instruction(operation, value, (left,) if right == NOTHING else (left, right))


def _joined(code: Program, steps: Sequence[tuple[int, int, int, int]]) -> list[_Instruction]:
    """The steps as instructions; a sum or product that only one other asks for is part of it."""
    asked = Counter(operand for step in steps for operand in step[2:])
    asked.update(value for _, _, value in code.stores)
    alone = {step[0]: step for step in steps if asked[step[0]] == 1}
    made: dict[int, _Instruction] = {}
    for value, operation, left, right in steps:
        made[value] = _instruction(value, operation, left, right)
        for inner, other, turned in (left, right, False), (right, left, operation == ca.OP_SUB):
            first = alone.get(inner)
            number = first and JOINED.get((first[1], operation, turned))
            if first is not None and number is not None:
                made[value] = _Instruction(number, value, (*first[2:], other))
                del made[inner], alone[inner]
                alone.pop(value, None)  # no third one is joined
                break
    return list(made.values())


def _slots(code: Program, before: Sequence[int], inside: Sequence[_Instruction]) -> list[int]:
    """The slot of every value: those that the loop computes share slots as soon as they are no
    longer needed."""
    last = [-1] * code.size
    for place, one in enumerate(inside):
        for operand in one.operands:
            last[operand] = place
    for _, _, value in code.stores:
        last[value] = len(inside)
    slots = [-1] * code.size
    kept = [*(v for v, _ in code.constants), *(v for v, _, _ in code.loads), *before]
    for slot, value in enumerate(kept):
        slots[value] = slot
    free: list[int] = []
    count = len(kept)
    inner = {one.value for one in inside}
    for place, one in enumerate(inside):
        for operand in set(one.operands) & inner:
            if last[operand] == place:
                free.append(slots[operand])
        if not free:
            free, count = [count], count + 1
        slots[one.value] = free.pop()
        if last[one.value] < 0:  # nobody asks for it
            free.append(slots[one.value])
    return slots


def _rows(which: Sequence[_Instruction], at: Sequence[int]) -> NDArray[np.int32]:
    """Instructions as rows of numbers: operation, result and operands, which are three."""
    rows = []
    for operation, value, operands in which:
        three = (*operands, *operands[-1:] * 2)[:3]
        rows.append((operation, at[value], *(at[operand] for operand in three)))
    return np.array(rows, dtype=np.int32).reshape(-1, 5)


@lru_cache(maxsize=1)
def machine() -> Machine | None:
    """The machine of this computer's processor; None without a compiler."""
    library = library_of(machine_code(), "-O3")
    if library is None:
        return None
    run = library.run
    number, address = ctypes.c_longlong, ctypes.c_void_p
    run.argtypes = (*(number,) * 3, address, *(number, address) * 4, *(address,) * 3, number)
    run.restype = None
    return run
