#pragma once
// What a step will take before it is made: bytes and seconds, from a sample of the bodies. World refuses a
// step that would take more than 80 % of the memory that is available, or than RunOptions::memory_limit,
// unless RunOptions::allow_large is set; about one that would take long it only gives a warning. Few bodies
// are not asked about: what their lists take is found when they grow (step_runner.h).

#include <cstdint>
#include <functional>
#include <string>

#include "sim_cuda/core/executor.h"
#include "sim_cuda/run/pipeline.h"
#include "sim_cuda/run/run_state.h"
#include "sim_cuda/scene/initial_bodies.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

struct StepEstimate {
  std::int64_t bodies = 0;
  double pairs = 0, contacts = 0;
  double seconds = 0;      ///< of a step, about
  std::int64_t bytes = 0;  ///< of all buffers of the executor; 0: so few that they were not counted
};

/// Where and how a world is about to begin.
struct WorldSetup {
  const std::string& broad_phase;
  const Scene& scene;
  const InitialBodies& initial;
  Effects effects;
  int substeps;
  const RunState* start = nullptr;  ///< as World's constructor has it
  const BodyIdMap& ids;
  Capacity capacity;  ///< of its lists at first
};

/// Of a world's first step. `thorough`: a larger sample, and bytes in any case. Throws Cancelled.
StepEstimate estimate_step(Executor& executor, const WorldSetup& setup, bool thorough);

/// Throws MachineError, with the figures, where the estimate is more than the executor has room for.
void require_memory_for_step(Executor& executor, const WorldSetup& setup);
/// The same by the number of bodies alone, before there are any.
void require_memory_for_bodies(const Scene& scene, const RunOptions& options);

/// s, about: what solving the contacts of one pipeline run takes.
double estimate_solve_seconds(const Executor& executor, const Physics& physics, double bodies,
                              double contacts, int substeps);

/// Is told, in a line, of steps that are expected to take long. One for the program; set before worlds are
/// made.
void set_slow_step_callback(std::function<void(const std::string& line)> callback);

/// "93.1 GB".
std::string short_bytes(double bytes);

}  // namespace collidoscope
