#include "headless/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>

#include "headless/cli/flag_value.h"
#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/assets.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

struct CommandName {
  const char* name;
  Command command;
  const char* operands;
  std::size_t least, most;  ///< operands
  const char* help;
};
constexpr std::array<CommandName, 7> commands{
    {{"run", Command::run, "SCENE", 1, 1, "step a scene and report what it cost; no pictures"},
     {"capture", Command::capture, "SCENE", 1, 1, "step a scene and write pictures of its states"},
     {"compare", Command::compare, "A.png B.png", 2, 2, "how different two pictures are"},
     {"bvh", Command::bvh, "SCENE", 1, 1, "how good the hierarchy of each broad phase is"},
     {"bench", Command::bench, "SUITE [SCENE]", 1, 2, "measure what things cost; a suite of measurements"},
     {"accuracy", Command::accuracy, "[SCENE]", 0, 1,
      "what accuracy costs: error over time; without a scene, cases in closed form"},
     {"stability", Command::stability, "[CASE...]", 0, std::numeric_limits<std::size_t>::max(),
      "what must hold of hard cases, with each solver in each precision"}}};

constexpr const char* exit_codes =
    "Exit status: 0 done, 1 a check failed, 2 bad input, 3 something that the machine lacks.";

constexpr CommandName viewer{"collidoscope", Command::view, "[SCENE]", 0, 1, "the window"};

std::string suite_names(std::span<const Suite> suites) {
  std::vector<std::string_view> names;
  for (const Suite& suite : suites) names.emplace_back(suite.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string program_help() {
  std::string text = "collidoscope-headless COMMAND ...: Collidoscope without a window.\n\n";
  for (const CommandName& one : commands)
    text += fmt::format("  {:<24}{}\n", fmt::format("{} {}", one.name, one.operands), one.help);
  return text +
         "\nA SCENE is a file, or the bare name of one in assets/scenes or assets/scenes/analytic,\n"
         "such as box_collider.\n"
         "COMMAND --help lists a command's flags; --version names the version.\n"
         "help --markdown [TOPIC] prints a reference table of the documents.\n" +
         exit_codes;
}

/// compare writes JSON to stdout alone; capture, whose stdout lists its pictures, to a file alone.
Flag as_taken_by(Command command, Flag flag) {
  if (flag.name != "--json") return flag;
  if (command == Command::compare) flag.value = "-", flag.help = "the report as JSON, alone on stdout";
  if (command == Command::capture) flag.value = "FILE", flag.help = "the report as JSON";
  return flag;
}

std::string command_help(const CommandName& command, std::span<const Suite> suites) {
  std::string text = fmt::format("{}{} {} [FLAGS]: {}.\n\n",
                                 command.command == Command::view ? "" : "collidoscope-headless ",
                                 command.name, command.operands, command.help);
  if (command.command == Command::bench) {
    for (const Suite& suite : suites) text += fmt::format("  {:<30}{}\n", suite.name, suite.help);
    text += '\n';
  }
  for (const Flag& every : flags()) {
    if (!(every.commands & bit(command.command))) continue;
    const Flag flag = as_taken_by(command.command, every);
    text += fmt::format("  {:<30}{}\n", fmt::format("{} {}", flag.name, flag.value), flag.help);
  }
  return text + "\n" + exit_codes;
}

CommandLine answer(std::string text) {
  CommandLine line;
  line.text = std::move(text);
  return line;
}

/// CLI11's own words for a flag at the end of the line that lacks its value, in ours.
std::string missing_value(const std::string& words) {
  const std::size_t colon = words.find(':');
  return words.starts_with("--") && colon != std::string::npos
             ? words.substr(0, colon) + ": its value is missing"
             : shown(words);
}

void check_operands(const CommandName& command, std::span<const Suite> suites,
                    const std::vector<std::string>& operands, bool loads, std::vector<std::string>& faults) {
  if (command.command == Command::bench && operands.empty())
    faults.push_back(fmt::format("bench: a suite is missing; there are {}", suite_names(suites)));
  else if (loads && !operands.empty())
    faults.push_back(fmt::format("--load: a snapshot has its own scene; leave out {}", shown(operands[0])));
  else if (!loads && operands.size() < command.least)
    faults.push_back(fmt::format("{}: {} missing: {} {}", command.name,
                                 command.least - operands.size() > 1 ? "two files are" : "a file is",
                                 command.name, command.operands));
  for (std::size_t extra = command.most; extra < operands.size(); ++extra)
    faults.push_back(fmt::format("{}: one argument too many; {} takes {}", shown(operands[extra]),
                                 command.name, command.operands));
}

/// The first operand of bench is its suite, and its scene is the Box Collider unless it says otherwise.
void take_suite(CommandLine& line, std::span<const Suite> suites, std::vector<std::string>& faults) {
  if (line.command != Command::bench || line.operands.empty()) return;
  line.suite = line.operands[0];
  line.operands.erase(line.operands.begin());
  if (std::ranges::find(suites, line.suite, [](const Suite& one) { return one.name; }) == suites.end())
    faults.push_back(
        fmt::format("bench: {} is no suite; there are {}", shown(line.suite), suite_names(suites)));
  if (line.operands.empty()) line.operands.emplace_back("box_collider");
}

/// A flag that the suite does not read would be ignored.
void check_suite_flag(const CommandLine& line, std::span<const Suite> suites, const Flag& flag,
                      std::vector<std::string>& faults) {
  const auto suite = std::ranges::find(suites, line.suite, [](const Suite& one) { return one.name; });
  if (suite == suites.end() || (flag.commands & bit(Command::run))) return;
  const std::string padded = fmt::format(" {} ", suite->flags);
  if (padded.find(fmt::format(" {} ", flag.name)) == std::string::npos)
    faults.push_back(
        fmt::format("{}: bench {} does not take it; it takes {}", flag.name, suite->name, suite->flags));
}

void check_files(const CommandLine& line, std::vector<std::string>& faults) {
  const Options& options = line.options;
  if (line.command == Command::compare && !options.json.empty() && options.json != "-")
    faults.push_back(fmt::format("--json: {} is not -, all that compare takes", shown(options.json)));
  if (line.command == Command::capture && options.json == "-")
    faults.emplace_back("--json: - is not a file; the stdout of capture lists its pictures");
  if (line.command == Command::compare) return;
  // One file for two things would keep the last alone; the scene would be lost.
  std::vector<std::pair<std::string, std::filesystem::path>> seen;
  const auto add = [&](const std::string& flag, const std::string& file) {
    if (file.empty() || file == "-") return;
    std::error_code failed;
    const auto path = std::filesystem::weakly_canonical(std::filesystem::absolute(file), failed);
    for (const auto& [other, taken] : seen)
      if (taken == path)
        faults.push_back(fmt::format("{}: {} is the file of {} too", flag, shown(file), other));
    seen.emplace_back(flag, path);
  };
  if (!line.operands.empty() && line.command != Command::stability) {
    try {
      add("the scene", scene_file(line.operands[0]));
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.lines().begin(), error.lines().end());
    }
  }
  add("--json", options.json == "-" ? "" : options.json);
  add("--dump-bodies", options.dump_bodies);
  add("--dump-dynamics", options.dump_dynamics);
  add("--energy-trace", options.energy_trace);
  add("--csv", options.bench.csv);
  add("--markdown", options.bench.markdown);
  add("--plot", options.bench.plot);
  add("--automation", options.view.automation);
  if (options.save != options.load) add("--load", options.load);  // going on in one file is no loss
  add("--changes", options.changes);
  add("--save", options.save);
}

/// The arguments that follow the command.
CommandLine parse_arguments(const CommandName& command, const std::vector<std::string>& arguments,
                            std::span<const Suite> suites) {
  CommandLine line;
  line.command = command.command;
  if (line.command == Command::bench) line.options.capture.height = 720;
  if (line.command == Command::accuracy) line.options.bench.repeats = 3;

  CLI::App app;
  app.allow_extras();
  std::vector<std::pair<const Flag*, CLI::Option*>> taken;
  for (const Flag& flag : flags()) {
    if (!(flag.commands & bit(line.command))) continue;
    CLI::Option* option = flag.value.empty() ? app.add_flag(flag.name) : app.add_option(flag.name);
    if (!flag.value.empty())
      option->take_all();  // twice is a fault of ours, not an exception that hides the others
    taken.emplace_back(&flag, option);
  }

  std::vector<std::string> faults;
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  } catch (const CLI::CallForHelp&) {
    return answer(command_help(command, suites));
  } catch (const CLI::ParseError& error) {
    faults.push_back(missing_value(error.what()));
  }
  for (const auto& [flag, option] : taken) {
    if (option->count() > 1 && !flag->value.empty() && !flag->again)
      faults.push_back(fmt::format("{}: given {} times; once is enough", flag->name, option->count()));
    else if (option->count() > 0)
      for (std::size_t k = 0; k < (flag->again ? option->count() : 1); ++k)
        read_flag(flag->name, option->results().at(k), line.options, faults);
  }
  for (const std::string& extra : app.remaining()) {
    if (extra.size() < 2 || extra[0] != '-')
      line.operands.push_back(extra);
    else if (extra != "--")
      faults.push_back(
          fmt::format("{}: unknown flag; {} --help lists those there are", shown(extra), command.name));
  }
  const bool loads = std::ranges::any_of(
      taken, [](const auto& one) { return one.first->name == "--load" && one.second->count() > 0; });
  check_operands(command, suites, line.operands, loads, faults);
  take_suite(line, suites, faults);
  for (const auto& [flag, option] : taken)
    if (option->count() > 0) check_suite_flag(line, suites, *flag, faults);
  check_files(line, faults);
  if (!faults.empty()) throw InputError(faults);
  return line;
}

}  // namespace

CommandLine parse_command_line(const std::vector<std::string>& arguments, std::span<const Suite> suites) {
  const std::string first = arguments.empty() ? "" : arguments[0];
  if (first == "--help" || first == "-h" || first == "help") return answer(program_help());
  if (first == "--version") return answer("collidoscope-headless " COLLIDOSCOPE_VERSION);
  const auto* command = std::ranges::find(commands, first, [](const CommandName& one) { return one.name; });
  if (command == commands.end())
    throw InputError((first.empty() ? "a command is missing" : shown(first) + ": unknown command") +
                     "; there are run, capture, compare, bvh, bench, accuracy and stability, and --help");
  return parse_arguments(*command, {std::next(arguments.begin()), arguments.end()}, suites);
}

CommandLine parse_viewer_line(const std::vector<std::string>& arguments) {
  if (std::ranges::find(arguments, "--version") != arguments.end())
    return answer("collidoscope " COLLIDOSCOPE_VERSION);
  CommandLine line = parse_arguments(viewer, arguments, {});
  if (line.operands.empty() && line.options.load.empty()) line.operands.emplace_back("box_collider");
  return line;
}

Scene load_scene(const CommandLine& line) {
  const std::string file = scene_file(line.operands[0]);
  Scene scene = read_scene(file);
  for (const std::string& warning : scene.warnings) fmt::print(stderr, "{}\n", warning);
  apply(line.options.overrides, file, scene);
  constexpr unsigned guarded = bit(Command::run) | bit(Command::capture) | bit(Command::view);
  if (!(guarded & bit(line.command))) disable_guards(scene.physics);
  return scene;
}

namespace {

/// Flags that ask for other bodies than those of the snapshot. Throws InputError.
void refuse_other_bodies(const SettingsPatch& settings, const std::string& file, const Scene& saved) {
  std::vector<std::string> faults;
  settings.for_each_set([&]<auto member>(const Field<member>& setting, const auto& value) {
    if (!is_of_generator(setting)) return;
    Scene scene = saved;
    apply(SettingsPatch().set<member>(value), scene);
    if (!requires_restart(saved, scene)) return;
    const std::string flag = flag_name(setting.name);
    faults.push_back(fmt::format("{}: {} has other bodies; leave out {}, or give the scene instead of --load",
                                 flag, shown(file), flag));
  });
  if (!faults.empty()) throw InputError(faults);
}

}  // namespace

Start load_start(const CommandLine& line) {
  Start start;
  if (line.options.load.empty()) {
    start.scene = load_scene(line);
    return start;
  }
  start.snapshot = read_snapshot(line.options.load);
  start.scene = start.snapshot->scene;
  apply(line.options.overrides, line.options.load, start.scene);
  refuse_other_bodies(line.options.overrides.settings, line.options.load, start.snapshot->scene);
  return start;
}

World Start::world(const RunOptions& options) const {
  return snapshot ? world_from(*snapshot, scene, options) : World(scene, options);
}

std::string scene_file(const std::string& given) {
  namespace fs = std::filesystem;
  std::error_code failed;
  if (given.empty()) throw InputError("'': neither a file nor the name of a scene");
  const bool bare = given.find('/') == std::string::npos && !given.ends_with(".json");
  if (!bare || fs::exists(given, failed)) return given;
  std::vector<std::string> names;
  for (const fs::path& folder : asset_folders()) {
    const bool first = names.empty();
    for (const fs::path& scenes : {folder / "scenes", folder / "scenes" / "analytic"}) {
      const fs::path file = scenes / (given + ".json");
      if (fs::exists(file, failed)) return file.string();
      if (!first) continue;
      for (const auto& entry : fs::directory_iterator(scenes, failed))
        if (entry.path().extension() == ".json") names.push_back(entry.path().stem().string());
    }
  }
  std::ranges::sort(names);
  throw InputError(fmt::format("{}: neither a file nor the name of a scene; {}", shown(given),
                               names.empty() ? "no folder assets/scenes was found"
                                             : fmt::format("there are {}", fmt::join(names, ", "))));
}

}  // namespace collidoscope
