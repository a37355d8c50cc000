#pragma once
// Options of how and where a scene runs. They do not affect the state. Plain data.

#include <cstdint>
#include <string>

#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

struct RunOptions : ExecutorOptions {
  std::string broad_phase = "lbvh_ropes";  ///< a name from broad_phase_names()
  std::int64_t initial_pair_capacity = 0;  ///< pairs; 0: estimated from N. Tests start with too small a
                                           ///< capacity on purpose.
};

}  // namespace collidoscope
