/* Example of a broad-phase plug-in: sweep and prune along x, on one thread of the CPU.
 *
 *   cc -O2 -shared -fPIC -I <include> -o libsweep_and_prune.so sweep_and_prune.c
 *   collidoscope --broad-phase ./libsweep_and_prune.so
 */
#include <collidoscope/broad_phase.h>
#include <stdlib.h>

typedef struct {
  float min_x;
  uint32_t box;
} Entry;

static void *create(uint32_t memory, uint32_t count) {
  (void)memory;
  return malloc(count * sizeof(Entry));
}

static int by_min_x(const void *a, const void *b) {
  const Entry *p = a, *q = b;
  return (p->min_x > q->min_x) - (p->min_x < q->min_x);
}

static int overlap(const collidoscope_box *a, const collidoscope_box *b) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(a->min[axis] <= b->max[axis] && b->min[axis] <= a->max[axis])) return 0;
  return 1;
}

static int find(void *object, const collidoscope_find *f) {
  Entry *entries = object;
  uint32_t listed = 0;
  f->begin_stage(f->context, "sort");
  for (uint32_t k = 0; k < f->count; ++k)
    if (f->boxes[k].min[0] <= f->boxes[k].max[0]) { /* empty boxes overlap nothing */
      entries[listed].min_x = f->boxes[k].min[0];
      entries[listed++].box = k;
    }
  qsort(entries, listed, sizeof *entries, by_min_x);

  f->begin_stage(f->context, "sweep");
  uint64_t found = 0;
  for (uint32_t i = 0; i < listed; ++i) {
    const collidoscope_box *a = &f->boxes[entries[i].box];
    for (uint32_t j = i + 1; j < listed && entries[j].min_x <= a->max[0]; ++j)
      if (overlap(a, &f->boxes[entries[j].box])) {
        if (found < f->capacity) f->pairs[found] = (collidoscope_pair){entries[i].box, entries[j].box};
        ++found;
      }
  }
  *f->pair_count = found;
  return 0;
}

COLLIDOSCOPE_EXPORT const collidoscope_broad_phase *collidoscope_broad_phase_v1(void) {
  static const collidoscope_broad_phase description = {
      COLLIDOSCOPE_BROAD_PHASE_VERSION,
      COLLIDOSCOPE_HOST,
      "sweep_and_prune",
      "example: sorted along x, one thread",
      create,
      free,
      find,
      NULL,
  };
  return &description;
}
