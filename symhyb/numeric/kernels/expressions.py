"""CasADi's operations on numbers as C expressions.

Special values (NaN, ±inf, subnormal numbers) mean what they mean in CasADi.
"""

import casadi as ca
import numpy as np

from symhyb.numeric.kernels.instructions import Program

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
# up to r¹⁴, whose rest is below 1e-17 of it. Plain arithmetic becomes part of a loop over lanes,
# which a call cannot; it is wrong by less than 3 units in the last place. Beyond |x| = 20, tanh is
# 1; a NaN stays one.
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


def supported(program: Program) -> bool:
    """Whether every operation has a C form here."""
    return program.operations() <= CALLED.keys() | WRITTEN.keys()


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
