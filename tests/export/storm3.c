/* The calls of FMI 3 in a storm. */
static void *made(int i) {
#ifndef N_I
  if (i == 0)
    return fmi3InstantiateCoSimulation("it", TOKEN, "", 0, 0, 0, 0, 0, 0, 0, 0, 0);
#endif
  (void)i;
  return fmi3InstantiateModelExchange("it", TOKEN, "", 0, 0, 0, 0);
}

static void freed(void *c, Draw *draw) {
  (void)fmi3FreeFMUState(c, &draw->kept);
  fmi3FreeInstance(c);
}

static int called(void *c, Draw *draw) {
  fmi3Boolean flags[5];
  double last, *in = draw->in, *out = draw->out, *seed = draw->seed;
  double now = ((Instance *)c)->m.v[V_T], step = drawn(draw, 4) ? 0.01 : value(draw);
  size_t n = some(draw), m = drawn(draw, N_U + 1), size = 0;
  fmi3ValueReference known[N_U + 1];
  switch (drawn(draw, 26)) {
    case 0: return fmi3SetFloat64(c, draw->refs, n, in, n);
    case 1: return fmi3GetFloat64(c, draw->refs, n, out, n);
    case 2: return fmi3GetFloat64(c, draw->refs, n, n ? out : 0, drawn(draw, 9) ? n : n + 1);
    case 3: return fmi3EnterInitializationMode(c, drawn(draw, 2), value(draw), 0, drawn(draw, 2), 99);
    case 4:
    case 5: return fmi3ExitInitializationMode(c);
    case 6:
    case 7:
    case 8: return fmi3DoStep(c, drawn(draw, 9) ? now : value(draw), step, 1, flags, flags + 1,
                              flags + 2, &last);
    case 9: return fmi3EnterEventMode(c);
    case 10: return fmi3UpdateDiscreteStates(c, flags, flags + 1, flags + 2, flags + 3, flags + 4,
                                             &last);
    case 11: return fmi3EnterContinuousTimeMode(c);
    case 12: return fmi3SetTime(c, drawn(draw, 3) ? now + step : value(draw));
    case 13: return fmi3GetContinuousStates(c, out, drawn(draw, 9) ? N_X : n);
    case 14: return fmi3SetContinuousStates(c, in, n);
    case 15: return fmi3GetContinuousStateDerivatives(c, out, N_X);
    case 16: return fmi3CompletedIntegratorStep(c, 1, flags, flags + 1);
#ifdef N_I
    case 17: return fmi3GetEventIndicators(c, out, N_I <= N_V ? N_I : 0);
#endif
    case 18:
      for (size_t i = 0; i < m; ++i) known[i] = (fmi3ValueReference)(V_U + i);
      return fmi3GetDirectionalDerivative(c, draw->refs, n, known, m, seed, m, out, n);
    case 19:
      for (size_t i = 0; i < m; ++i) known[i] = (fmi3ValueReference)(V_U + i);
      return fmi3GetAdjointDerivative(c, draw->refs, n, known, m, seed, n, out, m);
    case 20: return fmi3GetFMUState(c, &draw->kept);
    case 21: return fmi3SetFMUState(c, draw->kept);
    case 22: return draw->kept ? fmi3SerializedFMUStateSize(c, draw->kept, &size) : 0;
    case 23: return drawn(draw, 20) ? fmi3OK : fmi3Terminate(c);
    case 24: return fmi3GetNominalsOfContinuousStates(c, out, N_X);
    default: return drawn(draw, 8) ? fmi3EvaluateDiscreteStates(c) : fmi3Reset(c);
  }
}
