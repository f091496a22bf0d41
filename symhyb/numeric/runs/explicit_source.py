"""The C text of an explicit Runge–Kutta integrator, and of the rates of one machine.

    interpret   rates of any machine, from its instruction list; compiled once for all machines
    rate        rates of one machine as straight-line code, several times faster
    integrate   steps of order 8 with error control and dense output, on either of the two

Both get the same operations in the same order, and no flag lets the compiler reorder them, so they
give the same numbers. All memory is the caller's: any number of threads may integrate at once.
"""

from collections.abc import Sequence
from functools import lru_cache

from symhyb.numeric.kernels.expressions import (
    CALLED,
    HYPERBOLIC_TANGENT,
    TWO_ARGUMENTS,
    WRITTEN,
    formula,
    number,
)
from symhyb.numeric.kernels.instructions import NOTHING, Program
from symhyb.numeric.runs.dormand_prince import DENSE, ERRORS, NODES, SLOPES, STAGES
from symhyb.numeric.runs.explicit_call import LIST, TASK

INLINE_MOST = 60  # instructions: each stage of a step gets its own copy of rates that are so short
CURVE = 3 + len(DENSE)  # rows of the polynomial between the ends of a step
CURVE_AT = 4 + SLOPES  # where they lie in what the integrator works in
WORK = CURVE_AT + CURVE + 1  # columns of states that the integrator needs to work in
LOOKS = 4  # into a step that is watched
DIPS = 0.1  # a minimum between looks that may lie below this share of what was seen is looked at

_INTERPRETER = """
#include <math.h>
#include <string.h>
{tangent}
void execute(long long count, const int *code, double *slots) {{
  for (long long i = 0; i < count; i++, code += 4) {{
    const double x = slots[code[2]], y = slots[code[3]];
    double *const to = slots + code[1];
    (void)y;
    switch (code[0]) {{
{cases}
      default: *to = NAN;
    }}
  }}
}}
struct list {{ {fields} }};
/* loads: rows of (slot, argument, entry), arguments x, d, t; stores: rows of (slot, entry) */
void interpret(void *memory, double t, const double *x, const double *d, double *slope) {{
  const struct list *p = memory;
  const double *const given[3] = {{x, d, &t}};
  for (long long i = 0; i < p->n_loads; i++) {{
    const int *row = p->loads + 3 * i;
    p->slots[row[0]] = given[row[1]][row[2]];
  }}
  execute(p->n_steps, p->steps, p->slots);
  for (long long i = 0; i < p->n_slopes; i++) slope[i] = 0;
  for (long long i = 0; i < p->n_stores; i++)
    slope[p->stores[2 * i + 1]] = p->slots[p->stores[2 * i]];
}}
"""

# what the integrator calls: a function that it is handed, or the one that stands before it
_ANY_MACHINE = """
typedef void (*rate_type)(void *, double, const double *, const double *, double *);
#define RATE rate_type rate,
#define GIVEN rate,
#define STATES (r->states)
#define DRIVES (r->drives)
"""
_ONE_MACHINE = """
void rate(void *memory, double t, const double *x, const double *d, double *slope) {{
  rates(memory, t, x, d, slope);
}}
#define rate rates
#define RATE
#define GIVEN
#define STATES {states}
#define DRIVES {drives}
"""

# Times of outputs increase. The drive runs straight between its nodes, and no step reaches across
# one: every step sees smooth rates. count: rows written, steps accepted and rejected, evaluations.
# place: where the last step began and ended, its length, and how long the next wishes to be. Where
# something is watched, it returns after a step in which that may have fallen through zero, before
# the rows of that step. It returns after a step too where the equations are stiff and the steps
# shorter than suspect, and where the rates were evaluated pause times; resumed, it goes on there as
# if it had not returned. Stiff: fifteen steps at the border of stability, h·λ above 6.1, with fewer
# than six others in a row between them (Hairer & Wanner, Solving ODEs II, IV.2). The estimate of λ
# is the change of slope over that of place between the last stage and the end of a step.
_INTEGRATOR = """
typedef void watch_type(void *, double, const double *, const double *, double *);
struct task {{ {fields} }};
#define STABLE 6.1 /* h times a decay up to which this method is stable */
enum {{ DONE, WORK_MOST, STEP_LEAST, GROWN, TAPE_FULL, WATCHED, STIFF, PAUSED }};
static void hold(const struct task *r, long long k, double t, double *d) {{
  const long long m = DRIVES;
  if (!m) return;
  const double *a = r->node_d + k * m, *b = a + m;
  const double s = (t - r->node_t[k]) / (r->node_t[k + 1] - r->node_t[k]);
  for (long long j = 0; j < m; j++) d[j] = a[j] + s * (b[j] - a[j]);
}}
static double eighth(double x) {{ return sqrt(sqrt(sqrt(x))); }}
static double size(const struct task *r, const double *y, const double *e) {{
  double sum = 0;
  for (long long i = 0; i < STATES; i++) {{
    const double s = e[i] / (r->absolute[i] + r->relative * fabs(y[i]));
    sum += s * s;
  }}
  return sqrt(sum / (double)STATES);
}}
/* the length of the first step: Hairer, Norsett & Wanner, section II.4 */
static double first_step(RATE void *memory, const struct task *r, long long k, double t,
                         const double *y, const double *f, double *y1, double *f1) {{
  const double d0 = size(r, y, y), d1 = size(r, y, f);
  double h = d0 < 1e-10 || d1 < 1e-10 ? 1e-6 : 0.01 * d0 / d1;
  h = fmin(h, r->longest);
  for (long long i = 0; i < STATES; i++) y1[i] = y[i] + h * f[i];
  hold(r, k, t + h, r->drive);
  rate(memory, t + h, y1, r->drive, f1);
  for (long long i = 0; i < STATES; i++) f1[i] -= f[i];
  const double most = fmax(d1, size(r, y, f1) / h);
  const double next = most <= 1e-15 ? fmax(1e-6, 1e-3 * h) : eighth(0.01 / most);
  h = fmin(100 * h, next);
  return isfinite(h) ? fmin(h, r->longest) : 1e-6;
}}
/* the state at a share s of a step from y, whose polynomial has these rows */
static inline void between(long long n, double s, const double *y, const double *curve,
                           double *to) {{
  const double z = 1 - s;
  const double *a = curve, *b = a + n, *c = b + n, *d = c + n, *e = d + n, *f = e + n, *g = f + n;
  for (long long i = 0; i < n; i++)
    to[i] = y[i] + s * (a[i] + z * (b[i] + s * (c[i] + z * (d[i] + s * (e[i]
          + z * (f[i] + s * g[i]))))));
}}
/* whether a watch is not positive in one of the looks into a step, or may be between two */
static int may_switch(const struct task *r, long long at, double t, double h, const double *y,
                      const double *curve, double *z) {{
  const long long w = r->watches;
  for (int look = 1; look <= {looks}; look++) {{
    const double s = look / {looks}.0;
    between(STATES, s, y, curve, z);
    hold(r, at, t + s * h, r->drive);
    r->watch(r->watch_memory, t + s * h, z, r->drive, r->seen + look * w);
  }}
  for (long long k = w; k < ({looks} + 1) * w; k++) if (!(r->seen[k] > 0)) return 1;
  for (long long k = w; k < {looks} * w; k++) {{
    const double left = r->seen[k - w], middle = r->seen[k], right = r->seen[k + w];
    const double bend = left - 2 * middle + right, slope = (right - left) / 2;
    if (middle <= left && middle <= right && bend > 0
        && middle - slope * slope / (2 * bend) < {dips} * middle) return 1;
  }}
  memcpy(r->seen, r->seen + {looks} * w, w * sizeof(double));
  return 0;
}}
int integrate(RATE void *memory, const struct task *r) {{
  const long long n = STATES;
  double *k[{slopes}], *y = r->work, *y1 = y + n, *e3 = y1 + n, *e5 = e3 + n, *d = r->drive;
  for (int s = 0; s < {slopes}; s++) k[s] = e5 + (s + 1) * n;
  double *const curve = k[{slopes} - 1] + n, *const looked = curve + {curve} * n;
  long long row = r->row, at = 0, *count = r->count;
  const double end = r->end;
  double t = r->resumed ? r->place[1] : r->begin, wish = r->resumed ? r->place[3] : r->first;
  while (at + 2 < r->nodes && r->node_t[at + 1] <= t) at++;
  if (r->resumed) row = count[0];
  else {{
    memcpy(y, r->start, n * sizeof(double));
    if (row) memcpy(r->x, y, n * sizeof(double));
    for (long long i = 0; i < n; i++) r->reach[i] = fabs(y[i]);
    r->place[1] = t;
    count[0] = row; count[1] = count[2] = count[4] = count[5] = 0; count[3] = 2;
    hold(r, at, t, d);
    rate(memory, t, y, d, k[0]);
    if (!(wish > 0)) wish = first_step(GIVEN memory, r, at, t, y, k[0], y1, k[1]);
    if (r->watches) r->watch(r->watch_memory, t, y, d, r->seen);
  }}
  int rejected = 0, stiff = 0;
  while (t < end) {{
    if (stiff) return STIFF;
    if (count[3] >= r->pause && !rejected && count[1]) return PAUSED;
    r->place[0] = t;
    /* a tenth of the steps at first, all at the end: a run that crawls is given up soon */
    const double share = 0.1 + 0.9 * (t - r->begin) / (end - r->begin);
    if ((double)(count[1] + count[2]) >= share * (double)r->steps_most) return WORK_MOST;
    if (r->tape_x && count[1] >= r->tape_most) return TAPE_FULL;
    const double wall = at + 2 < r->nodes ? fmin(r->node_t[at + 1], end) : end;
    double *const stage = r->tape_x ? r->tape_x + {slopes} * n * count[1] : 0;
    double h = fmin(wish, r->longest);
    const int last = t + 1.01 * h >= wall;
    if (last) h = wall - t;
    else if (t + 0.1 * h == t) return STEP_LEAST;
{stages}
    count[3] += 12;
    for (long long i = 0; i < n; i++) {{
      e3[i] = {order_3};
      e5[i] = {order_5};
    }}
    double sum_3 = 0, sum_5 = 0, turn = 0, way = 0;
    const double *const z11 = stage ? stage + 11 * n : curve;
    for (long long i = 0; i < n; i++) {{
      const double scale = r->absolute[i] + r->relative * fmax(fabs(y[i]), fabs(y1[i]));
      sum_3 += e3[i] / scale * (e3[i] / scale);
      sum_5 += e5[i] / scale * (e5[i] / scale);
      turn += (k[12][i] - k[11][i]) / scale * ((k[12][i] - k[11][i]) / scale);
      way += (y1[i] - z11[i]) / scale * ((y1[i] - z11[i]) / scale);
    }}
    const double mixed = sum_5 + 0.01 * sum_3;
    const double error = mixed > 0 ? h * sum_5 / sqrt(mixed * (double)n) : h * mixed;
    if (!(error <= 1)) {{ /* a NaN too */
      count[2]++;
      rejected = 1;
      wish = h * (isfinite(error) ? fmax(1.0 / 6, 0.9 / eighth(error)) : 0.1);
      if (t + 0.1 * wish == t) return STEP_LEAST;
      continue;
    }}
    const double next = last ? wall : t + h;
    const double most = rejected ? 1.0 : 6.0;
    const double grow = error > 0 ? fmin(most, fmax(1.0 / 3, 0.9 / eighth(error))) : most;
    wish = last && !rejected ? fmax(wish, h * grow) : h * grow; /* a wall makes no step short */
    rejected = 0;
    if (h < r->suspect && h * h * turn > STABLE * STABLE * way) {{
      count[5] = 0;
      stiff = ++count[4] >= 15;
      if (stiff) count[4] = 0;
    }} else if (++count[5] >= 6) count[4] = 0;
    r->place[1] = next;
    r->place[2] = h;
    r->place[3] = wish;
    if (r->watches || (row < r->outputs && r->t[row] < next)) {{
      double *const p0 = curve, *const p1 = p0 + n, *const p2 = p1 + n, *const c = p2 + n;
      count[3] += 3;
{more}
      for (long long i = 0; i < n; i++) {{
        p0[i] = y1[i] - y[i];
        p1[i] = h * k[0][i] - p0[i];
        p2[i] = 2 * p0[i] - h * (k[12][i] + k[0][i]);
{dense_rows}
      }}
      if (r->watches && may_switch(r, at, t, h, y, curve, looked)) {{
        count[1]++;
        return WATCHED;
      }}
    }}
    const long long first_row = row;
    for (; row < r->outputs && r->t[row] <= next; row++, count[0]++) {{
      double *const to = r->x + row * n;
      if (r->t[row] == next) memcpy(to, y1, n * sizeof(double));
      else between(n, (r->t[row] - t) / h, y, curve, to);
    }}
    if (stage) {{
      memcpy(stage, y, n * sizeof(double));
      memcpy(stage + 12 * n, y1, n * sizeof(double));
      const double times[3] = {{t, h, next}};
      const long long places[3] = {{at, first_row, row}};
      memcpy(r->tape_t + 3 * count[1], times, sizeof times);
      memcpy(r->tape_i + 3 * count[1], places, sizeof places);
    }}
    count[1]++;
    for (long long i = 0; i < n; i++) {{
      const double far = fabs(y1[i]);
      if (!(far <= r->bound[i])) return GROWN;
      if (far > r->reach[i]) r->reach[i] = far;
    }}
    t = next;
    memcpy(y, y1, n * sizeof(double));
    memcpy(k[0], k[12], n * sizeof(double));
    while (at + 2 < r->nodes && r->node_t[at + 1] <= t) at++;
  }}
  return DONE;
}}
"""

# a function of the same kind at N points
_ROWS = """
void rows(rate_type rate, void *memory, long long count, const long long *width, const double *t,
          const double *x, const double *d, double *out) {
  for (long long i = 0; i < count; i++)
    rate(memory, t[i], x + i * width[0], d + i * width[1], out + i * width[2]);
}
"""


def _integrator() -> str:
    stages = "\n".join(_stage(s, "curve" if s == 11 else "y1") for s in range(1, 13))
    more = "\n".join("  " + _stage(s, "e5") for s in range(13, SLOPES))
    dense = "\n".join(f"        c[{j} * n + i] = h * ({_sum(row)});" for j, row in enumerate(DENSE))
    return _INTEGRATOR.format(
        fields=TASK,
        slopes=SLOPES,
        curve=CURVE,
        looks=LOOKS,
        dips=DIPS,
        stages=stages,
        more=more,
        dense_rows=dense,
        order_3=_sum(ERRORS[0]),
        order_5=_sum(ERRORS[1]),
    )


@lru_cache(maxsize=1)
def integrator_code() -> str:
    """The C text of the integrator with the interpreter; the same for every machine."""
    forms = {**WRITTEN, **{op: _called(name) for op, name in CALLED.items()}}
    cases = "\n".join(
        f"      case {operation}: *to = {form.format('x', 'y')}; break;"
        for operation, form in sorted(forms.items())
    )
    interpreter = _INTERPRETER.format(fields=LIST, tangent=HYPERBOLIC_TANGENT, cases=cases)
    return interpreter + _ANY_MACHINE + _integrator() + _ROWS


def _called(name: str) -> str:
    return f"{name}({{0}}, {{1}})" if name in TWO_ARGUMENTS else f"{name}({{0}})"


def _sum(row: Sequence[tuple[int, float]]) -> str:
    """The terms added in pairs, so that no sum waits for the one before it."""
    terms = [f"{factor!r} * k[{j}][i]" for j, factor in row]
    while len(terms) > 1:
        terms = [f"({' + '.join(terms[i : i + 2])})" for i in range(0, len(terms), 2)]
    return terms[0]


def _stage(s: int, into: str) -> str:
    """Slope number ``s``; the last of a step lies at its end. The newest slope is added last: the
    processor has done the rest while it waited for that."""
    place = f"stage ? stage + {s} * n : {into}" if s != 12 else into
    *older, (j, newest) = STAGES[s]
    before = f"y[i] + h * ({_sum(older)})" if older else "y[i]"
    return (
        f"    {{ double *const z = {place}, last = h * {newest!r};\n"
        f"    for (long long i = 0; i < n; i++) z[i] = fused(last, k[{j}][i], {before});\n"
        f"    hold(r, at, t + {NODES[s]!r} * h, d);\n"
        f"    rate(memory, t + {NODES[s]!r} * h, z, d, k[{s}]); }}"
    )


def machine_code(code: Program) -> str:
    """The C text of the rates of one machine, a program (x, d, t, p) -> x', and of an integrator
    for these alone.

    ``prepare`` computes once a run what depends on p alone, and keeps it in the memory of
    ``rate``; how much memory that needs is what ``held`` returns.
    """
    same = code.invariant(frozenset({3}))
    literal = {value: number(x) for value, x in code.constants}
    fixed = {value: entry for value, argument, entry in code.loads if argument == 3}
    before = [step for step in code.steps if same[step[0]]]
    inside = [step for step in code.steps if not same[step[0]]]
    asked = {v for step in inside for v in step[2:] if v != NOTHING}
    asked |= {value for _, _, value in code.stores}
    kept = [v for v in (*fixed, *(step[0] for step in before)) if v in asked]
    constants = [f"const double v{value} = {text};" for value, text in literal.items()]
    given = {0: "x[{}]", 1: "d[{}]", 2: "t"}
    loads = [(v, given[a].format(entry)) for v, a, entry in code.loads if a != 3]
    stored = {entry: f"v{value}" for _, entry, value in code.stores}
    inline = "inline __attribute__((always_inline))" if len(inside) <= INLINE_MOST else ""
    return "\n".join(
        [
            "#include <math.h>\n#include <string.h>",
            HYPERBOLIC_TANGENT,
            f"long long held(void) {{ return {len(kept)}; }}",
            "void prepare(const double *p, double *memory) {",
            *constants,
            *(f"const double v{value} = p[{entry}];" for value, entry in fixed.items()),
            *(f"const double v{v} = {formula(o, left, right)};" for v, o, left, right in before),
            *(f"memory[{j}] = v{value};" for j, value in enumerate(kept)),
            "}",
            f"static {inline} void rates(",
            "void *memory, double t, const double *x, const double *d, double *slope) {",
            "const double *const held = memory;",
            *constants,
            *(f"const double v{value} = held[{j}];" for j, value in enumerate(kept)),
            *(f"const double v{value} = {text};" for value, text in loads),
            *(f"const double v{v} = {formula(o, left, right)};" for v, o, left, right in inside),
            *(f"slope[{i}] = {stored.get(i, '0')};" for i in range(code.results[0])),
            "}",
            _ONE_MACHINE.format(states=code.arguments[0], drives=code.arguments[1]) + _integrator(),
        ]
    )
