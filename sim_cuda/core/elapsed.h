#pragma once
// Elapsed time of work on an executor.

#include <functional>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// Time in ms from the first operation that `work` enqueues to the end of the last. Measured with CUDA events
/// on a GPU. Returns after the work is done.
double milliseconds_of(Executor& executor, const std::function<void()>& work);

}  // namespace collidoscope
