#pragma once
// What `bench paper` says of its rows: tables beside the paper's, claims put to the test, JSON, CSV, a chart.

#include <cstdint>
#include <string>
#include <vector>

#include "headless/bench/paper_cells.h"
#include "headless/reporting/percentiles.h"
#include "sim_cuda/core/launch_shape.h"
#include "ui/chart.h"

namespace collidoscope {

/// How a body looks for its pairs: for all that it overlaps, from the root, so that both bodies of a pair
/// meet it, as the paper describes; or so that each pair is met once. `none`: by no tree (Tables 1 and 2).
enum class PaperQuery { none, whole, half };
const char* name_of(PaperQuery query);

/// What the first steps of one (method, query, N, B, T) took: ms, over the steps that were timed stage by
/// stage. Each shape of one N goes through the same steps.
struct PaperTiming {
  Percentiles forwarding, collisions, both;  ///< sums of stages, step by step
  Percentiles pairs_stage, sort_stage, build_stage;
  double whole_step = 0;  ///< median of the steps between, in which nothing is timed
  std::int64_t pairs = 0, bytes = 0;
  int launches = 0, steps = 0, timed = 0, key_bits = 0;
};

struct PaperRow {
  PaperCell cell;
  PaperQuery query;
  Percentiles ms;
  PaperTiming timing;
};

/// The query of the same tree by a stack and by calls.
struct PaperRecursion {
  std::int64_t bodies;
  LaunchShape shape;
  Percentiles stack_ms, calls_ms;
};

struct PaperResults {
  std::string device;
  std::vector<PaperRow> rows;
  std::vector<PaperRecursion> recursions;
};

std::string paper_text(const PaperResults& results, bool markdown);
std::string paper_json(const PaperResults& results);
std::string paper_csv(const PaperResults& results);
/// Table 5's speed-up over B T, whole queries: the paper's dashed, ours, and what all of the threads would
/// give.
Chart paper_chart(const PaperResults& results);

}  // namespace collidoscope
