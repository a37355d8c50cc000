#pragma once
// How and where a scene runs. Nothing in here changes the state. Plain data.

#include <cstdint>
#include <string>

#include "sim_cuda/core/executor_options.h"

namespace collidoscope {

struct RunOptions : ExecutorOptions {
  std::string broad_phase = "lbvh_ropes";  ///< a name from broad_phase_names()
  std::int64_t initial_pair_capacity = 0;  ///< 0: a guess from N; tests start too small on purpose
};

}  // namespace collidoscope
