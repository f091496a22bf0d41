#include <math.h>
#include <stdio.h>

int main(void) {
  double worst = 0;
  for (int i = 0; i < SAMPLES; ++i) {
    const double *row = SAMPLE + i * (1 + NX + NU + NX + NY), *told = row + 1 + NX + NU;
    double made[NX + NY + 1], largest = 1e-300;
    if (NAME_eval(row[0], row + 1, row + 1 + NX, NAME_p, made, made + NX)) {
      printf("NAME: a value is not finite at sample %d\n", i);
      return 1;
    }
    for (int k = 0; k < NX + NY; ++k) largest = fmax(largest, fabs(told[k]));
    for (int k = 0; k < NX + NY; ++k) worst = fmax(worst, fabs(made[k] - told[k]) / largest);
  }
  printf("NAME: %d samples, largest relative difference %.3g\n", SAMPLES, worst);
  return worst <= ALLOWED ? 0 : 1;
}
