#pragma once
// What accuracy costs in a running scene: a study (sim_cuda/accuracy/) of the scene as it is, from the bodies
// as they are when it begins, in slices, so that the picture keeps moving. The run is read once, and never
// touched. It stays the same study while nothing but numerical settings turns, and while the run goes on; it
// begins anew where the run is asked something else, or where somebody requests it. Owns the study.

#include <memory>
#include <string>

#include "sim_cuda/accuracy/study.h"
#include "sim_cuda/world.h"
#include "ui/accuracy_view.h"

namespace collidoscope {

class LiveAccuracy {
 public:
  static constexpr std::int64_t max_bodies = 20'000;  ///< one step is the least slice
  static constexpr double seconds = 1;                ///< s of simulated time, about: somebody waits
  static constexpr int rounds = 3;                    ///< runs that a cost is the middle of

  /// Of the scene of `world`; `generation` changes whenever it is another World.
  void follow(World& world, int generation, AccuracyRequests& requests);
  /// Measures for about so many milliseconds; nothing once all is done.
  void advance(double milliseconds);
  bool done() const { return study_ == nullptr || finished_; }
  /// Takes a study that was measured elsewhere, for pictures.
  void show(AccuracyView view) { view_ = std::move(view); }

  /// Of the study so far, with the answer to what the requests ask; sets a tolerance where there is none.
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
