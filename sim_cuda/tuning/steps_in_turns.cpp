#include "sim_cuda/tuning/steps_in_turns.h"

#include <chrono>

#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {

std::vector<double> StepsInTurns::turn() {
  std::vector<double> ms(worlds_.size());
  for (std::size_t k = 0; k < worlds_.size(); ++k) {
    const std::size_t index = reverse_ ? worlds_.size() - 1 - k : k;
    const auto start = std::chrono::steady_clock::now();
    worlds_[index]->step(steps_);
    ms[index] = 1e3 * seconds_since(start) / steps_;
  }
  reverse_ = !reverse_;
  return ms;
}

std::vector<double> ratios_of(const std::vector<double>& times, const std::vector<double>& references) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < times.size(); ++k) ratios.push_back(times[k] / references[k]);
  return ratios;
}

}  // namespace collidoscope
