/* EXPERIMENTAL: never run in Adams by those who wrote the program that wrote this file. Check sign,
   units and markers on a model with a known force before you trust it.

     SFORCE/1, I=.., J=.., ACTIONONLY, FUNCTION=USER(@MARKERS@, k), ROUTINE=@NAME@_adams:Sfosub

   k says which force is wanted: @FORCES@. Compile with @NAME@.c; slv_c_utils.h is that of your Adams. */
#include "slv_c_utils.h"
#include "@NAME@.h"

#define LENGTH 1e-3 /* metres in the length unit of the Adams model: here mm */
#define FORCE 1.0   /* newtons in its force unit */

static const int TURNING[@OUTPUTS@] = {@TURNING@}; /* 1: a torque, about z of the markers */

static double measured(const struct sAdamsSforce *sforce, int first, const char *what, int dflag) {
  int markers[3], failed = 0;
  double value = 0;
  (void)dflag;
  markers[0] = (int)sforce->PAR[first];     /* I */
  markers[1] = (int)sforce->PAR[first + 1]; /* J, along whose z the force acts */
  markers[2] = markers[1];
  c_sysfnc(what, markers, 3, &value, &failed);
  if (failed) c_errmes(failed, "@NAME@: a marker could not be read", sforce->ID, "STOP");
  return value;
}

adams_c_Sfosub Sfosub;
void Sfosub(const struct sAdamsSforce *sforce, double time, int dflag, int iflag, double *value) {
  double u[@INPUTS@], y[@OUTPUTS@], none[1];
  int which = (int)sforce->PAR[@WHICH@] - 1;
  (void)iflag;
@READS@
  if (which < 0 || which >= @OUTPUTS@ || @NAME@_eval(time, none, u, @NAME@_p, none, y)) {
    c_errmes(1, "@NAME@: the force is not finite or does not exist", sforce->ID, "STOP");
    *value = 0;
    return;
  }
  *value = y[which] / (TURNING[which] ? FORCE * LENGTH : FORCE); /* +dF: acts along +z of J */
}
