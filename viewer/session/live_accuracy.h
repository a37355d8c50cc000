#pragma once
// Accuracy study (sim_cuda/accuracy/) of a running scene, from its present state, a time slice per call. The
// running world is only read. The study is kept while the run continues and while only numerical settings
// change. Any other change, or a request, restarts it. Owns the study.

#include <memory>
#include <string>

#include "sim_cuda/accuracy/study.h"
#include "sim_cuda/world.h"
#include "ui/accuracy_view.h"

namespace collidoscope {

class LiveAccuracy {
 public:
  static constexpr std::int64_t max_bodies = 20'000;  ///< limit, since a slice takes at least one step
  static constexpr double seconds = 1;                ///< s, approximate simulated time of each run
  static constexpr int rounds = 3;                    ///< runs per cost, which is their median

  /// Follows the scene of `world`; `generation` changes with each new World.
  void follow(World& world, int generation, AccuracyRequests& requests);
  /// Measures for about `milliseconds`. Does nothing when done.
  void advance(double milliseconds);
  bool done() const { return study_ == nullptr || finished_; }
  /// Shows a study that was measured elsewhere, for pictures.
  void show(AccuracyView view) { view_ = std::move(view); }

  /// Results so far, and the recommendation for the requested tolerance. Sets a default tolerance if it is
  /// unset.
  const AccuracyView& view(const World& world, AccuracyRequests& requests);

 private:
  void begin(World& world);

  int generation_ = -1;
  std::string problem_;
  std::unique_ptr<AccuracyStudy> study_;
  bool finished_ = false;
  AccuracyView view_;
};

}  // namespace collidoscope
