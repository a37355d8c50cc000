#pragma once
// Estimates memory and time of a step from a sample of the bodies, before it is made. World refuses a step
// above 80 % of the available memory or above RunOptions::memory_limit, unless RunOptions::allow_large is
// set. A long step causes only a warning. Scenes with few bodies are not estimated; their limits are
// checked when lists grow (step_runner.h).

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
  double seconds = 0;      ///< estimated duration of a step
  std::int64_t bytes = 0;  ///< of all executor buffers; 0: not computed, since it is small
};

/// Parameters of a world to be created.
struct WorldSetup {
  const std::string& broad_phase;
  const Scene& scene;
  const InitialBodies& initial;
  Effects effects;
  int substeps;
  const RunState* start = nullptr;  ///< initial state, see World's constructor
  const BodyIdMap& ids;
  Capacity capacity;  ///< initial list capacities
};

/// Estimates the first step of a world. `thorough`: larger sample, and always computes bytes. Throws
/// Cancelled.
StepEstimate estimate_step(Executor& executor, const WorldSetup& setup, bool thorough);

/// Throws MachineError with the figures if the estimate exceeds the executor's available memory.
void require_memory_for_step(Executor& executor, const WorldSetup& setup);
/// The same check from the number of bodies alone, before they are created.
void require_memory_for_bodies(const Scene& scene, const RunOptions& options);

/// Estimated time for solving the contacts of one pipeline run, s.
double estimate_solve_seconds(const Executor& executor, const Physics& physics, double bodies,
                              double contacts, int substeps);

/// Sets the callback for warnings about long steps; `line`: one line of text. Global; set it before any
/// World is created.
void set_slow_step_callback(std::function<void(const std::string& line)> callback);

/// Formats a size: "93.1 GB".
std::string short_bytes(double bytes);

}  // namespace collidoscope
