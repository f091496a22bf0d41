/* Every function of FMI 3 in turn, right and wrong, under the checks of the compiler. Stands behind
   the code of an FMU. */
#define CHECK(condition) if (!(condition)) { fprintf(stderr, "line %d\n", __LINE__); return 1; }
#define OK(call) CHECK((call) == fmi3OK)
#define BAD(call) CHECK((call) == fmi3Error)
static int complaints;
static void logger(fmi3InstanceEnvironment e, fmi3Status s, fmi3String c, fmi3String text) {
  (void)e; (void)s; (void)c;
  complaints += strlen(text) > 0;
}
enum { UNKNOWNS = N_Y + 2 * N_X, ROOM = N_V + 1 };
static const fmi3ValueReference far[1] = {N_V};
static fmi3ValueReference known[N_U + 1], all[ROOM];
static double in[N_U + 1], ones[ROOM], out[ROOM];

static fmi3Instance made(int exchange) {
  if (exchange) return fmi3InstantiateModelExchange("it", TOKEN, "", 0, 0, 0, logger);
  return fmi3InstantiateCoSimulation("it", TOKEN, "", 0, 0, 0, 0, 0, 0, 0, logger, 0);
}

static int refused(void) {
  CHECK(!fmi3InstantiateModelExchange("it", "{}", "", 0, 0, 0, logger));
  CHECK(!fmi3InstantiateModelExchange("it", 0, "", 0, 0, 0, 0));
  CHECK(!fmi3InstantiateModelExchange("", TOKEN, "", 0, 0, 0, logger));
  CHECK(!fmi3InstantiateCoSimulation(0, TOKEN, "", 0, 0, 0, 0, 0, 0, 0, logger, 0));
  CHECK(!fmi3InstantiateCoSimulation("it", TOKEN, "", 0, 0, 1, 0, 0, 0, 0, logger, 0));
  CHECK(!fmi3InstantiateCoSimulation("it", TOKEN, "", 0, 0, 0, 0, all, 1, 0, logger, 0));
  CHECK(!fmi3InstantiateScheduledExecution("it", TOKEN, "", 0, 0, 0, logger, 0, 0, 0));
  fmi3FreeInstance(0);
  BAD(fmi3SetTime(0, 0));
  CHECK(!strcmp(fmi3GetVersion(), fmi3Version));
  return 0;
}

#define NONE(Type)                                                                       \
  OK(fmi3Get##Type(c, all, 0, 0, 0));                                                    \
  OK(fmi3Set##Type(c, all, 0, 0, 0));                                                    \
  BAD(fmi3Get##Type(c, all, 1, (fmi3##Type *)out, 1));                                   \
  BAD(fmi3Set##Type(c, all, 1, (const fmi3##Type *)out, 1))

static int not_offered(fmi3Instance c) {
  size_t n = 0;
  fmi3IntervalQualifier qualifier[1];
  fmi3UInt64 count[1] = {0};
  fmi3DependencyKind kind[1];
  NONE(Float32); NONE(Int8); NONE(UInt8); NONE(Int16); NONE(UInt16); NONE(Int32); NONE(UInt32);
  NONE(Int64); NONE(UInt64); NONE(Boolean); NONE(String);
  OK(fmi3GetBinary(c, all, 0, &n, 0, 0));
  BAD(fmi3GetBinary(c, all, 1, &n, 0, 1));
  OK(fmi3SetBinary(c, all, 0, &n, 0, 0));
  BAD(fmi3SetBinary(c, all, 1, &n, 0, 1));
  OK(fmi3GetClock(c, all, 0, 0));
  BAD(fmi3GetClock(c, all, 1, 0));
  OK(fmi3SetClock(c, all, 0, 0));
  BAD(fmi3SetClock(c, all, 1, 0));
  BAD(fmi3GetNumberOfVariableDependencies(c, 1, &n));
  BAD(fmi3GetVariableDependencies(c, 1, &n, known, &n, kind, 1));
  BAD(fmi3EnterConfigurationMode(c));
  BAD(fmi3ExitConfigurationMode(c));
  BAD(fmi3GetIntervalDecimal(c, all, 1, out, qualifier));
  BAD(fmi3GetIntervalFraction(c, all, 1, count, count, qualifier));
  BAD(fmi3GetShiftDecimal(c, all, 1, out));
  BAD(fmi3GetShiftFraction(c, all, 1, count, count));
  BAD(fmi3SetIntervalDecimal(c, all, 1, out));
  BAD(fmi3SetIntervalFraction(c, all, 1, count, count));
  BAD(fmi3SetShiftDecimal(c, all, 1, out));
  BAD(fmi3SetShiftFraction(c, all, 1, count, count));
  BAD(fmi3EnterStepMode(c));
  BAD(fmi3ActivateModelPartition(c, 1, 0));
  return 0;
}

static int begun(fmi3Instance c) {
  double bad[1] = {NAN};
  BAD(fmi3GetFloat64(c, all, N_V, out, N_V));
  BAD(fmi3ExitInitializationMode(c));
  BAD(fmi3Terminate(c));
  BAD(fmi3EnterEventMode(c));
  BAD(fmi3EnterInitializationMode(c, 0, 0, NAN, 0, 0));
  BAD(fmi3EnterInitializationMode(c, 0, 0, 1, 1, 0));
  OK(fmi3SetDebugLogging(c, 0, 0, 0));
  OK(fmi3SetFloat64(c, known, N_U, in, N_U));
  OK(fmi3EnterInitializationMode(c, 1, 1e-6, 0, 1, 10));
  BAD(fmi3EnterInitializationMode(c, 1, 1e-6, 0, 1, 10));
  OK(fmi3EvaluateDiscreteStates(c));
  OK(fmi3GetDirectionalDerivative(c, all + V_Y, UNKNOWNS, known, N_U, ones, N_U, out, UNKNOWNS));
  BAD(fmi3GetAdjointDerivative(c, all + V_Y, 1, known, N_U, ones, 1, out, N_U));
  OK(fmi3ExitInitializationMode(c));
  OK(fmi3GetFloat64(c, all, N_V, out, N_V));
  BAD(fmi3GetFloat64(c, far, 1, out, 1));
  BAD(fmi3GetFloat64(c, all, 1, out, 2));
  BAD(fmi3GetFloat64(c, 0, 1, out, 1));
  BAD(fmi3SetFloat64(c, all, 1, out, 2));
  BAD(fmi3SetFloat64(c, known, 1, 0, 1));
  BAD(fmi3SetFloat64(c, far, 1, ones, 1));
  BAD(fmi3SetFloat64(c, known, 1, bad, 1));
  BAD(fmi3SetFloat64(c, all + V_Y, 1, ones, 1));
  OK(fmi3SetFloat64(c, all + V_P, 1, out + V_P, 1));
  return 0;
}

static int derived(fmi3Instance c) {
  double pulled[N_S];
  OK(fmi3GetDirectionalDerivative(c, all + V_Y, UNKNOWNS, known, N_U, ones, N_U, out, UNKNOWNS));
  BAD(fmi3GetDirectionalDerivative(c, all + V_P, 1, known, 1, ones, 1, out, 1));
  BAD(fmi3GetDirectionalDerivative(c, all + V_Y, 1, far, 1, ones, 1, out, 1));
  BAD(fmi3GetDirectionalDerivative(c, all + V_Y, 1, known, 1, ones, 2, out, 1));
  OK(fmi3GetAdjointDerivative(c, all + V_Y, UNKNOWNS, known, N_U, ones, UNKNOWNS, pulled, N_U));
  OK(fmi3GetAdjointDerivative(c, all + V_Y, 1, all + V_X, N_X, ones, 1, pulled, N_X));
  BAD(fmi3GetAdjointDerivative(c, all + V_U, 1, known, 1, ones, 1, pulled, 1));
  BAD(fmi3GetAdjointDerivative(c, all + V_Y, 1, all + V_Y, 1, ones, 1, pulled, 1));
  BAD(fmi3GetAdjointDerivative(c, all + V_Y, 1, known, 1, ones, 1, pulled, 2));
  return 0;
}

static int remembered(fmi3Instance c, fmi3Instance other) {
  fmi3FMUState state = 0, again = 0;
  size_t size = 0;
  fmi3Byte bytes[sizeof(Memory) + 1];
  double before[ROOM];
  OK(fmi3GetFloat64(c, all, N_V, before, N_V));
  BAD(fmi3GetFMUState(c, 0));
  BAD(fmi3SetFMUState(c, 0));
  OK(fmi3GetFMUState(c, &state));
  OK(fmi3GetFMUState(c, &state)); /* into the same place */
  BAD(fmi3SerializedFMUStateSize(c, 0, &size));
  OK(fmi3SerializedFMUStateSize(c, state, &size));
  CHECK(size == sizeof(Memory));
  BAD(fmi3SerializeFMUState(c, state, bytes, size - 1));
  BAD(fmi3SerializeFMUState(c, state, 0, size));
  OK(fmi3SerializeFMUState(c, state, bytes, size));
  BAD(fmi3DeserializeFMUState(c, bytes, size + 1, &again));
  BAD(fmi3DeserializeFMUState(c, bytes, size, 0));
  OK(fmi3DeserializeFMUState(c, bytes, size, &again));
  CHECK(!memcmp(state, again, size));
  OK(fmi3SetFMUState(other, again));
  OK(fmi3GetFloat64(other, all, N_V, out, N_V));
  CHECK(!memcmp(before, out, N_V * sizeof *out));
  bytes[0] ^= 1;
  BAD(fmi3DeserializeFMUState(c, bytes, size, &again));
  OK(fmi3FreeFMUState(c, &state));
  OK(fmi3FreeFMUState(c, &again));
  OK(fmi3FreeFMUState(c, &again));
  OK(fmi3FreeFMUState(c, 0));
  CHECK(!state && !again);
  return 0;
}

static int stepped(fmi3Instance c) {
  fmi3Boolean event, over, early;
  double last;
#define STEP_BY(t, h) fmi3DoStep(c, t, h, 1, &event, &over, &early, &last)
  for (int i = 0; i < 100; ++i) {
    OK(STEP_BY(i * 0.01, 0.01));
    CHECK(!event && !over && !early && fabs(last - (i + 1) * 0.01) < 1e-9);
  }
  BAD(STEP_BY(5, 0.01));
  BAD(STEP_BY(1, 20));
  BAD(STEP_BY(1, -1));
  BAD(fmi3DoStep(c, 1, 0.01, 1, 0, &over, &early, &last));
  BAD(fmi3SetTime(c, 0));
  BAD(fmi3EnterEventMode(c));
  OK(fmi3GetOutputDerivatives(c, all, 0, 0, 0, 0));
  BAD(fmi3GetOutputDerivatives(c, all + V_Y, 1, 0, out, 1));
  return 0;
}

static int settled(fmi3Instance c) {
  fmi3Boolean flags[5];
  double next;
  BAD(fmi3UpdateDiscreteStates(c, 0, flags, flags, flags, flags, &next));
  OK(fmi3UpdateDiscreteStates(c, flags, flags + 1, flags + 2, flags + 3, flags + 4, &next));
  CHECK(!flags[0] && !flags[1] && !flags[2] && !flags[3] && !flags[4]);
  OK(fmi3EvaluateDiscreteStates(c));
  OK(fmi3EnterContinuousTimeMode(c));
  BAD(fmi3EvaluateDiscreteStates(c));
  BAD(fmi3UpdateDiscreteStates(c, flags, flags + 1, flags + 2, flags + 3, flags + 4, &next));
  BAD(fmi3EnterContinuousTimeMode(c));
  return 0;
}

static int exchanged(fmi3Instance c) {
  fmi3Boolean event, over, early;
  double x[N_X + 1], bad[N_X + 1], last;
  size_t n = 0;
  if (settled(c)) return 1;
  OK(fmi3SetTime(c, 0.5));
  BAD(fmi3SetTime(c, INFINITY));
  OK(fmi3GetNumberOfContinuousStates(c, &n));
  CHECK(n == N_X);
  BAD(fmi3GetNumberOfContinuousStates(c, 0));
  OK(fmi3GetContinuousStates(c, x, N_X));
  BAD(fmi3GetContinuousStates(c, x, N_X + 1));
  OK(fmi3SetContinuousStates(c, x, N_X));
  BAD(fmi3SetContinuousStates(c, x, N_X + 1));
  for (int i = 0; i < N_X; ++i) bad[i] = NAN;
  BAD(fmi3SetContinuousStates(c, bad, N_X));
  OK(fmi3GetContinuousStateDerivatives(c, x, N_X));
  BAD(fmi3GetContinuousStateDerivatives(c, x, N_X + 1));
  OK(fmi3GetNominalsOfContinuousStates(c, x, N_X));
  BAD(fmi3GetNominalsOfContinuousStates(c, x, N_X + 1));
  BAD(fmi3CompletedIntegratorStep(c, 1, 0, &over));
  OK(fmi3CompletedIntegratorStep(c, 1, &event, &over));
  BAD(fmi3DoStep(c, 0, 0.1, 1, &event, &over, &early, &last));
  BAD(fmi3GetNumberOfEventIndicators(c, 0));
  OK(fmi3GetNumberOfEventIndicators(c, &n));
#ifdef N_I
  CHECK(n == N_I);
#else
  CHECK(n == 0);
  OK(fmi3GetEventIndicators(c, out, 0));
  BAD(fmi3GetEventIndicators(c, out, 1));
#endif
  return 0;
}

#ifdef N_I
enum { KINDS = 1 }; /* model exchange alone */
/* The speed passes the band in which friction turns: its mode follows in event mode only. */
static int events(fmi3Instance c) {
  fmi3ValueReference v[1] = {N_U > 1 ? V_U + 1 : V_X + 1}, mode[1] = {V_M};
  double fast[2] = {1, -1}, rest[1] = {0}, z[N_I], held[1];
  fmi3Boolean wanted, over;
  BAD(fmi3GetEventIndicators(c, z, N_I + 1));
  BAD(fmi3GetEventIndicators(c, 0, N_I));
  BAD(fmi3SetFloat64(c, mode, 1, fast, 1));
  BAD(fmi3GetDirectionalDerivative(c, all + V_Y, 1, mode, 1, fast, 1, held, 1));
  OK(fmi3EnterEventMode(c));
  OK(fmi3SetFloat64(c, v, 1, rest, 1));
  OK(fmi3EnterContinuousTimeMode(c)); /* which settles what was not */
  for (int i = 0; i < 2; ++i) {
    OK(fmi3SetFloat64(c, v, 1, fast + i, 1));
    OK(fmi3CompletedIntegratorStep(c, 1, &wanted, &over));
    CHECK(wanted && !over);
    OK(fmi3GetEventIndicators(c, z, N_I));
    CHECK((z[0] > 0) == !i);
    OK(fmi3GetFloat64(c, mode, 1, held, 1));
    CHECK(held[0] == (i ? 1 : 0));
    OK(fmi3EnterEventMode(c));
    if (settled(c)) return 1;
    OK(fmi3GetFloat64(c, mode, 1, held, 1));
    CHECK(held[0] == fast[i]);
    OK(fmi3CompletedIntegratorStep(c, 1, &wanted, &over));
    CHECK(!wanted);
  }
  CHECK(!made(0));
  return 0;
}
#else
enum { KINDS = 2 };
static int events(fmi3Instance c) {
  (void)c;
  return 0;
}
#endif

/* Numbers that break the model: it can still be read, reset and freed. */
static int broken(fmi3Instance c) {
  double huge[N_P + 1];
  for (int i = 0; i <= N_P; ++i) huge[i] = i ? 1e308 : -1e308;
  OK(fmi3Reset(c));
  for (int i = 0; i < N_P; ++i) (void)fmi3SetFloat64(c, all + V_P + i, 1, huge + i, 1);
  for (int i = 0; i < N_U; ++i) OK(fmi3SetFloat64(c, known + i, 1, huge, 1));
  for (int i = 0; i < N_X - N_Z; ++i) OK(fmi3SetFloat64(c, all + V_X + i, 1, huge, 1));
  OK(fmi3EnterInitializationMode(c, 0, 0, 0, 0, 0));
  BAD(fmi3ExitInitializationMode(c));
  OK(fmi3GetFloat64(c, all, N_V, out, N_V));
  BAD(fmi3SetFloat64(c, known, N_U, in, N_U));
  BAD(fmi3Terminate(c));
  OK(fmi3Reset(c));
  return 0;
}

int main(void) {
  for (int i = 0; i < N_U; ++i) { known[i] = V_U + i; in[i] = 0.1 * (i + 1); }
  for (int i = 0; i < ROOM; ++i) { all[i] = i; ones[i] = 1; }
  if (refused()) return 1;
  for (int exchange = 1; exchange > 1 - KINDS; --exchange) {
    fmi3Instance c = made(exchange), other = made(exchange);
    CHECK(c && other && c != other);
    if (not_offered(c) || begun(c) || derived(c) || remembered(c, other)) return 1;
    if (exchange ? exchanged(c) || events(c) : stepped(c)) return 1;
    if (derived(c) || remembered(c, other)) return 1;
    OK(fmi3Terminate(c));
    OK(fmi3GetFloat64(c, all, N_V, out, N_V));
    BAD(fmi3Terminate(c));
    BAD(fmi3SetFloat64(c, known, N_U, in, N_U));
    fmi3FreeInstance(other);
    OK(fmi3Reset(c));
    if (begun(c) || broken(c)) return 1;
    fmi3FreeInstance(c);
  }
  CHECK(complaints > 0);
  puts("all as it should be");
  return 0;
}
