// Tests results of `tune` that *auto* uses: which result fits a run, their file, and that only shapes change.

#include "sim_cuda/core/tuned_shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "headless/cli/tuned_option.h"
#include "sim_cuda/accuracy/problem.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/tuning/paired_steps.h"
#include "sim_cuda/tuning/tuned_file.h"
#include "sim_cuda/world.h"
#include "tests/executors.h"
#include "tests/run_program.h"
#include "tests/scenes.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TunedShapes tuned_result_of(const TuningConditions& conditions, double low = 0.9, double high = 0.95) {
  TunedShapes result;
  result.conditions = conditions;
  result.ratio = {.ratio = 0.5 * (low + high), .low = low, .high = high, .pairs = 41};
  result.stages = {{"solve", {3, 32}}, {"integrate", {5, 64}}, {"no such stage", {1, 1}}};
  return result;
}

void keep(const std::string& file, const TunedShapes& result) {
  const std::string text = with_tuned(file, result);
  std::ofstream(file) << text;
}

const TuningConditions known{"D", "580", "B", 4, "lbvh_ropes", "impulse", "f32", {"gravity"}, 1000, "S"};

TEST(TunedChoices, NeedTheSameConditions) {
  const std::vector<TunedShapes> results{tuned_result_of(known)};
  EXPECT_EQ(choose_tuned(results, known).used, results.data());
  EXPECT_EQ(choose_tuned(results, known).rejection, "");
  const auto rejection = [&](auto change) {
    TuningConditions now = known;
    change(now);
    const TunedChoice choice = choose_tuned(results, now);
    EXPECT_EQ(choice.used, nullptr);
    return choice.rejection;
  };
  using C = TuningConditions;
  EXPECT_EQ(rejection([](C& c) { c.driver = "590"; }), "driver was 580, is 590");
  EXPECT_EQ(rejection([](C& c) { c.build = "C"; }), "build was B, is C");
  EXPECT_EQ(rejection([](C& c) { c.cpu_threads = 2; }), "number of CPU threads was 4, is 2");
  EXPECT_EQ(rejection([](C& c) { c.broad_phase = "ploc"; }), "broad phase was lbvh_ropes, is ploc");
  EXPECT_EQ(rejection([](C& c) { c.solver = "soft_step"; }), "solver was impulse, is soft_step");
  EXPECT_EQ(rejection([](C& c) { c.precision = "f64"; }), "precision was f32, is f64");
  EXPECT_EQ(rejection([](C& c) { c.effects.clear(); }), "list of effects was gravity, is none");
  EXPECT_EQ(rejection([](C& c) { c.bodies = 2001; }), "number of bodies was 1000, is 2001");
  EXPECT_EQ(rejection([](C& c) { c.bodies = 499; }), "number of bodies was 1000, is 499");
  EXPECT_EQ(rejection([](C& c) { c.device = "E"; }), "") << "defaults of other devices are not worth a line";
}

TEST(TunedChoices, OfANamedFileAreRejectedWithAReasonOnAnyDevice) {
  std::vector<TunedShapes> results{tuned_result_of(known)};
  results[0].named_by_user = true;
  TuningConditions now = known;
  now.device = "E";
  EXPECT_EQ(choose_tuned(results, now).rejection, "device was D, is E");
}

TEST(TunedChoices, PreferTheSceneThenTheSize) {
  const auto of = [](std::int64_t bodies, const char* scene, double high) {
    TuningConditions conditions = known;
    conditions.bodies = bodies;
    conditions.scene = scene;
    return tuned_result_of(conditions, 0.9, high);
  };
  const std::vector<TunedShapes> results{of(700, "S", 0.95), of(1900, "S", 0.95), of(1000, "T", 0.95),
                                         of(1000, "U", 1.01)};
  const auto used = [&](std::int64_t bodies, const char* scene) {
    TuningConditions now = known;
    now.bodies = bodies;
    now.scene = scene;
    const TunedShapes* const found = choose_tuned(results, now).used;
    return found != nullptr ? found - results.data() : -1;
  };
  EXPECT_EQ(used(1000, "S"), 0) << "this scene, although another has the same size";
  EXPECT_EQ(used(1300, "S"), 1);
  EXPECT_EQ(used(1000, "T"), 2);
  EXPECT_EQ(used(1000, "U"), -1) << "plain auto is as fast";
  EXPECT_EQ(used(1000, "V"), -1) << "one of two equally near ones is that plain auto is as fast";
  EXPECT_EQ(used(1800, "V"), 1);
}

TEST(TunedFiles, AreReadAsWritten) {
  TuningConditions other = known;
  other.effects = {};
  other.driver = "";
  std::vector<TunedShapes> results{tuned_result_of(known), tuned_result_of(other, 0.99, 1.1)};
  results[1].shape = {264, 128};
  results[1].data = "results/t.json";
  const TemporaryFolder folder;
  std::ofstream(folder / "t") << write_tuned(results);
  const std::vector<TunedShapes> read = read_tuned(folder / "t");
  ASSERT_EQ(read.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(read[k].conditions, results[k].conditions);
    EXPECT_EQ(read[k].shape, results[k].shape);
    EXPECT_EQ(read[k].stages, results[k].stages);
    EXPECT_EQ(read[k].data, results[k].data);
    EXPECT_EQ(read[k].ratio.high, results[k].ratio.high);
    EXPECT_EQ(read[k].ratio.pairs, 41);
  }
  keep(folder / "t", tuned_result_of(other, 0.5, 0.6));
  keep(folder / "new", tuned_result_of(other));
  const std::vector<TunedShapes> kept = read_tuned(folder / "t");
  ASSERT_EQ(kept.size(), 2u) << "a result with the same conditions is replaced";
  EXPECT_EQ(kept[1].ratio.high, 0.6);
  EXPECT_EQ(read_tuned(folder / "new").size(), 1u);
}

TEST(TunedFiles, SayWhatIsWrongWhere) {
  const TemporaryFolder folder;
  const std::string good = write_tuned({tuned_result_of(known)});
  const auto fault = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    std::ofstream(folder / "t") << text;
    try {
      read_tuned(folder / "t");
    } catch (const InputError& error) {
      return std::string(error.what()).substr((folder / "t").string().size());
    }
    return std::string("nothing");
  };
  EXPECT_EQ(fault("\"B\"", "\"B\""), "nothing");
  EXPECT_THAT(fault("collidoscope-tuned", "collidoscope"), HasSubstr(":2:13: "));
  EXPECT_THAT(fault("\"bodies\":1000,", ""), HasSubstr("\"bodies\" is missing"));
  EXPECT_THAT(fault("[5,64]", "[5,1025]"), HasSubstr("0 (auto) to 1024 threads"));
  EXPECT_THAT(fault("[5,64]", "[5.5,64]"), HasSubstr("blocks"));
  EXPECT_THAT(fault("[5,64]", "[-1,64]"), HasSubstr("blocks"));
  EXPECT_THAT(fault("[5,64]", "7"), HasSubstr("[B, T]"));
  EXPECT_THAT(fault("\"low\":0.9", "\"low\":2"), HasSubstr("low <= median"));
  EXPECT_THAT(fault("[\"gravity\"]", "[3]"), HasSubstr("must be the name of an effect"));
  EXPECT_THAT(fault("\"driver\"", "\"drivers\""), HasSubstr("drivers"));
  std::ofstream(folder / "t") << "{";
  EXPECT_THROW(read_tuned(folder / "t"), InputError);
}

class TunedRuns : public testing::TestWithParam<ExecutorKind> {
 protected:
  RunOptions options() const {
    RunOptions options;
    options.executor = GetParam();
    return options;
  }
  /// B and T of a stage; on the CPU, chunks and threads.
  static LaunchShape shape_of(World& world, const char* name) {
    const RunTimes times = world.latest_times();
    const auto stage = std::ranges::find(times.stages, name, &StageTime::name);
    EXPECT_NE(stage, times.stages.end()) << name;
    return {static_cast<int>(stage->launch.blocks), stage->launch.threads};
  }
};
ON_EACH_EXECUTOR(TunedRuns);

TEST_P(TunedRuns, HaveTheShapesAndTheSameState) {
  Scene scene = box_collider(400);
  scene.physics.solver = Solver::soft_step;
  scene.materials[0].friction = 0.5;
  World plain(scene, options());
  plain.step(20);
  RunOptions tuned = options();
  tuned.tuned_shapes = {tuned_result_of(plain.tuning_conditions())};
  World world(scene, tuned);
  world.step(20);
  EXPECT_EQ(world.state_hash(), plain.state_hash());
  EXPECT_THAT(world.info().tuned, HasSubstr("7.5 % ± 2.5 faster than plain auto, 41 pairs"));
  EXPECT_EQ(plain.info().tuned, "");
  RunOptions given = options();
  given.stage_shapes = {{"integrate", {5, 64}}};
  World expected(scene, given);
  expected.step(20);
  const LaunchShape tuned_shape = shape_of(expected, "integrate");
  EXPECT_EQ(shape_of(world, "integrate"), tuned_shape);
  EXPECT_NE(shape_of(plain, "integrate"), tuned_shape);
  EXPECT_EQ(shape_of(world, "relax"), shape_of(plain, "relax")) << "other stages stay automatic";
  EXPECT_EQ(world.launch_shape(), LaunchShape{}) << "it is still automatic";

  world.set_launch_shape({2, 96});
  world.step(2);
  EXPECT_NE(shape_of(world, "integrate"), tuned_shape) << "a given shape comes first";
  world.set_launch_shape({});
  world.step(2);
  plain.step(4);
  EXPECT_EQ(shape_of(world, "integrate"), tuned_shape);
  EXPECT_EQ(world.state_hash(), plain.state_hash());

  Scene fewer = scene;
  fewer.generators[0].count = 100;
  World small(fewer, tuned);
  EXPECT_EQ(small.info().tuned, "");
  EXPECT_EQ(small.info().tuned_rejection, "number of bodies was 400, is 100");
}

/// One of two compared runs might have a result, and the other not.
TEST_P(TunedRuns, AreNotCompared) {
  Scene scene = box_collider(100);
  const TuningConditions conditions = World(scene, options()).tuning_conditions();
  RunOptions tuned = options();
  tuned.tuned_shapes = {tuned_result_of(conditions)};
  World world(scene, tuned);
  ASSERT_NE(world.info().tuned, "");
  PairedSteps pair(world);
  EXPECT_EQ(pair.reference().info().tuned, "");
  EXPECT_EQ(pair.candidate().info().tuned, "");
  EXPECT_TRUE(make_accuracy_problem(scene, tuned, 0.1, nullptr).options.tuned_shapes.empty());
}

/// Another version of a kernel may need more registers than the one that was measured.
TEST_P(TunedRuns, IgnoreShapesThatAKernelCannotHave) {
  const Scene scene = box_collider(400);
  World plain(scene, options());
  plain.step(10);
  RunOptions tuned = options();
  TunedShapes result = tuned_result_of(plain.tuning_conditions());
  result.stages.clear();
  result.shape = {1, 1024};
  tuned.tuned_shapes = {result};
  World world(scene, tuned);
  world.step(10);
  EXPECT_EQ(world.state_hash(), plain.state_hash());
}

TEST(TunedFlag, IsUsedAndSaidAndCanBeOff) {
  const TemporaryFolder folder;
  RunOptions options;
  options.executor = ExecutorKind::cpu;
  Scene scene = read_scene(project_file("assets/scenes/box_collider.json"));
  scene.generators[0].count = 300;
  const World world(scene, options);
  keep(folder / "t", tuned_result_of(world.tuning_conditions()));
  const auto run = [&](const std::string& tuned, const std::string& bodies, bool as_json) {
    std::vector<std::string> arguments{"run", "box_collider", "--bodies", bodies,    "--executor",
                                       "cpu", "--steps",      "3",        "--tuned", tuned};
    if (as_json) arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = run_headless(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  const json used = json::parse(run(folder / "t", "300", true)), off = json::parse(run("off", "300", true)),
             other = json::parse(run(folder / "t", "900", true));
  EXPECT_THAT(used["tuned"].get<std::string>(), HasSubstr("with 300 bodies: 7.5 %"));
  EXPECT_TRUE(used["tuned_rejection"].is_null());
  EXPECT_TRUE(off["tuned"].is_null());
  EXPECT_TRUE(off["tuned_rejection"].is_null());
  EXPECT_EQ(used["state_hash"], off["state_hash"]);
  EXPECT_TRUE(other["tuned"].is_null());
  EXPECT_EQ(other["tuned_rejection"], "number of bodies was 300, is 900");
  EXPECT_THAT(run(folder / "t", "300", false), HasSubstr("auto, by tune: "));
  EXPECT_THAT(run(folder / "t", "900", false), HasSubstr("not used: number of bodies was 300, is 900\n"));

  EXPECT_EQ(run_headless({"run", "box_collider", "--tuned", folder / "none"}).status, 2);
  std::ofstream(folder / "bad") << "{}";
  const Outcome bad = run_headless({"run", "box_collider", "--tuned", folder / "bad"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_THAT(bad.err, HasSubstr("bad:1:1: "));
}

TEST(TunedFlag, OfTuneKeepsItsResult) {
  const TemporaryFolder folder;
  const std::vector<std::string> arguments{
      "tune", "box_collider", "--bodies", "200",     "--executor", "cpu",    "--steps",
      "2",    "--budget",     "2",        "--tuned", folder / "t", "--json", folder / "r.json"};
  const Outcome outcome = run_headless(arguments);
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("kept in " + (folder / "t").string()));
  const std::vector<TunedShapes> kept = read_tuned(folder / "t");
  ASSERT_EQ(kept.size(), 1u);
  EXPECT_EQ(kept[0].conditions.bodies, 200);
  for (const char* content : {"{}", "no JSON"}) {
    std::ofstream(folder / "bad") << content;
    std::vector<std::string> other = arguments;
    std::ranges::replace(other, (folder / "t").string(), (folder / "bad").string());
    const Outcome refused = run_headless(other);
    EXPECT_EQ(refused.status, 2) << "before it measures";
    EXPECT_EQ(refused.out, "");
    EXPECT_EQ(text_of(folder / "bad"), content);
  }
  const json report = json::parse(text_of(folder / "r.json"));
  EXPECT_EQ(report["tuned"]["ratio"]["median"], kept[0].ratio.ratio);
  const json run = json::parse(run_headless({"run", "box_collider", "--bodies", "200", "--executor", "cpu",
                                             "--steps", "2", "--tuned", folder / "t", "--json", "-"})
                                   .out);
  EXPECT_NE(run["tuned"].is_null(), run["tuned_rejection"].is_null()) << "used, or plain auto is as fast";
}

/// The committed defaults are those of the committed measurements.
/// The window does not try the file before it measures.
TEST(TunedFlag, NamesTheFileOfTheWindowToo) {
  const TemporaryFolder folder;
  Options options;
  options.run.executor = ExecutorKind::cpu;
  options.tuned = folder / "t";
  World world(box_collider(20), options.run);
  LaunchTuner tuner(world, 60);
  while (!tuner.done()) tuner.advance(100);
  EXPECT_THAT(keep_result(options, nullptr, world, tuner), HasSubstr("kept in " + options.tuned));
  EXPECT_EQ(read_tuned(options.tuned).size(), 1u);
  options.tuned = folder / "t" / "in_a_file";
  EXPECT_THAT(keep_result(options, nullptr, world, tuner), testing::StartsWith("not kept: "));
  options.tuned = "off";
  EXPECT_EQ(keep_result(options, nullptr, world, tuner), "");
}

TEST(TunedFiles, OfTheAssetsAreTheCommittedMeasurements) {
  const std::vector<TunedShapes> results = read_tuned(project_file("assets/tuned.json"));
  EXPECT_GE(results.size(), 10u);
  for (const TunedShapes& result : results) {
    SCOPED_TRACE(result.data);
    const json report = json::parse(text_of(project_file("assets/" + result.data)));
    EXPECT_EQ(report["device"], result.conditions.device);
    EXPECT_EQ(report["bodies"], result.conditions.bodies);
    EXPECT_EQ(report["scene"], result.conditions.scene);
    EXPECT_EQ(report["broad_phase"], result.conditions.broad_phase);
    EXPECT_THAT(result.conditions.build, testing::EndsWith(report["physics_version"].dump()));
    const json& by_stage = report["stage_shapes"];
    const json& source = result.stages.empty() ? report["chosen"]["confirmation"] : by_stage["confirmation"];
    EXPECT_EQ(source["ratio"], result.ratio.ratio);
    EXPECT_EQ(source["high"], result.ratio.high);
    std::string flag;
    for (const auto& [stage, shape] : result.stages)
      flag += (flag.empty() ? "" : ",") + stage + "=" + std::to_string(shape.blocks) + "x" +
              std::to_string(shape.threads);
    if (result.stages.empty())
      EXPECT_EQ(json({result.shape.blocks, result.shape.threads}),
                json({report["chosen"]["blocks"], report["chosen"]["threads"]}));
    else
      EXPECT_EQ(by_stage["flag"], flag);
  }
}

}  // namespace
}  // namespace collidoscope
