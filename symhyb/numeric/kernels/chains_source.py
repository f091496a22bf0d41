"""The C text of a machine that runs instruction lists on eight lanes at once."""

from symhyb.numeric.kernels.vector_source import CALLED, HYPERBOLIC_TANGENT, WRITTEN

LANES = 8  # numbers of a vector register, or of two

_MACHINE = """
#include <math.h>
#include <string.h>
enum {{ lanes = {lanes} }};
{tangent}
#define LOOP(expression) \\
  for (int l = 0; l < lanes; l++) {{ \\
    const double x = a[l], y = b[l]; (void)y; t[l] = expression; \\
  }} break;
static void execute(long long count, const int *code, double *slots) {{
  for (long long i = 0; i < count; i++, code += 4) {{
    double t[lanes] __attribute__((aligned(64)));
    const double *a = slots + (long long)code[2] * lanes, *b = slots + (long long)code[3] * lanes;
    switch (code[0]) {{
{cases}
      default: for (int l = 0; l < lanes; l++) t[l] = NAN;
    }}
    memcpy(slots + (long long)code[1] * lanes, t, sizeof t);
  }}
}}
/* loads and stores: rows of (slot, array, entry); in[0] is the start, fed back from out[0] */
void run(long long steps, double *slots, long long n_before, const int *before, long long n_inside,
         const int *inside, long long n_loads, const int *loads, long long n_stores,
         const int *stores, const double *const *in, double *const *out, const long long *width,
         long long n_in) {{
  execute(n_before, before, slots);
  for (long long s = 0; s < steps; s++) {{
    for (long long i = 0; i < n_loads; i++) {{
      const int *row = loads + 3 * i;
      const double *from;
      if (row[1]) from = in[row[1]] + (s * width[row[1]] + row[2]) * lanes;
      else from = (s ? out[0] + (s - 1) * width[0] * lanes : in[0]) + row[2] * lanes;
      memcpy(slots + (long long)row[0] * lanes, from, lanes * sizeof(double));
    }}
    execute(n_inside, inside, slots);
    for (long long i = 0; i < n_stores; i++) {{
      const int *row = stores + 3 * i;
      memcpy(out[row[1]] + (s * width[n_in + row[1]] + row[2]) * lanes,
             slots + (long long)row[0] * lanes, lanes * sizeof(double));
    }}
  }}
}}
"""


def machine_code() -> str:
    """The C text; one case an operation that CasADi's SX knows."""
    forms = {**WRITTEN, **{op: f"{name}({{0}}, {{1}})" for op, name in CALLED.items()}}
    two = ("pow", "atan2", "hypot", "fmod", "remainder")
    cases = []
    for operation, form in sorted(forms.items()):
        if operation in CALLED and CALLED[operation] not in two:
            form = f"{CALLED[operation]}({{0}})"
        cases.append(f"      case {operation}: LOOP({form.format('x', 'y')})")
    return _MACHINE.format(lanes=LANES, tangent=HYPERBOLIC_TANGENT, cases="\n".join(cases))
