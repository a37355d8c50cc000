#pragma once
// Options of how and where a scene runs. They do not affect the state. Plain data.

#include <cstdint>
#include <string>
#include <vector>

#include "sim_cuda/core/executor_options.h"
#include "sim_cuda/core/tuned_shapes.h"

namespace collidoscope {

struct RunOptions : ExecutorOptions {
  std::string broad_phase = "lbvh_ropes";  ///< a name from broad_phase_names()
  /// Earlier results, for a shape that is automatic for all stages.
  std::vector<TunedShapes> tuned_shapes;
  std::int64_t initial_pair_capacity = 0;  ///< pairs; 0: estimated from N. Tests start with too small a
                                           ///< capacity on purpose.
};

}  // namespace collidoscope
