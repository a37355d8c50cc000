#pragma once
// The measures of trees side by side, as text and as JSON. Plain data and free functions.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "sim_cuda/broad_phase/tree_quality.h"
#include "sim_cuda/core/stage_times.h"

namespace collidoscope {

struct MeasuredTree {
  std::string method;
  int key_bits = 0;  ///< 0: no Morton keys
  TreeQuality quality;
  /// Medians; the query includes the ordering of its pairs. 0: not known.
  double build_us = 0, query_us = 0;

  void take(const BroadPhaseTimes& times);  ///< sets build_us and query_us
};

nlohmann::ordered_json json_of(const MeasuredTree& tree);
std::string text_of(const std::vector<MeasuredTree>& trees);

}  // namespace collidoscope
