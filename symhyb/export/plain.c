#include <math.h>

static void run(int (*entry)(const double **, double **, casadi_int *, double *, int),
                const double *t, const double *x, const double *u, const double *p,
                const double *seed, double *first, double *second) {
  const double *arg[SZ_ARG] = {t, x, u, p, seed};
  double *res[SZ_RES] = {first, second};
  casadi_int iw[SZ_IW];
  double w[SZ_W];
  entry(arg, res, iw, w, 0);
}

int NAME_eval(double t, const double *x, const double *u, const double *p, double *dx, double *y) {
  run(model_value, &t, x, u, p, 0, dx, y);
  for (int i = 0; i < N_X; ++i)
    if (!isfinite(dx[i])) return 1;
  for (int i = 0; i < N_Y; ++i)
    if (!isfinite(y[i])) return 1;
  return 0;
}

void NAME_rest(double t, const double *u, const double *p, double *x) {
  if (N_Z > 0) run(model_rest, &t, x, u, p, 0, x + N_X - N_Z, 0);
}

void NAME_forward(double t, const double *x, const double *u, const double *p, const double *seed,
                  double *dx, double *y) {
  run(model_forward, &t, x, u, p, seed, dx, y);
}
