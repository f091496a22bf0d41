"""Many chains of steps side by side: a CasADi function fed its own first output, chain by chain.

Windows of a recording are independent of each other, so the same instruction serves eight of them
at once. With a C compiler a small machine for the instruction lists of SX functions does that, in
vector registers; it is compiled once for all functions, so that a new model costs no compilation.
Without a compiler CasADi's ``mapaccum`` gives the same answer.
Sizes: C chains, S steps, X states.
"""

import ctypes
import os
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains_native import Run, native
from symhyb.numeric.kernels.chains_source import JOINED, LANES, machine_code
from symhyb.numeric.kernels.compiled import shared_library
from symhyb.numeric.kernels.instructions import NOTHING, Program, program
from symhyb.numeric.kernels.vector_c import processor

FLAGS = ("-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
THREADS_MOST = 4
WORK_LEAST = 3_000_000  # instructions of eight lanes, from which a second thread pays
NATIVE_FASTER = 7  # times, than the machine for instruction lists
NATIVE_FROM = 40_000  # steps of eight lanes, which take as long as to compile their function
LOOPS_KEPT = 6  # without a compiler; building one takes long


class Chains:
    """A function (x, …, p) -> (x, …) ready to be applied along chains; its last argument is the
    same always."""

    def __init__(self, function: ca.Function):
        self._function = function
        self._loops: dict[tuple[int, int], ca.Function] = {}
        code, run = program(function), _machine()
        self._engine = None if code is None or run is None else _Engine(code, run)

    def __call__(self, start: Array, varying: Sequence[Array], p: Array) -> list[Array]:
        """Apply the function S times to each of C chains.

        ``start`` (C, X), ``varying`` arguments (C, S, rows), ``p`` (P,). Returns all outputs after
        every step, (C, S, entries), entries in CasADi's column-major order.
        """
        if self._engine is not None:
            return self._engine(start, varying, p)
        chains, steps = varying[0].shape[:2]
        loop = self._loop(chains, steps)
        outputs = call(loop, (start, *(a.reshape(chains * steps, -1) for a in varying), p))
        return [output.reshape(chains, steps, -1) for output in outputs]

    def _loop(self, chains: int, steps: int) -> ca.Function:
        loop = self._loops.get((chains, steps))
        if loop is None:
            f = self._function
            last = f.n_in() - 1
            widths = [chains, *[chains * steps] * (last - 1), 1]
            given = [ca.MX.sym(f.name_in(i), f.size1_in(i), w) for i, w in enumerate(widths)]
            wide = [*given[:-1], ca.repmat(given[-1], 1, chains * steps)]
            loop = ca.Function("chains", given, f.mapaccum(steps).map(chains).call(wide))
            kept = list(self._loops.items())[1 - LOOPS_KEPT :]
            self._loops = dict([*kept, ((chains, steps), loop)])
        return loop


class _Engine:
    """A program laid out for the machine: slots of values, instruction lists, loads and stores."""

    def __init__(self, code: Program, run: Callable[..., None]):
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
        self._stepped = 0  # steps of eight lanes so far
        self._native: Run | None = None

    def __call__(self, start: Array, varying: Sequence[Array], p: Array) -> list[Array]:
        chains, steps = varying[0].shape[:2]
        given = [np.ascontiguousarray(a, dtype=np.float64) for a in (start, *varying)]
        made = [np.zeros((chains, steps, width)) for width in self._code.results]
        blocks = max(-(-chains // LANES), 1)
        advance = self._ready(blocks * steps, p)
        work = blocks * steps * len(self._inside)
        work = work // NATIVE_FASTER if self._native else work
        threads = int(min(os.cpu_count() or 1, THREADS_MOST, blocks, 1 + work // WORK_LEAST))
        bounds = [min(LANES * int(i), chains) for i in np.linspace(0, blocks, threads + 1)]
        parts = [(given, made, range(*pair), steps) for pair in pairwise(bounds)]
        if threads == 1:
            advance(*parts[0])
            return made
        with ThreadPoolExecutor(threads - 1) as pool:
            jobs = [pool.submit(advance, *part) for part in parts[1:]]
            # the caller works too: a thread less to start, and none that only waits
            advance(*parts[0])
            for job in jobs:
                job.result()
        return made

    def _ready(self, more: int, p: Array) -> Callable[..., None]:
        """What advances a part of the chains under ``p`` (P,), where so many steps of eight lanes
        are asked for."""
        before, self._stepped = self._stepped, self._stepped + more
        if before < NATIVE_FROM <= self._stepped:
            self._native = native(self._code)
        if self._native is not None:
            fixed = np.ascontiguousarray(p, dtype=np.float64)
            run = self._native
            return lambda given, made, chains, steps: run(chains, steps, fixed, given, made)
        registers = _aligned(self._slots)
        for slot, number in self._constants:
            registers[slot] = number
        for slot, entry in self._fixed:
            registers[slot] = p[entry]
        return lambda *part: self._interpret(_aligned(registers), *part)

    def _interpret(
        self,
        registers: Array,
        given: Sequence[Array],
        made: Sequence[Array],
        chains: range,
        steps: int,
    ) -> None:
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


def _aligned(registers: Array | int) -> Array:
    """So many registers (slots, LANES), or a copy of these, each at a multiple of its size."""
    count = registers if isinstance(registers, int) else len(registers)
    size = LANES * np.dtype(np.float64).itemsize
    room = np.zeros(count * size + size, np.uint8)
    begin = -room.ctypes.data % size
    made = room[begin : begin + count * size].view(np.float64).reshape(count, LANES)
    if not isinstance(registers, int):
        made[:] = registers
    return made


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
def _machine() -> Callable[..., None] | None:
    """The machine of this computer's processor; None without a compiler."""
    about = processor()
    flags = (*FLAGS, "-march=native") if about else FLAGS
    path = shared_library(machine_code(), flags, about=about)
    if path is None:
        return None
    run = ctypes.CDLL(str(path)).run
    number, address = ctypes.c_longlong, ctypes.c_void_p
    run.argtypes = (*(number,) * 3, address, *(number, address) * 4, *(address,) * 3, number)
    run.restype = None
    return run
