#pragma once
// One broad phase at the initial state of one Box Collider, measured: what the suites that compare methods
// have a row of. And the loop over sizes, variants and methods that they share.

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
  std::int64_t bodies = 0, pairs = 0, bytes = 0;  ///< bytes: of the method
  int launches = 0, repeats = 0;
  int key_bits = 0;   ///< of Morton keys; 0: it has none
  double visits = 0;  ///< nodes that a query of the method's own reads, on average; 0: it has no tree
  Percentiles whole;  ///< us, from positions to the ordered list of pairs
  struct Stage {
    std::string name;
    double median_us;
    int launches;
    bool library_launch;
  };
  std::vector<Stage> stages;  ///< of other repeats, timed apart

  /// What any method must move: positions and radii read, boxes written and read, pairs written.
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
/// `build 3.1, pairs 20.4`; a star marks what in part ignores (B, T).
std::string stages_text(const MethodRow& row);

/// Where rows are measured.
struct BenchMachine {
  std::string executor, device;
  LaunchShape shape;
};
BenchMachine machine_of(const World& world);
/// `NVIDIA H200, B auto, T 64`.
std::string text_of(const BenchMachine& machine);

/// Time over N, a series for each method (and variant, where there are several).
Chart chart_of_methods(const std::string& title, const BenchMachine& machine,
                       const std::vector<MethodRow>& rows);

/// What a suite goes through where the line does not say.
struct SweepDefaults {
  std::vector<std::int64_t> sizes;
  std::vector<std::string> methods;
  std::vector<std::string> variants;  ///< none: the scene's own
};
/// Every size x variant x method that the line asks for. The scene has one generator, whose variant and
/// number of bodies are set, or which a crowded scene replaces. Leaves out what tests nearly all pairs where
/// that takes minutes. Throws InputError for a scene without one generator.
void sweep(const CommandLine& line, const SweepDefaults& defaults,
           const std::function<void(const SweepPoint&)>& visit);
/// The variant of a scene with one generator; "" of others.
std::string own_variant(const Scene& scene);

}  // namespace collidoscope
