#pragma once
// Records the residual of each solver iteration (residual.h). Sums use the fixed tree of core/reduce.h, so
// the result is the same on every executor. Values stay on the device until kept(). Owned by a solver.
// Disabled, it uses no memory and launches nothing.

#include <cstdint>

#include "sim_cuda/core/buffer.h"
#include "sim_cuda/core/reduce.h"
#include "sim_cuda/core/step_control.h"
#include "sim_cuda/solver/residual.h"

namespace collidoscope {

struct ResidualSum {
  double squares = 0, largest = 0;  ///< m^2/s^2
  std::int64_t contacts = 0;

  /// Adds a contact; `squared`: squared residual, m^2/s^2.
  SIM_HD void add(double squared) {
    squares += squared;
    largest = squared > largest ? squared : largest;
    ++contacts;
  }
};
SIM_HD inline ResidualSum combine(ResidualSum a, ResidualSum b) {
  return {a.squares + b.squares, b.largest > a.largest ? b.largest : a.largest, a.contacts + b.contacts};
}

/// Stores a sum. A step has `runs` pipeline runs, each with `places` sums.
struct KeepResidual {
  const ResidualSum* sum;
  const StepControl* control;
  std::uint32_t runs, places, place;
  ResidualSum* kept;
  SIM_HD void operator()(int) const { kept[control->committed % runs * places + place] = *sum; }
};

class Residuals {
 public:
  explicit Residuals(Executor& executor)
      : executor_(executor), scratch_(executor, "residuals"), kept_(executor, "residuals per step") {}

  /// Call outside of runs.
  void enable(bool on, int runs, int places) {
    runs_ = static_cast<std::uint32_t>(runs);
    places_ = static_cast<std::uint32_t>(places);
    kept_.resize_discarding(on ? static_cast<std::size_t>(runs) * static_cast<std::size_t>(places) : 0);
    scratch_.resize_discarding(on ? reduce_scratch_size(items_) : 0);
  }
  bool on() const { return kept_.size() > 0; }
  /// Call outside of runs. `items`: largest number of items per sum.
  void reserve(std::int64_t items) {
    items_ = items;
    if (on()) scratch_.resize_discarding(reduce_scratch_size(items));
  }

#if !SIM_CUDA || defined(__CUDACC__)  // as for Executor::run
  /// Enqueues a sum over items 0 to `items` - 1 of `load(item)`, a ResidualSum. Precondition: items beyond
  /// the number of contacts add nothing. So the result does not depend on the capacity.
  template <class Load>
  void record(int place, std::int64_t items, const Load& load, const StepControl* control) {
    if (!on() || items == 0) return;
    const ResidualSum* sum = reduce<ResidualSum>(executor_, "residual", items, load, scratch_.data());
    executor_.run(
        "residual", 1,
        KeepResidual{sum, control, runs_, places_, static_cast<std::uint32_t>(place), kept_.data()});
  }
#endif

  /// Sums by run, then by place; waits for the device.
  std::vector<ResidualSum> kept() const { return kept_.download(); }
  /// Converts a sum to a Residual.
  static Residual residual(const char* stage, int substep, int iteration, const ResidualSum& sum);

 private:
  Executor& executor_;
  std::uint32_t runs_ = 1, places_ = 0;
  std::int64_t items_ = 0;
  Buffer<ResidualSum> scratch_, kept_;
};

}  // namespace collidoscope
