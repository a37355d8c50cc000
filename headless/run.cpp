#include "headless/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <optional>

#include "headless/capture.h"
#include "headless/change_replay.h"
#include "headless/cli/flag_value.h"
#include "headless/cli/interrupt_handler.h"
#include "headless/cli/output_file.h"
#include "headless/cli/progress.h"
#include "headless/cli/standard_output.h"
#include "headless/reporting/body_csv.h"
#include "headless/reporting/report.h"
#include "sim_cuda/core/cancellation.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/core/physics_version.h"
#include "sim_cuda/recording/recorder.h"
#include "sim_cuda/run/checkpoint.h"
#include "sim_cuda/scene/relocated_scene.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/stability/offending_body.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Output files of a run, all opened before the simulation starts. Throws one InputError for all files.
struct Outputs {
  std::optional<OutputFile> json, bodies, dynamics, energy, snapshot, scene;

  explicit Outputs(const Options& options) {
    std::vector<std::string> faults;
    const auto open = [&](std::optional<OutputFile>& file, const char* flag, const std::string& target) {
      if (target.empty() || target == "-") return;
      try {
        file.emplace(flag, target);
      } catch (const InputError& error) {
        faults.insert(faults.end(), error.lines().begin(), error.lines().end());
      }
    };
    open(json, "--json", options.json);
    open(bodies, "--dump-bodies", options.dump_bodies);
    open(dynamics, "--dump-dynamics", options.dump_dynamics);
    open(energy, "--energy-trace", options.energy_trace);
    open(snapshot, "--save", options.save);
    open(scene, "--write-scene", options.write_scene);
    if (!faults.empty()) throw InputError(faults);
  }
  bool any() const { return json || bodies || dynamics || energy || snapshot || scene; }
};

/// Ends a run with output files at a signal, without ending the program. On the CPU the current step is
/// cancelled and is not part of the state. On a GPU the current batch of steps is completed.
class EarlyEnd {
 public:
  /// `cancellation`: null if a signal ends the program at once.
  explicit EarlyEnd(Cancellation* cancellation) : cancellation_(cancellation) {
    if (cancellation_ == nullptr) return;
    InterruptHandler::wait_for_work();
    cancellation_->suspend(true);
  }
  ~EarlyEnd() {
    if (cancellation_ != nullptr) cancellation_->suspend(false);
  }
  EarlyEnd(const EarlyEnd&) = delete;
  EarlyEnd& operator=(const EarlyEnd&) = delete;

  void step(World& world, int count) {
    if (cancellation_ == nullptr || world.info().on_gpu) return world.step(count);
    cancellation_->suspend(false);
    try {
      world.step(count);
    } catch (const Cancelled&) {
      cancellation_->clear();
      cancellation_->suspend(true);
      cancelled_ = true;
      world.detect();  // restores the state before that step
    }
    cancellation_->suspend(true);
  }
  bool requested() const { return cancelled_ || (cancellation_ != nullptr && cancellation_->requested()); }

 private:
  Cancellation* cancellation_;
  bool cancelled_ = false;
};

World make_world(const Start& start, const RunOptions& options) {
  World world = start.world(options);
  if (!world.initial().meshes.empty())
    std::fputs("note: mesh bodies collide as their bounding spheres\n", stderr);
  return world;
}

/// The scene of --write-scene, as text.
std::string scene_to_write(const Scene& scene, const std::string& file) try {
  const std::filesystem::path folder = std::filesystem::path(file).parent_path();
  return write_scene(relocated_scene(scene, folder.empty() ? "." : folder.string()));
} catch (const InputError& error) {
  throw InputError(std::string("--write-scene: ") + error.what());
}

std::string trace_row(const StepStats& s) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}\n", s.step, s.kinetic_energy, s.potential_energy,
                     s.push_work, s.energy(), s.pairs, s.touching, s.speculative, s.uncoloured_contacts,
                     s.bounce_cap, s.max_penetration, s.escaped);
}

/// Wall-clock and simulated seconds of stepping, and the reason of an early end.
struct Stepped {
  double seconds = 0, simulated = 0;
  std::optional<std::string> failure;  ///< the world is at the state before the failed step
  bool failed_at_start = false;        ///< the first state itself fails
};

/// Checks the stop conditions at each new state. When one is met, restores the previous state.
class Breaks {
 public:
  Breaks(const BreakConditions& conditions, const StepStats& start)
      : conditions_(conditions), monitor_(start), last_(start) {}
  bool any() const { return conditions_.any(); }
  void before_step(World& world) { checkpoint_.save_if_due(world); }
  std::optional<std::string> look_at_start(World& world) { return found(world, {}); }
  std::optional<std::string> check(World& world, const StepStats& stats) {
    last_ = stats;
    std::optional<std::string> failure = found(world, world.latest_times());
    if (failure) checkpoint_.restore(world, stats.step - 1);
    return failure;
  }
  void world_changed(const StepStats& stats) {
    checkpoint_.clear();
    monitor_.change(last_, stats);
  }

 private:
  std::optional<std::string> found(World& world, const RunTimes& times) {
    std::optional<BreakpointHit> hit = monitor_.check(conditions_, last_, times);
    if (!hit) return std::nullopt;
    hit->body = offending_body(world, hit->condition);
    return describe(*hit);
  }

  BreakConditions conditions_;
  BreakpointMonitor monitor_;
  StepStats last_;
  Checkpoint checkpoint_;
};

/// Steps in batches of about a tenth of a second, which keeps a GPU busy and progress visible. A trace or
/// stop conditions require measuring every state, a recording hashes it.
Stepped step_all(World& world, std::int64_t steps, ChangeReplay& replay, std::string* trace, bool residuals,
                 Breaks& breaks, EarlyEnd& early_end, Recorder* recorder) {
  Stepped stepped;
  stepped.failure = breaks.look_at_start(world);
  stepped.failed_at_start = stepped.failure.has_value();
  if (stepped.failure) return stepped;
  Progress progress("steps", steps);
  std::int64_t stride = 1;
  for (std::int64_t done = 0; done < steps && !early_end.requested();) {
    const std::int64_t rest = std::min(steps - done, replay.steps_to_next(world));
    int count = static_cast<int>(trace || breaks.any() || recorder != nullptr ? 1 : std::min(stride, rest));
    if (residuals && done + count == steps) {
      if (count == 1)
        world.records().record_residuals(true);  // of the last step only
      else
        --count;
    }
    const std::int64_t before = world.steps();
    const std::size_t frozen = world.validation().frozen().size();
    const Clock::time_point start = Clock::now();
    if (breaks.any()) breaks.before_step(world);
    early_end.step(world, count);
    const double spent = seconds_since(start);
    stepped.seconds += spent;
    stepped.simulated += static_cast<double>(world.steps() - before) * world.scene().physics.time_step;
    if (world.validation().frozen().size() > frozen)
      std::fputs(fmt::format("note: number of frozen bodies: {}; last finding: {}\n",
                             world.validation().frozen().size(), describe(*world.validation().finding()))
                     .c_str(),
                 stderr);
    if (world.steps() == before && !world.validation().paused()) break;  // the step was cancelled
    if (world.validation().paused()) stepped.failure = describe(*world.validation().finding());
    if (!stepped.failure && breaks.any()) stepped.failure = breaks.check(world, world.measure());
    if (stepped.failure) return stepped;
    done += world.steps() - before;
    if (recorder != nullptr && world.steps() > before) recorder->record_step(world);
    if (replay.make_due(world, recorder) && breaks.any()) breaks.world_changed(world.measure());
    if (trace) *trace += trace_row(world.measure());
    if (spent < 0.05 && stride < 1 << 20) stride *= 2;
    if (spent > 0.2 && stride > 1) stride /= 2;
    progress.update(done);
  }
  return stepped;
}

/// An unused file name in the working folder. `step` is the step that failed.
std::string failure_file(const World& world, std::int64_t step) {
  const std::string stem = fmt::format("failure-{}-{}", file_stem(world.scene().name), step);
  std::string file = stem + ".snapshot";
  std::error_code failed;
  for (int k = 2; std::filesystem::exists(file, failed); ++k) file = fmt::format("{}-{}.snapshot", stem, k);
  return file;
}

/// False if the final state differs from the one recorded in the change file. Prints a message in this case,
/// and if the states cannot be compared.
bool as_recorded(World& world, const ChangeReplay& replay, const std::string& file) {
  if (const std::size_t left = replay.left(); left > 0)
    std::fprintf(stderr, "note: %s: the run ended before %zu of the changes in this file\n", file.c_str(),
                 left);
  const std::optional<RecordedEnd>& end = replay.end();
  if (!end || end->step != world.steps()) return true;
  if (end->physics_version != physics_version) {
    std::fputs(
        fmt::format("note: {}: cannot compare hashes: physics version {}\n", file, end->physics_version)
            .c_str(),
        stderr);
    return true;
  }
  if (end->state_hash == world.state_hash()) return true;
  std::fputs(fmt::format("{}: state {}: recorded hash {:016x}, actual hash {:016x}; expected the same "
                         "scene and flags as in the recording\n",
                         file, end->step, end->state_hash, world.state_hash())
                 .c_str(),
             stderr);
  return false;
}

/// False if a plug-in had wrong pairs; prints them.
bool has_right_pairs(const RunReport& report) {
  if (!report.pair_check || !report.pair_check->is_wrong()) return true;
  fmt::print(stderr, "broad phase {}: wrong pairs: {}\n", report.broad_phase, describe(*report.pair_check));
  return false;
}

}  // namespace

int run_command(const CommandLine& line) {
  const Options& options = line.options;
  Start start = load_start(line);
  const std::string scene =
      options.write_scene.empty() ? "" : scene_to_write(start.scene, options.write_scene);
  RunOptions how = options.run;
  ChangeReplay replay(options.changes, start, how);
  Outputs outputs(options);
  World world = make_world(start, how);
  replay.make_due(world);
  std::optional<Recorder> recorder;
  if (!options.record.empty()) recorder.emplace(options.record).begin(world);

  const StepStats initial = world.measure();
  std::string trace =
      "step,kinetic,potential,push_work,total,pairs,touching,speculative,uncoloured_contacts,bounce_cap,"
      "max_penetration,escaped\n" +
      trace_row(initial);
  const std::int64_t recorded = replay.end() ? replay.end()->step - world.steps() : 300;
  Breaks breaks(options.breaks, initial);
  EarlyEnd early_end(outputs.any() || recorder ? options.run.cancellation : nullptr);
  const std::int64_t steps = options.steps_or(std::max<std::int64_t>(recorded, 0));
  const std::int64_t last = world.steps() + steps;
  const Stepped stepped = step_all(world, steps, replay, outputs.energy ? &trace : nullptr, options.residuals,
                                   breaks, early_end, recorder ? &*recorder : nullptr);
  if (recorder) recorder->end(world);
  const bool save_on_failure = stepped.failure && options.save.empty();
  const std::int64_t failed_step = world.steps() + (stepped.failed_at_start ? 0 : 1);
  std::string failed_at = save_on_failure ? failure_file(world, failed_step) : options.save;
  if (save_on_failure) outputs.snapshot.emplace("--save", failed_at);
  if (early_end.requested())
    std::fputs(fmt::format("interrupted at state {} of {}; the output files end at this state\n",
                           world.steps(), last)
                   .c_str(),
               stderr);
  RunReport report = make_report(world, initial, stepped.seconds);
  report.simulated_seconds = stepped.simulated;
  report.failure = stepped.failure.value_or("");

  with_allocation_context("writing the output files", [&] {
    // Writes all files before committing any. A full disk then leaves no partial set of files.
    const auto into = [&](OutputFile& file) {
      return [&](std::string_view text) {
        if (options.run.cancellation != nullptr && options.run.cancellation->poll()) throw Cancelled();
        file.write(text);
      };
    };
    if (outputs.bodies) write_body_states(world, into(*outputs.bodies));
    if (outputs.dynamics) write_body_dynamics(world, into(*outputs.dynamics));
    if (outputs.energy) outputs.energy->write(trace);
    if (outputs.snapshot) write_snapshot(snapshot_of(world), into(*outputs.snapshot));
    if (outputs.scene) outputs.scene->write(scene);
    if (outputs.json) into (*outputs.json)(to_json(report));
    InterruptHandler::work_ended();
    if (save_on_failure) {  // another run may have created the file meanwhile
      while (!outputs.snapshot->commit_new(failed_at)) failed_at = failure_file(world, failed_step);
      outputs.snapshot.reset();
    }
    for (auto* file : {&outputs.bodies, &outputs.dynamics, &outputs.energy, &outputs.snapshot, &outputs.scene,
                       &outputs.json})
      if (*file) (*file)->commit();
  });
  std::exception_ptr not_printed;  // the run's failure is reported in any case
  try {
    print(options.json == "-" ? to_json(report) : to_text(report));
    flush_stdout();
  } catch (const MachineError&) {
    not_printed = std::current_exception();
  }
  if (stepped.failure) {
    std::fputs(fmt::format("{}; state {} {}saved to {}\n", *stepped.failure, world.steps(),
                           stepped.failed_at_start ? "" : "before the failure ", failed_at)
                   .c_str(),
               stderr);
  }
  const bool good =
      !stepped.failure && has_right_pairs(report) && as_recorded(world, replay, options.changes);
  if (not_printed) std::rethrow_exception(not_printed);
  return good ? 0 : 1;
}

namespace {

/// Throws InputError if a picture would overwrite another output file.
void refuse_picture_files(const CommandLine& line, const Start& start) {
  namespace fs = std::filesystem;
  const Options& options = line.options;
  std::vector<std::string> faults;
  const auto whole = [](const std::string& file) {
    std::error_code failed;
    return fs::weakly_canonical(fs::absolute(file), failed);
  };
  const auto check = [&](const std::string& flag, const std::string& file) {
    if (file.empty()) return;
    const fs::path path = whole(file);
    if (path.parent_path() != whole(options.capture.out)) return;
    for (const std::int64_t state :
         states_to_draw(options.capture, start.snapshot ? start.snapshot->state.steps : 0))
      if (fs::path(picture_file(options.capture, start.scene, state)).filename() == path.filename())
        faults.push_back(fmt::format("{}: {} is also the picture of state {}; expected a different file",
                                     flag, shown(file), state));
  };
  check("--json", options.json);
  check("--load", options.load);
  if (!line.operands.empty()) check("the scene", scene_file(line.operands[0]));
  if (!faults.empty()) throw InputError(faults);
}

}  // namespace

int capture_command(CommandLine line) {
  Options& options = line.options;
  const Start start = load_start(line);
  FrameLayers& layers = options.capture.layers;
  if (start.has_boxes() && layers == CaptureRequest{}.layers) layers.spheres = false, layers.boxes = true;
  if (options.capture.states.empty() && start.has_boxes()) options.capture.states = {0};
  if (options.capture.states.empty())
    for (std::int64_t frame = 0; frame < std::ssize(start.frames); ++frame)
      options.capture.states.push_back(frame);
  refuse_picture_files(line, start);
  const Outputs checked(options);
  ensure_writable_folder("--out", options.capture.out);
  World world = make_world(start, options.run);

  const StepStats initial = world.measure();
  const int status = run_capture(options.capture, world, start.frames);
  const RunReport report = make_report(world, initial, std::nullopt);
  if (!options.json.empty()) {
    OutputFile json("--json", options.json);
    json.write(to_json(report));
    json.commit();
  }
  print("\n" + to_text(report));
  return has_right_pairs(report) ? status : 1;
}

}  // namespace collidoscope
