/* What a storm of calls draws: whole numbers, values, references. Stands behind the code of an FMU. */
typedef struct {
  unsigned long long state;
  void *kept; /* a state of the FMU, or none */
  unsigned refs[N_V + 4];
  double in[N_V + 4], seed[N_V + 4], out[N_V + 4];
} Draw;

static unsigned long drawn(Draw *draw, unsigned long below) {
  draw->state = draw->state * 6364136223846793005ULL + 1442695040888963407ULL;
  return (unsigned long)(draw->state >> 33) % below;
}

/* Mostly what a host would give, sometimes what it must not. */
static double value(Draw *draw) {
  static const double odd[] = {0, -1, 1e-300, 1e300, -1e308, NAN, INFINITY, -INFINITY, 1e6, 20};
  if (drawn(draw, 12) == 0) return odd[drawn(draw, sizeof odd / sizeof *odd)];
  return (double)drawn(draw, 2001) / 1000 - 1;
}

/* How many variables a call is about; their references and values. */
static size_t some(Draw *draw) {
  size_t n = drawn(draw, drawn(draw, 4) ? 3 : N_V + 3);
  for (size_t i = 0; i < n; ++i) {
    draw->refs[i] = drawn(draw, 20) ? (unsigned)drawn(draw, N_V) : (unsigned)drawn(draw, 2) - 1 + N_V;
    if (drawn(draw, 200) == 0) draw->refs[i] = 0xffffffffu;
    draw->in[i] = value(draw);
    draw->seed[i] = value(draw);
  }
  return n;
}
