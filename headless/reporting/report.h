#pragma once
// The final report of a run: collected from a World, written as JSON or as a text table. Plain data, SI
// units.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "sim_cuda/broad_phase/pair_check.h"
#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/core/stage_times.h"
#include "sim_cuda/guard/finding.h"
#include "sim_cuda/measure/step_stats.h"
#include "sim_cuda/scene/settings.h"
#include "sim_cuda/solver/residual.h"

namespace collidoscope {

class World;

struct RunReport {
  std::string scene;    ///< name of the scene
  std::string variant;  ///< of the generator; empty without one
  std::optional<std::uint64_t> seed;
  std::string executor;  ///< cpu or cuda: the executor used, not the requested one
  std::string device, broad_phase;
  std::optional<PairCheck> pair_check;  ///< of a plug-in
  int key_bits = 0;                     ///< of the broad phase's Morton keys; 0: none are used
  std::string solver, integrator, rotation_update, precision;
  std::vector<std::string> effects;                                 ///< enabled effects
  std::vector<std::pair<std::string, std::string>> effect_reasons;  ///< all effects with the reason for
                                                                    ///< "auto" to enable them or not
  RunSettings settings;                                             ///< as requested
  bool has_generator_settings = false;                              ///< the scene has exactly one generator
  LaunchShape shape;                                                ///< 0: "auto"
  std::string tuned, tuned_rejection;                               ///< see WorldInfo
  int substeps = 1, iterations = 1;
  double substeps_missed = 0;  ///< see joint_substeps.h
  double time_step = 0;        ///< s
  StepStats initial, final;
  std::vector<Residual> residuals;  ///< of the last step; empty if not requested
  RunTimes times;
  std::uint64_t state_hash = 0;
  std::int64_t allocated_bytes = 0;
  std::string guards;  ///< on_failure of the guards; empty: guards are off
  std::optional<Finding> finding;
  std::vector<std::uint32_t> frozen;   ///< ids
  std::string failure;                 ///< reason for an early end; empty: none
  std::optional<double> wall_seconds;  ///< s, of stepping only; unset if pictures were drawn between steps
  double simulated_seconds = 0;        ///< s, between the first and the last state
};

/// `initial`: World::measure() at the first state of the run.
RunReport make_report(World& world, const StepStats& initial, std::optional<double> wall_seconds);

/// One object with the fields of report_fields.h. Non-finite values are null.
nlohmann::ordered_json json_of(const RunReport& report);
/// JSON text with a final newline. Invalid UTF-8, possible in names, is replaced.
std::string json_text(const nlohmann::ordered_json& json);
std::string to_json(const RunReport& report);
/// Text for a terminal of 80 columns, with a final newline.
std::string to_text(const RunReport& report);
/// First lines of the text: scene, device and settings.
std::string title_text(const RunReport& report);

/// 1,234,567.
std::string grouped(std::int64_t number);

}  // namespace collidoscope
