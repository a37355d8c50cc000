// The table of all flags of the command line. Templates bind each flag to a member of Options.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "headless/cli/flag_value.h"
#include "headless/cli/options.h"
#include "headless/cli/setting_flags.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/import/columns.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/crowded_scenes.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/settings.h"
#include "sim_cuda/tuning/setting_comparison.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

constexpr unsigned running = bit(Command::run), capturing = bit(Command::capture);
constexpr unsigned viewing = bit(Command::view), benching = bit(Command::bench), grading = bit(Command::bvh);
constexpr unsigned studying = bit(Command::accuracy), testing = bit(Command::stability);
constexpr unsigned tuning = bit(Command::tune);
constexpr unsigned drawing = capturing | viewing | benching,
                   stepping = running | drawing | grading | studying | tuning;
constexpr unsigned replaying = bit(Command::replay);
constexpr unsigned guarding = running | capturing | viewing;
constexpr unsigned reporting = running | bit(Command::replay) | capturing | benching | grading | studying |
                               testing | tuning | bit(Command::compare);

/// NAME=BxT,... with 0 for an automatic B or T.
std::optional<StageShapes> parse_stage_shapes(FlagValue& value) {
  StageShapes shapes;
  for (FlagValue& part : value.parts()) {
    const std::string_view text = part.text();
    const std::size_t equals = text.find('='), cross = text.find('x', equals == text.npos ? 0 : equals);
    if (equals == text.npos || equals == 0 || cross == text.npos) {
      part.refuse("STAGE=BxT, such as solve=264x128");
      return std::nullopt;
    }
    const auto blocks = part.part(text.substr(equals + 1, cross - equals - 1)).whole(0, 2147483647);
    const auto threads = part.part(text.substr(cross + 1)).whole(0, 1024);
    if (!blocks || !threads) return std::nullopt;
    shapes.push_back(
        {std::string(text.substr(0, equals)), {static_cast<int>(*blocks), static_cast<int>(*threads)}});
  }
  return shapes;
}

void stage_shapes(FlagValue& value, Options& options) {
  if (auto shapes = parse_stage_shapes(value)) options.run.stage_shapes = std::move(*shapes);
}

// Paths to members of Options.
constexpr auto run = &Options::run;
constexpr auto capture = &Options::capture;
constexpr auto draw = &CaptureRequest::draw;
constexpr auto layers = &CaptureRequest::layers;
constexpr auto bench = &Options::bench;
constexpr auto stability = &Options::stability;
constexpr auto tune = &Options::tune;

template <auto... path>
auto& member(Options& options) {
  return (options.*....*path);
}

/// A flag without a value.
template <auto... path>
void on(FlagValue& value, Options& options) {
  if (value.text() == "true")
    member<path...>(options) = true;
  else
    value.fault("takes no value; remove " + shown(value.text()));
}

/// The name of a file or of a folder.
void file_name(FlagValue& value, std::string& name) {
  if (value.text().empty() || value.text().find('\0') != std::string_view::npos)
    value.refuse("the name of a file");
  else
    name = value.text();
}
template <auto... path>
void file(FlagValue& value, Options& options) {
  file_name(value, member<path...>(options));
}

template <std::int64_t min, std::int64_t max, auto... path>
void whole(FlagValue& value, Options& options) {
  if (const auto number = value.whole(min, max)) member<path...>(options) = *number;
}

/// "auto" is an unset optional, or 0.
template <int max, auto... path>
void whole_or_auto(FlagValue& value, Options& options) {
  auto& number = member<path...>(options);
  if (value.text() == "auto")
    number = {};
  else if (const auto given = value.whole(1, max, ", or auto"))
    number = static_cast<int>(*given);
}

/// For functions that throw faults, which begin with the flag.
template <auto parse, auto... path>
void parsed(FlagValue& value, Options& options) try {
  const std::string text(value.text()), flag(value.flag());
  auto& target = member<path...>(options);
  if constexpr (std::is_invocable_v<decltype(parse), const std::string&, decltype(target),
                                    const std::string&>)
    parse(text, target, flag);
  else if constexpr (std::is_invocable_v<decltype(parse), const std::string&, const std::string&>)
    target = parse(text, flag);
  else
    target = parse(text);
} catch (const InputError& error) {
  value.add(error.lines());
}

/// A list with commas.
template <auto read_part, auto... path>
void list(FlagValue& value, Options& options) {
  auto& parts = member<path...>(options);
  parts.clear();
  for (FlagValue& part : value.parts())
    if (const auto read = read_part(part)) parts.push_back(*read);
}
template <std::vector<std::string> (*words)()>
std::optional<std::string> word(FlagValue& value) {
  static const std::vector<std::string> known = words();
  return value.word(known);
}

std::optional<std::string> compared_setting(FlagValue& value) {
  static const std::vector<std::string> known = comparison_axes();
  return value.word(known, "setting");
}
std::optional<std::int64_t> body_count(FlagValue& value) { return value.whole(1, limits::max_bodies); }

void guards(FlagValue& value, Options& options) {
  if (value.text() == "off")
    options.overrides.guards = std::optional<OnFailure>{};
  else if (const auto on_failure = value_of(on_failure_names, value.text()))
    options.overrides.guards = std::optional<OnFailure>{*on_failure};
  else
    value.refuse("pause, freeze or off");
}

void steps(FlagValue& value, Options& options) {
  const auto number = value.whole(0, 1'000'000'000);
  if (number) options.steps = number;
  options.view.pause_at = number;
}

/// The colours and the range of boxes have flags of their own.
void layer_list(FlagValue& value, Options& options) {
  FrameLayers& chosen = options.capture.layers;
  const FrameLayers before = chosen;
  parsed<parse_layers, capture, layers>(value, options);
  chosen.color = before.color;
  chosen.box_color = before.box_color;
  chosen.box_low = before.box_low;
  chosen.box_high = before.box_high;
}

void columns(FlagValue& value, Options& options) try {
  parse_column_map(value.text(), std::string(value.flag()));
  options.import.columns = value.text();
} catch (const InputError& error) {
  value.add(error.lines());
}

void repeats(FlagValue& value, Options& options) {
  whole<1, 1'000'000, bench, &BenchRequest::repeats>(value, options);
  options.bench.repeats_given = true;
}

std::vector<Flag> all_flags() {
  std::vector<Flag> all;
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    if (!is_physical(setting) || setting.live != Live::never)  // the others are in scene files only
      all.push_back(
          {flag_name(setting.name), std::string(setting.placeholder), help_of_flag(setting),
           read_setting<member>, false, is_physical(setting) ? "Simulation" : "Execution",
           (is_physical(setting) ? 0 : replaying) | (setting.for_stability ? stepping | testing : stepping)});
  });
  const auto add = [&](const char* group, unsigned commands, std::vector<Flag> rows) {
    for (Flag& row : rows) row.group = group, row.commands = commands;
    std::ranges::move(rows, std::back_inserter(all));
  };
  add("Simulation", guarding,
      {{"--guards", "NAME", "pause, freeze or off: reaction to a failed step", guards}});
  add("Simulation", running | viewing,
      {{"--break", "LIST",
        "stop conditions, such as non-finite,energy-rise=5,penetration=0.1,speed=100,stage-ms=20,escaped",
        parsed<parse_break_conditions, &Options::breaks>}});
  add("Simulation", running | viewing | grading | tuning,
      {{"--steps", "K", "number of steps [300; bvh: 0; tune: 60]; the viewer pauses at this state", steps}});
  add("Execution", stepping | testing | replaying,
      {{"--allow-large", "", "allow steps to use all available memory (default: 80 %)",
        on<run, &RunOptions::allow_large>},
       {"--stage-shapes", "LIST", "B and T of single stages, such as solve=264x128,relax=0x64; 0: auto",
        stage_shapes}});
  add("Execution", running | capturing | viewing | tuning,
      {{"--tuned", "FILE|off",
        "launch shapes that tune measured; auto uses them on the same device, driver, build and size, "
        "and tune adds its own [those of assets/tuned.json and of the user's cache]",
        file<&Options::tuned>}});
  add("Output", reporting,
      {{"--json", "FILE|-", "the report as JSON; -: on stdout, without other text", file<&Options::json>}});
  add("Output", running,
      {{"--dump-bodies", "FILE", "CSV: state of all bodies at the end", file<&Options::dump_bodies>},
       {"--dump-dynamics", "FILE", "CSV: mass, X, R, P, L, inverse inertia, F, T of all bodies at the end",
        file<&Options::dump_dynamics>},
       {"--energy-trace", "FILE", "CSV: energies, pairs, penetration", file<&Options::energy_trace>},
       {"--residuals", "", "report the residual of each solver iteration of the last step",
        on<&Options::residuals>}});
  add("Output", benching | studying,
      {{"--csv", "FILE", "the rows as CSV", file<bench, &BenchRequest::csv>},
       {"--markdown", "FILE", "the rows as a Markdown table", file<bench, &BenchRequest::markdown>},
       {"--plot", "FILE.png", "a chart of the rows", file<bench, &BenchRequest::plot>}});
  add("Pictures", capturing,
      {{"--states", "LIST", "states to draw; 0 is the start [the first state, and 30 and 60 steps later]",
        parsed<parse_states, capture, &CaptureRequest::states>},
       {"--out", "DIR", "folder of the pictures [captures]", file<capture, &CaptureRequest::out>},
       {"--timings", "", "draw stage times; they differ between runs",
        on<capture, &CaptureRequest::timings>}});
  add("Pictures", drawing,
      {{"--layers", "LIST", "layers to draw, such as spheres,bvh:2-5,contacts", layer_list},
       {"--color", "NAME",
        "colour of bodies: speed, radius, id, contacts, order, depth, visits, sleep or error",
        parsed<parse_body_color, capture, layers, &FrameLayers::color>},
       {"--box-color", "NAME", "colour of boxes: level, sah, overlap, empty or visits",
        parsed<parse_box_color, capture, layers, &FrameLayers::box_color>},
       {"--box-range", "LOW,HIGH", "draw boxes with a value of --box-color in this range; HIGH may be inf",
        parsed<parse_box_range, capture, layers>},
       {"--size", "WxH", "width and height of a picture in pixels", parsed<parse_size, capture>},
       {"--display-path", "NAME", "auto, interop, copy or upload: transfer of simulation data to OpenGL",
        parsed<parse_display_path, capture, &CaptureRequest::display_path>},
       {"--draw-gpu", "I", "CUDA device number of the GPU that draws; default: the one that simulates",
        whole<0, 1023, capture, &CaptureRequest::draw_gpu>},
       {"--quality", "NAME", "full, quick or auto; quick has no ambient occlusion and hard shadows",
        parsed<parse_quality, capture, draw, &DrawRequest::light>},
       {"--supersample", "K", "K x K samples per pixel of the 3D view, 1 to 4, or auto",
        whole_or_auto<4, capture, draw, &DrawRequest::supersampling>},
       {"--sphere-method", "NAME", "auto, quads or compute: drawing method of spheres; same pixels",
        parsed<parse_sphere_method, capture, draw, &DrawRequest::spheres>},
       {"--light-method", "NAME", "auto, fragments or compute: kind of shader for lighting; same pixels",
        parsed<parse_light_method, capture, draw, &DrawRequest::light_method>}});
  add("Benchmarks", benching,
      {{"--frames", "K", "measured frames, after a warm-up [300]", whole<1, 1'000'000, &Options::frames>},
       {"--variants", "LIST",
        "comma-separated variants of the Box Collider, or mixed, log_normal or clusters",
        list<&word<compared_scenes>, bench, &BenchRequest::variants>},
       {"--sizes", "LIST", "comma-separated numbers of bodies",
        list<body_count, bench, &BenchRequest::sizes>}});
  add("Benchmarks", benching | grading,
      {{"--methods", "LIST", "comma-separated broad phases, or paths of plug-ins [all]",
        list<broad_phase_or_plugin, bench, &BenchRequest::methods>}});
  add("Files of bodies", stepping,
      {{"--columns", "MAP",
        "SCENE is a file of bodies: columns of quantities, by name or number from 1, or none: "
        "x=px,y=py,radius=4,vx=none; quantities: id, x, y, z, radius, diameter, mass, vx, vy, vz, wx, wy, "
        "wz, qw, qx, "
        "qy, qz; or of boxes: min_x, min_y, min_z, max_x, max_y, max_z [by the names of the columns]",
        columns},
       {"--radius", "R", "m: radius of bodies in a file without radii [a quarter of their mean distance]",
        [](FlagValue& value, Options& options) {
          options.import.radius = value.number(limits::min_radius, limits::max_radius, "m");
        }},
       {"--scale", "S", "m per unit of length in the file of bodies [1]",
        [](FlagValue& value, Options& options) {
          options.import.scale = value.number(1e-15, 1e15, "m").value_or(1);
        }},
       {"--frame", "K", "frame of a file of bodies with several, from 0 [0]",
        whole<0, 1'000'000'000, &Options::import, &ImportOptions::frame>}});
  add("Files of bodies", grading | guarding,
      {{"--boxes", "FILE",
        "boxes instead of the scene, without dynamics: a NumPy array of shape (n, 6), min x, y, z, max x, y, "
        "z "
        "of each box; or those of the triangles of a mesh (OBJ, STL, PLY)",
        file<bench, &BenchRequest::boxes>},
       {"--tree", "FILE.npy",
        "a tree over --boxes, to show or measure: shape (m, 8), box, parent row and box index of each node",
        file<bench, &BenchRequest::tree>}});
  add("Benchmarks", benching | grading | studying,
      {{"--repeats", "K", "repetitions of each measurement [50; accuracy: 3; paper: 20, at most 2 s]",
        repeats}});
  add("Accuracy study", studying,
      {{"--tolerance", "E", "m: report the fastest setting within this error; exit status 1 if there is none",
        [](FlagValue& value, Options& options) {
          options.accuracy.tolerance = value.number(limits::min_tolerance, limits::max_tolerance, "m");
        }},
       {"--seconds", "T", "maximum simulated seconds, at least 2 steps [60 steps, and at least 2 s]",
        [](FlagValue& value, Options& options) {
          options.accuracy.seconds = value.number(1e-6, 1e6, "s").value_or(0);
        }}});
  add("Launch tuning", tuning,
      {{"--budget", "S", "s: time of all measurements together [20]",
        [](FlagValue& value, Options& options) {
          options.tune.budget = value.number(0.1, 1e5, "s").value_or(0);
        }},
       {"--confirmation-pairs", "K", "fresh pairs of steps that confirm the chosen shape [41]",
        whole<6, 100'000, tune, &TuneOptions::confirmation_pairs>},
       {"--over", "LIST",
        "compare values of these settings instead of launch shapes: " +
            fmt::format("{}", fmt::join(comparison_axes(), ", ")),
        list<&compared_setting, tune, &TuneOptions::over>},
       {"--brute-force", "",
        "then measure all shapes; exit status 1 if one is more than 2 % faster than the chosen one",
        on<tune, &TuneOptions::brute_force>},
       {"--picture", "FILE", "PNG of the map of step times", file<tune, &TuneOptions::picture>},
       {"--kernel-tuner", "FILE", "shapes as a Kernel Tuner cache", file<tune, &TuneOptions::kernel_tuner>},
       {"--t4", "FILE", "shapes as T4 auto-tuning results", file<tune, &TuneOptions::t4>}});
  add("Stability tests", testing,
      {{"--extended", "", "run the long variants of the cases", on<stability, &StabilityOptions::extended>},
       {"--inject-faults", "", "run the injected-fault self-tests instead of the test cases",
        on<stability, &StabilityOptions::inject_faults>},
       {"--jobs", "K", "number of parallel trials; auto: one per core",
        whole_or_auto<1024, stability, &StabilityOptions::jobs>},
       {"--save-failures", "DIR", "folder for a snapshot of the state before each failure, for --load",
        file<stability, &StabilityOptions::save_failures>},
       {"--write-table", "FILE", "write the table of results into FILE instead of running cases",
        file<stability, &StabilityOptions::write_table>},
       {"--from", "FILE", "JSON report for --write-table; repeat for each machine",
        [](FlagValue& value, Options& options) { file_name(value, options.stability.from.emplace_back()); },
        true}});
  add("Stability tests", testing | viewing,
      {{"--cases", "DIR", "folder of the cases [assets/scenes/hard]",
        file<stability, &StabilityOptions::cases>}});
  add("Window", viewing,
      {{"--reset-ui", "", "reset panels, layers and theme to their defaults",
        on<&Options::view, &ViewRequest::reset_ui>},
       {"--automation", "FILE", "write one JSON line for each frame: state, positions of widgets",
        file<&Options::view, &ViewRequest::automation>}});
  add("Plug-ins", bit(Command::validate),
      {{"--timeout", "S", "s: longest time of one test [20]", [](FlagValue& value, Options& options) {
          options.validation_timeout = value.number(0.1, 1e5, "s").value_or(20);
        }}});
  add("Snapshots, changes, recordings", running | capturing | viewing | tuning,
      {{"--load", "FILE", "continue from a snapshot or the end of a recording; replaces SCENE",
        file<&Options::load>}});
  add("Snapshots, changes, recordings", running,
      {{"--changes", "FILE", "changes of settings and bodies during the run", file<&Options::changes>},
       {"--save", "FILE", "write a snapshot of the last state, for --load", file<&Options::save>},
       {"--write-scene", "FILE",
        "write the scene with the settings of these flags as a scene file; files of bodies must be in its "
        "folder",
        file<&Options::write_scene>},
       {"--record", "FILE", "record the run: states, changes, hashes; replay verifies it",
        file<&Options::record>}});
  return all;
}

}  // namespace

std::string flag_name(std::string_view setting) {
  std::string name = "--" + std::string(setting);
  std::ranges::replace(name, '_', '-');
  for (const RenamedFlag& renamed : renamed_flags)
    if (name == renamed.old_name) return std::string(renamed.name);
  return name;
}

std::span<const Flag> flags() {
  static const std::vector<Flag> all = all_flags();
  return all;
}

}  // namespace collidoscope
