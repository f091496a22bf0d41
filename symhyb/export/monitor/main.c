/* @NAME@: watches rows of numbers on standard input, times (s), inputs and sensors in SI, between
   commas; a first row that is none is left out. Ends with 1 if something has changed, with 2 if a row is wrong.

       cc -std=c99 -O2 @NAME@.c @NAME@_main.c -lm -o @NAME@
       ./@NAME@ < rig.csv                  --blocks prints the score of every block, too */
#include "@NAME@.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1 + @UPPER@_INPUTS + @UPPER@_SENSORS, LONGEST = 65536 };
static @NAME@_monitor monitor;
static char line[LONGEST];

static void told(const @NAME@_event *e, const char *what) {
  printf("%.17g s  %s since %.17g s: %s", e->at_s, what, e->since_s, @NAME@_cause[e->cause]);
  for (int i = 0; i < e->numbers; ++i) {
    const int n = @NAME@_first[e->cause] + i;
    printf(", %s by %.17g +- %.17g %s", @NAME@_number[n], e->size[i] * @NAME@_factor[n],
           e->sd[i] * @NAME@_factor[n], @NAME@_unit[n]);
  }
  printf(" (%.0f %% likely", 100 * e->probability);
  for (int i = 0; i < @RIVALS@ && e->rival[i] >= 0; ++i) printf("; or %s", @NAME@_cause[e->rival[i]]);
  puts(")");
}

int main(int count, char **arguments) {
  const int blocks = count > 1 && !strcmp(arguments[1], "--blocks");
  double row[WIDTH];
  int changed = 0;
  @NAME@_event event;
  @NAME@_begin(&monitor);
  for (long number = 1; fgets(line, LONGEST, stdin); ++number) {
    char *at = line, *end;
    int read = 0;
    if (line[strspn(line, " \t\r\n")] == 0) continue;
    while (read < WIDTH) {
      row[read] = strtod(at, &end);
      if (end == at) break;
      ++read;
      at = end + strspn(end, " \t\r\n");
      if (*at == ',') ++at;
    }
    if (read == 0 && number == 1) continue;
    if (read < WIDTH || *at) {
      fprintf(stderr, "row %ld: does not hold %d numbers between commas\n", number, WIDTH);
      return 2;
    }
    const int before = monitor.count;
    const int kind = @NAME@_step(&monitor, row[0], row + 1, row + 1 + @UPPER@_INPUTS, &event);
    if (event.back) printf("%.17g s  time went back\n", event.at_s);
    if (kind == @UPPER@_UNREADABLE) printf("%.17g s  a block cannot be read\n", event.at_s);
    if (kind == @UPPER@_CHANGED) told(&event, "something has changed"), changed = 1;
    if (kind == @UPPER@_NAMED) told(&event, "what has changed");
    if (blocks && monitor.rows == 0 && monitor.count && kind != @UPPER@_UNREADABLE &&
        (monitor.count > before || monitor.blocks[monitor.count - 1].end_s == event.at_s)) {
      const @NAME@_block *b = monitor.blocks + monitor.count - 1;
      printf("block %.17g %.17g %.17g", b->start_s, b->end_s, b->motion);
      for (int c = 0; c < @UPPER@_COLUMNS; ++c) printf(" %.17g %.17g", b->shown[c], b->score[c]);
      puts("");
    }
    fflush(stdout);
  }
  return changed;
}
