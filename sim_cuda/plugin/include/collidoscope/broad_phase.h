/* Interface of broad-phase plug-ins: shared libraries that find pairs of overlapping boxes for Collidoscope.
 * C99 and C++, without dependencies. A library exports one function:
 *
 *   COLLIDOSCOPE_EXPORT const collidoscope_broad_phase *collidoscope_broad_phase_v1(void);
 *
 * It returns a constant description with pointers to the library's functions. The program calls them from
 * one thread at a time, but for several objects in turns. It never unloads a library.
 */
#pragma once

#include <stdint.h>

#ifdef __cplusplus
#define COLLIDOSCOPE_EXPORT extern "C" __attribute__((visibility("default")))
extern "C" {
#else
#define COLLIDOSCOPE_EXPORT __attribute__((visibility("default")))
#endif

#define COLLIDOSCOPE_BROAD_PHASE_VERSION 1

/* Where boxes and pairs are. Bits, for `memory` of collidoscope_broad_phase. */
#define COLLIDOSCOPE_HOST 1u /* pointers of the host; `find` has finished when it returns */
#define COLLIDOSCOPE_CUDA 2u /* pointers of the current CUDA device; `find` enqueues its work on `stream` */

/* Closed intervals: boxes that touch overlap. All numbers are finite and min <= max; or the box is empty,
 * with min = +infinity and max = -infinity, and overlaps nothing. */
typedef struct collidoscope_box {
  float min[3], max[3]; /* m */
} collidoscope_box;

/* Indices of two different boxes, in either order. */
typedef struct collidoscope_pair {
  uint32_t a, b;
} collidoscope_pair;

/* Node of a hierarchy, in any order. Children are inside their parent. A leaf has one box and contains it. */
typedef struct collidoscope_node {
  float min[3], max[3]; /* m */
  int32_t parent;       /* index of another node; -1: this node is the root */
  int32_t box;          /* index of the leaf's box; -1: an inner node, with 1 to 8 children */
} collidoscope_node;

/* Arguments of `find`. */
typedef struct collidoscope_find {
  const collidoscope_box* boxes;
  uint32_t count;   /* number of boxes: that of `create` */
  uint32_t threads; /* host: number of threads to use */
  void* stream;     /* CUDA: a cudaStream_t, which may be in capture; host: NULL */
  /* Output, in the memory of the boxes. Each pair of overlapping boxes once, in any order. Pairs beyond the
   * capacity are not written but counted. The program then enlarges the list and calls `find` again.
   * *pair_count is 0 before the call. */
  collidoscope_pair* pairs;
  uint64_t capacity;
  uint64_t* pair_count;
  /* Optional to call: work from now on belongs to the stage `name` of the timings, such as "sort". */
  void (*begin_stage)(void* context, const char* name);
  void* context;
} collidoscope_find;

typedef struct collidoscope_broad_phase {
  uint32_t version;        /* COLLIDOSCOPE_BROAD_PHASE_VERSION */
  uint32_t memory;         /* COLLIDOSCOPE_HOST, COLLIDOSCOPE_CUDA, or both */
  const char* name;        /* shown in lists: 1 to 32 of a-z, 0-9 and _ */
  const char* description; /* a line of text, or NULL */

  /* Returns an object for `count` boxes (at least 1), or NULL if it cannot. `memory` is one of the bits. All
   * memory that `find` needs must be allocated here. */
  void* (*create)(uint32_t memory, uint32_t count);
  void (*destroy)(void* object);
  /* Finds the pairs. Returns 0, or another number for an error, which ends the run. With CUDA, it must not
   * wait for the device, allocate device memory or copy to pageable memory: a step is captured as a CUDA
   * graph and replayed, with the same pointers. */
  int (*find)(void* object, const collidoscope_find* arguments);
  /* Optional; NULL: there is no tree. Returns the number of nodes of the last `find`, and writes them to host
   * memory if they fit in `capacity`. Waits for the device if necessary. */
  uint32_t (*tree)(void* object, collidoscope_node* nodes, uint32_t capacity);
} collidoscope_broad_phase;

#ifdef __cplusplus
}
#endif
