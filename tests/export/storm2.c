/* The calls of FMI 2 in a storm. */
#include <stdarg.h>
static void silent(fmi2ComponentEnvironment e, fmi2String n, fmi2Status s, fmi2String c,
                   fmi2String text, ...) {
  (void)e; (void)n; (void)s; (void)c; (void)text;
}

static void *made(int i) {
  static const fmi2CallbackFunctions calls = {silent, calloc, free, 0, 0};
  fmi2Type type = fmi2ModelExchange;
#ifndef N_I
  if (i == 0) type = fmi2CoSimulation;
#endif
  (void)i;
  return fmi2Instantiate("it", type, TOKEN, "", &calls, 0, 0);
}

static void freed(void *c, Draw *draw) {
  (void)fmi2FreeFMUstate(c, &draw->kept);
  fmi2FreeInstance(c);
}

static int called(void *c, Draw *draw) {
  fmi2EventInfo info;
  fmi2Boolean flags[2];
  double *in = draw->in, *out = draw->out, *seed = draw->seed;
  double now = ((Instance *)c)->m.v[V_T], step = drawn(draw, 4) ? 0.01 : value(draw);
  size_t n = some(draw), m = drawn(draw, N_U + 1), size = 0;
  fmi2ValueReference known[N_U + 1];
  switch (drawn(draw, 26)) {
    case 0: return fmi2SetReal(c, draw->refs, n, in);
    case 1:
    case 2: return fmi2GetReal(c, draw->refs, n, out);
    case 3: return fmi2SetupExperiment(c, drawn(draw, 2), value(draw), 0, drawn(draw, 2), 99);
    case 4: return fmi2EnterInitializationMode(c);
    case 5: return fmi2ExitInitializationMode(c);
    case 6:
    case 7:
    case 8: return fmi2DoStep(c, drawn(draw, 9) ? now : value(draw), step, 1);
    case 9: return fmi2EnterEventMode(c);
    case 10: return fmi2NewDiscreteStates(c, &info);
    case 11: return fmi2EnterContinuousTimeMode(c);
    case 12: return fmi2SetTime(c, drawn(draw, 3) ? now + step : value(draw));
    case 13: return fmi2GetContinuousStates(c, out, drawn(draw, 9) ? N_X : n);
    case 14: return fmi2SetContinuousStates(c, in, n);
    case 15: return fmi2GetDerivatives(c, out, N_X);
    case 16: return fmi2CompletedIntegratorStep(c, 1, flags, flags + 1);
#ifdef N_I
    case 17: return fmi2GetEventIndicators(c, out, N_I <= N_V ? N_I : 0);
#endif
    case 18:
      for (size_t i = 0; i < m; ++i) known[i] = (fmi2ValueReference)(V_U + i);
      return fmi2GetDirectionalDerivative(c, draw->refs, n, known, m, seed, out);
    case 19: return fmi2GetNominalsOfContinuousStates(c, out, N_X);
    case 20: return fmi2GetFMUstate(c, &draw->kept);
    case 21: return fmi2SetFMUstate(c, draw->kept);
    case 22: return draw->kept ? fmi2SerializedFMUstateSize(c, draw->kept, &size) : 0;
    case 23: return drawn(draw, 20) ? fmi2OK : fmi2Terminate(c);
    default: return drawn(draw, 8) ? fmi2OK : fmi2Reset(c);
  }
}
