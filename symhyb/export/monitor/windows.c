/* ---- the model linearised from sample to sample along the motion ---- */

/* Slopes of the rates at a state. */
static void rated(const double *x, const double *d, double t, double made[WIDTH][RATES]) {
  const double *arg[SZ_ARG] = {x, d, &t, P};
  double *res[SZ_RES] = {made[0]};
  casadi_int iw[SZ_IW];
  double w[SZ_W];
  model_rate_slopes(arg, res, iw, w, 0);
}

/* Slopes of a step from those of the rates at its nodes: Lobatto IIIC with three stages. */
static void collocated(Monitor *m, double h) {
  static const double A[3][3] = {
      {1.0 / 6, -1.0 / 3, 1.0 / 6}, {1.0 / 6, 5.0 / 12, -1.0 / 12}, {1.0 / 6, 2.0 / 3, 1.0 / 6}};
  double (*matrix)[3 * RATES] = m->matrix, (*right)[WIDTH] = m->right;
  double (*node[3])[RATES];
  for (int k = 0; k < 3; ++k) node[k] = m->at_nodes[m->node[k]];
  for (int i = 0; i < 3; ++i)
    for (int row = 0; row < RATES; ++row) {
      const int at = i * RATES + row;
      for (int c = 0; c < WIDTH; ++c) {
        double total = 0;
        for (int k = 0; k < 3; ++k) total += A[i][k] * node[k][c][row];
        right[at][c] = c >= N_Q && c < N_X ? (c == N_Q + row) : h * total;
      }
      for (int k = 0; k < 3; ++k)
        for (int c = 0; c < RATES; ++c) {
          double total = A[i][k] * node[k][N_Q + c][row];
          if (c < N_Q)
            for (int o = 0; o < 3; ++o) total += h * A[i][o] * A[o][k] * node[o][c][row];
          matrix[at][k * RATES + c] = (at == k * RATES + c) - h * total;
        }
    }
  for (int j = 0; j < 3 * RATES; ++j) {
    int best = j;
    double most = fabs(matrix[j][j]) / 0.1;
    for (int i = j + 1; i < 3 * RATES; ++i)
      if (fabs(matrix[i][j]) > most) best = i, most = fabs(matrix[i][j]);
    for (int c = 0; best != j && c < 3 * RATES; ++c) {
      const double kept = matrix[j][c];
      matrix[j][c] = matrix[best][c], matrix[best][c] = kept;
    }
    for (int c = 0; best != j && c < WIDTH; ++c) {
      const double kept = right[j][c];
      right[j][c] = right[best][c], right[best][c] = kept;
    }
    const double by = matrix[j][j] != 0 ? 1 / matrix[j][j] : NAN;
    for (int c = j; c < 3 * RATES; ++c) matrix[j][c] *= by;
    for (int c = 0; c < WIDTH; ++c) right[j][c] *= by;
    for (int i = j + 1; i < 3 * RATES; ++i) {
      const double factor = matrix[i][j];
      if (factor == 0) continue;
      for (int c = j + 1; c < 3 * RATES; ++c) matrix[i][c] -= factor * matrix[j][c];
      for (int c = 0; c < WIDTH; ++c) right[i][c] -= factor * right[j][c];
    }
  }
  for (int j = 3 * RATES - 1; j > 0; --j)
    for (int i = 0; i < j; ++i)
      for (int c = 0; matrix[i][j] != 0 && c < WIDTH; ++c) right[i][c] -= matrix[i][j] * right[j][c];
  for (int c = 0; c < WIDTH; ++c) {
    for (int i = 0; i < N_Q; ++i) {
      double moved = 0;
      for (int k = 0; k < 3; ++k) moved += A[2][k] * right[k * RATES + i][c];
      m->slope[c][i] = h * moved + (c == i);
    }
    for (int i = 0; i < RATES; ++i) m->slope[c][N_Q + i] = right[2 * RATES + i][c];
  }
}

/* The slopes so far, a step further. */
static void joined(Monitor *m, int part, int parts) {
  const double where = (part + 0.5) / parts;
  double (*now)[JOINED] = m->now, (*after)[JOINED] = m->after;
  for (int r = 0; r < N_X; ++r)
    for (int c = 0; c < JOINED; ++c) {
      double total = 0;
      for (int q = 0; part && q < N_X; ++q) total += m->slope[q][r] * now[q][c];
      if (!part && c < N_X) total = m->slope[c][r];
      if (c >= N_X && c < N_X + N_F) total += m->slope[c][r];
      else if (c >= N_X + N_F + N_Q) total += where * m->slope[c - N_Q][r];
      else if (c >= N_X + N_F) total += (1 - where) * m->slope[c][r];
      after[r][c] = total;
    }
  memcpy(m->now, m->after, sizeof m->now);
}

static void driven(const Monitor *m, int r, int first, int last, double *d) {
  const int before = r > first ? r - 1 : r, next = r < last ? r + 1 : r;
  for (int i = 0; i < N_D; ++i) d[i] = 0;
  for (int i = 0; i < N_U; ++i) {
    d[i] = m->u[r][i];
    d[N_U + i] = (m->u[next][i] - m->u[before][i]) / (m->t[next] - m->t[before]);
  }
}

/* From sample r to the next: where the model ends that starts at the measured motion, and slopes. */
static void stepped(Monitor *m, int r, int first, int last) {
  double d[N_D + 1], rise[N_D + 1], d0[N_D + 1], d1[N_D + 1], w[SZ_W];
  casadi_int iw[SZ_IW];
  const int parts = STEPS * (m->near_[r] ? FINE : 1);
  const int size = !SMOOTH_ANY && parts % PIECES == 0 ? parts / PIECES : 1;
  const double h = (m->t[r + 1] - m->t[r]) / parts;
  driven(m, r, first, last, d), driven(m, r + 1, first, last, rise);
  for (int i = 0; i < N_D; ++i) rise[i] = (rise[i] - d[i]) / parts;
  memcpy(m->states[0], m->x[r], sizeof m->x[r]);
  for (int part = 0; part < parts; ++part) {
    const double t = m->t[r] + part * h;
    for (int i = 0; i < N_D; ++i) d0[i] = d[i] + part * rise[i], d1[i] = d0[i] + rise[i];
#if SMOOTH_ANY
    bend(m, r, t, d0), bend(m, r, t + h, d1);
#endif
    const double *arg[SZ_ARG] = {m->states[part], d0, d1, &t, &h, P};
    double *res[SZ_RES] = {m->states[part + 1], m->middle[part]};
    model_step(arg, res, iw, w, 0);
  }
  for (int piece = 0; piece * size < parts; ++piece) {
    const int at = piece * size, end = at + size, half = at + size / 2;
    const double t = m->t[r] + at * h, whole = size * h;
    for (int i = 0; i < N_D; ++i) d0[i] = d[i] + at * rise[i], d1[i] = d[i] + end * rise[i];
#if SMOOTH_ANY
    bend(m, r, t, d0), bend(m, r, t + whole, d1);
#endif
    const int free_one = m->node[0];
    if (piece) m->node[0] = m->node[2], m->node[2] = free_one; /* where the last one ended */
    else rated(m->states[at], d0, t, m->at_nodes[m->node[0]]);
    rated(m->states[end], d1, t + whole, m->at_nodes[m->node[2]]);
    for (int i = 0; i < N_D; ++i) d0[i] = (d0[i] + d1[i]) / 2;
    rated(size % 2 ? m->middle[half] : m->states[half], d0, t + whole / 2,
          m->at_nodes[m->node[1]]);
    collocated(m, whole);
    joined(m, piece, parts / size);
  }
  memcpy(m->end, m->states[parts], sizeof m->end);
}

/* What the sensors see of all that deviates, in units of the noise, at a sample of a window. */
static void seen(Monitor *m, int r, int first, int last, double (*white)[MOVED]) {
  double y[N_S], by_x[N_S * N_X], by_free[N_S * N_F + 1], by_force[N_S * N_Q], d[N_D + 1], w[SZ_W];
  casadi_int iw[SZ_IW];
  driven(m, r, first, last, d);
  const double *arg[SZ_ARG] = {m->x[r], d, m->t + r, P};
  double *res[SZ_RES] = {y, by_x, by_free, by_force};
  model_sense(arg, res, iw, w, 0);
  for (int j = 0; j < N_S; ++j)
    for (int c = 0; c < MOVED; ++c) {
      double sum = 0;
      for (int q = 0; q < N_X; ++q) sum += by_x[q * N_S + j] * m->moved[q][c];
      const int column = c - STARTS;
      if (column >= 0 && column < N_C)
        for (int i = 0; i < N_Q; ++i) sum += by_force[i * N_S + j] * m->force[r][column][i];
      else if (column >= N_C && column < N_COLUMNS) sum += by_free[(column - N_C) * N_S + j];
      else if (column == N_COLUMNS) sum = m->y[r][j] - y[j] - sum;
      white[j][c] = sum / SD[j];
    }
}

/* Takes out of a window what its initial state does, and adds up what is left. */
static int projected(Monitor *m, int rows, Block *block) {
  double (*white)[MOVED] = m->white;
  for (int s = 0; s < STARTS; ++s) {
    double scale = 0, norm = 0;
    for (int i = 0; i < rows; ++i) scale += white[i][s] * white[i][s];
    scale = scale > 0 ? sqrt(scale) : 1;
    for (int i = 0; i < rows; ++i) white[i][s] /= scale;
    for (int again = 0; again < 2; ++again)
      for (int b = 0; b < s; ++b) {
        double dot = 0;
        for (int i = 0; i < rows; ++i) dot += white[i][b] * white[i][s];
        for (int i = 0; i < rows; ++i) white[i][s] -= dot * white[i][b];
      }
    for (int i = 0; i < rows; ++i) norm += white[i][s] * white[i][s];
    norm = sqrt(norm);
    for (int i = 0; i < rows; ++i) white[i][s] = norm > 1e-9 ? white[i][s] / norm : 0;
  }
  for (int s = 0; s < STARTS; ++s) {
    double *dot = m->dot;
    memset(dot, 0, sizeof m->dot);
    for (int i = 0; i < rows; ++i)
      for (int c = STARTS; c < MOVED; ++c) dot[c] += white[i][s] * white[i][c];
    for (int i = 0; i < rows; ++i)
      for (int c = STARTS; c < MOVED; ++c) white[i][c] -= white[i][s] * dot[c];
  }
  for (int i = 0; i < rows; ++i) {
    const double *row = white[i] + STARTS;
    for (int c = 0; c < N_COLUMNS; ++c) {
      block->shown[c] += row[c] * row[c];
      block->score[c] += row[c] * row[N_COLUMNS];
    }
    for (int k = 0; k < N_CAUSES; ++k) {
      const int size = FIRST[k + 1] - FIRST[k], *own = COLUMN + FIRST[k];
      for (int a = 0; a < size; ++a)
        for (int b = 0; b < size; ++b) block->pairs[PAIR[k] + a * size + b] += row[own[a]] * row[own[b]];
    }
  }
  double total = 0;
  for (int i = 0; i < rows; ++i) total += fabs(white[i][MOVED - 1]);
  for (int c = 0; c < N_COLUMNS; ++c) total += block->shown[c] + fabs(block->score[c]);
  return isfinite(total);
}

/* The sample from which the motion determines a start: a spline may swing at its ends. */
static int settled(const Monitor *m) {
  const int end = (int)ceil(END_KNOTS * SPACING_S / m->step);
  if (N < 20 * end) return 0;
  for (int i = 0; i < N_Q; ++i) {
    double first = 0, between = 0;
    for (int r = 0; r < N - end; ++r) {
      if (r < end) first = fmax(first, fabs(m->v[r][i]));
      else between = fmax(between, fabs(m->v[r][i]));
    }
    if (first > SWUNG * between) return end;
  }
  return 0;
}

/* A block from the samples that were gathered; 0 if it holds no whole window. */
static int reduced(Monitor *m, Block *block) {
  int samples, begin = 0, windows = 0;
  memset(block, 0, sizeof *block);
  if (!smoothed(m)) return 0;
#if SMOOTH_ANY
  finer(m);
#endif
  turned(m);
  acted(m);
  const double length = fmin(LENGTH_S, m->step * (N - 1));
  samples = (int)nearbyint(length / m->step) + 1;
  if (samples < SAMPLES_LEAST) samples = SAMPLES_LEAST;
  if (samples > N) return 0;
  begin = settled(m);
  if (begin + samples > N) begin = 0;
  for (int first = begin; first + samples <= N; first += samples - 1) {
    const int last = first + samples - 1;
    if (m->t[last] - m->t[first] >= GAP * (samples - 1) * m->step) continue;
    memset(m->moved, 0, sizeof m->moved);
    for (int i = 0; i < STARTS; ++i) m->moved[i][i] = 1;
    for (int r = first; r <= last; ++r) {
      seen(m, r, first, last, m->white + (r - first) * N_S);
      if (r == last) break;
      stepped(m, r, first, last);
      for (int q = 0; q < N_X; ++q)
        for (int c = 0; c < MOVED; ++c) {
          double sum = 0;
          const int column = c - STARTS;
          for (int k = 0; k < N_X; ++k) sum += m->now[q][k] * m->moved[k][c];
          if (column >= 0 && column < N_C)
            for (int i = 0; i < N_Q; ++i) {
              const double *kick = m->now[q] + N_X + N_F + i;
              sum += kick[0] * m->force[r][column][i] + kick[N_Q] * m->force[r + 1][column][i];
            }
          else if (column >= N_C && column < N_COLUMNS) sum += m->now[q][N_X + column - N_C];
          else if (column == N_COLUMNS) sum += m->end[q] - m->x[r + 1][q];
          m->further[q][c] = sum;
        }
      memcpy(m->moved, m->further, sizeof m->moved);
    }
    if (!projected(m, samples * N_S, block)) return 0;
    ++windows;
  }
  for (int g = 0; g < N_GAINS; ++g) block->motion = fmax(block->motion, block->shown[GAINS[g]]);
  return windows > 0;
}
