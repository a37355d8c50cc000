#include "headless/tuning/tuner_files.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

namespace collidoscope {
namespace {

using TunerJson = nlohmann::ordered_json;

bool is_valid(const LaunchCell& cell) { return cell.state == LaunchCell::State::measured; }

bool was_tried(const LaunchCell& cell) {
  return is_valid(cell) || cell.state == LaunchCell::State::infeasible ||
         cell.state == LaunchCell::State::wrong;
}

/// ISO 8601 in UTC; empty if the cell was never measured.
std::string timestamp(const CellTimes& times) {
  if (times.measured_at == std::chrono::system_clock::time_point{}) return "";
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(times.measured_at)));
}

TunerJson configuration(LaunchShape shape) { return {{"blocks", shape.blocks}, {"threads", shape.threads}}; }

/// Calls `take` with each cell that was tried, and its times.
template <class Take>
void for_each_tried(const TunedRun& run, const LaunchSearch& search, const Take& take) {
  for (std::size_t k = 0; k < search.cells().size(); ++k)
    if (was_tried(search.cells()[k]))
      take(search.cells()[k], k < run.cell_times.size() ? run.cell_times[k] : CellTimes{});
}

/// "time", "ratio" and its interval as far as it is known.
std::vector<std::pair<std::string, double>> measurements(const TunedRun& run, const LaunchCell& cell) {
  const RatioEstimate ratio = cell.estimate();
  std::vector<std::pair<std::string, double>> list{{"time", typical_ms(run, cell)}, {"ratio", ratio.ratio}};
  if (std::isfinite(ratio.high)) {
    list.emplace_back("ratio_low", ratio.low);
    list.emplace_back("ratio_high", ratio.high);
  }
  return list;
}

}  // namespace

std::string kernel_tuner_cache(const TunedRun& run, const LaunchSearch& search) {
  std::set<int> blocks, threads;
  TunerJson entries = TunerJson::object();
  for_each_tried(run, search, [&](const LaunchCell& cell, const CellTimes& times) {
    blocks.insert(cell.shape.blocks);
    threads.insert(cell.shape.threads);
    TunerJson entry = configuration(cell.shape);
    if (is_valid(cell)) {
      for (const auto& [name, value] : measurements(run, cell)) entry[name] = value;
      entry["times"] = cell.ms;
    } else {
      // Kernel Tuner has no other class for a wrong result.
      entry["time"] = entry["__error__"] = "RuntimeFailedConfig";
      entry["reason"] = fmt::format("{}: {}", name_of(cell.state), cell.reason);
    }
    entry["compile_time"] = 0;  // kernels are compiled with the program
    entry["verification_time"] = times.check;
    entry["benchmark_time"] = times.benchmark;
    entry["strategy_time"] = times.search;
    entry["framework_time"] = times.setup;
    entry["timestamp"] = timestamp(times);
    entries[fmt::format("{},{}", cell.shape.blocks, cell.shape.threads)] = std::move(entry);
  });
  TunerJson file{{"schema_version", "1.0.0"},
                 {"device_name", run.device},
                 {"kernel_name", fmt::format("{}, step after state {}", run.scene, run.state)},
                 {"problem_size", {run.bodies}},
                 {"tune_params_keys", {"blocks", "threads"}},
                 {"tune_params", {{"blocks", blocks}, {"threads", threads}}},
                 {"objective", "time"}};
  // Kernel Tuner appends to the file, so the cache is the last member.
  file["cache"] = std::move(entries);
  return file.dump(1) + '\n';
}

std::string t4_results(const TunedRun& run, const LaunchSearch& search) {
  TunerJson results = TunerJson::array();
  for_each_tried(run, search, [&](const LaunchCell& cell, const CellTimes& times) {
    TunerJson values = TunerJson::array();
    if (is_valid(cell)) {
      for (const auto& [name, value] : measurements(run, cell))
        values.push_back({{"name", name}, {"value", value}, {"unit", name == "time" ? "ms" : ""}});
    } else {
      values.push_back({{"name", "reason"}, {"value", cell.reason}, {"unit", ""}});
    }
    const char* invalidity = is_valid(cell)                                ? "correct"
                             : cell.state == LaunchCell::State::infeasible ? "runtime"
                                                                           : "correctness";
    results.push_back({{"timestamp", timestamp(times)},
                       {"configuration", configuration(cell.shape)},
                       {"objectives", TunerJson::array({"time"})},
                       {"times",
                        {{"compilation_time", 0},  // kernels are compiled with the program
                         {"runtimes", is_valid(cell) ? cell.ms : std::vector<double>{}},
                         {"framework", times.setup},
                         {"benchmark", times.benchmark},
                         {"search_algorithm", times.search},
                         {"validation", times.check}}},
                       {"invalidity", invalidity},
                       {"correctness", is_valid(cell) ? 1 : 0},
                       {"measurements", std::move(values)}});
  });
  return TunerJson{{"schema_version", "1.0.0"},
                   {"results", std::move(results)},
                   {"metadata",
                    {{"timeunit", "milliseconds"},
                     {"scene", run.scene},
                     {"bodies", run.bodies},
                     {"state", run.state},
                     {"device", run.device},
                     {"executor", run.executor},
                     {"broad_phase", run.broad_phase},
                     {"physics_version", run.physics_version},
                     {"reference", shape_text(run.reference)},
                     {"reference_time", run.reference_ms}}}}
             .dump(1) +
         '\n';
}

}  // namespace collidoscope
