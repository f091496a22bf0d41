/* FMI 2.0.4 around the model: co-simulation and model exchange. */
#if !defined(DISABLE_PREFIX) && defined(FMI2_FUNCTION_PREFIX_WANTED)
#define FMI2_FUNCTION_PREFIX FMI2_FUNCTION_PREFIX_WANTED
#endif
#include "fmi2Functions.h"

typedef struct {
  Memory m;
  int exchange;
  char name[64];
  fmi2CallbackLogger logger;
  fmi2ComponentEnvironment environment;
} Instance;

static fmi2Status complain(Instance *self, const char *function, const char *reason) {
  if (self->logger)
    self->logger(self->environment, self->name, fmi2Error, "logStatusError", "%s: %s", function,
                 reason);
  return fmi2Error;
}

/* What breaks the model: from here on it may only be read, reset, restored or freed. */
static fmi2Status fail(Instance *self, const char *function, const char *reason) {
  self->m.phase = BROKEN;
  return complain(self, function, reason);
}

#define SELF(phases, function)                                                          \
  Instance *self = (Instance *)c;                                                       \
  if (!self) return fmi2Error;                                                          \
  if (!((int)self->m.phase & (phases)))                                                 \
    return complain(self, function, "must not be called in this phase of a simulation")
#define REQUIRE(condition, function, reason) \
  if (!(condition)) return complain(self, function, reason)

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions *functions,
                              fmi2Boolean visible, fmi2Boolean logging) {
  Instance *self = (Instance *)calloc(1, sizeof(Instance));
  (void)resources; (void)visible; (void)logging;
  if (!self) return 0;
  begin(&self->m);
  self->exchange = type == fmi2ModelExchange;
  snprintf(self->name, sizeof self->name, "%s", name ? name : "");
  if (functions) {
    self->logger = functions->logger;
    self->environment = functions->componentEnvironment;
  }
  if (!guid || strcmp(guid, TOKEN)) {
    complain(self, "fmi2Instantiate", "the GUID is not that of this model");
    free(self);
    return 0;
  }
#ifdef EVENTS
  if (type != fmi2ModelExchange) {
    complain(self, "fmi2Instantiate", "a model with events is for model exchange alone");
    free(self);
    return 0;
  }
#endif
  if (!name || !*name) {
    complain(self, "fmi2Instantiate", "the instance has no name");
    free(self);
    return 0;
  }
  return self;
}

void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String names[]) {
  SELF(ANY, "fmi2SetDebugLogging");
  (void)on; (void)n; (void)names;
  return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerant, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean ends, fmi2Real stop) {
  SELF(FRESH, "fmi2SetupExperiment");
  REQUIRE(isfinite(start), "fmi2SetupExperiment", "the start time is not finite");
  REQUIRE(!ends || stop > start, "fmi2SetupExperiment", "the stop time is before the start");
  if (tolerant && tolerance > 0) self->m.tolerance = fmin(fmax(tolerance, 1e-12), 1e-2);
  self->m.v[V_T] = start;
  self->m.stop = ends ? stop : HUGE_VAL;
  self->m.stale = 1;
  return fmi2OK;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  SELF(FRESH, "fmi2EnterInitializationMode");
  self->m.phase = INITIAL;
  return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
  SELF(INITIAL, "fmi2ExitInitializationMode");
  self->m.stale = 1;
  if (!refresh(&self->m))
    return fail(self, "fmi2ExitInitializationMode", "a value is not finite at the start");
  self->m.phase = self->exchange ? EVENT : STEP;
  return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
  SELF(EVENT | CONTINUOUS | STEP, "fmi2Terminate");
  self->m.phase = ENDED;
  return fmi2OK;
}

fmi2Status fmi2Reset(fmi2Component c) {
  SELF(ANY, "fmi2Reset");
  begin(&self->m);
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
  SELF(LIVE | ENDED | BROKEN, "fmi2GetReal");
  REQUIRE(n == 0 || (vr && value), "fmi2GetReal", "a pointer is missing");
  for (size_t i = 0; i < n; ++i)
    REQUIRE(vr[i] < N_V, "fmi2GetReal", "there is no variable of this reference");
  if (self->m.phase != BROKEN && !refresh(&self->m)) {
    complain(self, "fmi2GetReal", "a value is not finite");
    return self->exchange ? fmi2Discard : fmi2Error;
  }
  for (size_t i = 0; i < n; ++i) value[i] = self->m.v[vr[i]];
  return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                       const fmi2Real value[]) {
  SELF(FRESH | LIVE, "fmi2SetReal");
  REQUIRE(n == 0 || (vr && value), "fmi2SetReal", "a pointer is missing");
  for (size_t i = 0; i < n; ++i) {
    REQUIRE(vr[i] < N_V, "fmi2SetReal", "there is no variable of this reference");
    REQUIRE(may_set(&self->m, vr[i]), "fmi2SetReal", "this variable cannot be set now");
    REQUIRE(isfinite(value[i]), "fmi2SetReal", "the value is not a finite number");
  }
  for (size_t i = 0; i < n; ++i) self->m.v[vr[i]] = value[i];
  self->m.stale = 1;
  return fmi2OK;
}

#define NO_SUCH(Type)                                                                         \
  fmi2Status fmi2Get##Type(fmi2Component c, const fmi2ValueReference vr[], size_t n,          \
                           fmi2##Type value[]) {                                              \
    SELF(ANY, "fmi2Get" #Type);                                                               \
    (void)vr; (void)value;                                                                    \
    REQUIRE(n == 0, "fmi2Get" #Type, "the model has no variable of this type");               \
    return fmi2OK;                                                                            \
  }                                                                                           \
  fmi2Status fmi2Set##Type(fmi2Component c, const fmi2ValueReference vr[], size_t n,          \
                           const fmi2##Type value[]) {                                        \
    SELF(ANY, "fmi2Set" #Type);                                                               \
    (void)vr; (void)value;                                                                    \
    REQUIRE(n == 0, "fmi2Set" #Type, "the model has no variable of this type");               \
    return fmi2OK;                                                                            \
  }
NO_SUCH(Integer)
NO_SUCH(Boolean)
NO_SUCH(String)

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
  SELF(ANY, "fmi2GetFMUstate");
  REQUIRE(state, "fmi2GetFMUstate", "a pointer is missing");
  if (!*state) *state = malloc(sizeof(Memory));
  REQUIRE(*state, "fmi2GetFMUstate", "no memory is left");
  memcpy(*state, &self->m, sizeof(Memory));
  return fmi2OK;
}

fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
  SELF(ANY, "fmi2SetFMUstate");
  REQUIRE(state, "fmi2SetFMUstate", "a pointer is missing");
  memcpy(&self->m, state, sizeof(Memory));
  return fmi2OK;
}

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
  SELF(ANY, "fmi2FreeFMUstate");
  if (state) {
    free(*state);
    *state = 0;
  }
  return fmi2OK;
}

fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
  SELF(ANY, "fmi2SerializedFMUstateSize");
  REQUIRE(state && size, "fmi2SerializedFMUstateSize", "a pointer is missing");
  *size = sizeof(Memory);
  return fmi2OK;
}

fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[],
                                 size_t size) {
  SELF(ANY, "fmi2SerializeFMUstate");
  REQUIRE(state && bytes && size >= sizeof(Memory), "fmi2SerializeFMUstate", "no room for a state");
  memcpy(bytes, state, sizeof(Memory));
  return fmi2OK;
}

fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                   fmi2FMUstate *state) {
  Memory read;
  SELF(ANY, "fmi2DeSerializeFMUstate");
  REQUIRE(bytes && state && size == sizeof(Memory), "fmi2DeSerializeFMUstate", "is no state");
  memcpy(&read, bytes, sizeof read);
  REQUIRE(read.stamp == STAMP, "fmi2DeSerializeFMUstate", "is the state of another model");
  if (!*state) *state = malloc(sizeof(Memory));
  REQUIRE(*state, "fmi2DeSerializeFMUstate", "no memory is left");
  memcpy(*state, &read, sizeof read);
  return fmi2OK;
}

fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                        size_t n_unknown, const fmi2ValueReference known[],
                                        size_t n_known, const fmi2Real along_known[],
                                        fmi2Real along_unknown[]) {
  double seed[N_S] = {0}, along[N_V];
  SELF(LIVE | ENDED, "fmi2GetDirectionalDerivative");
  for (size_t i = 0; i < n_known; ++i) {
    REQUIRE(known[i] < N_V && seed_of(known[i]) >= 0, "fmi2GetDirectionalDerivative",
            "nothing is derived by this variable");
    seed[seed_of(known[i])] += along_known[i];
  }
  for (size_t i = 0; i < n_unknown; ++i)
    REQUIRE(unknown[i] >= V_Y && unknown[i] < V_P, "fmi2GetDirectionalDerivative",
            "this variable is not an output, a state or a rate");
  REQUIRE(refresh(&self->m), "fmi2GetDirectionalDerivative", "a value is not finite");
  forward(&self->m, seed, along);
  for (size_t i = 0; i < n_unknown; ++i) along_unknown[i] = along[unknown[i]];
  return fmi2OK;
}

/* --- model exchange --- */

fmi2Status fmi2EnterEventMode(fmi2Component c) {
  SELF(EVENT | CONTINUOUS, "fmi2EnterEventMode");
  self->m.phase = EVENT;
#ifdef EVENTS
  self->m.stale = 1;
#endif
  return fmi2OK;
}

fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
  SELF(EVENT, "fmi2NewDiscreteStates");
  REQUIRE(info, "fmi2NewDiscreteStates", "a pointer is missing");
  memset(info, 0, sizeof *info);
#ifdef EVENTS
  REQUIRE(refresh(&self->m), "fmi2NewDiscreteStates", "a value is not finite");
#endif
  return fmi2OK;
}

fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
  SELF(EVENT, "fmi2EnterContinuousTimeMode");
#ifdef EVENTS
  REQUIRE(refresh(&self->m), "fmi2EnterContinuousTimeMode", "a value is not finite");
#endif
  self->m.phase = CONTINUOUS;
  return fmi2OK;
}

fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean settled, fmi2Boolean *event,
                                       fmi2Boolean *terminate) {
  SELF(CONTINUOUS, "fmi2CompletedIntegratorStep");
  REQUIRE(event && terminate, "fmi2CompletedIntegratorStep", "a pointer is missing");
  (void)settled;
  *event = *terminate = fmi2False;
#ifdef EVENTS
  if (!refresh(&self->m)) {
    complain(self, "fmi2CompletedIntegratorStep", "a value is not finite");
    return fmi2Discard;
  }
  if (turned(&self->m, 0)) *event = fmi2True; /* for importers that do not watch the indicators */
#endif
  return fmi2OK;
}

fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
  SELF(EVENT | CONTINUOUS, "fmi2SetTime");
  REQUIRE(isfinite(time), "fmi2SetTime", "the time is not a finite number");
  self->m.v[V_T] = time;
  self->m.stale = 1;
  return fmi2OK;
}

fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
  SELF(EVENT | CONTINUOUS, "fmi2SetContinuousStates");
  REQUIRE(n == N_X && (n == 0 || x), "fmi2SetContinuousStates", "the number of states is another");
  REQUIRE(finite_all(x, (int)n), "fmi2SetContinuousStates", "a state is not a finite number");
  if (n) memcpy(self->m.v + V_X, x, n * sizeof *x);
  self->m.stale = 1;
  return fmi2OK;
}

fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real d[], size_t n) {
  SELF(LIVE | ENDED, "fmi2GetDerivatives");
  REQUIRE(n == N_X && (n == 0 || d), "fmi2GetDerivatives", "the number of states is another");
  if (!refresh(&self->m)) {
    complain(self, "fmi2GetDerivatives", "a value is not finite");
    return fmi2Discard;
  }
  if (n) memcpy(d, self->m.v + V_D, n * sizeof *d);
  return fmi2OK;
}

fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t n) {
  SELF(LIVE | ENDED, "fmi2GetEventIndicators");
#ifdef EVENTS
  REQUIRE(n == N_I && indicators, "fmi2GetEventIndicators", "the number of indicators is another");
  if (!refresh(&self->m)) {
    complain(self, "fmi2GetEventIndicators", "a value is not finite");
    return fmi2Discard;
  }
  memcpy(indicators, self->m.v + V_I, n * sizeof *indicators);
#else
  (void)indicators;
  REQUIRE(n == 0, "fmi2GetEventIndicators", "the model has none");
#endif
  return fmi2OK;
}

fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t n) {
  SELF(LIVE | ENDED, "fmi2GetContinuousStates");
  REQUIRE(n == N_X && (n == 0 || x), "fmi2GetContinuousStates", "the number of states is another");
  REQUIRE(refresh(&self->m), "fmi2GetContinuousStates", "a value is not finite");
  if (n) memcpy(x, self->m.v + V_X, n * sizeof *x);
  return fmi2OK;
}

fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real nominal[], size_t n) {
  SELF(LIVE | ENDED, "fmi2GetNominalsOfContinuousStates");
  REQUIRE(n == N_X, "fmi2GetNominalsOfContinuousStates", "the number of states is another");
  for (size_t i = 0; i < n; ++i) nominal[i] = NOMINAL[i];
  return fmi2OK;
}

/* --- co-simulation --- */

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                       const fmi2Integer order[], const fmi2Real value[]) {
  SELF(INITIAL | STEP, "fmi2SetRealInputDerivatives");
  for (size_t i = 0; i < n; ++i) {
    REQUIRE(vr[i] >= V_U && vr[i] < V_Y, "fmi2SetRealInputDerivatives", "this is not an input");
    REQUIRE(order[i] == 1, "fmi2SetRealInputDerivatives", "only first derivatives are taken");
    REQUIRE(isfinite(value[i]), "fmi2SetRealInputDerivatives", "the value is not finite");
  }
  for (size_t i = 0; i < n; ++i) self->m.slope[vr[i] - V_U] = value[i];
  return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                        const fmi2Integer order[], fmi2Real value[]) {
  SELF(STEP | ENDED, "fmi2GetRealOutputDerivatives");
  (void)vr; (void)order; (void)value;
  REQUIRE(n == 0, "fmi2GetRealOutputDerivatives", "derivatives of outputs are not offered");
  return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean settled) {
  const char *reason;
  SELF(STEP, "fmi2DoStep");
  (void)settled;
  REQUIRE(h > 0 && isfinite(h), "fmi2DoStep", "the step must be longer than 0");
  REQUIRE(fabs(t - self->m.v[V_T]) <= 1e-8 * (1 + fabs(t)), "fmi2DoStep",
          "the step does not begin where the last one ended");
  REQUIRE(t + h <= self->m.stop + 1e-8 * (1 + fabs(t)), "fmi2DoStep",
          "the step ends after the stop time");
  reason = advance(&self->m, h, t + h);
  return reason ? fail(self, "fmi2DoStep", reason) : fmi2OK;
}

fmi2Status fmi2CancelStep(fmi2Component c) {
  SELF(ANY, "fmi2CancelStep");
  return complain(self, "fmi2CancelStep", "no step is ever pending");
}

#define STATUS(Name, Type)                                                              \
  fmi2Status fmi2Get##Name(fmi2Component c, const fmi2StatusKind kind, Type *value) {   \
    SELF(ANY, "fmi2Get" #Name);                                                         \
    (void)kind; (void)value;                                                            \
    return fmi2Discard;                                                                 \
  }
STATUS(Status, fmi2Status)
STATUS(IntegerStatus, fmi2Integer)
STATUS(BooleanStatus, fmi2Boolean)
STATUS(StringStatus, fmi2String)

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
  SELF(ANY, "fmi2GetRealStatus");
  if (kind != fmi2LastSuccessfulTime || !value) return fmi2Discard;
  *value = self->m.v[V_T];
  return fmi2OK;
}
