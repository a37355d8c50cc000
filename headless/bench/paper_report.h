#pragma once
// Formats the results of `bench paper`: tables next to the paper's, checked claims, JSON, CSV, a chart.

#include <cstdint>
#include <string>
#include <vector>

#include "headless/bench/paper_cells.h"
#include "headless/reporting/percentiles.h"
#include "sim_cuda/core/launch_shape.h"
#include "ui/chart.h"

namespace collidoscope {

/// Tree query of a body. `whole`: starts at the root and finds all overlaps, so each pair is visited twice,
/// as in the paper. `half`: visits each pair once. `none`: no tree (Tables 1 and 2).
enum class PaperQuery { none, whole, half };
const char* name_of(PaperQuery query);

/// Times in ms of the first steps of one (method, query, N, B, T), over the steps with stage timing. All
/// shapes of one N simulate the same steps.
struct PaperTiming {
  Percentiles forwarding, collisions, both;  ///< per step, sums of stages
  Percentiles pairs_stage, sort_stage, build_stage;
  double whole_step = 0;  ///< median of the steps without stage timing
  std::int64_t pairs = 0, bytes = 0;
  int launches = 0, steps = 0, timed = 0, key_bits = 0;
};

struct PaperRow {
  PaperCell cell;
  PaperQuery query;
  Percentiles ms;
  PaperTiming timing;
};

/// Query of the same tree with a stack and with recursion.
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
/// Speed-up of Table 5 over B T with whole queries: the paper's (dashed), the measured one, and ideal
/// scaling.
Chart paper_chart(const PaperResults& results);

}  // namespace collidoscope
