/* FMI 3.0.1 around the model: co-simulation and model exchange. Of types only Float64 is used, there
   are no clocks, no arrays and no events. */
#ifdef EVENTS
/* With one exception: the events of state that switch modes. */
#endif
#if !defined(DISABLE_PREFIX) && defined(FMI3_FUNCTION_PREFIX_WANTED)
#define FMI3_FUNCTION_PREFIX FMI3_FUNCTION_PREFIX_WANTED
#endif
#include "fmi3Functions.h"

typedef struct {
  Memory m;
  int exchange;
  fmi3LogMessageCallback logger;
  fmi3InstanceEnvironment environment;
} Instance;

static fmi3Status complain(Instance *self, const char *function, const char *reason) {
  char text[256];
  snprintf(text, sizeof text, "%s: %s", function, reason);
  if (self->logger) self->logger(self->environment, fmi3Error, "logStatusError", text);
  return fmi3Error;
}

/* What breaks the model: from here on it may only be read, reset, restored or freed. */
static fmi3Status fail(Instance *self, const char *function, const char *reason) {
  self->m.phase = BROKEN;
  return complain(self, function, reason);
}

#define SELF(phases, function)                                                          \
  Instance *self = (Instance *)instance;                                                \
  if (!self) return fmi3Error;                                                          \
  if (!((int)self->m.phase & (phases)))                                                 \
    return complain(self, function, "must not be called in this phase of a simulation")
#define REQUIRE(condition, function, reason) \
  if (!(condition)) return complain(self, function, reason)

const char *fmi3GetVersion(void) { return fmi3Version; }

static fmi3Instance create(fmi3String name, fmi3String token, fmi3InstanceEnvironment environment,
                           fmi3LogMessageCallback logger, int exchange) {
  Instance *self = (Instance *)calloc(1, sizeof(Instance));
  const char *wrong = 0;
  if (!self) return 0;
  begin(&self->m);
  self->exchange = exchange;
  self->logger = logger;
  self->environment = environment;
  if (!token || strcmp(token, TOKEN)) wrong = "the instantiation token is not that of this model";
  if (!name || !*name) wrong = "the instance has no name";
#ifdef EVENTS
  if (!exchange) wrong = "a model with events is for model exchange alone";
#endif
  if (wrong) {
    complain(self, "fmi3Instantiate", wrong);
    free(self);
    return 0;
  }
  return self;
}

fmi3Instance fmi3InstantiateModelExchange(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
  (void)resources; (void)visible; (void)logging;
  return create(name, token, environment, logger, 1);
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference between[],
    size_t n, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback update) {
  (void)resources; (void)visible; (void)logging; (void)early; (void)between; (void)update;
  if (events || n) return 0; /* neither is offered in the description */
  return create(name, token, environment, logger, 0);
}

fmi3Instance fmi3InstantiateScheduledExecution(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
  (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)environment;
  (void)logger; (void)update; (void)lock; (void)unlock;
  return 0;
}

void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n,
                               const fmi3String names[]) {
  SELF(ANY, "fmi3SetDebugLogging");
  (void)on; (void)n; (void)names;
  return fmi3OK;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean tolerant,
                                       fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean ends,
                                       fmi3Float64 stop) {
  SELF(FRESH, "fmi3EnterInitializationMode");
  REQUIRE(isfinite(start), "fmi3EnterInitializationMode", "the start time is not finite");
  REQUIRE(!ends || stop > start, "fmi3EnterInitializationMode", "the stop time is before the start");
  if (tolerant && tolerance > 0) self->m.tolerance = fmin(fmax(tolerance, 1e-12), 1e-2);
  self->m.v[V_T] = start;
  self->m.stop = ends ? stop : HUGE_VAL;
  self->m.stale = 1;
  self->m.phase = INITIAL;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  SELF(INITIAL, "fmi3ExitInitializationMode");
  self->m.stale = 1;
  if (!refresh(&self->m))
    return fail(self, "fmi3ExitInitializationMode", "a value is not finite at the start");
  self->m.phase = self->exchange ? EVENT : STEP;
  return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance) {
  SELF(EVENT | CONTINUOUS, "fmi3EnterEventMode");
  self->m.phase = EVENT;
#ifdef EVENTS
  self->m.stale = 1;
#endif
  return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  SELF(EVENT | CONTINUOUS | STEP, "fmi3Terminate");
  self->m.phase = ENDED;
  return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance) {
  SELF(ANY, "fmi3Reset");
  begin(&self->m);
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                          fmi3Float64 value[], size_t n_value) {
  SELF(LIVE | ENDED | BROKEN, "fmi3GetFloat64");
  REQUIRE(n == n_value && (n == 0 || (vr && value)), "fmi3GetFloat64", "sizes do not agree");
  for (size_t i = 0; i < n; ++i)
    REQUIRE(vr[i] < N_V, "fmi3GetFloat64", "there is no variable of this reference");
  if (self->m.phase != BROKEN && !refresh(&self->m)) {
    complain(self, "fmi3GetFloat64", "a value is not finite");
    return self->exchange ? fmi3Discard : fmi3Error;
  }
  for (size_t i = 0; i < n; ++i) value[i] = self->m.v[vr[i]];
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                          const fmi3Float64 value[], size_t n_value) {
  SELF(FRESH | LIVE, "fmi3SetFloat64");
  REQUIRE(n == n_value && (n == 0 || (vr && value)), "fmi3SetFloat64", "sizes do not agree");
  for (size_t i = 0; i < n; ++i) {
    REQUIRE(vr[i] < N_V, "fmi3SetFloat64", "there is no variable of this reference");
    REQUIRE(may_set(&self->m, vr[i]), "fmi3SetFloat64", "this variable cannot be set now");
    REQUIRE(isfinite(value[i]), "fmi3SetFloat64", "the value is not a finite number");
  }
  for (size_t i = 0; i < n; ++i) self->m.v[vr[i]] = value[i];
  self->m.stale = 1;
  return fmi3OK;
}

#define NO_SUCH(Type, values, const_values)                                               \
  fmi3Status fmi3Get##Type(fmi3Instance instance, const fmi3ValueReference vr[],          \
                           size_t n, values) {                                            \
    SELF(ANY, "fmi3Get" #Type);                                                           \
    (void)vr;                                                                             \
    REQUIRE(n == 0, "fmi3Get" #Type, "the model has no variable of this type");           \
    return fmi3OK;                                                                        \
  }                                                                                       \
  fmi3Status fmi3Set##Type(fmi3Instance instance, const fmi3ValueReference vr[],          \
                           size_t n, const_values) {                                      \
    SELF(ANY, "fmi3Set" #Type);                                                           \
    (void)vr;                                                                             \
    REQUIRE(n == 0, "fmi3Set" #Type, "the model has no variable of this type");           \
    return fmi3OK;                                                                        \
  }
#define TWO(Type) fmi3##Type value[], size_t n_value
#define NO_SUCH_NUMBER(Type) NO_SUCH(Type, TWO(Type), const TWO(Type))
#define COMMA ,
NO_SUCH_NUMBER(Float32)
NO_SUCH_NUMBER(Int8)
NO_SUCH_NUMBER(UInt8)
NO_SUCH_NUMBER(Int16)
NO_SUCH_NUMBER(UInt16)
NO_SUCH_NUMBER(Int32)
NO_SUCH_NUMBER(UInt32)
NO_SUCH_NUMBER(Int64)
NO_SUCH_NUMBER(UInt64)
NO_SUCH_NUMBER(Boolean)
NO_SUCH_NUMBER(String)
NO_SUCH(Binary, size_t sizes[] COMMA fmi3Binary value[] COMMA size_t n_value,
        const size_t sizes[] COMMA const fmi3Binary value[] COMMA size_t n_value)
NO_SUCH(Clock, fmi3Clock value[], const fmi3Clock value[])

#define NOT_OFFERED(function)                     \
  {                                               \
    SELF(ANY, #function);                         \
    return complain(self, #function, "is not offered"); \
  }
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference vr,
                                               size_t *n) {
  (void)vr; (void)n;
  NOT_OFFERED(fmi3GetNumberOfVariableDependencies)
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference vr, size_t a[],
                                       fmi3ValueReference b[], size_t d[], fmi3DependencyKind k[],
                                       size_t n) {
  (void)vr; (void)a; (void)b; (void)d; (void)k; (void)n;
  NOT_OFFERED(fmi3GetVariableDependencies)
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state) {
  SELF(ANY, "fmi3GetFMUState");
  REQUIRE(state, "fmi3GetFMUState", "a pointer is missing");
  if (!*state) *state = malloc(sizeof(Memory));
  REQUIRE(*state, "fmi3GetFMUState", "no memory is left");
  memcpy(*state, &self->m, sizeof(Memory));
  return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state) {
  SELF(ANY, "fmi3SetFMUState");
  REQUIRE(state, "fmi3SetFMUState", "a pointer is missing");
  memcpy(&self->m, state, sizeof(Memory));
  return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state) {
  SELF(ANY, "fmi3FreeFMUState");
  if (state) {
    free(*state);
    *state = 0;
  }
  return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size) {
  SELF(ANY, "fmi3SerializedFMUStateSize");
  REQUIRE(state && size, "fmi3SerializedFMUStateSize", "a pointer is missing");
  *size = sizeof(Memory);
  return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[],
                                 size_t size) {
  SELF(ANY, "fmi3SerializeFMUState");
  REQUIRE(state && bytes && size >= sizeof(Memory), "fmi3SerializeFMUState", "no room for a state");
  memcpy(bytes, state, sizeof(Memory));
  return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size,
                                   fmi3FMUState *state) {
  Memory read;
  SELF(ANY, "fmi3DeserializeFMUState");
  REQUIRE(bytes && state && size == sizeof(Memory), "fmi3DeserializeFMUState", "is no state");
  memcpy(&read, bytes, sizeof read);
  REQUIRE(read.stamp == STAMP, "fmi3DeserializeFMUState", "is the state of another model");
  if (!*state) *state = malloc(sizeof(Memory));
  REQUIRE(*state, "fmi3DeserializeFMUState", "no memory is left");
  memcpy(*state, &read, sizeof read);
  return fmi3OK;
}

fmi3Status fmi3GetDirectionalDerivative(
    fmi3Instance instance, const fmi3ValueReference unknown[], size_t n_unknown,
    const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[], size_t n_seed,
    fmi3Float64 sensitivity[], size_t n_sensitivity) {
  double full[N_S] = {0}, along[N_V];
  SELF(LIVE | ENDED, "fmi3GetDirectionalDerivative");
  REQUIRE(n_seed == n_known && n_sensitivity == n_unknown, "fmi3GetDirectionalDerivative",
          "sizes do not agree");
  for (size_t i = 0; i < n_known; ++i) {
    REQUIRE(known[i] < N_V && seed_of(known[i]) >= 0, "fmi3GetDirectionalDerivative",
            "nothing is derived by this variable");
    full[seed_of(known[i])] += seed[i];
  }
  for (size_t i = 0; i < n_unknown; ++i)
    REQUIRE(unknown[i] >= V_Y && unknown[i] < V_P, "fmi3GetDirectionalDerivative",
            "this variable is not an output, a state or a rate");
  REQUIRE(refresh(&self->m), "fmi3GetDirectionalDerivative", "a value is not finite");
  forward(&self->m, full, along);
  for (size_t i = 0; i < n_unknown; ++i) sensitivity[i] = along[unknown[i]];
  return fmi3OK;
}

/* Weights of rates and outputs (N_X + N_Y) pulled back to what is known (N_S). */
static void backward(const Memory *m, const double *weights, double *pulled) {
  const double *v = m->v;
  run(model_adjoint, v, v + V_X, v + V_U, v + V_P, weights, pulled, 0);
}

fmi3Status fmi3GetAdjointDerivative(
    fmi3Instance instance, const fmi3ValueReference unknown[], size_t n_unknown,
    const fmi3ValueReference known[], size_t n_known, const fmi3Float64 seed[], size_t n_seed,
    fmi3Float64 sensitivity[], size_t n_sensitivity) {
  double weights[N_X + N_Y + 1] = {0}, direct[N_X + 1] = {0}, pulled[N_S];
  SELF(EVENT | CONTINUOUS | STEP | ENDED, "fmi3GetAdjointDerivative");
  REQUIRE(n_seed == n_unknown && n_sensitivity == n_known, "fmi3GetAdjointDerivative",
          "sizes do not agree");
  for (size_t i = 0; i < n_known; ++i)
    REQUIRE(known[i] < N_V && seed_of(known[i]) >= 0, "fmi3GetAdjointDerivative",
            "nothing is derived by this variable");
  for (size_t i = 0; i < n_unknown; ++i) {
    unsigned vr = unknown[i];
    REQUIRE(vr >= V_Y && vr < V_P, "fmi3GetAdjointDerivative",
            "this variable is not an output, a state or a rate");
    if (vr < V_X) weights[N_X + vr - V_Y] += seed[i];
    else if (vr < V_D) direct[vr - V_X] += seed[i];
    else weights[vr - V_D] += seed[i];
  }
  REQUIRE(refresh(&self->m), "fmi3GetAdjointDerivative", "a value is not finite");
  backward(&self->m, weights, pulled);
  for (int i = 0; i < N_X; ++i) pulled[S_X + i] += direct[i];
  for (size_t i = 0; i < n_known; ++i) sensitivity[i] = pulled[seed_of(known[i])];
  return fmi3OK;
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
NOT_OFFERED(fmi3EnterConfigurationMode)
fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
NOT_OFFERED(fmi3ExitConfigurationMode)
fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                  fmi3Float64 a[], fmi3IntervalQualifier b[]) {
  (void)vr; (void)n; (void)a; (void)b;
  NOT_OFFERED(fmi3GetIntervalDecimal)
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                   fmi3UInt64 a[], fmi3UInt64 b[], fmi3IntervalQualifier d[]) {
  (void)vr; (void)n; (void)a; (void)b; (void)d;
  NOT_OFFERED(fmi3GetIntervalFraction)
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                               fmi3Float64 a[]) {
  (void)vr; (void)n; (void)a;
  NOT_OFFERED(fmi3GetShiftDecimal)
}
fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                fmi3UInt64 a[], fmi3UInt64 b[]) {
  (void)vr; (void)n; (void)a; (void)b;
  NOT_OFFERED(fmi3GetShiftFraction)
}
fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                  const fmi3Float64 a[]) {
  (void)vr; (void)n; (void)a;
  NOT_OFFERED(fmi3SetIntervalDecimal)
}
fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                   const fmi3UInt64 a[], const fmi3UInt64 b[]) {
  (void)vr; (void)n; (void)a; (void)b;
  NOT_OFFERED(fmi3SetIntervalFraction)
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                               const fmi3Float64 a[]) {
  (void)vr; (void)n; (void)a;
  NOT_OFFERED(fmi3SetShiftDecimal)
}
fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                const fmi3UInt64 a[], const fmi3UInt64 b[]) {
  (void)vr; (void)n; (void)a; (void)b;
  NOT_OFFERED(fmi3SetShiftFraction)
}
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance) {
  SELF(INITIAL | EVENT, "fmi3EvaluateDiscreteStates");
  return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again,
                                    fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *values, fmi3Boolean *defined, fmi3Float64 *next) {
  SELF(EVENT, "fmi3UpdateDiscreteStates");
  REQUIRE(again && terminate && nominals && values && defined && next, "fmi3UpdateDiscreteStates",
          "a pointer is missing");
  *again = *terminate = *nominals = *values = *defined = fmi3False;
  *next = 0;
#ifdef EVENTS
  REQUIRE(refresh(&self->m), "fmi3UpdateDiscreteStates", "a value is not finite");
#endif
  return fmi3OK;
}

/* --- model exchange --- */

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance) {
  SELF(EVENT, "fmi3EnterContinuousTimeMode");
#ifdef EVENTS
  REQUIRE(refresh(&self->m), "fmi3EnterContinuousTimeMode", "a value is not finite");
#endif
  self->m.phase = CONTINUOUS;
  return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean settled,
                                       fmi3Boolean *event, fmi3Boolean *terminate) {
  SELF(CONTINUOUS, "fmi3CompletedIntegratorStep");
  REQUIRE(event && terminate, "fmi3CompletedIntegratorStep", "a pointer is missing");
  (void)settled;
  *event = *terminate = fmi3False;
#ifdef EVENTS
  if (!refresh(&self->m)) {
    complain(self, "fmi3CompletedIntegratorStep", "a value is not finite");
    return fmi3Discard;
  }
  if (turned(&self->m, 0)) *event = fmi3True; /* for importers that do not watch the indicators */
#endif
  return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time) {
  SELF(EVENT | CONTINUOUS, "fmi3SetTime");
  REQUIRE(isfinite(time), "fmi3SetTime", "the time is not a finite number");
  self->m.v[V_T] = time;
  self->m.stale = 1;
  return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 x[], size_t n) {
  SELF(EVENT | CONTINUOUS, "fmi3SetContinuousStates");
  REQUIRE(n == N_X && (n == 0 || x), "fmi3SetContinuousStates", "the number of states is another");
  REQUIRE(finite_all(x, (int)n), "fmi3SetContinuousStates", "a state is not a finite number");
  if (n) memcpy(self->m.v + V_X, x, n * sizeof *x);
  self->m.stale = 1;
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 d[], size_t n) {
  SELF(LIVE | ENDED, "fmi3GetContinuousStateDerivatives");
  REQUIRE(n == N_X && (n == 0 || d), "fmi3GetContinuousStateDerivatives",
          "the number of states is another");
  if (!refresh(&self->m)) {
    complain(self, "fmi3GetContinuousStateDerivatives", "a value is not finite");
    return fmi3Discard;
  }
  if (n) memcpy(d, self->m.v + V_D, n * sizeof *d);
  return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[], size_t n) {
  SELF(LIVE | ENDED, "fmi3GetEventIndicators");
#ifdef EVENTS
  REQUIRE(n == N_I && indicators, "fmi3GetEventIndicators", "the number of indicators is another");
  if (!refresh(&self->m)) {
    complain(self, "fmi3GetEventIndicators", "a value is not finite");
    return fmi3Discard;
  }
  memcpy(indicators, self->m.v + V_I, n * sizeof *indicators);
#else
  (void)indicators;
  REQUIRE(n == 0, "fmi3GetEventIndicators", "the model has none");
#endif
  return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 x[], size_t n) {
  SELF(LIVE | ENDED, "fmi3GetContinuousStates");
  REQUIRE(n == N_X && (n == 0 || x), "fmi3GetContinuousStates", "the number of states is another");
  REQUIRE(refresh(&self->m), "fmi3GetContinuousStates", "a value is not finite");
  if (n) memcpy(x, self->m.v + V_X, n * sizeof *x);
  return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominal[],
                                             size_t n) {
  SELF(LIVE | ENDED, "fmi3GetNominalsOfContinuousStates");
  REQUIRE(n == N_X, "fmi3GetNominalsOfContinuousStates", "the number of states is another");
  for (size_t i = 0; i < n; ++i) nominal[i] = NOMINAL[i];
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n) {
  SELF(ANY, "fmi3GetNumberOfEventIndicators");
  REQUIRE(n, "fmi3GetNumberOfEventIndicators", "a pointer is missing");
#ifdef EVENTS
  *n = N_I;
#else
  *n = 0;
#endif
  return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n) {
  SELF(ANY, "fmi3GetNumberOfContinuousStates");
  REQUIRE(n, "fmi3GetNumberOfContinuousStates", "a pointer is missing");
  *n = N_X;
  return fmi3OK;
}

/* --- co-simulation --- */

fmi3Status fmi3EnterStepMode(fmi3Instance instance) NOT_OFFERED(fmi3EnterStepMode)

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                    const fmi3Int32 order[], fmi3Float64 value[], size_t n_value) {
  SELF(STEP | ENDED, "fmi3GetOutputDerivatives");
  (void)vr; (void)order; (void)value; (void)n_value;
  REQUIRE(n == 0, "fmi3GetOutputDerivatives", "derivatives of outputs are not offered");
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 t, fmi3Float64 h, fmi3Boolean settled,
                      fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                      fmi3Float64 *last) {
  const char *reason;
  SELF(STEP, "fmi3DoStep");
  (void)settled;
  REQUIRE(event && terminate && early && last, "fmi3DoStep", "a pointer is missing");
  REQUIRE(h > 0 && isfinite(h), "fmi3DoStep", "the step must be longer than 0");
  REQUIRE(fabs(t - self->m.v[V_T]) <= 1e-8 * (1 + fabs(t)), "fmi3DoStep",
          "the step does not begin where the last one ended");
  REQUIRE(t + h <= self->m.stop + 1e-8 * (1 + fabs(t)), "fmi3DoStep",
          "the step ends after the stop time");
  *event = *terminate = *early = fmi3False;
  reason = advance(&self->m, h, t + h);
  *last = self->m.v[V_T];
  return reason ? fail(self, "fmi3DoStep", reason) : fmi3OK;
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock,
                                      fmi3Float64 t) {
  (void)clock; (void)t;
  NOT_OFFERED(fmi3ActivateModelPartition)
}
