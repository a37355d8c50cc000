#pragma once
// The measured shapes in the file formats of auto-tuners. Both record each shape that was tried: invalid ones
// with the reason, and without times. Shapes that were left out or not reached are missing, as configurations
// that were not evaluated. All times in ms.

#include <string>

#include "headless/tuning/tuned_run.h"

namespace collidoscope {

/// Cache file of Kernel Tuner: cache schema 1.0.0 of its branch `cache_files`, with the member `__error__` of
/// version 1.5. `time` is the median. Its last characters are "}\n}", as Kernel Tuner requires of a complete
/// file.
std::string kernel_tuner_cache(const TunedRun& run, const LaunchSearch& search);

/// T4 auto-tuning results, schema 1.0.0 (TuningSchema).
std::string t4_results(const TunedRun& run, const LaunchSearch& search);

}  // namespace collidoscope
