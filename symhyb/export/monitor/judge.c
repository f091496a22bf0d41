/* ---- whether blocks differ from the reference, since when, and by which cause ---- */

/* The pseudoinverse (size, size) of a symmetric matrix, by Jacobi's rotations. */
static void inverted(const double *given, int size, double *made) {
  double a[K_MOST][K_MOST], v[K_MOST][K_MOST] = {{0}}, most = 0;
  for (int i = 0; i < size; ++i) {
    v[i][i] = 1;
    for (int j = 0; j < size; ++j) a[i][j] = given[i * size + j];
  }
  for (int sweep = 0; sweep < 30; ++sweep) {
    double off = 0;
    for (int p = 0; p < size; ++p)
      for (int q = p + 1; q < size; ++q) {
        if (a[p][q] == 0) continue;
        off += fabs(a[p][q]);
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double tangent = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1));
        const double c = 1 / sqrt(tangent * tangent + 1), s = tangent * c;
        for (int k = 0; k < size; ++k) {
          const double x = a[k][p], y = a[k][q], z = v[k][p];
          a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
          v[k][p] = c * z - s * v[k][q], v[k][q] = s * z + c * v[k][q];
        }
        for (int k = 0; k < size; ++k) {
          const double x = a[p][k], y = a[q][k];
          a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
        }
        a[p][q] = a[q][p] = 0;
      }
    if (off == 0) break;
  }
  for (int k = 0; k < size; ++k) most = fmax(most, fabs(a[k][k]));
  for (int i = 0; i < size; ++i)
    for (int j = 0; j < size; ++j) {
      double sum = 0;
      for (int k = 0; k < size; ++k)
        if (fabs(a[k][k]) > 1e-15 * most) sum += v[i][k] * v[j][k] / a[k][k];
      made[i * size + j] = sum;
    }
}

/* How improbable what the last blocks say is, by the most improbable column and length. */
static double chance_of(Monitor *m) {
  double found = 0;
  const int recent = m->count < LONGEST ? m->count : LONGEST;
  for (int c = 0; c < N_COLUMNS; ++c) {
    if (!KNOWN[c]) continue;
    for (int bound = 0; bound < N_BOUNDS; ++bound) {
      double sum = 0;
      for (int length = 1, which = 0; length <= recent; ++length) {
        const Block *b = m->blocks + m->count - length;
        double z = 0;
        if (b->shown[c] > 0)
          z = (b->score[c] - b->shown[c] * THETA[c]) /
              sqrt(b->shown[c] * (SCATTER[c] + ACCURACY * ACCURACY * b->motion));
        sum += fmin(fmax(z / LARGEST[bound * N_COLUMNS + c], -1), 1);
        if (length != LENGTHS[which]) continue;
        const double more = CLUSTERED[(bound * N_LENGTHS + which) * N_COLUMNS + c];
        for (int t = 0; t < N_TILTS; ++t) {
          const double log_mean = CUMULANT[(bound * N_TILTS + t) * N_COLUMNS + c];
          found = fmin(found, (length * log_mean - TILT[t] * fabs(sum)) /
                                  (more + length / (double)BLOCKS));
        }
        ++which;
      }
    }
  }
  return fmin(2 * exp(found), 1);
}

static void summed(const Monitor *m, int since, Block *sum) {
  memset(sum, 0, sizeof *sum);
  for (int b = since; b < m->count; ++b) {
    const Block *one = m->blocks + b;
    for (int c = 0; c < N_COLUMNS; ++c) sum->score[c] += one->score[c];
    for (int k = 0; k < N_PAIRS; ++k) sum->pairs[k] += one->pairs[k];
    sum->motion += one->motion;
  }
}

/* By how much each cause explains what is otherwise in blocks; the best one. */
static int worth_of(const Block *sum, double *worth) {
  int best = 0;
  for (int k = 0; k < N_CAUSES; ++k) {
    const int size = FIRST[k + 1] - FIRST[k], *own = COLUMN + FIRST[k];
    const double *pairs = sum->pairs + PAIR[k];
    double inverse[K_MOST * K_MOST], left[K_MOST], total = 0;
    int known = 1;
    for (int a = 0; a < size; ++a) {
      known &= KNOWN[own[a]];
      left[a] = sum->score[own[a]];
      for (int b = 0; b < size; ++b) left[a] -= pairs[a * size + b] * BEFORE[FIRST[k] + b];
    }
    inverted(pairs, size, inverse);
    for (int a = 0; a < size; ++a)
      for (int b = 0; b < size; ++b) total += left[a] * inverse[a * size + b] * left[b];
    worth[k] = known ? total / UNIT - PRICE[k] : -HUGE_VAL;
    if (worth[k] > worth[best]) best = k;
  }
  return best;
}

/* What has changed since a block. */
static void named(Monitor *m, int since, Event *event) {
  double *worth = m->worth, odds = 0;
  Block *sum = &m->sum;
  summed(m, since, sum);
  const int best = worth_of(sum, worth), size = FIRST[best + 1] - FIRST[best];
  const int *own = COLUMN + FIRST[best];
  double after[K_MOST * K_MOST];
  inverted(sum->pairs + PAIR[best], size, after);
  event->since_s = m->blocks[since].start_s;
  event->cause = best;
  event->numbers = size;
  event->chance = m->chance;
  for (int a = 0; a < size; ++a) {
    double value = -BEFORE[FIRST[best] + a];
    const double variance = after[a * size + a];
    for (int b = 0; b < size; ++b) value += after[a * size + b] * sum->score[own[b]];
    event->size[a] = value;
    event->sd[a] = sqrt((variance + REFERENCE_VARIANCE[FIRST[best] + a]) * SCATTER[own[a]] +
                        variance * ACCURACY * ACCURACY * sum->motion);
  }
  for (int k = 0; k < N_CAUSES; ++k) odds += exp(0.5 * (worth[k] - worth[best]));
  event->probability = 1 / odds;
  for (int i = 0, last = best; i < RIVALS; ++i) { /* the likeliest first */
    int next = -1;
    for (int k = 0; k < N_CAUSES; ++k) {
      const int behind = worth[k] < worth[last] || (worth[k] == worth[last] && k > last);
      if (k != best && behind && (next < 0 || worth[k] > worth[next])) next = k;
    }
    if (next >= 0 && !(worth[best] - worth[next] < SIGNIFICANT)) next = -1;
    event->rival[i] = next;
    if (next < 0) {
      for (; i < RIVALS; ++i) event->rival[i] = -1;
      break;
    }
    last = next;
  }
}

/* The change that the blocks show, the last one included; 0 for none. */
static int changed(Monitor *m, Event *event) {
  int since = -1;
  double most = 0;
  m->chance = chance_of(m);
  if (m->chance >= LEAST) return 0;
  for (int i = m->count > LONGEST ? m->count - LONGEST : 0; i < m->count; ++i) {
    summed(m, i, &m->sum);
    const int best = worth_of(&m->sum, m->worth);
    if (since < 0 || m->worth[best] > most) since = i, most = m->worth[best];
  }
  named(m, since, event);
  m->since = since;
  for (int a = 0; a < event->numbers; ++a)
    if (fabs(event->size[a]) > OUTSTANDING * event->sd[a]) return 1;
  return 0;
}

/* Hold a block against the reference. */
static int judged(Monitor *m, Event *event) {
  const Block *last = m->blocks + m->count - 1;
  if (m->since < 0) {
    if (changed(m, event)) return CHANGED;
    m->since = -1;
    return NOTHING;
  }
  if (last->end_s - m->blocks[m->since].start_s < NAMED_S || m->count - m->since < NAMED_BLOCKS)
    return NOTHING;
  named(m, m->since, event);
  m->latched = 1;
  return NAMED;
}

/* ---- the interface ---- */

void NAME_begin(NAME_monitor *m) {
  memset(m, 0, sizeof *m);
  for (int k = 0; k < 3; ++k) m->node[k] = k;
  m->since = -1;
  m->last_s = -HUGE_VAL;
}

int NAME_step(NAME_monitor *m, double t, const double *u, const double *y, NAME_event *event) {
  int kind;
  memset(event, 0, sizeof *event);
  event->at_s = t;
  if (m->latched) return NOTHING;
  const int r = m->rows / THINNING;
  if (m->rows == 0) m->start_s = t;
  if (m->rows % THINNING == 0 && r < N) {
    m->t[r] = 0;
    memset(m->u[r], 0, sizeof m->u[r]);
    memset(m->y[r], 0, sizeof m->y[r]);
  }
  if (r < N) { /* what is left over of a block makes no sample of its own */
    m->t[r] += THINNING > 1 ? t : 0;
    for (int i = 0; i < N_U; ++i) m->u[r][i] += u[i];
    for (int j = 0; j < N_S; ++j) m->y[r][j] += y[j];
    if (THINNING == 1) m->t[r] = t;
    if (m->rows % THINNING == THINNING - 1) {
      m->t[r] /= THINNING;
      for (int i = 0; i < N_U; ++i) m->u[r][i] /= THINNING;
      for (int j = 0; j < N_S; ++j) m->y[r][j] /= THINNING;
    }
  }
  if (!isfinite(t) || (m->rows && !(t > m->before_s))) m->broken = 1;
  for (int i = 0; i < N_U; ++i) m->broken |= !isfinite(u[i]);
  for (int j = 0; j < N_S; ++j) m->broken |= !isfinite(y[j]);
  m->before_s = t;
  if (++m->rows < ROWS) return NOTHING;
  m->rows = 0;
  const int broken = m->broken;
  m->broken = 0;
  if (broken) return UNREADABLE;
  if (m->start_s <= m->last_s) event->back = 1, m->count = 0, m->since = -1;
  m->last_s = t;
  if (m->count == KEPT) { /* a change that waits for its name is never this long */
    memmove(m->blocks, m->blocks + 1, (KEPT - 1) * sizeof *m->blocks);
    m->count -= 1;
  }
  Block *block = m->blocks + m->count;
  if (!reduced(m, block)) return UNREADABLE;
  block->start_s = m->start_s, block->end_s = t;
  ++m->count;
  kind = judged(m, event);
  if (m->since < 0 && m->count > LONGEST) {
    memmove(m->blocks, m->blocks + m->count - LONGEST, LONGEST * sizeof *m->blocks);
    m->count = LONGEST;
  }
  return kind;
}
