#include "headless/cli/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "headless/cli/flag_value.h"
#include "sim_cuda/changes/changes.h"
#include "sim_cuda/core/error.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

struct Operand {
  const char* name;
  const char* help;
  bool required = true, many = false;
};
constexpr Operand scene_operand{
    "SCENE",
    "scene file, or name of a scene in assets/scenes or assets/scenes/analytic; or bodies of "
    "another program: NPY, NPZ, CSV, XYZ, LAMMPS dump, PLY, OBJ, STL, URDF, MJCF"};
constexpr Operand optional_scene{scene_operand.name, scene_operand.help, false};
struct CommandInfo {
  std::string name;
  Command command;
  const char* help;
  std::vector<Operand> operands;

  /// Such as "SUITE [SCENE]".
  std::string usage() const {
    std::vector<std::string> names;
    for (const Operand& one : operands) {
      const std::string operand = fmt::format("{}{}", one.name, one.many ? "..." : "");
      names.push_back(one.required ? operand : "[" + operand + "]");
    }
    return fmt::format("{}", fmt::join(names, " "));
  }
};

const std::vector<CommandInfo>& commands() {
  static const std::vector<CommandInfo> every{
      {"run", Command::run, "simulate a scene and report state and cost, without pictures", {scene_operand}},
      {"replay",
       Command::replay,
       "simulate a recorded run again and compare every state",
       {{"FILE", "recording of run --record"}}},
      {"capture",
       Command::capture,
       "simulate a scene and write pictures of its states; several files of bodies are its states",
       {{scene_operand.name, scene_operand.help, true, true}}},
      {"compare",
       Command::compare,
       "measure the difference of two pictures",
       {{"A.png", "first picture"}, {"B.png", "second picture"}}},
      {"bvh", Command::bvh, "measure the quality of the tree of each broad phase", {scene_operand}},
      {"bench",
       Command::bench,
       "run a suite of measurements",
       {{"SUITE", "name of a suite below"}, optional_scene}},
      {"accuracy",
       Command::accuracy,
       "convergence study: error versus run time; without SCENE, for cases with closed-form solutions",
       {optional_scene}},
      {"stability",
       Command::stability,
       "stress-test suite over all solvers and precisions",
       {{"CASE", "name of a case [all]", false, true}}},
      {"tune", Command::tune, "measure launch shapes (B, T) and find the fastest", {scene_operand}},
      {"validate",
       Command::validate,
       "test a broad-phase plug-in in a separate process",
       {{"FILE.so", "library that exports the functions of collidoscope/broad_phase.h"}}}};
  return every;
}

constexpr const char* exit_codes =
    "Exit status: 0 success, 1 failed check, 2 bad input, 3 missing hardware, memory or display.";

std::string suite_names(std::span<const Suite> suites) {
  std::vector<std::string_view> names;
  for (const Suite& suite : suites) names.emplace_back(suite.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string suite_list(std::span<const Suite> suites) {
  std::string text = "Suites:\n";
  for (const Suite& suite : suites) text += fmt::format("  {:<28}{}\n", suite.name, suite.help);
  return text + '\n';
}

/// compare writes JSON only to stdout, capture only to a file: its stdout lists the pictures.
Flag as_taken_by(Command command, Flag flag) {
  if (flag.name != "--json") return flag;
  if (command == Command::compare) flag.value = "-", flag.help = "the report as JSON on stdout";
  if (command == Command::capture) flag.value = "FILE", flag.help = "the report as JSON";
  return flag;
}

/// Omits the old names of flags.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(30);
    label("OPTIONS", "FLAGS");
    label("SUBCOMMAND", "COMMAND ...");
    label("Positionals", "Operands");
    label("REQUIRED", "");
  }
  std::string make_option_name(const CLI::Option* option, bool positional) const override {
    return option->get_lnames().size() > 1 ? option->get_name()
                                           : CLI::Formatter::make_option_name(option, positional);
  }
};

void set_up(CLI::App& app) {
  app.formatter(std::make_shared<HelpFormatter>());
  app.set_help_flag("-h,--help", "print this help and exit");
  app.footer(exit_codes);
  app.allow_extras();
}

/// Help of the selected command, else of the program.
std::string help_of(const CLI::App& app) {
  std::string text = app.help();
  // CLI11 separates groups by two blank lines.
  for (std::size_t at; (at = text.find("\n\n\n")) != std::string::npos;) text.erase(at, 1);
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

/// Returns the text that --help or --version requests, else "". Throws CLI::ParseError.
std::string parse(CLI::App& app, const std::vector<std::string>& arguments) {
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
    return "";
  } catch (const CLI::CallForHelp&) {
    return help_of(app);
  } catch (const CLI::CallForVersion& version) {
    return version.what();
  } catch (const CLI::ConversionError& error) {  // of --version=x
    throw InputError(shown(error.what()));
  }
}

/// Adds the operands and flags of a command. The parser fills `line` and adds faults; it does not throw for
/// a value, so that all faults of a command line are reported at once.
void add_arguments(CLI::App& app, const CommandInfo& command, CommandLine& line,
                   std::vector<std::string>& faults) {
  for (const Operand& operand : command.operands) {
    const auto take = [&line](const CLI::results_t& texts) {
      line.operands.insert(line.operands.end(), texts.begin(), texts.end());
      return true;
    };
    CLI::Option* option = app.add_option(operand.name, take, operand.help)->required(operand.required);
    if (operand.many) option->expected(-1)->take_all();
  }
  for (const Flag& flag : flags()) {
    if (!(flag.commands & bit(command.command))) continue;
    std::string names = flag.name;
    for (const RenamedFlag& renamed : renamed_flags)
      if (renamed.name == flag.name) names += fmt::format(",{}", renamed.old_name);
    const auto take = [&](const CLI::results_t& texts) {
      if (texts.size() > 1 && !flag.value.empty() && !flag.again) {
        faults.push_back(fmt::format("{}: given {} times, expected once", flag.name, texts.size()));
        return true;
      }
      for (const std::string& text : texts) {
        FlagValue value(flag.name, text, faults);
        flag.read(value, line.options);
      }
      return true;
    };
    const Flag shown_flag = as_taken_by(command.command, flag);
    CLI::Option* option = app.add_option(names, take, shown_flag.help)->take_all()->group(flag.group);
    if (flag.value.empty())
      option->expected(0);
    else
      option->option_text(shown_flag.value);
  }
}

bool is_given(const CLI::App& app, std::string_view flag) {
  const CLI::Option* option = app.get_option_no_throw(std::string(flag));
  return option != nullptr && option->count() > 0;
}

void warn_of_old_names(const CLI::App& app, const std::vector<std::string>& arguments) {
  for (const auto& [old_name, name] : renamed_flags) {
    const auto is_old = [old = old_name](const std::string& text) {
      return text.substr(0, text.find('=')) == old;
    };
    if (is_given(app, name) && std::ranges::any_of(arguments, is_old))
      fmt::print(stderr, "{}: renamed to {}; the old name is still accepted\n", old_name, name);
  }
}

void check_operands(const CommandInfo& command, std::span<const Suite> suites,
                    const std::vector<std::string>& operands, const CLI::App& app,
                    std::vector<std::string>& faults) {
  const bool loads = is_given(app, "--load"), has_boxes = is_given(app, "--boxes");
  const auto required = std::ranges::count_if(command.operands, &Operand::required);
  const auto missing = required - std::ssize(operands);
  if (command.command == Command::bench && operands.empty())
    faults.push_back(fmt::format("bench: missing SUITE, expected one of {}", suite_names(suites)));
  else if (loads && !operands.empty())
    faults.push_back(fmt::format("--load: the snapshot contains its scene; remove {}", shown(operands[0])));
  else if (loads && has_boxes)
    faults.emplace_back("--boxes: the snapshot of --load contains its bodies; remove one of them");
  else if (has_boxes && !operands.empty())
    faults.push_back(fmt::format("--boxes: the boxes replace the scene; remove {}", shown(operands[0])));
  else if (!loads && !has_boxes && missing > 0)
    faults.push_back(fmt::format("{}: missing {}, expected {} {}", command.name,
                                 missing > 1 ? "two files" : "file", command.name, command.usage()));
}

/// The first operand of bench is its suite, and its scene is the Box Collider unless it says otherwise.
void take_suite(CommandLine& line, std::span<const Suite> suites, std::vector<std::string>& faults) {
  if (line.command != Command::bench || line.operands.empty()) return;
  line.suite = line.operands[0];
  line.operands.erase(line.operands.begin());
  if (std::ranges::find(suites, line.suite, &Suite::name) == suites.end())
    faults.push_back(
        fmt::format("bench: unknown suite {}, expected one of {}", shown(line.suite), suite_names(suites)));
  if (line.operands.empty()) line.operands.emplace_back("box_collider");
}

/// A flag that the suite does not read would be ignored.
void check_suite_flag(const CommandLine& line, std::span<const Suite> suites, const Flag& flag,
                      std::vector<std::string>& faults) {
  const auto suite = std::ranges::find(suites, line.suite, &Suite::name);
  if (suite == suites.end() || (flag.commands & bit(Command::run))) return;
  const std::string padded = fmt::format(" {} ", suite->flags);
  if (padded.find(fmt::format(" {} ", flag.name)) == std::string::npos)
    faults.push_back(
        fmt::format("{}: not a flag of bench {}, expected {}", flag.name, suite->name, suite->flags));
}

void check_files(const CLI::App& app, const CommandLine& line, std::vector<std::string>& faults) {
  const Options& options = line.options;
  if (line.command == Command::compare && !options.json.empty() && options.json != "-")
    faults.push_back(fmt::format("--json: {} is not supported by compare, expected -", shown(options.json)));
  if (line.command == Command::capture && options.json == "-")
    faults.emplace_back(
        "--json: - is not supported by capture, which lists pictures on stdout; expected a file");
  if (line.command == Command::compare) return;
  // One file for two things would keep the last alone; the scene would be lost.
  std::vector<std::pair<std::string, std::filesystem::path>> seen;
  const auto add = [&](const std::string& flag, const std::string& file) {
    if (file.empty() || file == "-") return;
    std::error_code failed;
    const auto path = std::filesystem::weakly_canonical(std::filesystem::absolute(file), failed);
    for (const auto& [other, taken] : seen)
      if (taken == path)
        faults.push_back(fmt::format("{}: {} is also the file of {}, expected a different file", flag,
                                     shown(file), other));
    seen.emplace_back(flag, path);
  };
  if (!line.operands.empty() && line.command != Command::stability && line.command != Command::replay &&
      line.command != Command::validate) {
    try {
      add("the scene", scene_file(line.operands[0]));
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.lines().begin(), error.lines().end());
    }
  }
  for (const Flag& flag : flags())
    if (flag.value.starts_with("FILE") && is_given(app, flag.name) &&
        !(flag.name == "--load" && options.save == options.load))  // the run can replace its snapshot
      add(flag.name, app.get_option(flag.name)->results()[0]);
}

std::string expected_commands() {
  std::vector<std::string_view> names;
  for (const CommandInfo& command : commands()) names.emplace_back(command.name);
  return fmt::format(", expected {}", fmt::join(names, ", "));
}

/// `app` is the whole program and `selected` the part that is the command.
CommandLine parse_command(CLI::App& app, CLI::App& selected, const CommandInfo& command,
                          const std::vector<std::string>& arguments, std::span<const Suite> suites) {
  CommandLine line;
  line.command = command.command;
  if (line.command == Command::bench) line.options.capture.height = 720;
  if (line.command == Command::accuracy) line.options.bench.repeats = 3;
  std::vector<std::string> faults;
  add_arguments(selected, command, line, faults);
  try {
    line.text = parse(app, arguments);
    if (!line.text.empty()) return line;
  } catch (const CLI::RequiredError&) {     // check_operands names the operand
  } catch (const CLI::ArgumentMismatch&) {  // the last flag lacks its value
    const std::string& flag = arguments.back();
    faults.push_back(shown(flag.substr(0, flag.find('='))) + ": missing value");
    for (CLI::Option* option : selected.get_options())
      if (option->count() > 0 && !option->get_callback_run()) option->run_callback();
  }
  // CLI11's mark for the end of a subcommand.
  if (std::ranges::find(arguments, "++") != arguments.end())
    faults.push_back(fmt::format("++: unexpected argument; usage: {} {}", command.name, command.usage()));
  warn_of_old_names(selected, arguments);
  for (const std::string& extra : app.remaining(true)) {
    if (extra.size() < 2 || extra[0] != '-')
      faults.push_back(
          fmt::format("{}: unexpected argument; usage: {} {}", shown(extra), command.name, command.usage()));
    else if (extra != "--")
      faults.push_back(fmt::format("{}: unknown flag; see {} --help", shown(extra), command.name));
  }
  if (line.command == Command::view || line.command == Command::capture)
    sort_by_numbers(line.operands);  // a shell has 10 before 2
  check_operands(command, suites, line.operands, selected, faults);
  take_suite(line, suites, faults);
  for (const Flag& flag : flags())
    if (is_given(selected, flag.name)) check_suite_flag(line, suites, flag, faults);
  check_files(selected, line, faults);
  if (!faults.empty()) throw InputError(faults);
  return line;
}

}  // namespace

std::vector<CommandText> command_texts() {
  std::vector<CommandText> texts;
  for (const CommandInfo& command : commands())
    texts.push_back({command.name, command.usage(), command.help, command.command});
  return texts;
}

CommandLine parse_command_line(const std::vector<std::string>& arguments, std::span<const Suite> suites) {
  CLI::App app("Collidoscope without a window.", "collidoscope-headless");
  set_up(app);
  app.set_version_flag("--version", "collidoscope-headless " COLLIDOSCOPE_VERSION,
                       "print the version and exit");
  app.require_subcommand(0, 1);
  for (const CommandInfo& command : commands()) app.add_subcommand(command.name, command.help);
  app.get_subcommand("bench")->footer(suite_list(suites) + exit_codes);
  const std::string first = arguments.empty() ? "" : arguments[0];
  const auto command = std::ranges::find(commands(), first, &CommandInfo::name);
  if (command != commands().end())
    return parse_command(app, *app.get_subcommand(first), *command, arguments, suites);
  if (first == "help" && arguments.size() > 2)
    throw InputError(shown(arguments[2]) + ": unexpected argument; usage: help [COMMAND]");
  if (first == "help" && arguments.size() > 1) {
    if (std::ranges::find(commands(), arguments[1], &CommandInfo::name) == commands().end())
      throw InputError("help " + shown(arguments[1]) + ": unknown command" + expected_commands());
    return parse_command_line({arguments[1], "--help"}, suites);
  }
  CommandLine answer;
  answer.text = first == "help" ? help_of(app) : parse(app, {first});
  if (answer.text.empty())
    throw InputError((first.empty() ? "missing command" : shown(first) + ": unknown command") +
                     expected_commands() + " or --help");
  return answer;
}

CommandLine parse_viewer_line(const std::vector<std::string>& arguments) {
  const std::string series_help =
      std::string(optional_scene.help) + "; several files of bodies are the frames of a run";
  const CommandInfo viewer{"collidoscope",
                           Command::view,
                           "The window.",
                           {{optional_scene.name, series_help.c_str(), false, true}}};
  CLI::App app("Collidoscope in a window.", viewer.name);
  set_up(app);
  app.set_version_flag("--version", "collidoscope " COLLIDOSCOPE_VERSION, "print the version and exit");
  CommandLine line = parse_command(app, app, viewer, arguments, {});
  if (line.text.empty() && line.operands.empty() && line.options.load.empty() &&
      line.options.bench.boxes.empty())
    line.operands.emplace_back("box_collider");
  return line;
}

}  // namespace collidoscope
