/* @NAME@: @TITLE@. A monitor of the machine as it was in @REFERENCE@.

   Give @NAME@_step every sample, everything in SI, arrays in this order:

@LISTED@

   @ROWS@ samples are a block, about @BLOCK_S@ s. The sample that completes one is answered when the block has been
   judged; all others return at once. About @FALSE@ false alarms a day are allowed for.
   Nothing is allocated, nothing is global but constants: a monitor is its own memory. */
#ifndef @UPPER@_H
#define @UPPER@_H
#define @UPPER@_INPUTS @N_U@
#define @UPPER@_SENSORS @N_S@
#define @UPPER@_COLUMNS @N_COLUMNS@ /* of the causes and their numbers */
#define @UPPER@_ROWS @ROWS@
#ifdef __cplusplus
extern "C" {
#endif
enum {
  @UPPER@_NOTHING,   /* no block was completed, or it is as those of the reference */
  @UPPER@_CHANGED,   /* something has changed; the likeliest cause so far */
  @UPPER@_NAMED,     /* the same by all blocks since; then nothing more until @NAME@_begin */
  @UPPER@_UNREADABLE /* a block with numbers that are not finite, or times that do not increase */
};
typedef struct {
  double at_s, since_s;           /* now, and since when */
  int back;                       /* 1: time went back, and blocks so far are forgotten */
  int cause;                      /* of @NAME@_cause, with as many numbers as it has */
  int numbers;
  double size[@K_MOST@], sd[@K_MOST@]; /* by how much, SI */
  double probability;             /* among the causes that compete */
  double chance;                  /* of as much where nothing changes */
  int rival[@RIVALS@];                   /* causes that are not ruled out, -1: none */
} @NAME@_event;
extern const char *const @NAME@_cause[@N_CAUSES@];
extern const int @NAME@_first[@N_CAUSES_1@]; /* where the numbers of a cause begin in the next three */
extern const char *const @NAME@_number[@N_NUMBERS@];
extern const char *const @NAME@_unit[@N_NUMBERS@]; /* of the model file */
extern const double @NAME@_factor[@N_NUMBERS@];    /* a size times this is in that unit */

/* What follows is the memory of a monitor; only blocks[count - 1] is of use to others. */
typedef struct {
  double start_s, end_s, motion;
  double shown[@N_COLUMNS@], score[@N_COLUMNS@], pairs[@N_PAIRS@];
} @NAME@_block;
typedef struct {
  int rows, broken, latched, since, count;
  double start_s, before_s, last_s, chance, step;
  @NAME@_block blocks[@KEPT@], sum;
  double worth[@N_CAUSES@];
  double t[@N@], u[@N@][@U@], y[@N@][@N_S@];
  double q[@N@][@N_Q@], v[@N@][@N_Q@], a[@N@][@N_Q@], x[@N@][@N_X@];
  double z[@N@ * @N_Z@ + 1], tried[@N@ * @N_ZL@ + 1], force[@N@][@N_C@][@N_Q@];
  double sorted[@N@], knots[@KNOTS@], basis[@N@][3][6], coefficient[@SIZE@], change[@SIZE@];
  double normal[@SIZE@][@BAND@], speed_sd[@N_Q@], rate[@N@][@SHARP@];
  double through[@N_FINE@][11], spline[@N_FINE@][@U@];
  double fine_t[@N_FINE@ * 8], fine[@N_FINE@ * 8][@U@];
  int first[@N@], near_[@N@], node[3];
  double states[@PARTS@ + 1][@N_X@], middle[@PARTS@][@N_X@], end[@N_X@];
  double at_nodes[3][@WIDTH@][@RATES@], matrix[3 * @RATES@][3 * @RATES@], right[3 * @RATES@][@WIDTH@];
  double slope[@WIDTH@][@N_X@], now[@N_X@][@JOINED@], after[@N_X@][@JOINED@];
  double moved[@N_X@][@MOVED@], further[@N_X@][@MOVED@], dot[@MOVED@];
  double white[@N@ * @N_S@][@MOVED@];
} @NAME@_monitor;

void @NAME@_begin(@NAME@_monitor *m);
int @NAME@_step(@NAME@_monitor *m, double t, const double *u, const double *y, @NAME@_event *event);
#ifdef __cplusplus
}
#endif
#endif
