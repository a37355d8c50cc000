// The flags of the command line: what each is called, what --help says of it, and how its text is read.
// More than 400 lines: the table of all flags.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "headless/cli/flag_value.h"
#include "headless/cli/options.h"
#include "headless/cli/setting_flags.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/broad_phase_methods.h"
#include "sim_cuda/scene/crowded_scenes.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/world.h"

namespace collidoscope {
namespace {

constexpr std::string_view or_auto = ", or auto";
constexpr std::int64_t max_int = std::numeric_limits<int>::max();

/// One flag being read: its text, and where the value or the faults go.
struct FlagReading {
  FlagValue value;
  Options& options;
  std::vector<std::string>& faults;
};

std::optional<int> read_count(FlagValue& value, std::int64_t min, std::int64_t max,
                              std::string_view or_word = "") {
  const auto number = value.whole(min, max, or_word);
  return number ? std::optional(static_cast<int>(*number)) : std::nullopt;
}

void read_count_or_auto(FlagValue& value, std::int64_t max, int& count) {
  if (value.text() == "auto") {
    count = 0;
  } else if (const auto number = value.whole(1, max, or_auto)) {
    count = static_cast<int>(*number);
  }
}

void read_guards(FlagValue& value, Overrides& overrides) {
  if (value.text() == "off")
    overrides.guards = std::optional<OnFailure>{};
  else if (const auto on_failure = value_of(on_failure_names, value.text()))
    overrides.guards = std::optional<OnFailure>{*on_failure};
  else
    value.refuse("pause, freeze or off");
}

void read_path(FlagValue& value, std::string& path) {
  if (value.text().empty() || value.text().find('\0') != std::string_view::npos)
    value.refuse("the name of a file");
  else
    path = value.text();
}

/// Reads each part of a comma-separated list.
template <class Read>
void for_each_part(FlagReading& in, Read read) {
  std::string_view rest = in.value.text();
  for (bool more = true; more;) {
    const std::size_t comma = rest.find(',');
    FlagValue part(in.value.flag(), rest.substr(0, comma), in.faults);
    read(part);
    more = comma != std::string_view::npos;
    if (more) rest.remove_prefix(comma + 1);
  }
}

/// Some readers throw their faults.
template <class Read>
void collect(std::vector<std::string>& faults, Read read) {
  try {
    read();
  } catch (const InputError& error) {
    faults.insert(faults.end(), error.lines().begin(), error.lines().end());
  }
}

constexpr unsigned running = bit(Command::run), capturing = bit(Command::capture);
constexpr unsigned viewing = bit(Command::view), benching = bit(Command::bench), grading = bit(Command::bvh);
constexpr unsigned studying = bit(Command::accuracy), breaking = bit(Command::stability);
constexpr unsigned drawing = capturing | viewing | benching,
                   stepping = running | drawing | grading | studying;
constexpr unsigned guarding = running | capturing | viewing;
constexpr unsigned reporting =
    running | capturing | benching | grading | studying | breaking | bit(Command::compare);

struct PlainFlag {
  const char *name, *value, *help;
  unsigned commands;
  bool again = false;
};
struct Reader {
  PlainFlag flag;
  void (*read)(FlagReading& in);
};

/// All but those of settings.
constexpr Reader readers[] = {
    {{"--guards", "NAME", "pause, freeze or off: what happens where a step goes wrong", guarding},
     [](FlagReading& in) { read_guards(in.value, in.options.overrides); }},
    {{"--break", "LIST",
      "such as non-finite,energy-rise=5,penetration=0.1,speed=100,stage-ms=20,escaped: where it stops",
      running | viewing},
     [](FlagReading& in) {
       collect(in.faults, [&] { in.options.breaks = parse_break_conditions(std::string(in.value.text())); });
     }},

    {{"--allow-large", nullptr, "steps may take all memory that is available, not only 80 % of it",
      stepping | breaking},
     [](FlagReading& in) { in.options.run.allow_large = true; }},
    {{"--steps", "K", "steps to run [300; bvh: 0]; the viewer pauses at this state",
      running | viewing | grading},
     [](FlagReading& in) {
       const auto n = in.value.whole(0, 1'000'000'000);
       if (n) in.options.steps = *n;
       in.options.view.pause_at = n;
     }},
    {{"--json", "FILE|-", "the report as JSON; with -, alone on stdout", reporting},
     [](FlagReading& in) { read_path(in.value, in.options.json); }},
    {{"--dump-bodies", "FILE", "CSV: the state of every body at the end", running},
     [](FlagReading& in) { read_path(in.value, in.options.dump_bodies); }},
    {{"--dump-dynamics", "FILE", "CSV: mass, X, R, P, L, inverse inertia, F, T of every body at the end",
      running},
     [](FlagReading& in) { read_path(in.value, in.options.dump_dynamics); }},
    {{"--energy-trace", "FILE", "CSV: energies, pairs and penetration at every state", running},
     [](FlagReading& in) { read_path(in.value, in.options.energy_trace); }},
    {{"--residuals", nullptr, "what each sweep of the last step's solver left, in the report", running},
     [](FlagReading& in) { in.options.residuals = true; }},

    {{"--save", "FILE", "a snapshot of the run at its end, from which --load goes on", running},
     [](FlagReading& in) { read_path(in.value, in.options.save); }},
    {{"--load", "FILE", "goes on from a snapshot, in place of a SCENE", running | capturing | viewing},
     [](FlagReading& in) { read_path(in.value, in.options.load); }},
    {{"--changes", "FILE", "what is changed on the way: settings, bodies added and removed", running},
     [](FlagReading& in) { read_path(in.value, in.options.changes); }},

    {{"--states", "LIST",
      "states to draw, counted from the run's state 0 [the first, and 30 and 60 steps after it]", capturing},
     [](FlagReading& in) {
       collect(in.faults, [&] { in.options.capture.states = parse_states(std::string(in.value.text())); });
     }},
    {{"--layers", "LIST", "such as spheres,bvh:2-5,contacts", drawing},
     [](FlagReading& in) {
       collect(in.faults, [&] {
         const FrameLayers before = in.options.capture.layers;
         FrameLayers& layers = in.options.capture.layers;
         layers = parse_layers(std::string(in.value.text()));
         layers.color = before.color;
         layers.box_color = before.box_color;
         layers.box_low = before.box_low;
         layers.box_high = before.box_high;
       });
     }},
    {{"--color", "NAME",
      "speed, radius, id, contacts, order, depth, visits, sleep or error: what colours the bodies", drawing},
     [](FlagReading& in) {
       collect(in.faults,
               [&] { in.options.capture.layers.color = parse_body_color(std::string(in.value.text())); });
     }},
    {{"--box-color", "NAME", "level, sah, overlap, empty or visits: what colours the boxes", drawing},
     [](FlagReading& in) {
       collect(in.faults,
               [&] { in.options.capture.layers.box_color = parse_box_color(std::string(in.value.text())); });
     }},
    {{"--box-range", "LOW,HIGH", "values of the boxes that are drawn, by what colours them; HIGH may be inf",
      drawing},
     [](FlagReading& in) {
       collect(in.faults, [&] { parse_box_range(std::string(in.value.text()), in.options.capture.layers); });
     }},
    {{"--size", "WxH", "pixels of a picture", drawing},
     [](FlagReading& in) {
       collect(in.faults, [&] { parse_size(std::string(in.value.text()), in.options.capture); });
     }},
    {{"--out", "DIR", "where pictures go [captures]", capturing},
     [](FlagReading& in) { read_path(in.value, in.options.capture.out); }},
    {{"--display-path", "NAME", "auto, interop, copy or upload: how data reach the picture", drawing},
     [](FlagReading& in) {
       collect(in.faults,
               [&] { in.options.capture.display_path = parse_display_path(std::string(in.value.text())); });
     }},
    {{"--quality", "NAME", "full, quick or auto: ambient occlusion and soft shadows, or neither", drawing},
     [](FlagReading& in) {
       collect(in.faults,
               [&] { in.options.capture.draw.light = parse_quality(std::string(in.value.text())); });
     }},
    {{"--supersample", "K", "K x K samples for each pixel of the 3D view, 1 to 4, or auto", drawing},
     [](FlagReading& in) {
       in.options.capture.draw.supersampling.reset();
       if (in.value.text() != "auto")
         in.options.capture.draw.supersampling = read_count(in.value, 1, 4, or_auto);
     }},
    {{"--sphere-method", "NAME", "auto, quads or compute: what draws spheres; the picture is the same",
      drawing},
     [](FlagReading& in) {
       collect(in.faults,
               [&] { in.options.capture.draw.spheres = parse_sphere_method(std::string(in.value.text())); });
     }},
    {{"--timings", nullptr, "draw stage times too; such pictures differ from run to run", capturing},
     [](FlagReading& in) { in.options.capture.timings = true; }},

    {{"--frames", "K", "frames to measure [300], after some that warm up", benching},
     [](FlagReading& in) {
       if (const auto n = in.value.whole(1, 1'000'000)) in.options.frames = *n;
     }},

    {{"--methods", "LIST", "broad phases to compare, comma-separated [all]", benching | grading},
     [](FlagReading& in) {
       in.options.bench.methods.clear();
       for_each_part(in, [&](FlagValue& part) {
         static const std::vector<std::string> known = broad_phase_names();
         if (const auto name = part.word(known)) in.options.bench.methods.push_back(*name);
       });
     }},
    {{"--variants", "LIST",
      "variants of the Box Collider to compare, and mixed, log_normal, clusters; comma-separated", benching},
     [](FlagReading& in) {
       in.options.bench.variants.clear();
       for_each_part(in, [&](FlagValue& part) {
         static const std::vector<std::string> known = compared_scenes();
         if (const auto variant = part.word(known)) in.options.bench.variants.push_back(*variant);
       });
     }},
    {{"--sizes", "LIST", "numbers of bodies to compare, comma-separated", benching},
     [](FlagReading& in) {
       in.options.bench.sizes.clear();
       for_each_part(in, [&](FlagValue& part) {
         if (const auto n = part.whole(1, limits::max_bodies)) in.options.bench.sizes.push_back(*n);
       });
     }},
    {{"--repeats", "K", "how often each thing is timed [50; accuracy: 3; paper: 20, or what 2 s allow]",
      benching | grading | studying},
     [](FlagReading& in) {
       if (const auto n = in.value.whole(1, 1'000'000)) {
         in.options.bench.repeats = *n;
         in.options.bench.repeats_given = true;
       }
     }},
    {{"--csv", "FILE", "the rows of a suite as CSV", benching | studying},
     [](FlagReading& in) { read_path(in.value, in.options.bench.csv); }},
    {{"--markdown", "FILE", "the rows of a suite as a table in Markdown", benching | studying},
     [](FlagReading& in) { read_path(in.value, in.options.bench.markdown); }},

    {{"--plot", "FILE.png", "a chart of the suite", benching | studying},
     [](FlagReading& in) { read_path(in.value, in.options.bench.plot); }},

    {{"--tolerance", "E", "m: names the cheapest setting whose error is no larger; 1 if there is none",
      studying},
     [](FlagReading& in) {
       in.options.accuracy.tolerance = in.value.number(limits::min_tolerance, limits::max_tolerance, "m");
     }},
    {{"--seconds", "T", "simulated seconds to compare at most, 2 steps or more [60 steps, and at least 2 s]",
      studying},
     [](FlagReading& in) {
       if (const auto seconds = in.value.number(1e-6, 1e6, "s")) in.options.accuracy.seconds = *seconds;
     }},

    {{"--long", nullptr, "the long variants of the cases that have one", breaking},
     [](FlagReading& in) { in.options.stability.extended = true; }},
    {{"--plant", nullptr, "in place of the trials: faults, each of which must fail its criterion", breaking},
     [](FlagReading& in) { in.options.stability.plant = true; }},
    {{"--jobs", "K", "trials side by side, or auto: one for each core", breaking},
     [](FlagReading& in) { read_count_or_auto(in.value, 1024, in.options.stability.jobs); }},
    {{"--cases", "DIR", "a folder of cases [assets/scenes/hard]", breaking | viewing},
     [](FlagReading& in) { read_path(in.value, in.options.stability.cases); }},
    {{"--save-failures", "DIR", "snapshots, from which --load goes on to what failed", breaking},
     [](FlagReading& in) { read_path(in.value, in.options.stability.save_failures); }},
    {{"--readme", "FILE", "in place of the trials: writes the table of stability in FILE anew", breaking},
     [](FlagReading& in) { read_path(in.value, in.options.stability.readme); }},
    {{"--from", "FILE", "of --readme: what --json wrote; once for each machine", breaking, true},
     [](FlagReading& in) { read_path(in.value, in.options.stability.from.emplace_back()); }},

    {{"--reset-ui", nullptr, "panels, layers and theme as on the first day", viewing},
     [](FlagReading& in) { in.options.view.reset_ui = true; }},
    {{"--automation", "FILE", "a line of JSON for each frame: state, and where each widget is", viewing},
     [](FlagReading& in) { read_path(in.value, in.options.view.automation); }},
};

}  // namespace

std::string flag_name(std::string_view setting) {
  std::string name = "--" + std::string(setting);
  std::ranges::replace(name, '_', '-');
  return name;
}

std::span<const Flag> flags() {
  static const std::vector<Flag> every = [] {
    std::vector<Flag> list;
    for_each_setting([&](const auto& setting) {
      if (has_flag(setting))
        list.push_back({flag_name(setting.name), std::string(setting.placeholder), help_of_flag(setting),
                        setting.for_stability ? stepping | breaking : stepping});
    });
    for (const auto& [flag, read] : readers)
      list.push_back({flag.name, flag.value ? flag.value : "", flag.help, flag.commands, flag.again});
    return list;
  }();
  return every;
}

void read_flag(std::string_view flag, std::string_view text, Options& options,
               std::vector<std::string>& faults) {
  FlagReading in{FlagValue(flag, text, faults), options, faults};
  for_each_setting([&]<auto member>(const Field<member>& setting) {
    if (!has_flag(setting) || flag != flag_name(setting.name)) return;
    auto value = parse_setting(in.value, setting);
    if constexpr (is_physical(Field<member>{})) {
      options.overrides.settings.get<member>() = std::move(value);
    } else if (value) {
      using Owner = typename Field<member>::Owner;
      if constexpr (std::is_same_v<Owner, LaunchShape>)
        options.run.shape.*member = *value;
      else
        options.run.*member = *value;
    }
  });
  for (const Reader& reader : readers)
    if (flag == reader.flag.name) reader.read(in);
}

}  // namespace collidoscope
