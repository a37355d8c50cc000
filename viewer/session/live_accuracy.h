#pragma once
// What accuracy costs in a running scene: a study (sim_cuda/accuracy/) of the scene as it is, from the bodies
// as they are when it begins, in slices, so that the picture keeps moving. The run is read once, and never
// touched. It stays the same study while nothing but numerical settings turns, and while the run goes on; it
// begins anew where the run is asked something else, or where somebody wishes it. Owns the study.

#include <memory>
#include <string>

#include "sim_cuda/accuracy/study.h"
#include "sim_cuda/world.h"
#include "ui/accuracy_facts.h"

namespace collidoscope {

class LiveAccuracy {
 public:
  static constexpr std::int64_t most_bodies = 20'000;  ///< one step is the least slice
  static constexpr double seconds = 1;                 ///< s of simulated time, about: somebody waits
  static constexpr int rounds = 3;                     ///< runs that a price is the middle of

  /// Of the scene of `world`; `generation` changes whenever it is another World.
  void follow(World& world, int generation, AccuracyWishes& wishes);
  /// Measures for about so many milliseconds; nothing once all is done.
  void go_on(double milliseconds);
  bool done() const { return study_ == nullptr || finished_; }
  /// Takes a study that was measured elsewhere, for pictures.
  void show(AccuracyFacts facts) { facts_ = std::move(facts); }

  /// Of the study so far, with the answer to what the wishes ask; sets a tolerance where there is none.
  const AccuracyFacts& facts(const World& world, AccuracyWishes& wishes);

 private:
  void begin(World& world);

  int generation_ = -1;
  std::string problem_;
  std::unique_ptr<AccuracyStudy> study_;
  bool finished_ = false;
  AccuracyFacts facts_;
};

}  // namespace collidoscope
