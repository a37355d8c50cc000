#pragma once
// How long work on an executor takes.

#include <functional>

#include "sim_cuda/core/executor.h"

namespace collidoscope {

/// From the first of what `work` enqueues to the end of the last, in ms: on the device's clock where there is
/// one. Returns when it is done.
double milliseconds_of(Executor& executor, const std::function<void()>& work);

}  // namespace collidoscope
