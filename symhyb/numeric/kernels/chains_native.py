"""Chains of steps as machine code of their own, eight side by side.

It is two to seven times as fast as the machine for instruction lists, but a compiler takes longer
than that machine needs to begin. So it compiles beside the run, one function at a time, what has
run for a while; and what was compiled before, by whatever run, is taken from the cache at once. All
round alike, operation by operation, so that a result does not depend on when one takes over from
the other. Sizes: C chains, S steps.
"""

import ctypes
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from symhyb.numeric.kernels.buffers import Array, aligned
from symhyb.numeric.kernels.chains_source import LANES
from symhyb.numeric.kernels.chains_text import source
from symhyb.numeric.kernels.compiled import file_of, loaded
from symhyb.numeric.kernels.instructions import Program

LEVEL = "-O1"  # of the compiler
INSTRUCTIONS_MOST = 100_000  # a compiler takes about 0.07 ms each
# Instructions of eight lanes after which compiling begins: some, and so many for each that there
# is. They take the machine for instruction lists a third of the time that a compiler takes.
BEGIN_FROM, BEGIN_FROM_EACH = 6_000_000, 9_000

Run = Callable[[range, int, Array, Sequence[Array], Sequence[Array]], None]

_compiler = threading.Lock()  # held while a compiler works: the other cores have their own work


@dataclass(eq=False, slots=True)
class Native:
    """The machine code of a program: ``run`` is None until it is there. It is called with the
    chains to advance (a range of them), S, p (P,), the arrays given and those to be filled, all
    C-contiguous, in the units of the function."""

    code: Program
    run: Run | None = None
    thread: threading.Thread | None = None
    _steps: int = 0
    _file: Path | None = None  # compiled, and not loaded yet

    def after(self, steps: int) -> Run | None:
        """The machine code, if it is there, where so many more steps of eight lanes are asked for.
        Compiling begins when enough of them have been."""
        if self._file is not None:  # loaded by who runs it: never beside what it does
            self.run, self._file = _bound(loaded(self._file)), None
        if self.run is not None or self.thread is not None:
            return self.run
        size = len(self.code.steps)
        if size > INSTRUCTIONS_MOST:
            return None
        if not self._steps:
            ready = file_of(source(self.code), LEVEL, ready=True)
            self.run = None if ready is None else _bound(loaded(ready))
        self._steps += steps
        worth = self._steps * size >= BEGIN_FROM + BEGIN_FROM_EACH * size
        if self.run is None and worth and _compiler.acquire(blocking=False):
            self.thread = threading.Thread(target=self._compile, name="compiler")
            self.thread.start()
        return self.run

    def _compile(self) -> None:
        try:
            self._file = file_of(source(self.code), LEVEL)
        finally:
            _compiler.release()


def _bound(library: ctypes.CDLL | None) -> Run | None:
    """The compiled function; None without it."""
    if library is None:
        return None
    address, function = ctypes.c_void_p, library.run
    function.argtypes = (*(ctypes.c_longlong,) * 3, *(address,) * 5)
    function.restype = None
    still, lanes = (ctypes.c_longlong.in_dll(library, name).value for name in ("still", "lanes"))

    def run(
        chains: range, steps: int, p: Array, given: Sequence[Array], made: Sequence[Array]
    ) -> None:
        first, results = (
            (address * len(a))(*(one.ctypes.data for one in a)) for a in (given, made)
        )
        rooms = np.empty(still), aligned(lanes, LANES)  # of this thread
        at = (one.ctypes.data for one in (p, *rooms))
        function(chains.start, chains.stop, steps, *at, first, results)

    return run
