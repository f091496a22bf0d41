"""The C text of a program over many samples, written so that its loop becomes vector code.

    kernel   one loop over the samples; what is the same for all of them stands before it
    run      blocks of samples: columns of no known stride go through buffers that stay in the cache
             of the processor; all else is read and written where it is

Special values (NaN, ±inf, subnormal numbers) mean what they mean in CasADi.
"""

from collections.abc import Sequence

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.instructions import Program

BUFFER = 256 * 1024  # bytes of all column buffers together: a share of a second-level cache
BLOCK_LEAST, BLOCK_MOST = 64, 2048  # samples
SHUFFLED = frozenset(
    (1, 2, 3, 4, 8)
)  # rows of arrays that compilers take apart by shuffling registers

# Functions of the mathematical library, and what is plain arithmetic. {0} and {1} are operands.
CALLED = {
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_POW: "pow",
    ca.OP_CONSTPOW: "pow",
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin",
    ca.OP_ACOS: "acos",
    ca.OP_ATAN: "atan",
    ca.OP_SINH: "sinh",
    ca.OP_COSH: "cosh",
    ca.OP_ASINH: "asinh",
    ca.OP_ACOSH: "acosh",
    ca.OP_ATANH: "atanh",
    ca.OP_LOG1P: "log1p",
    ca.OP_EXPM1: "expm1",
    ca.OP_ATAN2: "atan2",
    ca.OP_HYPOT: "hypot",
    ca.OP_FMOD: "fmod",
    ca.OP_REMAINDER: "remainder",
    ca.OP_ERF: "erf",
}
TWO_ARGUMENTS = frozenset({"pow", "atan2", "hypot", "fmod", "remainder"})
WRITTEN = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_TWICE: "{0} + {0}",
    ca.OP_INV: "1.0 / {0}",
    ca.OP_SQRT: "__builtin_sqrt({0})",
    ca.OP_FABS: "__builtin_fabs({0})",
    ca.OP_FLOOR: "__builtin_floor({0})",
    ca.OP_CEIL: "__builtin_ceil({0})",
    ca.OP_COPYSIGN: "__builtin_copysign({0}, {1})",
    ca.OP_TANH: "hyperbolic_tangent({0})",
    ca.OP_SIGN: "{0} < 0 ? -1.0 : {0} > 0 ? 1.0 : {0}",
    ca.OP_LT: "{0} < {1} ? 1.0 : 0.0",
    ca.OP_LE: "{0} <= {1} ? 1.0 : 0.0",
    ca.OP_EQ: "{0} == {1} ? 1.0 : 0.0",
    ca.OP_NE: "{0} != {1} ? 1.0 : 0.0",
    ca.OP_NOT: "{0} != 0 ? 0.0 : 1.0",
    ca.OP_AND: "({0} != 0) & ({1} != 0) ? 1.0 : 0.0",
    ca.OP_OR: "({0} != 0) | ({1} != 0) ? 1.0 : 0.0",
    ca.OP_IF_ELSE_ZERO: "{0} != 0 ? {1} : 0.0",
    # as fmin and fmax of C: a NaN gives way to the other number
    ca.OP_FMIN: "({0} < {1}) | ({1} != {1}) ? {0} : {1}",
    ca.OP_FMAX: "({0} > {1}) | ({1} != {1}) ? {0} : {1}",
}

# tanh|x| = e/(e + 2) with e = exp(2|x|) − 1; 2|x| = k·ln 2 + r, and exp(r) − 1 by its Taylor series
# up to r¹⁴, whose rest is below 1e-17 of it. Plain arithmetic becomes part of the loop, which a
# call cannot; it takes a quarter of the time of libmvec's, and is wrong by less than 3 units in
# the last place. Beyond |x| = 20, tanh is 1; a NaN stays one.
HYPERBOLIC_TANGENT = """
#ifdef __FMA__
#define fused(a, b, c) __builtin_fma(a, b, c)
#else
#define fused(a, b, c) ((a) * (b) + (c))
#endif
static inline double hyperbolic_tangent(double x) {
  const double twice = 2 * __builtin_fabs(x), y = twice > 40.0 ? 40.0 : twice;
  const double round = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to an integer */
  const double shifted = fused(y, 1.4426950408889634, round), k = shifted - round;
  const double r = fused(-k, 1.9082149292705877e-10, fused(-k, 0.6931471803691238, y));
  const double s = r * r;
  long long bits;
  double power; /* 2^k */
  __builtin_memcpy(&bits, &shifted, 8);
  bits = (long long)(((unsigned long long)bits + 1023) << 52);
  __builtin_memcpy(&power, &bits, 8);
  const double s2 = s * s; /* the series in pairs, so that no term waits for all the others */
  const double e2 = fused(s, 1.0 / 87178291200, 1.0 / 479001600);
  const double o2 = fused(s, 1.0 / 6227020800, 1.0 / 39916800);
  const double e1 = fused(s, 1.0 / 3628800, 1.0 / 40320), o1 = fused(s, 1.0 / 362880, 1.0 / 5040);
  const double e0 = fused(s, 1.0 / 720, 1.0 / 24), o0 = fused(s, 1.0 / 120, 1.0 / 6);
  const double even = fused(s2, fused(s2, e2, e1), e0), odd = fused(s2, fused(s2, o2, o1), o0);
  const double series = fused(s, fused(s, even, fused(r, odd, 0.5)), r);
  const double e = fused(power, series, power - 1);
  return __builtin_copysign(e / (e + 2), x);
}"""

_RUN = """
void run(long long n, const double *p, const double *const *in, const long long *in_step,
         double *const *out) {{
  enum {{ inputs = {inputs}, outputs = {outputs}, block = {block}, line = block + 40 }};
  static const int packed[inputs + 1] = {{{packed}}};
  static const int rows[outputs + 1] = {{{rows}}}, direct[outputs + 1] = {{{direct}}};
  double gathered[inputs + 1][line] __attribute__((aligned(64)));
  double computed[outputs + 1][line] __attribute__((aligned(64)));
  const double *x[inputs + 1];
  double *y[outputs + 1];
  for (long long start = 0; start < n; start += block) {{
    const long long size = n - start < block ? n - start : block;
    for (int j = 0; j < inputs; j++) {{
      const long long step = in_step[j];
      const double *from = in[j] + start * step;
      const int ready = packed[j] || step == 1;
      x[j] = ready ? from : gathered[j];
      if (!ready) for (long long i = 0; i < size; i++) gathered[j][i] = from[i * step];
    }}
    for (int j = 0; j < outputs; j++) y[j] = direct[j] ? out[j] + start * rows[j] : computed[j];
    kernel(size, p, x, y);
    for (int j = 0; j < outputs; j++) {{
      double *to = out[j] + start * rows[j];
      if (!direct[j]) for (long long i = 0; i < size; i++) to[i * rows[j]] = computed[j][i];
    }}
  }}
}}
"""


def supported(program: Program) -> bool:
    """Whether every operation has a C form here."""
    return program.operations() <= CALLED.keys() | WRITTEN.keys()


def source(
    program: Program, repeated: frozenset[int], packed: frozenset[int], vector: frozenset[str]
) -> str:
    """C code with one function ``run``.

    The arguments ``packed`` and all outputs are C-contiguous (N, rows); other arguments are columns
    with any stride. Of the functions ``vector`` there are vector forms.
    """
    varying = [load for load in program.loads if load[1] not in repeated]
    names = sorted({CALLED[o] for o in program.operations() if o in CALLED})
    packed = frozenset(i for i in packed if program.arguments[i] in SHUFFLED)
    direct = _direct(program)
    block = BUFFER // 8 // max(len(varying) + len(program.stores), 1) // 64 * 64
    run = _RUN.format(
        inputs=len(varying),
        outputs=len(program.stores),
        block=min(max(block, BLOCK_LEAST), BLOCK_MOST),
        packed="".join(f"{int(load[1] in packed)}, " for load in varying) + "0",
        direct="".join(f"{int(store[0] in direct)}, " for store in program.stores) + "0",
        rows="".join(f"{program.results[store[0]]}, " for store in program.stores) + "0",
    )
    tangent = [HYPERBOLIC_TANGENT] if ca.OP_TANH in program.operations() else []
    declared = [_declaration(name, name in vector) for name in names]
    return "\n".join((*tangent, *declared, *_kernel(program, repeated, packed), run))


def _declaration(name: str, vector: bool) -> str:
    """The attribute says what glibc's header says only under -ffast-math."""
    arguments = "double, double" if name in TWO_ARGUMENTS else "double"
    simd = '__attribute__((__simd__("notinbranch"))) ' if vector else ""
    return f"{simd}extern double {name}({arguments}) __attribute__((const));"


def _kernel(program: Program, repeated: frozenset[int], packed: frozenset[int]) -> list[str]:
    varying = [load for load in program.loads if load[1] not in repeated]
    fixed = [load for load in program.loads if load[1] in repeated]
    same = program.invariant(repeated)
    before = [f"const double v{load[0]} = p[{i}];" for i, load in enumerate(fixed)]
    before += [f"const double v{value} = {number(x)};" for value, x in program.constants]
    sources = _places("x", [load[1:] for load in varying], program.arguments, packed)
    targets = _places(
        "y", [store[:2] for store in program.stores], program.results, _direct(program)
    )
    inside = [f"const double v{v[0]} = {at};" for v, at in zip(varying, sources, strict=True)]
    for value, operation, left, right in program.steps:
        line = f"const double v{value} = {formula(operation, left, right)};"
        (before if same[value] else inside).append(line)
    inside += [f"{at} = v{s[2]};" for s, at in zip(program.stores, targets, strict=True)]
    return [
        "static void kernel(long long n, const double *p, const double **x, double **y) {",
        *(f"const double *restrict x{i} = x[{i}];" for i in _arrays(sources)),
        *(f"double *restrict y{i} = y[{i}];" for i in _arrays(targets)),
        *before,
        "#pragma GCC ivdep",
        "for (long long i = 0; i < n; i++) {",
        *inside,
        "}",
        "}",
    ]


def _arrays(places: Sequence[str]) -> list[int]:
    """The numbers of the arrays that stand in these places."""
    return sorted({int(place[1 : place.index("[")]) for place in places})


def _direct(program: Program) -> frozenset[int]:
    """The outputs that the kernel writes to itself: a few entries without gaps."""
    return frozenset(i for i in program.full() if program.results[i] in SHUFFLED)


def _places(
    name: str,
    columns: Sequence[tuple[int, ...]],
    rows: Sequence[int],
    packed: frozenset[int],
) -> list[str]:
    """How the kernel writes element i of every column, (owner, entry) each.

    What is packed is written relative to its first column, so that the compiler
    sees one array and loads whole samples, to be shuffled in registers.
    """
    first: dict[int, int] = {}
    texts = []
    for j, (owner, entry) in enumerate(columns):
        if owner in packed:
            begin = first.setdefault(owner, j)
            texts.append(f"{name}{begin}[i * {rows[owner]} + {entry - columns[begin][1]}]")
        else:
            texts.append(f"{name}{j}[i]")
    return texts


def number(x: float) -> str:
    """A C constant for exactly this number."""
    if np.isnan(x):
        return '__builtin_nan("")'
    if np.isinf(x):
        return "__builtin_inf()" if x > 0 else "-__builtin_inf()"
    return float(x).hex()


def formula(operation: int, left: int, right: int) -> str:
    """The C expression of one step of a program, of the values v<left> and v<right>."""
    return expression(operation, f"v{left}", f"v{right}")


def expression(operation: int, left: str, right: str = "") -> str:
    """The C expression of an operation on these operands; a second one that it has no use for is
    left out."""
    if operation in CALLED:
        both = f"{left}, {right}" if CALLED[operation] in TWO_ARGUMENTS else left
        return f"{CALLED[operation]}({both})"
    return WRITTEN[operation].format(left, right)
