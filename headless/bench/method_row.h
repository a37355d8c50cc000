#pragma once
// Measurement of one broad phase at the initial state of a Box Collider, and the loop over sizes, variants
// and methods. Shared by the suites that compare methods.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "headless/cli/command_line.h"
#include "headless/reporting/percentiles.h"
#include "sim_cuda/core/launch_shape.h"
#include "sim_cuda/world.h"
#include "ui/chart.h"

namespace collidoscope {

struct MethodRow {
  std::string method, variant;
  std::int64_t bodies = 0, pairs = 0, bytes = 0;  ///< bytes: memory of the method
  int launches = 0, repeats = 0;
  int key_bits = 0;   ///< of Morton keys; 0: none are used
  double visits = 0;  ///< mean number of nodes read by one query of the method; 0: no tree
  Percentiles whole;  ///< us, from positions to the ordered list of pairs
  struct Stage {
    std::string name;
    double median_us;
    int launches;
    bool library_launch;
  };
  std::vector<Stage> stages;  ///< measured in separate repeats

  /// Minimum memory traffic of any method: positions and radii read, boxes written and read, pairs written.
  std::int64_t floor_bytes() const { return bodies * (16 + 2 * 24) + pairs * 4; }
};

/// One row to measure.
struct SweepPoint {
  Scene scene;
  std::string variant;  ///< of the scene
  RunOptions run;
};
MethodRow measure_method(const SweepPoint& at, int repeats);
nlohmann::ordered_json json_of(const MethodRow& row);
std::string csv_of(const std::vector<MethodRow>& rows);
/// `build 3.1, pairs 20.4`. A star marks stages that partly ignore (B, T).
std::string stages_text(const MethodRow& row);

/// The machine of the measurements.
struct BenchMachine {
  std::string executor, device;
  LaunchShape shape;
  std::vector<std::string> plugins;  ///< see plugin_notes()
};
BenchMachine machine_of(const World& world);
/// `NVIDIA H200, B auto, T 64`.
std::string text_of(const BenchMachine& machine);

/// Chart of time over N, with one series per method, or per method and variant if there are several.
Chart chart_of_methods(const std::string& title, const BenchMachine& machine,
                       const std::vector<MethodRow>& rows);

/// Defaults of a suite for values that the command line does not set.
struct SweepDefaults {
  std::vector<std::int64_t> sizes;
  std::vector<std::string> methods;
  std::vector<std::string> variants;  ///< empty: the scene's own
};
/// Calls `visit` for every combination of size, variant and method. Sets the variant and the number of bodies
/// of the scene's generator, or replaces the scene by a crowded scene.
/// Skips methods that test nearly all pairs if they would take minutes. Throws InputError if the scene does
/// not have exactly one generator.
void sweep(const CommandLine& line, const SweepDefaults& defaults,
           const std::function<void(const SweepPoint&)>& visit);
/// The variant of a scene with one generator; "" for other scenes.
std::string own_variant(const Scene& scene);

}  // namespace collidoscope
