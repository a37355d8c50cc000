#include "sim_cuda/solver/residuals.h"

#include <cmath>

namespace collidoscope {

Residual Residuals::residual(const char* stage, int substep, int iteration, const ResidualSum& sum) {
  Residual residual{stage, substep, iteration, sum.contacts, 0, std::sqrt(sum.largest)};
  if (sum.contacts > 0) residual.rms = std::sqrt(sum.squares / static_cast<double>(sum.contacts));
  return residual;
}

}  // namespace collidoscope
