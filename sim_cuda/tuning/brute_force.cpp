#include "sim_cuda/tuning/brute_force.h"

#include <limits>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/wall_clock.h"
#include "sim_cuda/tuning/paired_steps.h"

namespace collidoscope {
namespace {

constexpr int first_pairs = 2;
constexpr double too_slow = 2;

/// Median ratio of a shape, or infinity.
double ratio_of(PairedSteps& pair, LaunchShape shape, int pairs) {
  std::vector<double> ratios;
  try {
    pair.candidate().set_launch_shape(shape);
    pair.measure(pairs, PairedSteps::Clock::time_point::max(),
                 [&](double ms, double reference_ms) { ratios.push_back(ms / reference_ms); });
  } catch (const MachineError&) {  // infeasible
    return std::numeric_limits<double>::infinity();
  }
  return estimate_ratio(ratios).ratio;
}

}  // namespace

BruteForce brute_force(World& world, const LaunchSearch& search,
                       const std::function<void(double)>& progress) {
  const PairedSteps::Clock::time_point start = PairedSteps::Clock::now();
  const LaunchShape chosen = search.cells()[search.chosen().value()].shape;
  PairedSteps pair(world);
  pair.reference().set_launch_shape(chosen);
  BruteForce result{.best = chosen, .estimate = {}};
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < search.cells().size(); ++k) {
    const LaunchCell& cell = search.cells()[k];
    progress(static_cast<double>(k) / static_cast<double>(search.cells().size()));
    if (cell.state == LaunchCell::State::wrong || cell.shape == chosen) continue;
    double ratio = ratio_of(pair, cell.shape, first_pairs);
    if (ratio < too_slow) ratio = ratio_of(pair, cell.shape, LaunchSearch::fresh_pairs);
    result.shapes += ratio < std::numeric_limits<double>::infinity();
    if (!(ratio < least)) continue;
    least = ratio;
    result.best = cell.shape;
  }
  std::vector<double> fresh;
  pair.candidate().set_launch_shape(result.best);
  pair.measure(LaunchSearch::fresh_pairs, PairedSteps::Clock::time_point::max(),
               [&](double ms, double reference_ms) { fresh.push_back(ms / reference_ms); });
  result.estimate = estimate_ratio(fresh);
  result.seconds = seconds_since(start);
  progress(1);
  return result;
}

}  // namespace collidoscope
