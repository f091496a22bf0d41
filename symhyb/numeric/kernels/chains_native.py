"""Chains of steps as machine code of their own, eight side by side.

A compiler takes longer than the machine for instruction lists needs to begin, and its code is seven
times as fast: it is worth its time where a function runs long. Both round alike, operation by
operation, so that a run does not depend on when one takes over from the other.
Sizes: C chains, S steps.
"""

import ctypes
from collections.abc import Callable, Sequence

from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.chains_source import LANES, PLAIN
from symhyb.numeric.kernels.compiled import shared_library
from symhyb.numeric.kernels.instructions import Program
from symhyb.numeric.kernels.vector_c import processor
from symhyb.numeric.kernels.vector_source import HYPERBOLIC_TANGENT, expression, number

FLAGS = ("-O1", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off")
INSTRUCTIONS_MOST = 20_000  # a compiler takes about 0.2 ms each, and longer beyond

_BEGIN = """
#include <math.h>
{tangent}
enum {{ lanes = {lanes} }};
typedef double vec __attribute__((vector_size({lanes} * sizeof(double)), may_alias));
#define EACH for (int l = 0; l < lanes; l++)
void run(long long first, long long last, long long steps, const double *p,
         const double *const *in, double *const *out) {{
"""
_LOOP = """
for (long long begin = first; begin < last; begin += lanes) {
  const int real = last - begin < lanes ? (int)(last - begin) : lanes;
  long long at[lanes]; /* lanes that are left over do what the last chain does */
  EACH at[l] = begin + (l < real ? l : real - 1);
  for (long long s = 0; s < steps; s++) {
"""

Run = Callable[[range, int, Array, Sequence[Array], Sequence[Array]], None]


def source(code: Program) -> str:
    """The C text of a function (x, …, p) → (x, …) along chains: arrays are (C, S, width),
    the start (C, width); the first result is fed back, the last argument ``p`` stays."""
    last = len(code.arguments) - 1
    same = code.invariant(frozenset({last}))
    before = [f"const double v{v} = p[{entry}];" for v, which, entry in code.loads if which == last]
    before += [f"const double v{v} = {number(x)};" for v, x in code.constants]
    inside = [_load(code, *load) for load in code.loads if load[1] != last]
    for value, operation, *operands in code.steps:
        names = [f"v{one}" for one in operands if one >= 0]
        if same[value]:
            before.append(f"const double v{value} = {expression(operation, *names)};")
        elif operation in PLAIN:
            inside.append(f"const vec v{value} = {expression(operation, *names)};")
        else:
            given = [f"v{one}" if same[one] else f"v{one}[l]" for one in operands if one >= 0]
            inside.append(f"vec v{value}; EACH v{value}[l] = {expression(operation, *given)};")
    for output, entry, value in code.stores:
        to = f"out[{output}][((begin + l) * steps + s) * {code.results[output]} + {entry}]"
        text = f"v{value}" if same[value] else f"v{value}[l]"
        inside.append(f"for (int l = 0; l < real; l++) {to} = {text};")
    begin = _BEGIN.format(tangent=HYPERBOLIC_TANGENT, lanes=LANES)
    return "\n".join((begin, *before, _LOOP, *inside, "}}}"))


def _load(code: Program, value: int, which: int, entry: int) -> str:
    wide = code.arguments[which]
    if which:
        return (
            f"vec v{value}; EACH v{value}[l] = in[{which}][(at[l] * steps + s) * {wide} + {entry}];"
        )
    back = f"out[0][(at[l] * steps + s - 1) * {wide} + {entry}]"
    return f"vec v{value}; EACH v{value}[l] = s ? {back} : in[0][at[l] * {wide} + {entry}];"


def native(code: Program) -> Run | None:
    """The compiled function, called with the chains to advance (a range of them), S, p (P,), the
    arrays given and those to be filled, all C-contiguous, in the units of the function; None
    without a working compiler."""
    if len(code.steps) > INSTRUCTIONS_MOST:
        return None
    about = processor()
    flags = (*FLAGS, "-march=native") if about else FLAGS
    path = shared_library(source(code), flags, about=about)
    if path is None:
        return None
    try:
        function = ctypes.CDLL(str(path)).run
    except OSError:  # a folder from which nothing may be run
        return None
    address = ctypes.c_void_p
    function.argtypes = (*(ctypes.c_longlong,) * 3, *(address,) * 3)
    function.restype = None

    def run(
        chains: range, steps: int, p: Array, given: Sequence[Array], made: Sequence[Array]
    ) -> None:
        first, results = (
            (address * len(a))(*(one.ctypes.data for one in a)) for a in (given, made)
        )
        function(chains.start, chains.stop, steps, p.ctypes.data, first, results)

    return run
