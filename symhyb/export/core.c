/* The model behind every interface: one flat array of values, evaluated when it is asked for.

     values:  t | inputs u | outputs y | states x | rates x' | parameters p

   The generated part before this file defines N_U, N_Y, N_X, N_Z (the last of the states, that begin
   at rest), N_P, START, the entries model_value, model_forward, model_adjoint, model_rest and
   model_rest_forward, and STAMP, which tells models apart. Nothing here is global but constants:
   instances may live on threads of their own. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
  V_T = 0, V_U = 1, V_Y = V_U + N_U, V_X = V_Y + N_Y, V_D = V_X + N_X, V_P = V_D + N_X,
  N_V = V_P + N_P,
  S_T = 0, S_X = 1, S_U = S_X + N_X, S_P = S_U + N_U, N_S = S_P + N_P /* of a seed */
};
#ifdef EVENTS
/* Of the outputs the last N_I are indicators of events, of the parameters the last N_M are modes,
   each of WAYS (2: 0 or 1; 3: -1, 0 or 1) and told by one indicator less than that. */
enum { V_I = V_X - N_I, V_M = N_V - N_M };
#endif
enum { FRESH = 1, INITIAL = 2, EVENT = 4, CONTINUOUS = 8, STEP = 16, ENDED = 32, BROKEN = 64 };
enum { ANY = 127, LIVE = INITIAL | EVENT | CONTINUOUS | STEP };

/* All that an instance remembers, in numbers alone: a copy of it is a saved state. */
typedef struct {
  double stamp, phase, stale, step, tolerance, stop;
  double v[N_V];
  double slope[N_U + 1];  /* u' until the next communication point */
  double largest[N_X + 1]; /* of each state so far: what its error is held against */
} Memory;

typedef int (*Entry)(const double **, double **, casadi_int *, double *, int);

static int run(Entry entry, const double *t, const double *x, const double *u, const double *p,
               const double *seed, double *first, double *second) {
  const double *arg[SZ_ARG] = {t, x, u, p, seed};
  double *res[SZ_RES] = {first, second};
  casadi_int iw[SZ_IW];
  double w[SZ_W];
  return entry(arg, res, iw, w, 0);
}

static int finite_all(const double *values, int count) {
  for (int i = 0; i < count; ++i)
    if (!isfinite(values[i])) return 0;
  return 1;
}

static void begin(Memory *m) {
  memset(m, 0, sizeof *m);
  m->stamp = STAMP;
  m->phase = FRESH;
  m->stale = 1;
  m->tolerance = 1e-7;
  m->stop = HUGE_VAL;
  for (int i = 0; i < N_V; ++i) m->v[i] = START[i];
}

#ifdef EVENTS
/* Whether another mode belongs to the indicators; it is taken if that is wanted. */
static int turned(Memory *m, int take) {
  const double *indicator = m->v + V_I;
  int turned = 0;
  for (int i = 0; i < N_M; ++i) {
    double mode = indicator[0] > 0;
    if (WAYS[i] == 3 && mode == 0 && indicator[1] <= 0) mode = -1;
    if (mode != m->v[V_M + i]) turned = 1;
    if (take) m->v[V_M + i] = mode;
    indicator += (int)WAYS[i] - 1;
  }
  return turned;
}

#endif
/* Brings outputs and rates up to date; 0 if a number is not finite. Until initialisation ends, inner
   states are those of a machine that stood still at the given place. */
static int refresh(Memory *m) {
  double *v = m->v;
  if (m->stale == 0) return 1;
  if (((int)m->phase & (FRESH | INITIAL)) && N_Z > 0)
    run(model_rest, v, v + V_X, v + V_U, v + V_P, 0, v + V_X + N_X - N_Z, 0);
#ifdef EVENTS
  if ((int)m->phase & (FRESH | INITIAL)) memset(v + V_M, 0, N_M * sizeof *v);
#endif
  run(model_value, v, v + V_X, v + V_U, v + V_P, 0, v + V_D, v + V_Y);
  if (!finite_all(v, N_V)) return 0;
#ifdef EVENTS
  /* Modes stay between events and after the end. One may depend on others, but none on itself:
     each time round at least one more is right. */
  if ((int)m->phase & (FRESH | INITIAL | EVENT))
    for (int i = 0; i < N_M && turned(m, 1); ++i) {
      run(model_value, v, v + V_X, v + V_U, v + V_P, 0, v + V_D, v + V_Y);
      if (!finite_all(v, N_V)) return 0;
    }
#endif
  m->stale = 0;
  return 1;
}

/* Rates at time t + s, x; inputs run on with their slopes. */
static int rates(const Memory *m, double s, const double *x, double *d) {
  double u[N_U + 1], y[N_Y + 1], t = m->v[V_T] + s;
  for (int i = 0; i < N_U; ++i) u[i] = m->v[V_U + i] + s * m->slope[i];
  run(model_value, &t, x, u, m->v + V_P, 0, d, y);
  return finite_all(d, N_X);
}

/* Gaussian elimination with row exchanges, in place; the exchanges are left in order. */
static int factorise(double *a, int *order, int n) {
  for (int j = 0; j < n; ++j) {
    int best = j;
    for (int i = j + 1; i < n; ++i)
      if (fabs(a[i * n + j]) > fabs(a[best * n + j])) best = i;
    order[j] = best;
    if (a[best * n + j] == 0 || !isfinite(a[best * n + j])) return 0;
    for (int k = 0; k < n; ++k) {
      double held = a[j * n + k];
      a[j * n + k] = a[best * n + k];
      a[best * n + k] = held;
    }
    for (int i = j + 1; i < n; ++i) {
      a[i * n + j] /= a[j * n + j];
      for (int k = j + 1; k < n; ++k) a[i * n + k] -= a[i * n + j] * a[j * n + k];
    }
  }
  return 1;
}

static void solve(const double *a, const int *order, double *b, int n) {
  for (int j = 0; j < n; ++j) {
    double held = b[j];
    b[j] = b[order[j]];
    b[order[j]] = held;
  }
  for (int j = 0; j < n; ++j)
    for (int i = j + 1; i < n; ++i) b[i] -= a[i * n + j] * b[j];
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) b[i] -= a[i * n + k] * b[k];
    b[i] /= a[i * n + i];
  }
}

/* RODAS4 (Hairer & Wanner, Solving ODEs II, IV.7 and IV.10): order 4 with an error estimate of
   order 3, L-stable, so that the steep slope of dry friction costs no tiny steps. */
static const double A[6][5] = {
  {0}, {1.544}, {0.9466785280815826, 0.2557011698983284},
  {3.314825187068521, 2.896124015972201, 0.9986419139977817},
  {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
  {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0}};
static const double C[6][5] = {
  {0}, {-5.6688}, {-2.430093356833875, -0.2063599157091915},
  {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
  {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
  {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
   -6.058818238834054}};
static const double ALPHA[6] = {0.0, 0.386, 0.21, 0.63, 1.0, 1.0};
static const double GAMMA[6] = {0.25, -0.1043, 0.1035, -0.0362, 0.0, 0.0};
#define DIAGONAL 0.25

/* One step of length h from time t + s: x becomes the new state, the result is the error over the
   tolerance, infinite where the step makes no sense. */
static double attempt(const Memory *m, double s, double h, double *x) {
  double matrix[(N_X + 1) * (N_X + 1)], stage[6][N_X + 1], seed[N_S], by_t[N_X + 1];
  double here[N_X + 1], d[N_X + 1], y[N_Y + 1], u[N_U + 1], t = m->v[V_T] + s, worst = 0;
  int order[N_X + 1];
  for (int i = 0; i < N_U; ++i) u[i] = m->v[V_U + i] + s * m->slope[i];
  for (int j = 0; j < N_X; ++j) {
    memset(seed, 0, sizeof seed);
    seed[S_X + j] = 1;
    run(model_forward, &t, x, u, m->v + V_P, seed, d, y);
    for (int i = 0; i < N_X; ++i) matrix[i * N_X + j] = (i == j) - DIAGONAL * h * d[i];
  }
  memset(seed, 0, sizeof seed);
  seed[S_T] = 1;
  for (int i = 0; i < N_U; ++i) seed[S_U + i] = m->slope[i];
  run(model_forward, &t, x, u, m->v + V_P, seed, by_t, y);
  if (!factorise(matrix, order, N_X)) return HUGE_VAL;
  for (int k = 0; k < 6; ++k) {
    double past[N_X + 1];
    for (int i = 0; i < N_X; ++i) {
      here[i] = x[i];
      past[i] = 0;
      for (int j = 0; j < k; ++j) {
        here[i] += A[k][j] * stage[j][i];
        past[i] += C[k][j] * stage[j][i];
      }
    }
    if (!rates(m, s + ALPHA[k] * h, here, d)) return HUGE_VAL;
    for (int i = 0; i < N_X; ++i)
      stage[k][i] = DIAGONAL * (h * d[i] + past[i] + GAMMA[k] * h * h * by_t[i]);
    solve(matrix, order, stage[k], N_X);
  }
  for (int i = 0; i < N_X; ++i) {
    double scale, share;
    x[i] = here[i] + stage[5][i];
    scale = fmax(m->largest[i], fabs(x[i]));
    share = fabs(stage[5][i]) / (m->tolerance * scale + 1e-14);
    if (!(share <= worst)) worst = share;
  }
  return isfinite(worst) ? worst : HUGE_VAL;
}

/* Moves time and states on by `length`; the reason if it cannot. */
static const char *advance(Memory *m, double length, double end) {
  double *x = m->v + V_X, trial[N_X + 1], done = 0, h = m->step > 0 ? m->step : length;
  int tries = 0;
  while (N_X > 0 && done < length) {
    int last = h >= (length - done) * (1 - 1e-9);
    double step = last ? length - done : h, error, factor;
    if (step < 1e-13 * (fabs(m->v[V_T]) + length) || ++tries > 1000000)
      return "the states change too fast to be followed; the step became too small";
    memcpy(trial, x, N_X * sizeof *trial);
    error = attempt(m, done, step, trial);
    factor = error > 0 ? fmax(0.1, 0.9 * pow(error, -0.25)) : 5;
    if (error > 1) {
      h = step * fmin(factor, 0.9);
      continue;
    }
    memcpy(x, trial, N_X * sizeof *trial);
    for (int i = 0; i < N_X; ++i) m->largest[i] = fmax(m->largest[i], fabs(x[i]));
    done = last ? length : done + step;
    h = last && h > step ? fmax(h, step * fmin(factor, 5)) : step * fmin(factor, 5);
    m->step = h;
  }
  m->v[V_T] = end;
  for (int i = 0; i < N_U; ++i) {
    m->v[V_U + i] += length * m->slope[i];
    m->slope[i] = 0;
  }
  m->stale = 1;
  return refresh(m) ? 0 : "a value is not finite";
}

/* Where a value stands in a seed, -1 for outputs and rates. */
static int seed_of(unsigned reference) {
#ifdef EVENTS
  if (reference >= V_M) return -1;
#endif
  if (reference == V_T) return S_T;
  if (reference < V_Y) return S_U + (int)reference - V_U;
  if (reference >= V_X && reference < V_D) return S_X + (int)reference - V_X;
  return reference >= V_P && reference < N_V ? S_P + (int)reference - V_P : -1;
}

/* Derivatives of all values along a seed (N_S) of what is known. */
static void forward(const Memory *m, double *seed, double *along) {
  const double *v = m->v;
  memset(along, 0, N_V * sizeof *along);
  if (((int)m->phase & (FRESH | INITIAL)) && N_Z > 0)
    run(model_rest_forward, v, v + V_X, v + V_U, v + V_P, seed, seed + S_X + N_X - N_Z, 0);
  run(model_forward, v, v + V_X, v + V_U, v + V_P, seed, along + V_D, along + V_Y);
  for (int i = 0; i < N_X; ++i) along[V_X + i] = seed[S_X + i];
}

/* Whether a value of this reference may be set in this phase. Parameters may be set between steps of
   a solver too, which the standard leaves to events: optimisers that read an FMU need it. */
static int may_set(const Memory *m, unsigned reference) {
  int early = ((int)m->phase & (FRESH | INITIAL)) != 0;
#ifdef EVENTS
  if (reference >= V_M) return 0;
#endif
  if (reference >= V_U && reference < V_Y) return 1;
  if (reference >= V_X && reference < V_D) /* an importer's solver may set any state */
    return early ? reference < V_D - N_Z : ((int)m->phase & (EVENT | CONTINUOUS)) != 0;
  return reference >= V_P && reference < N_V;
}
