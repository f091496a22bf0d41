/* Every function of FMI 2 in turn, right and wrong, under the checks of the compiler. Stands behind
   the code of an FMU. */
#include <stdarg.h>
#define CHECK(condition) if (!(condition)) { fprintf(stderr, "line %d\n", __LINE__); return 1; }
static int complaints;
static void logger(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c,
                   fmi2String text, ...) {
  (void)e; (void)n; (void)s; (void)c; (void)text;
  ++complaints;
}
#ifdef N_I
enum { KINDS = 1 }; /* model exchange alone */
/* The speed passes the band in which friction turns: its mode follows in event mode only. */
static int events(fmi2Component c) {
  fmi2ValueReference v[1] = {N_U > 1 ? V_U + 1 : V_X + 1}, mode[1] = {V_M};
  double fast[2] = {1, -1}, rest[1] = {0}, z[N_I], out[1];
  fmi2EventInfo info;
  fmi2Boolean wanted, over;
  CHECK(fmi2GetEventIndicators(c, z, N_I + 1) == fmi2Error);
  CHECK(fmi2GetEventIndicators(c, 0, N_I) == fmi2Error);
  CHECK(fmi2SetReal(c, mode, 1, fast) == fmi2Error);
  CHECK(fmi2GetDirectionalDerivative(c, v, 0, mode, 1, fast, out) == fmi2Error);
  CHECK(fmi2EnterEventMode(c) == fmi2OK && fmi2SetReal(c, v, 1, rest) == fmi2OK);
  CHECK(fmi2EnterContinuousTimeMode(c) == fmi2OK); /* which settles what was not */
  for (int i = 0; i < 2; ++i) {
    CHECK(fmi2SetReal(c, v, 1, fast + i) == fmi2OK);
    CHECK(fmi2CompletedIntegratorStep(c, 1, &wanted, &over) == fmi2OK && wanted && !over);
    CHECK(fmi2GetEventIndicators(c, z, N_I) == fmi2OK && (z[0] > 0) == !i);
    CHECK(fmi2GetReal(c, mode, 1, out) == fmi2OK && out[0] == (i ? 1 : 0));
    CHECK(fmi2EnterContinuousTimeMode(c) == fmi2Error && fmi2NewDiscreteStates(c, &info));
    CHECK(fmi2EnterEventMode(c) == fmi2OK && fmi2NewDiscreteStates(c, 0) == fmi2Error);
    CHECK(fmi2NewDiscreteStates(c, &info) == fmi2OK && !info.newDiscreteStatesNeeded);
    CHECK(fmi2GetReal(c, mode, 1, out) == fmi2OK && out[0] == fast[i]);
    CHECK(fmi2EnterContinuousTimeMode(c) == fmi2OK);
    CHECK(fmi2CompletedIntegratorStep(c, 1, &wanted, &over) == fmi2OK && !wanted);
  }
  return 0;
}
#else
enum { KINDS = 2 };
static int events(fmi2Component c) {
  double z[1];
  CHECK(fmi2GetEventIndicators(c, z, 0) == fmi2OK && fmi2GetEventIndicators(c, z, 1) == fmi2Error);
  return 0;
}
#endif
int main(void) {
  fmi2CallbackFunctions calls = {logger, calloc, free, 0, 0};
  for (int type = 0; type < KINDS; ++type) {
    fmi2Component c = fmi2Instantiate("it", type ? fmi2CoSimulation : fmi2ModelExchange, TOKEN, "",
                                      &calls, 0, 0);
    fmi2FMUstate state = 0, again = 0;
    fmi2ValueReference u[N_U + 1], y[N_V], far[1] = {N_V}, p[1] = {V_P};
    double in[N_U + 1], out[N_V], x[N_X + 1], bad[1] = {NAN}, seed[N_U + 1];
    size_t size = 0;
    char bytes[sizeof(Memory)];
    for (int i = 0; i < N_U; ++i) { u[i] = V_U + i; in[i] = 0.1 * (i + 1); seed[i] = 1; }
    for (int i = 0; i < N_V; ++i) y[i] = i;
    CHECK(c && !fmi2Instantiate("it", fmi2CoSimulation, "{}", "", &calls, 0, 0));
    CHECK(!fmi2Instantiate("", fmi2CoSimulation, TOKEN, "", &calls, 0, 0));
    CHECK(fmi2GetReal(c, y, N_V, out) == fmi2Error);
    CHECK(fmi2SetupExperiment(c, 1, 1e-6, 0, 1, 10) == fmi2OK);
    CHECK(fmi2SetReal(c, u, N_U, in) == fmi2OK);
    CHECK(fmi2EnterInitializationMode(c) == fmi2OK);
    CHECK(fmi2GetDirectionalDerivative(c, y + V_Y, N_Y + 2 * N_X, u, N_U, seed, out) == fmi2OK);
    CHECK(fmi2ExitInitializationMode(c) == fmi2OK);
    CHECK(fmi2GetReal(c, y, N_V, out) == fmi2OK && fmi2GetReal(c, far, 1, out) == fmi2Error);
    CHECK(fmi2SetReal(c, u, 1, bad) == fmi2Error && fmi2SetReal(c, p, 1, out + V_P) == fmi2OK);
    CHECK(fmi2GetFMUstate(c, &state) == fmi2OK);
    if (type) {
      for (int i = 0; i < 100; ++i) CHECK(fmi2DoStep(c, i * 0.01, 0.01, 1) == fmi2OK);
      CHECK(fmi2DoStep(c, 5, 0.01, 1) == fmi2Error && fmi2DoStep(c, 1, 20, 1) == fmi2Error);
      CHECK(fmi2DoStep(c, 1, -1, 1) == fmi2Error && fmi2SetTime(c, 0) == fmi2Error);
    } else {
      CHECK(fmi2EnterContinuousTimeMode(c) == fmi2OK && fmi2SetTime(c, 0.5) == fmi2OK);
      CHECK(fmi2GetContinuousStates(c, x, N_X) == fmi2OK);
      CHECK(fmi2SetContinuousStates(c, x, N_X) == fmi2OK);
      CHECK(fmi2GetDerivatives(c, x, N_X) == fmi2OK);
      CHECK(fmi2GetDerivatives(c, x, N_X + 1) == fmi2Error);
      CHECK(fmi2DoStep(c, 0, 0.1, 1) == fmi2Error && events(c) == 0);
    }
    CHECK(fmi2GetDirectionalDerivative(c, y + V_Y, N_Y + 2 * N_X, u, N_U, seed, out) == fmi2OK);
    CHECK(fmi2GetDirectionalDerivative(c, p, 1, u, 1, seed, out) == fmi2Error);
    CHECK(fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK && size == sizeof bytes);
    CHECK(fmi2SerializeFMUstate(c, state, bytes, size - 1) == fmi2Error);
    CHECK(fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK);
    CHECK(fmi2DeSerializeFMUstate(c, bytes, size, &again) == fmi2OK);
    CHECK(!memcmp(state, again, size) && fmi2SetFMUstate(c, again) == fmi2OK);
    bytes[0] ^= 1;
    CHECK(fmi2DeSerializeFMUstate(c, bytes, size, &again) == fmi2Error);
    CHECK(fmi2FreeFMUstate(c, &state) == fmi2OK && fmi2FreeFMUstate(c, &again) == fmi2OK);
    CHECK(fmi2Reset(c) == fmi2OK);
    fmi2FreeInstance(c);
  }
  CHECK(KINDS == 2 || !fmi2Instantiate("it", fmi2CoSimulation, TOKEN, "", &calls, 0, 0));
  CHECK(complaints > 0 && fmi2SetTime(0, 0) == fmi2Error);
  puts("all as it should be");
  return 0;
}
