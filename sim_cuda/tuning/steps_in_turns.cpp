#include "sim_cuda/tuning/steps_in_turns.h"

#include <chrono>

#include "sim_cuda/core/wall_clock.h"

namespace collidoscope {

std::vector<double> StepsInTurns::turn() {
  std::vector<double> ms(worlds_.size());
  for (const std::size_t index : order_of_turn(worlds_.size(), turns_++)) {
    const auto start = std::chrono::steady_clock::now();
    worlds_[index]->step(steps_);
    ms[index] = 1e3 * seconds_since(start) / steps_;
  }
  return ms;
}

std::vector<std::size_t> order_of_turn(std::size_t count, std::size_t turn) {
  const std::size_t row = turn % (2 * count), first = row % count;
  std::vector<std::size_t> order;
  for (std::size_t k = 0; k < count; ++k)
    order.push_back((row < count ? first + k : first + count - k) % count);
  return order;
}

std::vector<double> ratios_of(const std::vector<double>& times, const std::vector<double>& references) {
  std::vector<double> ratios;
  for (std::size_t k = 0; k < times.size(); ++k) ratios.push_back(times[k] / references[k]);
  return ratios;
}

}  // namespace collidoscope
