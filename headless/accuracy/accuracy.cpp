#include "headless/accuracy/accuracy.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <optional>

#include "headless/accuracy/analytic_suite.h"
#include "headless/accuracy/study_report.h"
#include "headless/cli/interrupt_handler.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/result_files.h"
#include "sim_cuda/accuracy/problem.h"
#include "sim_cuda/accuracy/study.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/scene/text_file.h"

namespace collidoscope {
namespace {

/// Makes the scene's spheres start apart, if the user did not choose a spawn and there is room. The study
/// then has an exact reference, which gives the most reliable errors.
void start_apart(const CommandLine& line, Scene& scene) {
  const bool overlapping = std::ranges::any_of(scene.generators, [](const BoxCollider& g) {
    return g.spawn != Spawn::apart && g.variant != Variant::settled;
  });
  if (!overlapping || line.options.overrides.settings.has<&BoxCollider::spawn>()) return;
  Scene apart = scene;
  for (BoxCollider& generator : apart.generators) generator.spawn = Spawn::apart;
  try {
    initial_bodies(apart);
  } catch (const InputError&) {
    return;  // no room
  }
  scene = std::move(apart);
  std::fputs(
      "note: generated spheres start apart, which gives an exact reference; set --spawn to change this\n",
      stderr);
}

/// Restores the results of an interrupted study from the --json file. Any other file will be replaced.
void advance(const std::string& file, AccuracyStudy& study) {
  if (file.empty() || file == "-" || !std::filesystem::is_regular_file(file)) return;
  try {
    const std::string text = read_text_file(file, std::size_t{64} << 20, "a report of accuracy --json");
    const AccuracyRecord record = parse_record(text, file);
    if (record.complete) return;
    if (record.physics_version != physics_version)
      std::fputs(fmt::format("note: {} was written by physics version {}; this program has version {}, so "
                             "the study starts again\n",
                             file, record.physics_version, physics_version)
                     .c_str(),
                 stderr);
    if (!study.restore(record)) return;
    const auto known = std::ranges::count_if(record.points, &AccuracyPoint::has_error);
    std::fputs(fmt::format("note: {} already has the results of {} of {} settings\n", file, known,
                           record.points.size())
                   .c_str(),
               stderr);
  } catch (const InputError&) {
  }
}

/// Runs the study to its end or to Ctrl-C, which also cancels the step in progress. Saves the files once per
/// second.
void work(AccuracyStudy& study, const InterruptHandler& interrupt_handler,
          const std::function<void()>& save) {
  using Clock = std::chrono::steady_clock;
  std::optional<Progress> bar;
  std::int64_t total = -1;
  Clock::time_point saved = Clock::now();
  const auto advance = [&] {
    try {
      return study.advance(50);
    } catch (const Cancelled&) {  // results measured so far remain valid
      return false;
    }
  };
  while (!interrupt_handler.requested() && advance()) {
    const AccuracyStudy::Progress progress = study.progress();
    if (progress.total != total) bar.emplace(study.reference() ? "runs" : "reference", progress.total);
    total = progress.total;
    bar->update(progress.done);
    if (study.points().empty() || Clock::now() - saved < std::chrono::seconds(1)) continue;
    save();
    saved = Clock::now();
  }
}

[[noreturn]] void end_without_result() {
  std::fputs("stopped before the reference was computed; no results to save\n", stderr);
  InterruptHandler::reraise();
}

}  // namespace

int accuracy_command(const CommandLine& line) try {
  if (line.operands.empty()) return analytic_suite(line);
  const Options& options = line.options;
  const std::optional<double> tolerance = options.accuracy.tolerance;
  Scene scene = load_scene(line);
  const double least = coarsest_step(scene.physics.time_step);
  if (options.accuracy.seconds != 0 && options.accuracy.seconds < least)
    throw InputError(
        fmt::format("--seconds: {} s is shorter than the largest tested step, {} s; expected at least {} s",
                    options.accuracy.seconds, least, least));
  const ResultFiles files(options);
  start_apart(line, scene);
  Cancellation cancellation;
  const InterruptHandler interrupt_handler(cancellation, /*at_once=*/false);
  RunOptions run = options.run;
  run.cancellation = &cancellation;
  AccuracyStudy study(
      scene, run, {.seconds = options.accuracy.seconds, .rounds = static_cast<int>(options.bench.repeats)});
  advance(options.json, study);
  const auto save = [&] {
    const AccuracyRecord record = study.record();
    files.write(write_record(record), study_csv(record), study_markdown(record, tolerance));
  };
  work(study, interrupt_handler, save);
  if (study.points().empty()) end_without_result();
  save();
  const AccuracyRecord record = study.record();
  files.plot(study_chart(record, tolerance));
  print(options.json == "-" ? write_record(record) : study_text(record, tolerance));
  flush_stdout();
  if (!record.complete) {
    const bool kept = !options.json.empty() && options.json != "-";
    std::fputs(
        kept ? fmt::format("stopped; run the same command again to continue from {}\n", options.json).c_str()
             : "stopped; results not saved; with --json FILE, the same command can continue\n",
        stderr);
    InterruptHandler::reraise();
  }
  return tolerance && !recommended(record.points, record.reference.error, *tolerance).point ? 1 : 0;
} catch (const Cancelled&) {
  end_without_result();  // cancelled during the construction of the study
}

}  // namespace collidoscope
