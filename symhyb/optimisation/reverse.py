"""The steps of an explicit run backwards, in machine code, for the slopes of what it gave.

Sizes: N outputs, X states, K samples of the drive, P parameters, F of them free.

Source: Hager, Runge–Kutta methods in optimal control and the transformed adjoint system, Numer.
Math. 87, 2000.
"""

import ctypes
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from symhyb.errors import NumericsError
from symhyb.numeric.kernels.buffers import Array
from symhyb.numeric.kernels.compiled import library_of
from symhyb.numeric.runs.dormand_prince import DENSE, NODES, SLOPES, STAGES
from symhyb.numeric.runs.explicit import Desk, Field, Tape, Tolerances, address
from symhyb.numeric.runs.explicit_source import integrator_code

# The steps of a tape backwards: what a change of the states at the outputs, weighed by seed, is in
# terms of the start (back), the parameters and the nodes of the drive. pull: (x, weights of x'), d,
# t -> the same weighed by the slopes of the rates by x, d and p.
_REVERSE = """
void reverse(rate_type pull, void *memory, const struct task *r, long long parameters,
             const double *seed, double *back, double *by_p, double *by_d, double *work) {{
  const long long n = r->states, m = r->drives;
  static const double c[{slopes}] = {{{nodes}}};
  static const double a[{slopes}][{slopes}] = {{{rows}}}, dense[{dense}][{slopes}] = {{{upper}}};
  double *z = work, *out = z + 2 * n, *plain = out + n + m + parameters, *y[{slopes}], *k[{slopes}];
  for (int s = 0; s < {slopes}; s++) y[s] = plain + (1 + s) * n;
  for (int s = 0; s < {slopes}; s++) k[s] = y[{slopes} - 1] + (1 + s) * n;
  for (long long i = 0; i < n; i++) back[i] = 0;
  for (long long step = r->count[1] - 1; step >= 0; step--) {{
    const double t = r->tape_t[3 * step], h = r->tape_t[3 * step + 1];
    const double end = r->tape_t[3 * step + 2];
    const long long *place = r->tape_i + 3 * step, at = place[0];
    const double first = m ? r->node_t[at] : 0, length = m ? r->node_t[at + 1] - first : 1;
    int stages = 12;
    memset(plain, 0, n * sizeof(double));
    memset(k[0], 0, {slopes} * n * sizeof(double));
    for (long long row = place[1]; row < place[2]; row++) {{
      const double *here = seed + row * n;
      if (r->t[row] == end) {{
        for (long long i = 0; i < n; i++) back[i] += here[i];
        continue;
      }}
      stages = {slopes};
      const double s = (r->t[row] - t) / h, q = 1 - s, p1 = s * q, p2 = p1 * s, p3 = p2 * q;
      const double p4 = p3 * s, p5 = p4 * q, p6 = p5 * s;
      for (int j = 0; j < {slopes}; j++) {{
        double w = a[12][j] * (s - p1 + 2 * p2) + dense[0][j] * p3 + dense[1][j] * p4
                   + dense[2][j] * p5 + dense[3][j] * p6;
        w += j == 0 ? p1 - p2 : j == 12 ? -p2 : 0;
        for (long long i = 0; i < n; i++) k[j][i] += w * here[i];
      }}
      for (long long i = 0; i < n; i++) plain[i] += here[i];
    }}
    for (int s = 12; s < {slopes}; s++) memset(y[s], 0, n * sizeof(double));
    if (stages == 12) memcpy(y[12], back, n * sizeof(double));
    for (int s = stages - 1; s >= 0; s--) {{
      memcpy(z, r->tape_x + ({slopes} * step + s) * n, n * sizeof(double));
      for (long long i = 0; i < n; i++) {{
        double sum = k[s][i];
        for (int j = s + 1; j < {slopes}; j++) if (a[j][s] != 0) sum += a[j][s] * y[j][i];
        z[n + i] = h * sum;
      }}
      hold(r, at, t + c[s] * h, r->drive);
      pull(memory, t + c[s] * h, z, r->drive, out);
      memcpy(y[s], out, n * sizeof(double));
      if (s == 12) for (long long i = 0; i < n; i++) y[s][i] += back[i];
      const double share = (t + c[s] * h - first) / length;
      for (long long j = 0; j < m; j++) {{
        by_d[at * m + j] += (1 - share) * out[n + j];
        by_d[(at + 1) * m + j] += share * out[n + j];
      }}
      for (long long j = 0; j < parameters; j++) by_p[j] += out[n + m + j];
    }}
    memcpy(back, plain, n * sizeof(double));
    for (int s = 0; s < {slopes}; s++) for (long long i = 0; i < n; i++) back[i] += y[s][i];
  }}
  for (long long i = 0; i < n; i++) back[i] += seed[i];
}}
"""


def pulled_back(
    slopes: Field,
    tape: Tape,
    steps: int,
    seed: Array,
    p: Array,
    t: Array,
    nodes: tuple[Array, Array],
) -> tuple[Array, Array, Array]:
    """The slopes of Σ seed·x, ``seed`` (N, X), along ``steps`` of a ``tape`` with outputs at ``t``
    (N,), parameters ``p`` (P,) and a drive between ``nodes``, times (K,) and values (K, drive): by
    start (X,), free parameters (F,) and drive (K, drive), SI.

    ``slopes`` are not the rates that were integrated but, for x next to a weight of x', (2X,),
    their slopes by x, drive and free parameters, weighed.

    Raises:
        NumericsError: no C compiler that works.
    """
    library = _library()
    if library is None:
        raise NumericsError("slopes of whole runs need a C compiler that works")
    states, drives = seed.shape[1], nodes[1].shape[1]
    one = np.ones(states)
    desk = Desk(t, one, nodes, Tolerances(1, one, one, 1), seed, tape)
    desk.count[1] = steps
    free = slopes.code.results[0] - states - drives
    back, by_p, by_d = np.zeros(states), np.zeros(free), np.zeros(nodes[1].shape)
    work = np.zeros((2 * SLOPES + 4) * states + drives + free)
    pull = slopes.prepared(p)
    library.reverse(
        pull.rate,
        pull.memory,
        ctypes.byref(desk.task),
        ctypes.c_longlong(free),
        *(address(a) for a in (np.ascontiguousarray(seed), back, by_p, by_d, work)),
    )
    slopes.count(12 * steps)
    return back, by_p, by_d


@lru_cache(maxsize=1)
def _library() -> ctypes.CDLL | None:
    """``reverse`` behind the integrator, whose structures it shares; None without a compiler."""
    library = library_of(integrator_code() + _reverse_code())
    if library is not None:
        library.reverse.restype = None
    return library


def _reverse_code() -> str:
    """The C text of ``reverse``."""

    def full(row: Sequence[tuple[int, float]]) -> str:
        known = dict(row)
        return ", ".join(repr(known.get(j, 0.0)) for j in range(SLOPES))

    return _REVERSE.format(
        slopes=SLOPES,
        dense=len(DENSE),
        nodes=", ".join(map(repr, NODES)),
        rows=", ".join(f"{{{full(row)}}}" for row in STAGES),
        upper=", ".join(f"{{{full(row)}}}" for row in DENSE),
    )
