/* Calls in any order with any numbers, on three instances in each of four threads, under the checks
   of the compiler. Every status is one of the standard's, and every thread, which draws the same
   calls, gets the same answers: instances share nothing. Stands behind the code of an FMU and the
   `storm2.c` or `storm3.c` that names its calls: made(kind), freed(c) and called(c, kind, draw). */
#include <pthread.h>

enum { THREADS = 4, INSTANCES = 3, CALLS = 10000 };

typedef struct {
  Draw draw;
  unsigned long long digest;
  long ok, refused, odd;
} Part;

static void *storm(void *place) {
  Part *part = (Part *)place;
  Draw *draw = &part->draw;
  void *c[INSTANCES];
  for (int i = 0; i < INSTANCES; ++i) c[i] = made(i);
  for (long k = 0; k < CALLS; ++k) {
    int i = (int)drawn(draw, INSTANCES);
    int status = called(c[i], draw);
    if (status == 0) ++part->ok;
    else if (status == 2 || status == 3) ++part->refused; /* Discard, Error: never Fatal */
    else ++part->odd;
    part->digest = part->digest * 31 + (unsigned)status;
    for (int v = 0; v < N_V; ++v) {
      unsigned char bytes[sizeof(double)];
      memcpy(bytes, draw->out + v, sizeof bytes);
      for (size_t b = 0; b < sizeof bytes; ++b) part->digest = part->digest * 31 + bytes[b];
    }
  }
  for (int i = 0; i < INSTANCES; ++i) freed(c[i], draw);
  return 0;
}

int main(void) {
  static Part parts[THREADS + 1];
  pthread_t threads[THREADS];
  storm(parts + THREADS); /* alone first */
  for (int i = 0; i < THREADS; ++i)
    if (pthread_create(threads + i, 0, storm, parts + i)) return 2;
  for (int i = 0; i < THREADS; ++i) pthread_join(threads[i], 0);
  for (int i = 0; i <= THREADS; ++i)
    if (parts[i].odd || parts[i].digest != parts[0].digest) {
      fprintf(stderr, "thread %d: %ld odd, digest %llx\n", i, parts[i].odd, parts[i].digest);
      return 1;
    }
  printf("%ld calls done, %ld refused\n", parts[0].ok, parts[0].refused);
  return 0;
}
