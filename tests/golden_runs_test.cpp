// Tests runs of the program against committed state hashes: every effect, solver and precision, sleeping
// bodies, and runs that continue from snapshots of an older version. The values are those of commit 8efde11.
// UPDATE_GOLDENS=1 writes new values, for an announced change of the physics.

#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "sim_cuda/scene/names.h"
#include "sim_cuda/snapshot/snapshot.h"
#include "tests/executors.h"
#include "tests/golden_files.h"
#include "tests/run_program.h"

namespace collidoscope {
namespace {

using nlohmann::ordered_json;

ordered_json committed_runs() {
  std::ifstream in(golden_file<"runs.json">());
  return ordered_json::parse(in);
}

/// Writes one row per line.
void write(const ordered_json& golden) {
  std::ofstream out(golden_file<"runs.json">());
  const char* before = "{";
  for (const auto& [list, rows] : golden.items()) {
    out << before << '"' << list << "\": [";
    for (std::size_t k = 0; k < rows.size(); ++k) out << (k == 0 ? "\n" : ",\n") << rows[k].dump();
    out << "\n]";
    before = ",\n";
  }
  out << "}\n";
}

std::vector<std::string> words_of(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Hash and number of sleeping bodies of a run with `arguments`, in the form of a row.
ordered_json result_of(std::vector<std::string> arguments, ExecutorKind executor) {
  arguments.insert(arguments.begin(), "run");
  for (const char* more : {"--executor", executor == ExecutorKind::cuda ? "cuda" : "cpu", "--json", "-"})
    arguments.emplace_back(more);
  const Outcome outcome = run_headless(arguments);
  if (outcome.status != 0) return {{"error", outcome.err}};
  const ordered_json report = ordered_json::parse(outcome.out);
  return {{"state_hash", report["state_hash"]},
          {"asleep", report.contains("sleep") ? report["sleep"]["asleep"] : ordered_json(0)}};
}

class GoldenRuns : public OnEachExecutor {
 protected:
  /// Compares the rows of one list of the file. `arguments` returns the command line of a row.
  template <class Arguments>
  void check(const char* list, const Arguments& arguments) {
    const bool update = std::getenv("UPDATE_GOLDENS") != nullptr && GetParam() == ExecutorKind::cpu;
    ordered_json golden = committed_runs();
    ASSERT_FALSE(golden.at(list).empty());
    for (ordered_json& row : golden.at(list)) {
      const ordered_json result = result_of(arguments(row), GetParam());
      if (update)
        row.update(result);
      else
        for (const auto& [name, value] : result.items())
          EXPECT_EQ(row.value(name, ordered_json()), value) << row;
    }
    if (update) write(golden);
  }
};
ON_EACH_EXECUTOR(GoldenRuns);

TEST_P(GoldenRuns, OfEveryEffectSolverAndPrecision) {
  check("runs", [](const ordered_json& row) { return words_of(row.at("run")); });
}

TEST_P(GoldenRuns, GoOnFromSnapshotsOfAnOlderVersion) {
  // Listed individually, so that the list of read files is complete.
  const std::map<std::string, std::filesystem::path> files{
      {"impulse", golden_file<"8efde11_impulse.snapshot">()},
      {"soft_step", golden_file<"8efde11_soft_step.snapshot">()},
      {"jacobi_split", golden_file<"8efde11_jacobi_split.snapshot">()},
      {"joints", golden_file<"8efde11_joints.snapshot">()},
      {"sleeping", golden_file<"8efde11_sleeping.snapshot">()}};
  for (const auto& [solver, file] : files)
    EXPECT_EQ(read_snapshot(file.string()).physics_version, 1) << solver << ": a file without the number";
  check("snapshots", [&](const ordered_json& row) {
    return std::vector<std::string>{"--load", files.at(row.at("snapshot")).string(), "--steps",
                                    std::to_string(row.at("steps").get<int>())};
  });
  EXPECT_EQ(committed_runs().at("snapshots").size(), files.size());
}

TEST(GoldenRunsFile, HoldsEveryEffectSolverPrecisionAndSleepingBodies) {
  std::set<std::string> seen;
  const ordered_json golden = committed_runs();
  for (const ordered_json& row : golden.at("runs")) {
    const std::string solver = row.at("solver"), precision = row.at("precision");
    for (const ordered_json& effect : row.at("effects"))
      seen.insert(effect.get<std::string>() + ' ' + solver + ' ' + precision);
    if (row.at("asleep") > 0) seen.insert("asleep " + solver + ' ' + precision);
  }
  // The scene reader refuses effects that impulse does not have.
  const std::set<std::string> of_impulse{"gravity", "drag", "rotation", "guards"};
  for (const auto& solver : solver_names)
    for (const auto& precision : precision_names) {
      const std::string with = ' ' + std::string(solver.name) + ' ' + std::string(precision.name);
      for (const EffectName& effect : effect_names) {
        if (solver.value == Solver::impulse && !of_impulse.contains(std::string(effect.name))) continue;
        EXPECT_TRUE(seen.contains(std::string(effect.name) + with)) << effect.name << with;
      }
      if (solver.value != Solver::impulse) {
        EXPECT_TRUE(seen.contains("asleep" + with)) << with;
      }
    }
}

}  // namespace
}  // namespace collidoscope
