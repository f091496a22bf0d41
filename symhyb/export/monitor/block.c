/* One block of the source, reduced as symhyb watch reduces it: splines through what was measured,
   the model linearised along them, and what every cause would do to what it leaves.

   The generated part before this file defines the sizes, the constants and the functions of the
   model (model_sensed and so on). Sizes: N samples, N_Q coordinates, N_S sensors, N_X states, N_C
   columns of forces, N_F of parameters. */
enum {
  DEGREE = 5, ORDER = DEGREE + 1, BAND = ORDER * N_Q, RATES = N_X - N_Q,
  WIDTH = N_X + N_F + N_Q,    /* slopes of a step: by states, parameters, forces */
  JOINED = N_X + N_F + 2 * N_Q, /* the same from sample to sample: a force before and after */
  STARTS = 2 * N_Q, MOVED = STARTS + N_COLUMNS + 1 /* what deviates along a window */
};

static int larger(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *values, int count) {
  qsort(values, (size_t)count, sizeof *values, larger);
  return count % 2 ? values[count / 2] : (values[count / 2 - 1] + values[count / 2]) / 2;
}

/* ---- splines ---- */

static int span_of(const double *knots, int count, double t) {
  int s = DEGREE;
  while (s < count - 1 && t >= knots[s + 1]) ++s;
  return s;
}

/* The splines that are not 0 at t, with two derivatives: Cox and de Boor. */
static void basis_at(const double *knots, int s, double t, double made[3][ORDER]) {
  double low[ORDER][ORDER] = {{1.0}}, slope[ORDER] = {0};
  for (int p = 1; p <= DEGREE; ++p)
    for (int j = 0; j <= p; ++j) {
      const double *k = knots + s - p + j;
      double sum = 0;
      if (j > 0) sum += (t - k[0]) / (k[p] - k[0]) * low[p - 1][j - 1];
      if (j < p) sum += (k[p + 1] - t) / (k[p + 1] - k[1]) * low[p - 1][j];
      low[p][j] = sum;
    }
  for (int j = 0; j <= DEGREE; ++j) made[0][j] = low[DEGREE][j];
  for (int p = DEGREE - 1; p <= DEGREE; ++p)
    for (int j = 0; j <= p; ++j) {
      const double *k = knots + s - p + j;
      double sum = 0;
      if (j > 0) sum += low[p - 1][j - 1] / (k[p] - k[0]);
      if (j < p) sum -= low[p - 1][j] / (k[p + 1] - k[1]);
      if (p < DEGREE) slope[j] = p * sum;
      else made[1][j] = p * sum;
    }
  for (int j = 0; j <= DEGREE; ++j) {
    const double *k = knots + s - DEGREE + j;
    double sum = 0;
    if (j > 0) sum += slope[j - 1] / (k[DEGREE] - k[0]);
    if (j < DEGREE) sum -= slope[j] / (k[DEGREE + 1] - k[1]);
    made[2][j] = DEGREE * sum;
  }
}

#if SMOOTH_ANY
/* Inputs that are smooth between samples, on a grid FINER times as fine: the quintic spline through
   the samples, its knots those samples but for three at either end. */
static void finer(Monitor *m) {
  double *knots = m->knots, (*row)[2 * DEGREE + 1] = m->through;
  for (int i = 0; i < ORDER; ++i) knots[i] = m->t[0], knots[N + i] = m->t[N - 1];
  for (int i = 3; i < N - 3; ++i) knots[i + 3] = m->t[i];
  memset(row, 0, sizeof m->through);
  for (int r = 0; r < N; ++r) {
    double made[3][ORDER];
    const int s = span_of(knots, N, m->t[r]);
    basis_at(knots, s, m->t[r], made);
    for (int j = 0; j < ORDER; ++j) {
      const int at = s - r + j; /* of column s - DEGREE + j */
      if (at >= 0 && at <= 2 * DEGREE) row[r][at] = made[0][j];
    }
    for (int i = 0; i < N_U; ++i) m->spline[r][i] = m->u[r][i];
  }
  for (int j = 0; j < N; ++j)
    for (int r = j + 1; r < N && r <= j + DEGREE; ++r) {
      const double factor = row[r][j - r + DEGREE] / row[j][DEGREE];
      for (int c = 1; c <= DEGREE; ++c) row[r][j - r + DEGREE + c] -= factor * row[j][DEGREE + c];
      for (int i = 0; i < N_U; ++i) m->spline[r][i] -= factor * m->spline[j][i];
    }
  for (int r = N - 1; r >= 0; --r)
    for (int i = 0; i < N_U; ++i) {
      for (int c = 1; c <= DEGREE && r + c < N; ++c)
        m->spline[r][i] -= row[r][DEGREE + c] * m->spline[r + c][i];
      m->spline[r][i] /= row[r][DEGREE];
    }
  for (int k = 0; k <= (N - 1) * FINER; ++k) {
    const int r = k / FINER < N - 1 ? k / FINER : N - 2;
    const double t = m->t[r] + (m->t[r + 1] - m->t[r]) * (k - r * FINER) / (double)FINER;
    const int s = span_of(knots, N, t);
    double made[3][ORDER];
    basis_at(knots, s, t, made);
    m->fine_t[k] = t;
    for (int i = 0; i < N_U; ++i) {
      m->fine[k][i] = 0;
      for (int j = 0; j < ORDER; ++j) m->fine[k][i] += made[0][j] * m->spline[s - DEGREE + j][i];
    }
  }
}

/* Puts the smooth inputs at a time between sample r and the next into a drive. */
static void bend(const Monitor *m, int r, double t, double *drive) {
  int k = r * FINER;
  while (k < (r + 1) * FINER - 1 && t >= m->fine_t[k + 1]) ++k;
  const double where = (t - m->fine_t[k]) / (m->fine_t[k + 1] - m->fine_t[k]);
  for (int i = 0; i < N_U; ++i)
    if (SMOOTH[i])
      drive[i] = m->fine[k][i] + fmin(fmax(where, 0), 1) * (m->fine[k + 1][i] - m->fine[k][i]);
}
#endif

/* Noise of a sensor from its high differences; not a number with too few samples. */
static double noise_level(Monitor *m, int sensor) {
  double least = NAN, *d = m->sorted;
  for (int i = 0; i < N; ++i) d[i] = m->y[i][sensor];
  for (int order = 1, count = N - 1; order <= 10; ++order, --count) {
    double squares = 0;
    for (int i = 0; i < count; ++i) d[i] = d[i + 1] - d[i], squares += d[i] * d[i];
    if (order < 2) continue;
    if (count < FEW) break;
    least = fmin(least, sqrt(squares / count / CENTRAL[order])); /* fmin leaves out what is none */
  }
  return least;
}

static double entry(const Monitor *m, int r, int c) { return m->normal[r][r - c]; }

static int factored(Monitor *m, int size) {
  for (int r = 0; r < size; ++r)
    for (int c = r - BAND + 1 > 0 ? r - BAND + 1 : 0; c <= r; ++c) {
      double sum = entry(m, r, c);
      for (int k = r - BAND + 1 > 0 ? r - BAND + 1 : 0; k < c; ++k)
        sum -= entry(m, r, k) * entry(m, c, k);
      if (r == c && !(sum > 0)) return 0;
      m->normal[r][r - c] = r == c ? sqrt(sum) : sum / entry(m, c, c);
    }
  return 1;
}

static void solved(const Monitor *m, int size, double *x) {
  for (int r = 0; r < size; ++r) {
    for (int c = r - BAND + 1 > 0 ? r - BAND + 1 : 0; c < r; ++c) x[r] -= entry(m, r, c) * x[c];
    x[r] /= entry(m, r, r);
  }
  for (int r = size - 1; r >= 0; --r) {
    for (int c = r + 1; c < size && c < r + BAND; ++c) x[r] -= entry(m, c, r) * x[c];
    x[r] /= entry(m, r, r);
  }
}

/* Places, speeds and accelerations at all samples from the coefficients. */
static void moved_by(const Monitor *m, const double *c, double (*motion[3])[N_Q]) {
  for (int r = 0; r < N; ++r)
    for (int o = 0; o < 3; ++o)
      for (int i = 0; i < N_Q; ++i) {
        double sum = 0;
        for (int j = 0; j < ORDER; ++j) sum += m->basis[r][o][j] * c[(m->first[r] + j) * N_Q + i];
        motion[o][r][i] = sum;
      }
}

static void sensed(const Monitor *m, int r, double *y, double *slopes) {
  static const double none[N_ZL + 1] = {0};
  const double *arg[SZ_ARG] = {m->q[r], m->v[r], m->a[r], none, m->u[r], m->t + r, P};
  double *res[SZ_RES] = {y, slopes, slopes + N_M * N_Q, slopes + 2 * N_M * N_Q};
  casadi_int iw[SZ_IW];
  double w[SZ_W];
  model_sensed(arg, res, iw, w, 0);
}

/* Splines of all coordinates by weighted least squares (Gauss and Newton); 0 where there are none. */
static int smoothed(Monitor *m) {
  double (*motion[3])[N_Q] = {m->q, m->v, m->a}, weight[N_M], y[N_M], slopes[3 * N_M * N_Q];
  int any = 0;
  for (int i = 0; i < N - 1; ++i) m->sorted[i] = m->t[i + 1] - m->t[i];
  m->step = median(m->sorted, N - 1);
  const double spacing = SPACING_S / m->step;
  if (N < 4 * spacing || !(m->step > 0)) return 0;
  const int pieces = (int)fmax(nearbyint((m->t[N - 1] - m->t[0]) / (spacing * m->step)), 1);
  const int count = pieces + DEGREE, size = count * N_Q;
  if (count > N_B) return 0;
  for (int j = 0; j < N_M; ++j) {
    double mean = 0, square = 0;
    const double noise = noise_level(m, MOTION[j]);
    for (int r = 0; r < N; ++r) mean += m->y[r][MOTION[j]] / N;
    for (int r = 0; r < N; ++r) square += pow(m->y[r][MOTION[j]] - mean, 2) / N;
    const double spread = sqrt(square), known = isfinite(noise) ? noise : 1e-2 * spread;
    const double level = fmax(known, 1e-9 * spread);
    weight[j] = level > 0 ? 1 / level : 1;
    any |= isfinite(noise);
  }
  if (!any) return 0;
  for (int i = 0; i < ORDER; ++i) m->knots[i] = m->t[0], m->knots[count + i] = m->t[N - 1];
  for (int i = 1; i < pieces; ++i)
    m->knots[DEGREE + i] = m->t[0] + i * ((m->t[N - 1] - m->t[0]) / pieces);
  for (int r = 0; r < N; ++r) {
    const int s = span_of(m->knots, count, m->t[r]);
    m->first[r] = s - DEGREE;
    basis_at(m->knots, s, m->t[r], m->basis[r]);
  }
  for (int b = 0; b < count; ++b)
    for (int i = 0; i < N_Q; ++i) m->coefficient[b * N_Q + i] = START[i];
  for (int round = 0; round < 12; ++round) {
    double most = 0, largest = 1e-300;
    moved_by(m, m->coefficient, motion);
    memset(m->normal, 0, sizeof m->normal);
    memset(m->change, 0, sizeof m->change);
    for (int r = 0; r < N; ++r) {
      sensed(m, r, y, slopes);
      for (int i = 0; i < N_Q; ++i) largest = fmax(largest, fabs(m->q[r][i]));
      for (int j = 0; j < N_M; ++j) {
        double line[BAND];
        const double left = (m->y[r][MOTION[j]] - y[j]) * weight[j];
        for (int b = 0; b < ORDER; ++b)
          for (int i = 0; i < N_Q; ++i) {
            double sum = 0;
            for (int o = 0; o < 3; ++o)
              sum += slopes[(o * N_Q + i) * N_M + j] * weight[j] * m->basis[r][o][b];
            line[b * N_Q + i] = sum;
          }
        for (int b = 0; b < BAND; ++b) {
          const int at = m->first[r] * N_Q + b;
          m->change[at] += line[b] * left;
          for (int c = 0; c <= b; ++c) m->normal[at][b - c] += line[b] * line[c];
        }
      }
    }
    for (int i = 0; i < size; ++i) m->normal[i][0] += 1e-9 + 1e-12 * m->normal[i][0];
    if (!factored(m, size)) return 0;
    solved(m, size, m->change);
    for (int i = 0; i < size; ++i) m->coefficient[i] += m->change[i];
    for (int r = 0; r < N; ++r)
      for (int i = 0; i < N_Q; ++i) {
        double sum = 0;
        for (int j = 0; j < ORDER; ++j)
          sum += m->basis[r][0][j] * m->change[(m->first[r] + j) * N_Q + i];
        most = fmax(most, fabs(sum));
      }
    if (most / largest < 1e-9) break;
  }
  moved_by(m, m->coefficient, motion);
#if N_SHARP
  double cost = 0;
  for (int r = 0; r < N; ++r) {
    sensed(m, r, y, slopes);
    for (int j = 0; j < N_M; ++j) cost += pow((m->y[r][MOTION[j]] - y[j]) * weight[j], 2);
  }
  const double variance = cost / (N * N_M - size > 1 ? N * N_M - size : 1);
  for (int i = 0; i < N_Q; ++i) { /* of a speed, by rows in the middle */
    for (int k = 0; k < N_MIDDLE; ++k) {
      const int r = MIDDLE[k];
      memset(m->change, 0, sizeof m->change);
      for (int j = 0; j < ORDER; ++j) m->change[(m->first[r] + j) * N_Q + i] = m->basis[r][1][j];
      solved(m, size, m->change);
      m->sorted[k] = 0;
      for (int j = 0; j < ORDER; ++j)
        m->sorted[k] += m->basis[r][1][j] * m->change[(m->first[r] + j) * N_Q + i];
    }
    m->speed_sd[i] = sqrt(variance * median(m->sorted, N_MIDDLE));
  }
#endif
  return 1;
}

/* ---- what acts along the motion ---- */

#if N_ZL
/* Inner states along the motion, at rest first: two steps from sample to sample. */
static void inner_along(Monitor *m, Entry rest, Entry step, const double *p, int size, double *z) {
  enum { DRIVE = N_U + 3 * N_Q };
  casadi_int iw[SZ_IW];
  double w[SZ_W], now[N_ZL], after[N_ZL];
  {
    const double *arg[SZ_ARG] = {m->q[0], m->v[0], m->t, p};
    double *res[SZ_RES] = {now};
    rest(arg, res, iw, w, 0);
  }
  memcpy(z, now, sizeof *now * (size_t)size);
  for (int r = 0; r < N - 1; ++r) {
    double before[DRIVE + 1], rise[DRIVE + 1], d0[DRIVE + 1], d1[DRIVE + 1];
    for (int i = 0; i < DRIVE; ++i) {
      const int own = (i - N_U) % (N_Q ? N_Q : 1);
      double (*from)[N_Q] = i < N_U + N_Q ? m->q : i < N_U + 2 * N_Q ? m->v : m->a;
      before[i] = i < N_U ? m->u[r][i] : from[r][own];
      rise[i] = ((i < N_U ? m->u[r + 1][i] : from[r + 1][own]) - before[i]) / 2;
    }
    for (int part = 0; part < 2; ++part) {
      const double h = (m->t[r + 1] - m->t[r]) / 2;
      const double t = m->t[r] + 0.5 * part * (m->t[r + 1] - m->t[r]);
      for (int i = 0; i < DRIVE; ++i) d0[i] = before[i] + part * rise[i], d1[i] = d0[i] + rise[i];
      const double *arg[SZ_ARG] = {now, d0, d1, &t, &h, p};
      double *res[SZ_RES] = {after};
      step(arg, res, iw, w, 0);
      memcpy(now, after, sizeof *now * (size_t)size);
    }
    memcpy(z + (r + 1) * size, now, sizeof *now * (size_t)size);
  }
}
#endif

/* States, and the forces of all causes; one that is not finite all along is none. */
static void acted(Monitor *m) {
#if N_Z
  inner_along(m, model_inner_rest, model_inner_step, P, N_Z, m->z);
#endif
#if N_ZL
  inner_along(m, model_tried_rest, model_tried_step, P_TRIED, N_ZL, m->tried);
#endif
  for (int r = 0; r < N; ++r) {
    const double *arg[SZ_ARG] = {m->q[r], m->v[r], m->a[r], m->tried + r * N_ZL,
                                 m->u[r], m->t + r, P_TRIED};
    double *res[SZ_RES] = {m->force[r][0]};
    casadi_int iw[SZ_IW];
    double w[SZ_W];
    model_forces(arg, res, iw, w, 0);
    memcpy(m->x[r], m->q[r], sizeof m->q[r]);
    memcpy(m->x[r] + N_Q, m->v[r], sizeof m->v[r]);
    memcpy(m->x[r] + 2 * N_Q, m->z + r * N_Z, N_Z * sizeof(double));
  }
  for (int c = 0; c < N_C; ++c) {
    int finite = 1;
    for (int r = 0; r < N; ++r)
      for (int i = 0; i < N_Q; ++i) finite &= !!isfinite(m->force[r][c][i]);
    for (int r = 0; r < N && !finite; ++r) memset(m->force[r][c], 0, sizeof m->force[r][c]);
  }
}

/* Intervals near a reversal or a rest of a place where a law is steep. */
static void turned(Monitor *m) {
  memset(m->near_, 0, sizeof m->near_);
#if N_SHARP
  double size[N_SHARP] = {0}, sd[N_SHARP] = {0}, rates[N_RATE + 1], ways[N_RATE * N_Q + 1];
  for (int r = 0; r < N; ++r) {
    const double *arg[SZ_ARG] = {m->q[r], m->v[r], m->t + r, P};
    double *res[SZ_RES] = {rates, ways};
    casadi_int iw[SZ_IW];
    double w[SZ_W];
    model_pathways(arg, res, iw, w, 0);
    for (int k = 0; k < N_SHARP; ++k) {
      const int e = SHARP[k]; /* an element, or -1 - i: the speed of a coordinate */
      m->rate[r][k] = e >= 0 ? rates[e] : m->v[r][-1 - e];
      size[k] = fmax(size[k], fabs(m->rate[r][k]));
      for (int i = 0; i < N_Q && e >= 0; ++i) sd[k] += pow(ways[e * N_Q + i] * m->speed_sd[i], 2) / N;
    }
  }
  for (int k = 0; k < N_SHARP; ++k)
    sd[k] = SHARP[k] >= 0 ? sqrt(sd[k]) : m->speed_sd[-1 - SHARP[k]];
  for (int r = 0; r < N - 1; ++r)
    for (int k = 0; k < N_SHARP; ++k) {
      const double a = m->rate[r][k], b = m->rate[r + 1][k], slow = fmax(SLOW * size[k], STILL * sd[k]);
      const int turns = a * b <= 0 || fabs(a) < slow || fabs(b) < slow;
      for (int i = r - 3; turns && i <= r + 3; ++i)
        if (i >= 0 && i < N - 1) m->near_[i] = 1;
    }
#endif
}
