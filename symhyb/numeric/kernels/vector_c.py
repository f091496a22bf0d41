"""A program over many samples as machine code, called through ctypes.

None of the flags assumes that special values do not occur, and none changes how the process treats
subnormal numbers. That glibc has vector forms of the mathematical functions (libmvec) is said in
the code itself, which needs no -ffast-math; -fno-builtin keeps gcc from fusing sin(x) and cos(x)
into one call, of which there is no vector form, and products and sums are not fused either, so
that what cancels without a compiler cancels with one.
"""

import ctypes
import hashlib
import platform
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from symhyb.numeric.kernels.compiled import find_compiler, shared_library
from symhyb.numeric.kernels.instructions import Program
from symhyb.numeric.kernels.vector_source import CALLED, TWO_ARGUMENTS, source

FLAGS = ("-O3", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
COLUMNS_MOST = 1000  # their buffers are on the stack, and that of a thread may be small


@lru_cache(maxsize=1)
def processor() -> str:
    """What *native* means on this machine; empty where it cannot be known."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return ""
    traits = [
        line for line in lines if line.startswith(("model name", "flags", "Features", "CPU "))
    ]
    return hashlib.sha256("\n".join(sorted(set(traits))).encode()).hexdigest() if traits else ""


@lru_cache(maxsize=1)
def _vector_functions() -> frozenset[str]:
    """The functions of which the C library of this machine has vector forms."""
    if platform.machine() != "x86_64" or platform.system() != "Linux":
        return frozenset()
    try:
        library = ctypes.CDLL("libmvec.so.1")
    except OSError:
        return frozenset()
    # the name of a form says its instruction set (b: SSE, which all have), width and arguments
    forms = {n: f"_ZGVbN2{'vv' if n in TWO_ARGUMENTS else 'v'}_{n}" for n in CALLED.values()}
    return frozenset(name for name, form in forms.items() if hasattr(library, form))


def build(
    program: Program, repeated: frozenset[int], packed: frozenset[int] = frozenset()
) -> "Kernel | None":
    """The compiled program, from the cache if it is there; None without a working compiler.

    The arguments ``packed`` will be the columns of C-contiguous arrays (N, rows).
    """
    compiler = find_compiler()
    if compiler is None or len(program.loads) + len(program.stores) > COLUMNS_MOST:
        return None
    gnu = "clang" not in compiler[1].lower()
    vector = _vector_functions()
    flags = list(FLAGS)
    if about := processor():
        flags += ["-march=native"]
    if gnu:
        flags += ["-fno-builtin"]
    elif vector:
        flags += ["-fveclib=libmvec"]
    libraries = ["-lmvec", "-lm"] if vector else ["-lm"]
    code = source(program, repeated, packed, vector if gnu else frozenset())
    library = shared_library(code, flags, libraries, about)
    try:
        return None if library is None else Kernel(program, repeated, library)
    except OSError:  # a folder from which nothing may be run
        return None


class Kernel:
    """A program in machine code; calling it releases Python's lock, so threads may share it."""

    def __init__(self, program: Program, repeated: frozenset[int], library: Path):
        self.varying = tuple(load for load in program.loads if load[1] not in repeated)
        self.fixed = tuple(load for load in program.loads if load[1] in repeated)
        self.stores, self.full = program.stores, program.full()
        self._run = ctypes.CDLL(str(library)).run
        self._run.argtypes = [ctypes.c_int64, *[ctypes.c_void_p] * 4]
        self._run.restype = None

    def __call__(
        self,
        inputs: Sequence[NDArray[np.float64]],
        fixed: NDArray[np.float64],
        outputs: Sequence[NDArray[np.float64]],
    ) -> None:
        """Fill ``outputs``, views into C-contiguous arrays (N, rows), one column (N,) a store, from
        columns (N,) in the order of ``varying`` and the numbers ``fixed``."""
        if not outputs:
            return
        steps = np.array([column.strides[0] // 8 for column in inputs], dtype=np.int64)
        given, made = _addresses(inputs), _addresses(outputs)
        self._run(
            outputs[0].size,
            fixed.ctypes.data,
            given.ctypes.data,
            steps.ctypes.data,
            made.ctypes.data,
        )


def packed(columns: Sequence[NDArray[np.float64]]) -> bool:
    """Whether these columns (N,), in any unit, are all those of a C-contiguous array, in order."""
    wide, addresses = 8 * len(columns), _addresses(columns)
    return bool(
        all(column.strides[0] == wide for column in columns)
        and np.all(addresses == addresses[:1] + 8 * np.arange(addresses.size, dtype=np.uintp))
    )


def _addresses(columns: Sequence[NDArray[np.float64]]) -> NDArray[np.uintp]:
    return np.array([column.__array_interface__["data"][0] for column in columns], dtype=np.uintp)
