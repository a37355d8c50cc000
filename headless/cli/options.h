#pragma once
// What a command line asks for: where and how a scene runs, what of the scene it overrides, and what is
// written where. Plain data, filled by read_flag(), one flag at a time.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "headless/cli/capture_request.h"
#include "sim_cuda/run/break_conditions.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// `view` is what the desktop program does; it has no word on the command line.
enum class Command { run, capture, compare, bvh, bench, accuracy, stability, view };

/// What only the desktop program takes.
struct ViewRequest {
  bool reset_ui = false;                 ///< forget what was remembered of panels and layers
  std::string automation;                ///< file that gets a line of JSON for each frame, or empty
  std::optional<std::int64_t> pause_at;  ///< state
};

/// What only `bench` and `bvh` take; empty lists are the suite's own.
struct BenchRequest {
  std::vector<std::string> methods;   ///< broad phases
  std::vector<std::string> variants;  ///< of the Box Collider, or crowded scenes (scene/crowded_scenes.h)
  std::vector<std::int64_t> sizes;    ///< numbers of bodies
  std::int64_t repeats = 50;          ///< of what is timed
  bool repeats_given = false;         ///< --repeats was
  std::string csv, markdown, plot;    ///< files, or empty
};

/// What replaces values of the scene; unset leaves the scene's own. "auto" is a value where the scene knows
/// it.
struct Overrides {
  std::optional<std::int64_t> bodies;
  std::optional<Variant> variant;
  std::optional<Spawn> spawn;
  std::optional<std::uint64_t> seed;
  std::optional<Vector3d> gravity;             ///< m/s^2
  std::optional<double> time_step;             ///< s
  std::optional<int> steps_per_second;         ///< where the time step was given as 1/n
  std::optional<std::optional<int>> substeps;  ///< inner unset: "auto"
  std::optional<int> iterations;
  std::optional<Solver> solver;
  std::optional<Integrator> integrator;
  std::optional<RotationUpdate> rotation_update;
  std::optional<Precision> precision;
  std::optional<std::optional<Effects>> effects;               ///< inner unset: "auto"
  std::optional<std::optional<double>> restitution_threshold;  ///< m/s; inner unset: "auto"
  std::optional<std::optional<OnFailure>> guards;              ///< inner unset: none
};

/// What only `accuracy` takes, beside what it shares with `bench`.
struct AccuracyOptions {
  std::optional<double> tolerance;  ///< m
  double seconds = 0;               ///< s, that are compared at most; 0: as AccuracyStudyOptions has it
};

/// What only `stability` takes, but for the cases, which the viewer lists.
struct StabilityOptions {
  std::string cases;              ///< folder; empty: assets/scenes/hard
  bool extended = false;          ///< the long variants
  bool plant = false;             ///< faults that must fail their criteria, in place of the trials
  int jobs = 0;                   ///< trials side by side; 0: one for each core
  std::string save_failures;      ///< folder of snapshots, or empty
  std::string readme;             ///< file whose table is written anew, or empty
  std::vector<std::string> from;  ///< files of --json that the table is made of
};

struct Options {
  RunOptions run;
  Overrides overrides;
  std::optional<std::int64_t> steps;  ///< unset: 300, of `bvh` 0
  std::string json;                   ///< file, "-" for stdout, or empty
  std::string dump_bodies;            ///< file or empty, and so the next two
  std::string dump_dynamics;          ///<
  std::string energy_trace;           ///<
  std::string save, load;             ///< snapshots, or empty
  std::string changes;                ///< of `run`: what is changed on the way, or empty
  bool residuals = false;             ///< of the last step
  BreakConditions breaks;             ///< of `run` and the window
  CaptureRequest capture;
  ViewRequest view;
  std::int64_t frames = 300;  ///< of `bench frames`
  BenchRequest bench;
  AccuracyOptions accuracy;
  StabilityOptions stability;

  std::int64_t steps_or(std::int64_t otherwise) const { return steps.value_or(otherwise); }
};

/// A flag of the command line, for --help and for the parser.
struct Flag {
  const char* name;
  const char* value;  ///< what stands for its value in --help; nullptr: it takes none
  const char* help;
  unsigned commands;   ///< bit() of each command that takes it
  bool again = false;  ///< whether it may be given more than once
};
constexpr unsigned bit(Command command) { return 1u << static_cast<unsigned>(command); }
std::span<const Flag> flags();

/// Reads one flag's text into `options`, or adds lines to `faults`. `flag` is the name of one of flags().
void read_flag(std::string_view flag, std::string_view text, Options& options,
               std::vector<std::string>& faults);

/// Replaces what the overrides name, then validates the whole. Throws InputError: faults of a value that came
/// from a flag begin with the flag, others with `file` and the path in the scene.
void apply(const Overrides& overrides, const std::string& file, Scene& scene);

}  // namespace collidoscope
