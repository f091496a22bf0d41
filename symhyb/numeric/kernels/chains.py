"""Many chains of steps side by side: a CasADi function fed its own first output, chain by chain.

Windows of a recording are independent of each other, so the same instruction serves eight of them
at once. With a C compiler a small machine for the instruction lists of SX functions does that, in
vector registers; it is compiled once for all functions, so that a new model costs no compilation.
Without a compiler CasADi's ``mapaccum`` gives the same answer.
Sizes: C chains, S steps, X states.
"""

import ctypes
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains_source import LANES, machine_code
from symhyb.numeric.kernels.compiled import shared_library
from symhyb.numeric.kernels.instructions import NOTHING, Program, program
from symhyb.numeric.kernels.vector_c import processor

FLAGS = ("-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
THREADS_MOST = 4
WORK_LEAST = 3_000_000  # instructions of eight lanes, from which a second thread pays
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
        before, inside, slots = _slots(code, fixed)
        self._before, self._inside = _instructions(code, slots, before, inside)
        self._slots = int(slots.max(initial=-1)) + 1
        self._constants = [(int(slots[value]), number) for value, number in code.constants]
        self._fixed = [(int(slots[v]), entry) for v, arg, entry in code.loads if arg in fixed]
        loads = [(slots[v], arg, entry) for v, arg, entry in code.loads if arg not in fixed]
        self._loads = np.array(loads, dtype=np.int32).reshape(-1, 3)
        stores = [(slots[value], output, entry) for output, entry, value in code.stores]
        self._stores = np.array(stores, dtype=np.int32).reshape(-1, 3)

    def __call__(self, start: Array, varying: Sequence[Array], p: Array) -> list[Array]:
        chains, steps = varying[0].shape[:2]
        blocks = -(-chains // LANES)
        given = [_laned(start[:, None], blocks), *(_laned(a, blocks) for a in varying)]
        made = [np.zeros((blocks, steps, width, LANES)) for width in self._code.results]
        registers = np.zeros((self._slots, LANES))
        for slot, number in self._constants:
            registers[slot] = number
        for slot, entry in self._fixed:
            registers[slot] = p[entry]
        work = blocks * steps * len(self._inside)
        threads = int(min(os.cpu_count() or 1, THREADS_MOST, blocks, 1 + work // WORK_LEAST))
        parts = [range(i, blocks, threads) for i in range(threads)]
        if threads == 1:
            self._advance(parts[0], given, made, registers, steps)
        else:
            with ThreadPoolExecutor(threads - 1) as pool:
                jobs = [
                    pool.submit(self._advance, part, given, made, registers.copy(), steps)
                    for part in parts[1:]
                ]
                # the caller works too: a thread less to start, and none that only waits
                self._advance(parts[0], given, made, registers, steps)
                for job in jobs:
                    job.result()
        return [
            output.transpose(0, 3, 1, 2).reshape(blocks * LANES, steps, -1)[:chains]
            for output in made
        ]

    def _advance(
        self, blocks: range, given: Sequence[Array], made: Sequence[Array], registers: Array,
        steps: int,
    ) -> None:  # fmt: skip
        address = ctypes.c_void_p
        for block in blocks:
            sources = (address * len(given))(*(a[block].ctypes.data for a in given))
            targets = (address * len(made))(*(a[block].ctypes.data for a in made))
            widths = [*self._code.arguments[:-1], *self._code.results]
            self._run(
                steps, registers.ctypes.data,
                len(self._before), self._before.ctypes.data,
                len(self._inside), self._inside.ctypes.data,
                len(self._loads), self._loads.ctypes.data,
                len(self._stores), self._stores.ctypes.data,
                sources, targets, (ctypes.c_longlong * len(widths))(*widths), len(given),
            )  # fmt: skip


def _laned(values: Array, blocks: int) -> Array:
    """(C, S, rows) as (blocks, S, rows, LANES); lanes that are too many repeat the last chain."""
    chains = len(values)
    rows = np.minimum(np.arange(blocks * LANES), chains - 1)
    wide = values[rows].reshape(blocks, LANES, *values.shape[1:])
    return np.ascontiguousarray(wide.transpose(0, 2, 3, 1))


def _slots(code: Program, fixed: frozenset[int]) -> tuple[list[int], list[int], NDArray[np.int64]]:
    """Steps before the loop, steps inside of it, and the slot of every value: values that a loop
    computes share slots as soon as they are no longer needed."""
    same = code.invariant(fixed)
    before = [i for i, step in enumerate(code.steps) if same[step[0]]]
    inside = [i for i, step in enumerate(code.steps) if not same[step[0]]]
    last = np.full(code.size, -1)
    for place, i in enumerate(inside):
        _, _, left, right = code.steps[i]
        last[left] = place
        if right != NOTHING:
            last[right] = place
    for _, _, value in code.stores:
        last[value] = len(inside)
    slots = np.full(code.size, -1)
    kept = [v for v, number in code.constants]
    kept += [v for v, arg, _ in code.loads]
    kept += [code.steps[i][0] for i in before]
    for slot, value in enumerate(kept):
        slots[value] = slot
    free: list[int] = []
    count = len(kept)
    inner = {code.steps[i][0] for i in inside}
    for place, i in enumerate(inside):
        value, _, left, right = code.steps[i]
        for operand in {left, right} - {NOTHING}:
            if operand in inner and last[operand] == place:
                free.append(int(slots[operand]))
        if not free:
            free, count = [count], count + 1
        slots[value] = free.pop()
        if last[value] < 0:  # nobody asks for it
            free.append(int(slots[value]))
    return before, inside, slots


def _instructions(
    code: Program, slots: NDArray[np.int64], before: Sequence[int], inside: Sequence[int]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Rows (operation, out, left, right) of slots."""

    def row(i: int) -> tuple[int, int, int, int]:
        value, operation, left, right = code.steps[i]
        second = left if right == NOTHING else right
        return operation, int(slots[value]), int(slots[left]), int(slots[second])

    def rows(which: Sequence[int]) -> NDArray[np.int32]:
        return np.array([row(i) for i in which], dtype=np.int32).reshape(-1, 4)

    return rows(before), rows(inside)


@lru_cache(maxsize=1)
def _machine() -> Callable[..., None] | None:
    """The machine of this computer's processor; None without a compiler."""
    about = processor()
    flags = (*FLAGS, "-march=native") if about else FLAGS
    path = shared_library(machine_code(), flags, about=about)
    if path is None:
        return None
    run = ctypes.CDLL(str(path)).run
    pair = (ctypes.c_longlong, ctypes.c_void_p)
    run.argtypes = (*pair, *pair * 4, *(ctypes.c_void_p,) * 3, ctypes.c_longlong)
    run.restype = None
    return run
