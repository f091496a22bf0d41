/* EXPERIMENTAL: never run in Simulink by those who wrote the program that wrote this file. Check sign
   and units on a model with a known force before you trust it.

     1. In MATLAB, in this folder:  mex @NAME@_sfun.c @NAME@.c
     2. Add a block "S-Function" of the name @NAME@_sfun, with the parameter []: the values found.
        Other values are a vector in the order below.
     3. Join its input by a "Mux" and take its output apart by a "Demux", in this order, in SI:

@PORTS@

@SIGN@*/
#define S_FUNCTION_NAME @NAME@_sfun
#define S_FUNCTION_LEVEL 2
#include "simstruc.h"

#include "@NAME@.h"

enum { NU = @INPUTS@, NY = @OUTPUTS@, NX = @STATES@, NP = @PARAMETERS@ };

static const double *parameters(SimStruct *S) {
  const mxArray *given = ssGetSFcnParam(S, 0);
  return mxGetNumberOfElements(given) == 0 ? @NAME@_p : mxGetPr(given);
}

static const double *inputs(SimStruct *S) {
  static const double none[1] = {0};
  return NU > 0 ? (const double *)ssGetInputPortSignal(S, 0) : none;
}

#define MDL_CHECK_PARAMETERS
static void mdlCheckParameters(SimStruct *S) {
  const mxArray *given = ssGetSFcnParam(S, 0);
  size_t count = mxGetNumberOfElements(given);
  if (count != 0 && (count != NP || !mxIsDouble(given) || mxIsComplex(given)))
    ssSetErrorStatus(S, "@NAME@: the parameter is [] or a vector of @PARAMETERS@ real numbers");
}

static void mdlInitializeSizes(SimStruct *S) {
  ssSetNumSFcnParams(S, 1);
  if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) return; /* Simulink says so itself */
  mdlCheckParameters(S);
  if (ssGetErrorStatus(S) != NULL) return;
  ssSetSFcnParamTunable(S, 0, 1);
  ssSetNumContStates(S, NX);
  ssSetNumDiscStates(S, 0);
  if (!ssSetNumInputPorts(S, NU > 0)) return;
  if (NU > 0) {
    ssSetInputPortWidth(S, 0, NU);
    ssSetInputPortRequiredContiguous(S, 0, 1);
    ssSetInputPortDirectFeedThrough(S, 0, 1);
  }
  if (!ssSetNumOutputPorts(S, 1)) return;
  ssSetOutputPortWidth(S, 0, NY);
  ssSetNumSampleTimes(S, 1);
  ssSetNumRWork(S, NX + NY);
  ssSetNumIWork(S, 1);
  ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);
}

static void mdlInitializeSampleTimes(SimStruct *S) {
  ssSetSampleTime(S, 0, CONTINUOUS_SAMPLE_TIME);
  ssSetOffsetTime(S, 0, 0.0);
}

#define MDL_INITIALIZE_CONDITIONS
static void mdlInitializeConditions(SimStruct *S) {
  real_T *x = ssGetContStates(S);
  for (int i = 0; i < NX; ++i) x[i] = @NAME@_x[i];
  ssSetIWorkValue(S, 0, 0);
}

/* Rates and outputs in the work vector; 0 if a number is not finite. */
static int evaluated(SimStruct *S) {
  real_T *work = ssGetRWork(S);
  if (@NAME@_eval(ssGetT(S), ssGetContStates(S), inputs(S), parameters(S), work, work + NX)) {
    ssSetErrorStatus(S, "@NAME@: a value is not finite");
    return 0;
  }
  return 1;
}

static void mdlOutputs(SimStruct *S, int_T tid) {
  real_T *y = ssGetOutputPortRealSignal(S, 0);
  (void)tid;
  if (ssGetIWorkValue(S, 0) == 0 && ssIsMajorTimeStep(S)) {
    /* inner states begin at rest under the first input, which is not there any earlier */
    @NAME@_rest(ssGetT(S), inputs(S), parameters(S), ssGetContStates(S));
    ssSetIWorkValue(S, 0, 1);
    if (NX > 0) ssSetSolverNeedsReset(S);
  }
  if (!evaluated(S)) return;
  for (int i = 0; i < NY; ++i) y[i] = ssGetRWork(S)[NX + i];
}

#define MDL_DERIVATIVES
static void mdlDerivatives(SimStruct *S) {
  real_T *dx = ssGetdX(S);
  if (!evaluated(S)) return;
  for (int i = 0; i < NX; ++i) dx[i] = ssGetRWork(S)[i];
}

static void mdlTerminate(SimStruct *S) { (void)S; }

#ifdef MATLAB_MEX_FILE
#include "simulink.c"
#else
#include "cg_sfun.h"
#endif
