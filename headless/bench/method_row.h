#pragma once
// One broad phase at the initial state of one Box Collider, measured: what the suites that compare methods
// have a row of. And the loop over sizes, variants and methods that they share.

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "headless/bench/spread.h"
#include "headless/command_line.h"
#include "sim_cuda/core/launch_shape.h"
#include "ui/chart.h"

namespace collidoscope {

struct MethodRow {
  std::string method, variant;
  std::int64_t bodies = 0, pairs = 0, bytes = 0;  ///< bytes: of the method
  int launches = 0, repeats = 0;
  Spread whole;  ///< us, from positions to the ordered list of pairs
  struct Stage {
    std::string name;
    double median_us;
    int launches;
    bool own_shape;
  };
  std::vector<Stage> stages;  ///< of other repeats, timed apart

  /// What any method must move: positions and radii read, boxes written and read, pairs written.
  std::int64_t floor_bytes() const { return bodies * (16 + 2 * 24) + pairs * 4; }
};

MethodRow measure_method(const Scene& scene, const RunOptions& options, int repeats);
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

/// Every size x variant x method that the line asks for, on the scene's one generator. `sizes`: where it
/// names none; and `methods`: all. Leaves out what tests nearly all pairs where that takes minutes. Throws
/// InputError for a scene without one generator.
struct SweepPoint {
  Scene scene;
  RunOptions run;
};
void sweep(const CommandLine& line, std::vector<std::int64_t> sizes, std::vector<std::string> methods,
           const std::function<void(const SweepPoint&)>& visit);

}  // namespace collidoscope
