"""Many chains of steps side by side: a CasADi function fed its own first output, chain by chain.

Windows of a recording are independent of each other, so the same instruction serves eight of them
at once. With a C compiler a small machine for the instruction lists of SX functions does that, in
vector registers; it is compiled once for all functions, so that a new model costs no compilation,
and code of its own takes over where a function runs long (:mod:`chains_native`).
Without a compiler CasADi's ``mapaccum`` gives the same answer.
Sizes: C chains, S steps, X states.
"""

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.buffers import Array, call
from symhyb.numeric.kernels.chains_listed import Advance, Listed, Machine, machine
from symhyb.numeric.kernels.chains_native import Native, Run
from symhyb.numeric.kernels.chains_source import LANES
from symhyb.numeric.kernels.instructions import Program, program

THREADS_MOST = 4
WORK_LEAST = 4_500_000  # instructions of eight lanes, from which a second thread pays
NATIVE_FASTER = 7  # times, than the machine for instruction lists
LOOPS_KEPT = 6  # without a compiler; building one takes long


class Chains:
    """A function (x, …, p) -> (x, …) ready to be applied along chains; its last argument is the
    same always."""

    def __init__(self, function: ca.Function):
        self._function = function
        self._loops: dict[tuple[int, int], ca.Function] = {}
        code, run = program(function), machine()
        self._engine = None if code is None or run is None else Engine(code, run)

    def __call__(self, start: Array, varying: Sequence[Array], p: Array) -> list[Array]:
        """Apply the function S times to each of C chains.

        ``start`` (C, X), ``varying`` arguments (C, S, rows), ``p`` (P,). Returns all outputs after
        every step, (C, S, entries), entries in CasADi's column-major order.
        """
        chains, steps = varying[0].shape[:2]
        if self._engine is not None:
            return self._engine([start, *varying], p, chains, steps)
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


class Engine:
    """A program that advances chains by the machine for instruction lists, and by code of its own
    as soon as that is there. Its last argument is the same always."""

    def __init__(self, code: Program, machine: Machine):
        self._code, self._machine = code, machine
        self._listed: Listed | None = None
        self.native = Native(code)

    def __call__(self, given: Sequence[Array], p: Array, chains: int, steps: int) -> list[Array]:
        """All outputs (C, S, entries), from the start (C, X), what varies (C, S, rows), and ``p``
        (P,); in the units of the function."""
        given = [np.ascontiguousarray(a, dtype=np.float64) for a in given]
        made = [np.zeros((chains, steps, width)) for width in self._code.results]
        blocks = max(-(-chains // LANES), 1)
        own = self.native.after(blocks * steps)
        advance = self._interpreted(p) if own is None else _bound(own, p)
        work = blocks * steps * len(self._code.steps) // (1 if own is None else NATIVE_FASTER)
        threads = int(min(THREADS_MOST, blocks, 1 + work // WORK_LEAST))
        if threads > 1:  # the system takes longer to count than some functions run
            threads = min(threads, os.cpu_count() or 1)
        if threads == 1:
            advance(given, made, range(chains), steps)
            return made
        bounds = [min(LANES * int(i), chains) for i in np.linspace(0, blocks, threads + 1)]
        parts = [(given, made, range(*pair), steps) for pair in pairwise(bounds)]
        with ThreadPoolExecutor(threads - 1) as pool:
            jobs = [pool.submit(advance, *part) for part in parts[1:]]
            # the caller works too: a thread less to start, and none that only waits
            advance(*parts[0])
            for job in jobs:
                job.result()
        return made

    def _interpreted(self, p: Array) -> Advance:
        """What advances a part of the chains under ``p`` (P,) by instruction lists."""
        if self._listed is None:
            self._listed = Listed(self._code, self._machine)
        return self._listed.under(p)


def _bound(run: Run, p: Array) -> Advance:
    """The same by code of its own."""
    fixed = np.ascontiguousarray(p, dtype=np.float64)
    return lambda given, made, chains, steps: run(chains, steps, fixed, given, made)
