#pragma once
// Pre-simulation for the variant `settled`: the scene as `scaled`, simulated to rest before its state 0.
// Used by World's constructor.
//
// Solver: soft_step, with the scene's settings if that is its solver, otherwise with default settings. The
// simulation runs for the time T = sqrt(2 side / |g|) of a fall through the box. Then it runs until the
// kinetic energy would lift all bodies by at most 1/20,000 of the largest radius. For 5 m that is 0.25 mm,
// or speeds of 7 cm/s on Earth. Rest is checked every 30 steps. The limit is 20 T; then a log line reports
// the remaining energy.
//
// Spheres that slide without friction, or roll, never stop by themselves. So from time T on, velocities are
// damped by 1/(1 + 4 t/T) at each check; t is the time between checks. The damping does not change contact
// loads.
//
// The result is cached in $XDG_CACHE_HOME or ~/.cache, collidoscope/settled/<hash>.snapshot, so later
// starts are fast. The hash covers everything that determines the result, including the behaviour of this
// program on a small test scene. Errors of the cache are not fatal; the result is then computed again.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// settled_state() in time slices, for callers with other work, such as a window.
class Presimulation {
 public:
  /// done() is true at once if the result is cached.
  Presimulation(const Scene& scene, const RunOptions& options);
  ~Presimulation();
  Presimulation(Presimulation&&) noexcept;
  Presimulation& operator=(Presimulation&&) noexcept;

  bool done() const;
  /// Simulates for about `milliseconds`, at least one step, or until done. Throws as World does.
  void advance(double milliseconds);
  std::int64_t steps() const;      ///< steps made so far
  std::int64_t max_steps() const;  ///< upper limit of steps
  /// Returns the state at rest. Precondition: done().
  RunState take();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Limit of the kinetic energy at rest, J. `mass`: total, kg; `g`: m/s^2; `radius`: largest, m.
double energy_at_rest(double mass, double g, double radius);

/// Global progress and log callbacks for pre-simulation. Set once, before any World is created.
struct PresimulationCallbacks {
  std::function<void(std::int64_t steps, std::int64_t max_steps)>
      progress;  ///< at the end, `steps` = `max_steps`
  std::function<void(const std::string& line)> log;
};
void set_presimulation_callbacks(PresimulationCallbacks callbacks);

}  // namespace collidoscope
