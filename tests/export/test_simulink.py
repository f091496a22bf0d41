"""The S-function compiles without warnings and does what symhyb does, under a stand-in for
Simulink."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fmus import element, machine, whole
from test_c_code import compiled, put

from symhyb.export.simulink import simulink_files
from symhyb.export.spec import Spec, spec_of

# What Simulink would bring, so far as the source asks for it.
SIMSTRUC = """
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
typedef double real_T;
typedef int int_T;
typedef struct { size_t count; double *values; } mxArray;
typedef struct {
  double t, *u, *y, *x, *dx, *rwork;
  int iwork, major, reset, nx, nu, ny, nr, ports, tunable;
  mxArray given;
  const char *error;
} SimStruct;
#define mxGetNumberOfElements(a) ((a)->count)
#define mxGetPr(a) ((a)->values)
#define mxIsDouble(a) ((a) != NULL)
#define mxIsComplex(a) ((a) == NULL)
#define ssGetSFcnParam(S, i) (&(S)->given)
#define ssSetNumSFcnParams(S, n) ((void)(n))
#define ssGetNumSFcnParams(S) 1
#define ssGetSFcnParamsCount(S) 1
#define ssSetSFcnParamTunable(S, i, v) ((S)->tunable = (v))
#define ssSetErrorStatus(S, text) ((S)->error = (text))
#define ssGetErrorStatus(S) ((S)->error)
#define ssSetNumContStates(S, n) ((S)->nx = (n))
#define ssSetNumDiscStates(S, n) ((void)(n))
#define ssSetNumInputPorts(S, n) ((S)->ports = (n), 1)
#define ssSetInputPortWidth(S, p, n) ((S)->nu = (n))
#define ssSetInputPortRequiredContiguous(S, p, v) ((void)(v))
#define ssSetInputPortDirectFeedThrough(S, p, v) ((void)(v))
#define ssSetNumOutputPorts(S, n) ((n) == 1)
#define ssSetOutputPortWidth(S, p, n) ((S)->ny = (n))
#define ssSetNumSampleTimes(S, n) ((void)(n))
#define ssSetNumRWork(S, n) ((S)->nr = (n))
#define ssSetNumIWork(S, n) ((void)(n))
#define SS_OPTION_EXCEPTION_FREE_CODE 0
#define ssSetOptions(S, o) ((void)(o))
#define CONTINUOUS_SAMPLE_TIME 0.0
#define ssSetSampleTime(S, i, t) ((void)(t))
#define ssSetOffsetTime(S, i, t) ((void)(t))
#define ssGetContStates(S) ((S)->x)
#define ssGetdX(S) ((S)->dx)
#define ssGetRWork(S) ((S)->rwork)
#define ssSetIWorkValue(S, i, v) ((S)->iwork = (v))
#define ssGetIWorkValue(S, i) ((S)->iwork)
#define ssGetInputPortSignal(S, p) ((const void *)(S)->u)
#define ssGetOutputPortRealSignal(S, p) ((S)->y)
#define ssGetT(S) ((S)->t)
#define ssIsMajorTimeStep(S) ((S)->major)
#define ssSetSolverNeedsReset(S) ((S)->reset = 1)
"""
# Sizes, first outputs, then outputs and rates anywhere: t, states and inputs are read.
DRIVER = """
int main(void) {
  SimStruct block = {0}, *S = &block;
  static double factor[NP + 1];
  double x[NX + 1], dx[NX + 1], u[NU + 1], y[NY + 1], work[NX + NY];
  block.x = x, block.dx = dx, block.u = u, block.y = y, block.rwork = work;
  mdlInitializeSizes(S);
  mdlInitializeSampleTimes(S);
  if (S->error) { puts(S->error); return 1; }
  if (S->nx != NX || S->nu != NU || S->ny != NY || S->nr < NX + NY || !S->tunable) return 2;
  S->major = 1;
  for (int i = 0; i < NU; ++i) if (scanf("%lf", u + i) != 1) return 3;
  mdlInitializeConditions(S);
  mdlOutputs(S, 0);
  for (int i = 0; i < NX; ++i) printf("%.17g ", x[i]);
  for (int i = 0; i < NY; ++i) printf("%.17g ", y[i]);
  if (scanf("%lf", &block.t) != 1) return 3;
  for (int i = 0; i < NX; ++i) if (scanf("%lf", x + i) != 1) return 3;
  for (int i = 0; i < NU; ++i) if (scanf("%lf", u + i) != 1) return 3;
  for (int i = 0; i < NP; ++i) if (scanf("%lf", factor + i) != 1) return 3;
  block.given.count = NP, block.given.values = factor;
  mdlCheckParameters(S);
  mdlOutputs(S, 0);
  mdlDerivatives(S);
  for (int i = 0; i < NX; ++i) printf("%.17g ", dx[i]);
  for (int i = 0; i < NY; ++i) printf("%.17g ", y[i]);
  if (S->error) { puts(S->error); return 1; }
  block.given.count = NP + 1;
  mdlCheckParameters(S);
  mdlTerminate(S);
  printf("%s", S->error ? S->error : "");
  return 0;
}
"""


def ran(spec: Spec, folder: Path, numbers: np.ndarray) -> str:
    """Build the block in a folder and run it on these numbers; what it prints."""
    files = {
        "simstruc.h": SIMSTRUC,
        "simulink.c": DRIVER,
        "given.txt": " ".join(map(repr, numbers.tolist())),
    }
    put(folder, simulink_files(spec) | files)
    name = spec.identifier
    return compiled(
        folder, "-DMATLAB_MEX_FILE", f"{name}_sfun.c", f"{name}.c", given=folder / "given.txt"
    )


def law() -> Spec:
    """A law without a state."""
    return spec_of(machine(), "law", ("drag",))


@pytest.mark.parametrize("made", [element, whole, law])
def test_block_begins_at_rest_and_gives_rates_and_outputs(made, tmp_path: Path) -> None:
    spec = made()
    e, chance = spec.exported, np.random.default_rng(3)
    first, u = chance.normal(size=(2, e.u.size))
    x, p, t = chance.normal(size=e.x.size) * 0.1, e.p * 1.1, 0.7
    status, *shown = ran(spec, tmp_path, np.concatenate([first, [t], x, u, p])).split(maxsplit=1)
    assert status == "0", shown
    values = np.array(shown[0].split()[: 2 * (e.x.size + len(e.outputs))], float)
    begun, outputs, rates, later = np.split(values, np.cumsum([e.x.size, len(e.outputs), e.x.size]))
    assert outputs == pytest.approx(e.evaluate(0.0, begun, first, e.p)[1], rel=1e-12)
    if e.inner:  # at rest: what an inner state does vanishes
        assert e.evaluate(0.0, begun, first, e.p)[0][-e.inner :] == pytest.approx(0.0, abs=1e-12)
    expected = e.evaluate(t, x, u, p)
    assert rates == pytest.approx(expected[0], rel=1e-12)
    assert later == pytest.approx(expected[1], rel=1e-12)
    assert f"a vector of {e.p.size} real numbers" in shown[0]  # one value too many


def test_head_lists_ports_and_parameters_in_order() -> None:
    text = simulink_files(law())["law_sfun.c"]
    for said in ("1: v.x [m/s]", "1: dF.x [N]", "1: p.b [N*s^2/m^2]", "mex law_sfun.c law.c"):
        assert said in text
    assert "sum them to the forces" in text
    assert "sum them to the forces" not in simulink_files(whole())["machine_sfun.c"]


def test_text_of_a_stranger_cannot_leave_its_comment() -> None:
    base = element()
    head, code = simulink_files(base)["correction_sfun.c"].split("*/", 1)
    odd = replace(
        base, variables=tuple(replace(v, about="a */ int evil; ??/\n") for v in base.variables)
    )
    other, rest = simulink_files(odd)["correction_sfun.c"].split("*/", 1)
    assert rest == code
    assert len(other.splitlines()) == len(head.splitlines())
