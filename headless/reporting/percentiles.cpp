#include "headless/reporting/percentiles.h"

#include "sim_cuda/core/stage_clock.h"
#include "sim_cuda/core/statistics.h"

namespace collidoscope {

Percentiles percentiles_of(const std::vector<float>& samples) {
  return {quantile(samples, 0.5), quantile(samples, 0.05), quantile(samples, 0.95)};
}

}  // namespace collidoscope
