"""The C text of a machine that runs instruction lists on eight lanes at once.

An instruction is five numbers: what it does, where the result goes, and up to three operands. Most
of a list are sums and products, so that two of these in a row are one instruction
(:data:`JOINED`), which saves a place in memory and a jump; both are rounded as they would be one by
one. Every instruction jumps to the next by itself, which processors foresee better than one jump
for all.
"""

import casadi as ca

from symhyb.numeric.kernels.expressions import (
    CALLED,
    HYPERBOLIC_TANGENT,
    TWO_ARGUMENTS,
    WRITTEN,
)

LANES = 8  # numbers of a vector register, or of two
PLAIN = {
    ca.OP_ADD: "A + B",
    ca.OP_SUB: "A - B",
    ca.OP_MUL: "A * B",
    ca.OP_DIV: "A / B",
    ca.OP_NEG: "-A",
    ca.OP_SQ: "A * A",
    ca.OP_TWICE: "A + A",
    ca.OP_INV: "1.0 / A",
}

_FIRST = {ca.OP_ADD: "(A + B)", ca.OP_SUB: "(A - B)", ca.OP_MUL: "(A * B)"}
_SECOND = {ca.OP_ADD: "+", ca.OP_SUB: "-", ca.OP_MUL: "*"}
_BEGIN = 1 + max(WRITTEN.keys() | CALLED.keys())
# (operation, the next one, whether it takes the result on its right) -> its own number
JOINED = {
    (first, second, right): _BEGIN + number
    for number, (first, second, right) in enumerate(
        (first, second, right)
        for first in _FIRST
        for second in _SECOND
        for right in (False, True)
        if not right or second == ca.OP_SUB  # sums and products read the same both ways
    )
}

_MACHINE = """
#include <math.h>
#include <string.h>
enum {{ lanes = {lanes} }};
typedef double vec __attribute__((vector_size({lanes} * sizeof(double)), may_alias));
{tangent}
#define NEXT if (code == end) return; goto *labels[code[0]];
#define A slots[code[2]]
#define B slots[code[3]]
#define C slots[code[4]]
#define SET(expression) {{ slots[code[1]] = expression; code += 5; NEXT }}
#define LOOP(expression) {{ \\
  const vec a = A, b = B; vec t; (void)b; \\
  for (int l = 0; l < lanes; l++) {{ \\
    const double x = a[l], y = b[l]; (void)y; t[l] = expression; \\
  }} \\
  SET(t) }}
static void execute(long long count, const int *code, vec *slots) {{
  static const void *const labels[] = {{{labels}}};
  const int *end = code + 5 * count;
  NEXT
{cases}
  unknown: LOOP(NAN)
}}
/* The chains from first to last, each of so many steps, eight at once; the last one fills lanes
   that are left over. Arrays are (chains, steps, width), the start, which is array 0, (chains,
   width); from then on the first result is fed back. Loads and stores: rows of (slot, array,
   entry). */
void run(long long first, long long last, long long steps, double *slots,
         long long n_before, const int *before, long long n_inside, const int *inside,
         long long n_loads, const int *loads, long long n_stores, const int *stores,
         const double *const *in, double *const *out, const long long *width, long long n_in) {{
  execute(n_before, before, (vec *)slots);
  for (long long begin = first; begin < last; begin += lanes) {{
    const int real = last - begin < lanes ? (int)(last - begin) : lanes;
    for (long long s = 0; s < steps; s++) {{
      for (const int *row = loads, *end = loads + 3 * n_loads; row < end; row += 3) {{
        const long long wide = width[row[1]], apart = row[1] || s ? steps * wide : wide;
        const double *from = row[1] ? in[row[1]] + s * wide : s ? out[0] + (s - 1) * wide : in[0];
        double *to = slots + (long long)row[0] * lanes;
        from += begin * apart + row[2];
        for (int l = 0; l < lanes; l++) to[l] = from[(l < real ? l : real - 1) * apart];
      }}
      execute(n_inside, inside, (vec *)slots);
      for (const int *row = stores, *end = stores + 3 * n_stores; row < end; row += 3) {{
        const long long wide = width[n_in + row[1]];
        double *to = out[row[1]] + (begin * steps + s) * wide + row[2];
        for (int l = 0; l < real; l++) to[l * steps * wide] = slots[(long long)row[0] * lanes + l];
      }}
    }}
  }}
}}
"""


def machine_code() -> str:
    """The C text; one label an operation that CasADi's SX knows, and one for each pair of them
    that is joined. The slots must lie at multiples of their size in memory."""
    cases = {operation: f"SET({form})" for operation, form in PLAIN.items()}
    for operation, form in WRITTEN.items():
        cases.setdefault(operation, f"LOOP({form.format('x', 'y')})")
    for operation, name in CALLED.items():
        cases[operation] = f"LOOP({name}({'x, y' if name in TWO_ARGUMENTS else 'x'}))"
    for (first, second, right), number in JOINED.items():
        parts = ("C", _FIRST[first]) if right else (_FIRST[first], "C")
        cases[number] = f"SET({parts[0]} {_SECOND[second]} {parts[1]})"
    known = [f"&&at{i}" if i in cases else "&&unknown" for i in range(max(cases) + 1)]
    return _MACHINE.format(
        lanes=LANES,
        tangent=HYPERBOLIC_TANGENT,
        labels=", ".join(known),
        cases="\n".join(f"  at{i}: {case}" for i, case in sorted(cases.items())),
    )
