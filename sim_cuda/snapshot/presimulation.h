#pragma once
// The variant `settled`: the scene as `scaled`, simulated to rest before its state 0. World's constructor
// asks for it; free functions.
//
// It runs with soft_step (the scene's own settings, where that is its solver, else the solver's), for the
// time T = sqrt(2 side / |g|) of a fall through the box, and then until the kinetic energy would lift all
// bodies by no more than 1/20,000 of the largest radius (0.25 mm for 5 m, speeds of 7 cm/s on Earth), looked
// at every 30 steps; at most for 20 T, after which a line says how far from rest it is. Spheres that slide
// without friction, or roll, never stop by themselves; so from T on, at each look, all speeds are divided by
// 1 + 4 t/T, t being the time between two looks: a drag that holds nothing up and leaves the piles their
// weight.
//
// What it came to stays in the user's cache folder, so that the next start is instant: $XDG_CACHE_HOME or
// ~/.cache, collidoscope/settled/<hash>.snapshot. The hash is of all that decides it, this program's way of
// stepping included: what a small scene comes to in it. A cache that cannot be read or written costs time,
// and ends nothing.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// settled_state() in slices, for callers that work in between, such as a window.
class Presimulation {
 public:
  /// Done at once where the cache has it.
  Presimulation(const Scene& scene, const RunOptions& options);
  ~Presimulation();
  Presimulation(Presimulation&&) noexcept;
  Presimulation& operator=(Presimulation&&) noexcept;

  bool done() const;
  /// Steps for about so many milliseconds, and one at least, until it is done. Throws as World does.
  void advance(double milliseconds);
  std::int64_t steps() const;      ///< so far
  std::int64_t max_steps() const;  ///< steps after which it ends, at rest or not
  /// The state at rest, once it is done.
  RunState take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The kinetic energy in J at which bodies of `mass` kg in all are at rest; g in m/s^2, `radius` the largest.
double energy_at_rest(double mass, double g, double radius);

/// Who is told while a world settles, since that takes long. One for the program; set before worlds are made.
struct PresimulationCallbacks {
  std::function<void(std::int64_t steps, std::int64_t max_steps)>
      progress;  ///< `steps` = `max_steps` at the end
  std::function<void(const std::string& line)> log;
};
void set_presimulation_callbacks(PresimulationCallbacks callbacks);

}  // namespace collidoscope
