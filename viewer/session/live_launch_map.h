#pragma once
// Launch map (sim_cuda/tuning/) of a running scene, from its present state, a time slice per call. The
// running world is only read. The map is kept until the world is replaced or a new map is requested. Owns the
// two worlds that measure.

#include <functional>
#include <memory>
#include <string>

#include "sim_cuda/tuning/launch_tuner.h"
#include "sim_cuda/world.h"
#include "ui/launch_map_view.h"

namespace collidoscope {

class LiveLaunchMap {
 public:
  /// `generation` changes with each new World.
  void follow(int generation, LaunchMapRequests& requests);
  /// Measures for about `milliseconds`. The first call copies the state of `world`. Throws Cancelled.
  void advance(World& world, double budget, double milliseconds);
  bool done() const { return !requested_ || !view_.unavailable_reason.empty() || view_.done; }
  /// Shows a map that was measured elsewhere, for pictures.
  void show(LaunchMapView view) { view_ = std::move(view); }
  const LaunchMapView& view(const World& world);
  /// Returns the tuner of a complete map once. Later calls, and calls before that, return null.
  const LaunchTuner* take_complete();

  /// See LaunchTuner::set_hash.
  void set_hash(std::function<std::uint64_t(World&)> hash) { hash_ = std::move(hash); }

 private:
  int generation_ = -1;
  bool requested_ = false, taken_ = false;
  std::unique_ptr<LaunchTuner> tuner_;
  std::function<std::uint64_t(World&)> hash_;
  LaunchMapView view_;
};

}  // namespace collidoscope
