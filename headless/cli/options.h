#pragma once
// What a command line asks for: where and how a scene runs, what of the scene it overrides, and what is
// written where. Plain data, filled by Flag::read(), one flag at a time.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "headless/cli/capture_request.h"
#include "sim_cuda/run/break_conditions.h"
#include "sim_cuda/scene/imported_scene.h"
#include "sim_cuda/scene/run_options.h"
#include "sim_cuda/scene/scene.h"
#include "sim_cuda/scene/settings_patch.h"
#include "sim_cuda/tuning/launch_search.h"

namespace collidoscope {

/// `view` is what the desktop program does; it has no word on the command line.
enum class Command { run, replay, capture, compare, bvh, bench, accuracy, stability, tune, validate, view };

/// What only the desktop program takes.
struct ViewRequest {
  bool reset_ui = false;                 ///< forget what was remembered of panels and layers
  std::string automation;                ///< file that gets a line of JSON for each frame, or empty
  std::optional<std::int64_t> pause_at;  ///< state
};

/// What only `bench` and `bvh` take; empty lists are the suite's own.
struct BenchRequest {
  std::vector<std::string> methods;   ///< broad phases
  std::string boxes, tree;            ///< files of boxes and of a tree over them, or empty
  std::vector<std::string> variants;  ///< of the Box Collider, or crowded scenes (scene/crowded_scenes.h)
  std::vector<std::int64_t> sizes;    ///< numbers of bodies
  std::int64_t repeats = 50;          ///< of what is timed
  bool repeats_given = false;         ///< --repeats was
  std::string csv, markdown, plot;    ///< files, or empty
};

/// What replaces values of the scene.
struct Overrides {
  SettingsPatch settings;                          ///< physical ones; Options::run has the others
  std::optional<std::optional<OnFailure>> guards;  ///< inner unset: none
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
  bool inject_faults = false;     ///< faults that must fail their criteria, in place of the trials
  int jobs = 0;                   ///< trials side by side; 0: one for each core
  std::string save_failures;      ///< folder of snapshots, or empty
  std::string write_table;        ///< file whose table is written anew, or empty
  std::vector<std::string> from;  ///< files of --json that the table is made of
};

/// What only `tune` takes.
struct TuneOptions {
  double budget = 20;                                           ///< s, of all measurements together
  std::int64_t confirmation_pairs = LaunchSearch::fresh_pairs;  ///< fresh pairs of the chosen shape
  std::vector<std::string> over;                                ///< comparison_axes(); empty: launch shapes
  bool brute_force = false;                                     ///< compare the chosen shape with all others
  std::string picture, kernel_tuner, t4;                        ///< files, or empty
};

struct Options {
  RunOptions run;
  std::string tuned;     ///< file of launch shapes, "off", or empty: those that are known
  ImportOptions import;  ///< of a SCENE that is a file of bodies
  Overrides overrides;
  std::optional<std::int64_t> steps;  ///< unset: 300, of `bvh` 0
  std::string json;                   ///< file, "-" for stdout, or empty
  std::string dump_bodies;            ///< file or empty, and so the next two
  std::string dump_dynamics;          ///<
  std::string energy_trace;           ///<
  std::string save, load;             ///< snapshots, or empty
  std::string write_scene;            ///< scene file, or empty
  std::string record;                 ///< recording, or empty
  std::string changes;                ///< of `run`: what is changed on the way, or empty
  bool residuals = false;             ///< of the last step
  BreakConditions breaks;             ///< of `run` and the window
  CaptureRequest capture;
  ViewRequest view;
  std::int64_t frames = 300;  ///< of `bench frames`
  BenchRequest bench;
  AccuracyOptions accuracy;
  StabilityOptions stability;
  TuneOptions tune;
  double validation_timeout = 20;  ///< s, for one test of `validate`

  std::int64_t steps_or(std::int64_t otherwise) const { return steps.value_or(otherwise); }
};

class FlagValue;
/// A flag of the command line: its help, and how its text is read into the member it is bound to.
struct Flag {
  std::string name;
  std::string value;  ///< placeholder of the value in --help; empty: the flag takes no value
  std::string help;
  /// Reads one text ("true" if the flag takes no value), or adds faults to `value`.
  void (*read)(FlagValue& value, Options& options);
  bool again = false;      ///< the flag can be given more than once
  std::string group = {};  ///< heading in --help
  unsigned commands = 0;   ///< bit() of each command that takes the flag
};
constexpr unsigned bit(Command command) { return 1u << static_cast<unsigned>(command); }
/// All flags of all commands.
std::span<const Flag> flags();
/// "--time-step" of "time_step".
std::string flag_name(std::string_view setting);

struct RenamedFlag {
  std::string_view old_name, name;
};
/// The parser still accepts the old names, with a warning. --help does not list them.
inline constexpr RenamedFlag renamed_flags[] = {{"--long", "--extended"},
                                                {"--plant", "--inject-faults"},
                                                {"--readme", "--write-table"},
                                                {"--lane-order", "--cpu-item-order"}};

/// Replaces what the overrides name, then validates the whole. Throws InputError: faults of a value that came
/// from a flag begin with the flag, others with `file` and the path in the scene.
void apply(const Overrides& overrides, const std::string& file, Scene& scene);

}  // namespace collidoscope
