#pragma once
// What a run has to say at its end: gathered once from a World, then written as JSON or as a table for
// people. Plain data, SI units.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/guard/finding.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/solver/residual.h"

namespace collidoscope {

class World;

struct RunReport {
  std::string scene;    ///< its name
  std::string variant;  ///< of its generator; empty where it has none
  std::optional<std::uint64_t> seed;
  std::string executor;  ///< cpu or cuda: what ran, not what was asked for
  std::string device, broad_phase;
  int key_bits = 0;  ///< of the broad phase's Morton keys; 0: it has none
  std::string solver, integrator, rotation_update, precision;
  std::vector<std::string> effects;                                 ///< that are on
  std::vector<std::pair<std::string, std::string>> effect_reasons;  ///< of all: why called for, or why not
  LaunchShape shape;                                                ///< zeros are "auto"
  int substeps = 1, iterations = 1;
  double time_step = 0;  ///< s
  StepStats initial, final;
  std::vector<Residual> residuals;  ///< of the last step; empty where nobody asked
  RunTimes times;
  std::uint64_t state_hash = 0;
  std::int64_t allocated_bytes = 0;
  std::string guards;  ///< on_failure of guards that look; empty: nobody does
  std::optional<Finding> finding;
  std::vector<std::uint32_t> frozen;   ///< ids
  std::string failure;                 ///< what ended the run early; empty: nothing
  std::optional<double> wall_seconds;  ///< s, of the stepping alone; unset where pictures were drawn between
  double simulated_seconds = 0;        ///< s, between its first state and its last
};

/// `initial`: World::measure() at the state that the run started from.
RunReport make_report(World& world, const StepStats& initial, std::optional<double> wall_seconds);

/// One object, the fields of report_fields.h; what is not finite is null.
nlohmann::ordered_json json_of(const RunReport& report);
/// Its text. A name may hold any bytes of a scene file: what is not UTF-8 is replaced. Ends in a newline.
std::string json_text(const nlohmann::ordered_json& json);
std::string to_json(const RunReport& report);
/// For a terminal of 80 columns. Ends in a newline.
std::string to_text(const RunReport& report);
/// Its first lines: what ran on what.
std::string title_text(const RunReport& report);

/// 1,234,567.
std::string grouped(std::int64_t number);

}  // namespace collidoscope
