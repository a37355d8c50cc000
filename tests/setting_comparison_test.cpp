// Tests `tune --over`: comparison of settings by pairs of steps, and by their error. Same tests on CPU and
// CUDA.

#include "sim_cuda/tuning/setting_comparison.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "sim_cuda/scene/broad_phase_methods.h"
#include "tests/executors.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using testing::HasSubstr;

class SettingComparisons : public OnEachExecutor {};
ON_EACH_EXECUTOR(SettingComparisons);

Scene compared_scene() {
  Scene scene = box_collider(120);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.3;
  return scene;
}

const ComparedSetting& row_of(const SettingComparison& comparison, const std::string& axis,
                              const std::string& value) {
  const auto found = std::ranges::find_if(
      comparison.rows, [&](const ComparedSetting& row) { return row.axis == axis && row.value == value; });
  if (found == comparison.rows.end()) throw std::runtime_error("no row " + axis + ' ' + value);
  return *found;
}

TEST_P(SettingComparisons, KeepTheStateWithEveryMethod) {
  World world(compared_scene(), options());
  world.step(10);
  const std::uint64_t hash = world.state_hash();
  const auto choices = setting_choices(world, {"broad-phase", "key-bits", "sort", "cpu-threads"});
  EXPECT_GE(choices.size(), broad_phase_names(GetParam()).size() - 1 + 3 + 2);
  double last = 0;
  const SettingComparison result = compare_settings(world, choices, 1, [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_DOUBLE_EQ(last, 1);
  ASSERT_EQ(result.rows.size(), choices.size());
  for (const ComparedSetting& row : result.rows) {
    EXPECT_EQ(row.unavailable_reason, "") << row.value;
    EXPECT_EQ(row.difference, "") << row.value;
    EXPECT_GE(row.estimate.pairs, 6) << row.value;
    EXPECT_TRUE(std::isfinite(row.estimate.high));
    EXPECT_GT(row.ms, 0);
    EXPECT_FALSE(std::isfinite(row.error));
  }
  EXPECT_EQ(world.state_hash(), hash) << "the run is only read";
}

TEST_P(SettingComparisons, ReportAnotherState) {
  World world(compared_scene(), options());
  world.step(30);
  SettingChoice planted{"sort", "planted", world.scene(), world.options(), true};
  planted.scene.physics.gravity *= 1.01;
  const SettingComparison result = compare_settings(world, {planted}, 1, [](double) {});
  EXPECT_THAT(result.rows[0].difference, HasSubstr("expected"));
  EXPECT_EQ(result.rows[0].estimate.pairs, 6);
}

/// A planet on its orbit: the integrator is of second order, so half a step has a quarter of the error. Times
/// are not compared: on a loaded machine, two substeps of two bodies may take less than one.
TEST_P(SettingComparisons, ShowWhatAccuracyCosts) {
  World world(project_scene("analytic/orbit"), options());
  const SettingComparison result =
      compare_settings(world, setting_choices(world, {"substeps", "precision"}), 60, [](double) {});
  EXPECT_EQ(result.error_unavailable, "");
  ASSERT_EQ(world.substeps(), 1);
  double error = result.reference_error;
  for (const char* substeps : {"2", "4", "8", "16"}) {
    const ComparedSetting row = row_of(result, "substeps", substeps);
    EXPECT_NEAR(error / row.error, 4, 0.1) << substeps;
    EXPECT_GE(row.estimate.pairs, 6) << substeps;
    EXPECT_GT(row.ms, 0) << substeps;
    error = row.error;
  }
  EXPECT_LT(result.error_resolution, 1e-3 * error);
  EXPECT_NEAR(row_of(result, "precision", "f32").error, result.reference_error,
              0.01 * result.reference_error);
}

TEST_P(SettingComparisons, GiveTheReasonOfASettingThatTheSceneCannotHave) {
  World world(compared_scene(), options());
  const SettingComparison result =
      compare_settings(world, setting_choices(world, {"solver"}), 1, [](double) {});
  EXPECT_THAT(row_of(result, "solver", "impulse").unavailable_reason, HasSubstr("friction"));
  EXPECT_EQ(row_of(result, "solver", "jacobi_split").unavailable_reason, "");
}

TEST(TuneOver, WritesTableAndJson) {
  const Outcome outcome =
      run_headless({"tune", "box_collider", "--bodies", "100", "--executor", "cpu", "--steps", "5", "--over",
                    "sort,iterations", "--budget", "4", "--json", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["state"], 5);
  ASSERT_EQ(report["settings"].size(), 2 + 3u);
  EXPECT_EQ(report["settings"][0]["value"], "library");
  EXPECT_EQ(report["settings"][0]["keeps_result"], true);
  EXPECT_FALSE(report["settings"][0].contains("error"));
  EXPECT_TRUE(report["settings"][4].contains("error"));
  const Outcome table = run_headless(
      {"tune", "box_collider", "--bodies", "100", "--executor", "cpu", "--over", "sort", "--budget", "1"});
  ASSERT_EQ(table.status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("radix"));
  EXPECT_THAT(table.out, HasSubstr(" pairs\n"));
}

TEST(TuneCommand, ComparesItsChoiceWithAllShapes) {
  const Outcome outcome = run_headless({"tune", "box_collider", "--bodies", "40", "--executor", "cpu",
                                        "--budget", "2", "--brute-force", "--json", "-"});
  ASSERT_LE(outcome.status, 1) << outcome.err;
  const auto all = nlohmann::json::parse(outcome.out)["brute_force"];
  EXPECT_GT(all["shapes"], 4);
  EXPECT_EQ(all["over_chosen"]["pairs"], 41);
  EXPECT_EQ(all["agrees"], outcome.status == 0);
}

TEST(TuneOver, RefusesWhatItCannotCompare) {
  const Outcome unknown = run_headless({"tune", "box_collider", "--over", "sorting"});
  EXPECT_EQ(unknown.status, 2);
  EXPECT_EQ(unknown.err,
            "--over: unknown setting \"sorting\"; expected broad-phase, key-bits, sort, cpu-threads, solver, "
            "substeps, iterations or precision\n");
  const Outcome none = run_headless({"tune", "box_collider", "--bodies", "20", "--executor", "cpu",
                                     "--broad-phase", "brute_force", "--over", "key-bits"});
  EXPECT_EQ(none.status, 2);
  EXPECT_EQ(none.err, "--over: this run has no other value of these settings\n");
  const Outcome picture = run_headless({"tune", "box_collider", "--over", "sort", "--picture", "map.png"});
  EXPECT_EQ(picture.status, 2);
  EXPECT_EQ(picture.err, "--picture: not with --over, which measures no map\n");
}

}  // namespace
}  // namespace collidoscope
