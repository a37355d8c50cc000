// Tests `tune SCENE` through the real program, and its outputs for a real search with a planted wrong hash.

#include "headless/tune.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "headless/tuning/launch_map.h"
#include "headless/tuning/tuner_files.h"
#include "tests/executors.h"
#include "tests/run_program.h"
#include "tests/scenes.h"
#include "viewer/render/image.h"

namespace collidoscope {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::vector<std::string> tune(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{"tune",    "box_collider", "--bodies", "200",      "--executor",
                                     "cpu",     "--steps",      "2",        "--budget", "1",
                                     "--tuned", "off"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

TEST(TuneCommand, WritesTheSameNumbersToAllFiles) {
  const TemporaryFolder folder;
  const Outcome run = run_headless(tune({"--json", folder / "r.json", "--picture", folder / "r.png",
                                         "--kernel-tuner", folder / "k.json", "--t4", folder / "t4.json"}));
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(folder.files(), 4u);
  EXPECT_GT(read_png(folder / "r.png").width, 1000);
  const json report = json::parse(text_of(folder / "r.json")),
             cache = json::parse(text_of(folder / "k.json")), t4 = json::parse(text_of(folder / "t4.json"));
  EXPECT_EQ(cache["device_name"], report["device"]);
  EXPECT_EQ(t4["metadata"]["executor"], "cpu");
  EXPECT_EQ(cache["problem_size"][0], report["bodies"]);
  std::size_t measured = 0;
  for (const json& cell : report["cells"]) {
    if (cell["state"] != "measured") continue;
    const json& entry = cache["cache"].at(std::to_string(cell["blocks"].get<int>()) + "," +
                                          std::to_string(cell["threads"].get<int>()));
    EXPECT_EQ(entry["time"], cell["ms"]);
    EXPECT_EQ(entry["ratio"], cell["ratio"]["ratio"]);
    EXPECT_EQ(entry["times"].size(), cell["ratio"]["pairs"]);
    EXPECT_GT(entry["benchmark_time"], 0);
    EXPECT_GT(entry["framework_time"], 0);
    const json& result = t4["results"][measured++];
    EXPECT_EQ(result["configuration"], json({{"blocks", cell["blocks"]}, {"threads", cell["threads"]}}));
    EXPECT_EQ(result["measurements"][0]["value"], cell["ms"]);
    EXPECT_EQ(result["times"]["runtimes"], entry["times"]);
  }
  EXPECT_GT(measured, 1u) << "one shape cannot be mixed up with another";
  EXPECT_EQ(t4["results"].size(), measured);
  EXPECT_EQ(cache["cache"].size(), measured);
}

TEST(TuneCommand, ConfirmsWithAsManyPairsAsAsked) {
  const Outcome run =
      run_headless({"tune", "box_collider", "--bodies", "20", "--executor", "cpu", "--steps", "2", "--budget",
                    "20", "--tuned", "off", "--confirmation-pairs", "73", "--json", "-"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(json::parse(run.out)["chosen"]["confirmation"]["pairs"], 73);
  EXPECT_EQ(run_headless(tune({"--confirmation-pairs", "5"})).status, 2);
}

TEST(TuneCommand, RefusesFilesThatCannotBeWrittenBeforeItMeasures) {
  for (const char* flag : {"--json", "--picture", "--kernel-tuner", "--t4"}) {
    const Outcome run = run_headless(tune({flag, "/no/such/folder/file"}));
    EXPECT_EQ(run.status, 2) << flag;
    EXPECT_THAT(run.err, testing::StartsWith(std::string(flag) + ": "));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_EQ(run.out, "");
    EXPECT_EQ(run_headless(tune({flag, ""})).status, 2) << flag;
  }
}

/// Each file keeps its old content if the new one does not fit.
TEST(TuneCommand, KeepsOldFilesOnAFullDisk) {
  for (const char* flag : {"--picture", "--kernel-tuner", "--t4"}) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "old";
    const Outcome run = run_headless(tune({flag, folder / "file"}), Launch{.max_file_bytes = 2000});
    EXPECT_EQ(run.status, 3) << flag << run.err;
    EXPECT_THAT(run.err, HasSubstr("file"));
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    EXPECT_EQ(text_of(folder / "file"), "old") << flag;
    EXPECT_EQ(folder.files(), 1u) << flag;
  }
}

class TuneOutputs : public OnEachExecutor {};
ON_EACH_EXECUTOR(TuneOutputs);

/// Ctrl-C keeps the measurements in the --json file, and the same command goes on from there.
TEST_P(TuneOutputs, GoOnAfterCtrlC) {
  const TemporaryFolder folder;
  const std::string file = folder / "r.json";
  // So many pairs take longer than the budget.
  const std::vector<std::string> arguments{"tune",
                                           "box_collider",
                                           "--bodies",
                                           "500",
                                           "--executor",
                                           this->options().executor == ExecutorKind::cuda ? "cuda" : "cpu",
                                           "--budget",
                                           "4",
                                           "--tuned",
                                           "off",
                                           "--json",
                                           file,
                                           "--confirmation-pairs",
                                           "10000"};
  json kept;
  // ms; a busy machine starts slowly
  for (int wait = 1000; kept["tasks"].empty() && wait < 60000; wait *= 2) {
    const Outcome stopped = run_headless(arguments, Launch{.interrupt_after_ms = wait});
    ASSERT_EQ(stopped.status, 128 + SIGINT) << stopped.err;
    if (!std::filesystem::exists(file)) continue;
    EXPECT_THAT(stopped.err, HasSubstr("run the same command again to continue from "));
    kept = json::parse(text_of(file));
    EXPECT_EQ(kept["complete"], false);
  }
  ASSERT_GT(kept["tasks"].size(), 0u);

  const Outcome other = run_headless(tune({"--json", file}));
  ASSERT_EQ(other.status, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("another search"));

  std::ofstream(file) << kept.dump();
  const Outcome run = run_headless(arguments);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("already has "));
  const json whole = json::parse(text_of(file));
  EXPECT_EQ(whole["complete"], true);
  EXPECT_GE(whole["seconds"].get<double>(), kept["seconds"].get<double>());
  std::map<std::size_t, std::size_t> pairs;  // by cell; the last tasks may be those of the confirmation
  for (const json& task : kept["tasks"])
    if (task["hurried"] == false) pairs[task["cell"].get<std::size_t>()] += task["pairs"].size();
  for (const auto& [cell, count] : pairs)
    EXPECT_GE(whole["cells"][cell]["ratio"]["pairs"].get<std::size_t>(), count) << cell;

  // Damaged progress is ignored, and the search starts again.
  json damaged = kept;
  damaged["tasks"][0]["pairs"][0]["ms"] = -1;
  for (const std::string& text : {damaged.dump(), kept.dump().substr(0, 300), std::string("{}")}) {
    std::ofstream(file) << text;
    const Outcome again = run_headless(tune({"--json", file}));
    EXPECT_EQ(again.status, 0) << again.err;
    EXPECT_EQ(json::parse(text_of(file))["complete"], true);
  }
}

TEST_P(TuneOutputs, ShowAShapeWithAnotherHash) {
  Scene scene = box_collider(300);
  World world(scene, options());
  LaunchTuner tuner(world, 1.5);
  tuner.set_hash([](World& one) { return one.state_hash() ^ (one.launch_shape().threads == 64 ? 1u : 0u); });
  while (!tuner.done()) tuner.advance(50);
  const TunedRun run = tuned_run(world, tuner);
  std::size_t wrong = 0;
  for (const LaunchCell& cell : tuner.search().cells()) wrong += cell.state == LaunchCell::State::wrong;
  ASSERT_GT(wrong, 0u);

  std::size_t crossed = 0;
  const HeatMap map = launch_map(run, tuner.search());
  for (const HeatCell& cell : map.cells) {
    if (cell.kind != HeatCell::Kind::crossed) continue;
    ++crossed;
    EXPECT_EQ(cell.y, 64);
  }
  EXPECT_EQ(crossed, wrong);
  std::size_t cached = 0;
  const json cache = json::parse(kernel_tuner_cache(run, tuner.search()))["cache"];
  for (const json& entry : cache) {
    if (!entry.contains("__error__")) continue;
    ++cached;
    EXPECT_EQ(entry["threads"], 64);
    EXPECT_THAT(entry["reason"], HasSubstr("wrong hash: state "));
    EXPECT_GT(entry["verification_time"], 0);
  }
  EXPECT_EQ(cached, wrong);
  std::size_t incorrect = 0;
  const json t4 = json::parse(t4_results(run, tuner.search()));
  for (const json& result : t4["results"]) {
    if (result["invalidity"] != "correctness") continue;
    ++incorrect;
    EXPECT_EQ(result["configuration"]["threads"], 64);
    EXPECT_EQ(result["correctness"], 0);
    EXPECT_THAT(result["measurements"][0]["value"], HasSubstr("expected"));
  }
  EXPECT_EQ(incorrect, wrong);
}

TEST_P(TuneOutputs, MarkThePlaceOfTheReference) {
  RunOptions shaped = options();
  shaped.shape = {4, 64};
  World world(box_collider(100), shaped);
  LaunchTuner tuner(world, 0.3);
  while (!tuner.done()) tuner.advance(50);
  const TunedRun run = tuned_run(world, tuner);
  ASSERT_TRUE(run.reference_place);
  EXPECT_EQ(run.reference_place->shape, shaped.shape);
  EXPECT_EQ(run.reference_place->stage, "");
  World automatic(box_collider(100), options());
  LaunchTuner other(automatic, 0.3);
  while (!other.done()) other.advance(50);
  const TunedRun of_auto = tuned_run(automatic, other);
  EXPECT_EQ(of_auto.reference_place.has_value(), automatic.info().on_gpu);
  EXPECT_EQ(of_auto.executor, automatic.info().on_gpu ? "cuda" : "cpu");
}

}  // namespace
}  // namespace collidoscope
