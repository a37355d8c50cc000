/* A plug-in for tests: compares all boxes. FAULT selects a fault. */
#include <collidoscope/broad_phase.h>
#include <signal.h>
#include <stdlib.h>
#include <unistd.h>

enum { NONE, MISSING, DUPLICATE, OUT_OF_RANGE, SELF, APART, BEYOND, ABSURD, CRASH, HANG, STATUS, NO_OBJECT, EXIT, TREE, BAD_TREE };

#ifndef FAULT
#define FAULT NONE
#endif
#ifndef VERSION
#define VERSION COLLIDOSCOPE_BROAD_PHASE_VERSION
#endif
#ifndef NAME
#define NAME "test_plugin"
#endif
#ifndef MEMORY
#define MEMORY COLLIDOSCOPE_HOST
#endif

typedef struct {
  uint32_t count;
  collidoscope_box *boxes; /* of the last call, for the tree */
} Object;

static void *create(uint32_t memory, uint32_t count) {
  (void)memory;
  if (FAULT == NO_OBJECT) return NULL;
  Object *object = malloc(sizeof *object);
  object->count = count;
  object->boxes = malloc(count * sizeof *object->boxes);
  return object;
}

static void destroy(void *object) {
  free(((Object *)object)->boxes);
  free(object);
}

static int overlap(const collidoscope_box *a, const collidoscope_box *b) {
  for (int k = 0; k < 3; ++k)
    if (!(a->min[k] <= b->max[k] && b->min[k] <= a->max[k])) return 0;
  return 1;
}

static void put(const collidoscope_find *f, uint32_t a, uint32_t b) {
  const uint64_t place = (*f->pair_count)++;
  if (place < f->capacity) f->pairs[place] = (collidoscope_pair){a, b};
}

static int find(void *object, const collidoscope_find *f) {
  for (uint32_t k = 0; k < f->count; ++k) ((Object *)object)->boxes[k] = f->boxes[k];
  if (FAULT == CRASH && f->count == 300) raise(SIGSEGV);
  if (FAULT == HANG && f->count == 300)
    for (;;) pause();
  if (FAULT == EXIT && f->count == 300) exit(5);
  if (FAULT == STATUS) return 7;
  f->begin_stage(f->context, "test stage");
  for (uint32_t b = 0; b < f->count; ++b)
    for (uint32_t a = 0; a < b; ++a) {
      if (!overlap(&f->boxes[a], &f->boxes[b])) continue;
      if (FAULT == MISSING && (a + b) % 7 == 0) continue;
      put(f, b, a);
      if (FAULT == DUPLICATE && (a + b) % 5 == 0) put(f, a, b);
    }
  if (FAULT == OUT_OF_RANGE) put(f, 0, f->count);
  if (FAULT == SELF) put(f, 0, 0);
  if (FAULT == APART)
    for (uint32_t k = 1; k < f->count; ++k)
      if (!overlap(&f->boxes[0], &f->boxes[k])) put(f, 0, k);
  if (FAULT == BEYOND) f->pairs[f->capacity] = (collidoscope_pair){0, 1};
  if (FAULT == ABSURD) *f->pair_count = ~(uint64_t)0;
  return 0;
}

/* All leaves, then levels of groups of eight. */
static uint32_t tree(void *object, collidoscope_node *nodes, uint32_t capacity) {
  const Object *self = object;
  uint32_t first = 0, end = 0;
  for (uint32_t k = 0; k < self->count; ++k, ++end) {
    const collidoscope_box *box = &self->boxes[k];
    if (end >= capacity) continue;
    nodes[end] = (collidoscope_node){{box->min[0], box->min[1], box->min[2]}, {box->max[0], box->max[1], box->max[2]}, -1, (int32_t)k};
    if (FAULT == BAD_TREE && k == 2) nodes[end].box = 1;
  }
  while (end - first > 1) {
    const uint32_t last = end;
    for (; first < last; ++end) {
      collidoscope_node group = nodes[first];
      group.parent = group.box = -1;
      for (uint32_t k = 0; k < 8 && first < last; ++k, ++first) {
        nodes[first].parent = (int32_t)end;
        for (int axis = 0; axis < 3; ++axis) {
          if (nodes[first].min[axis] < group.min[axis]) group.min[axis] = nodes[first].min[axis];
          if (nodes[first].max[axis] > group.max[axis]) group.max[axis] = nodes[first].max[axis];
        }
      }
      if (end < capacity) nodes[end] = group;
    }
  }
  return end;
}

COLLIDOSCOPE_EXPORT const collidoscope_broad_phase *collidoscope_broad_phase_v1(void) {
  static const collidoscope_broad_phase description = {
      VERSION, MEMORY, NAME, "compares\nall boxes", create, destroy, find, FAULT == TREE || FAULT == BAD_TREE ? tree : NULL};
  return &description;
}
