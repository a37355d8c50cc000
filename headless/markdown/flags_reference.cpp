// The table of all flags, in groups. The commands that take a flag decide its group.

#include <array>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "headless/cli/options.h"
#include "headless/markdown/field_cells.h"
#include "headless/markdown/reference_pages.h"

namespace collidoscope {
namespace {

struct FlagCommand {
  Command command;
  std::string_view text;
};
constexpr auto flag_commands = std::to_array<FlagCommand>({{Command::run, "`run`"},
                                                           {Command::replay, "`replay`"},
                                                           {Command::capture, "`capture`"},
                                                           {Command::bvh, "`bvh`"},
                                                           {Command::bench, "`bench`"},
                                                           {Command::accuracy, "`accuracy`"},
                                                           {Command::stability, "`stability`"},
                                                           {Command::tune, "`tune`"},
                                                           {Command::compare, "`compare`"},
                                                           {Command::view, "the viewer"}});

constexpr unsigned drawing_commands = bit(Command::capture) | bit(Command::bench) | bit(Command::view);
constexpr unsigned measuring_commands = bit(Command::bench) | bit(Command::bvh) | bit(Command::accuracy);
constexpr unsigned stepping_commands =
    bit(Command::run) | drawing_commands | measuring_commands | bit(Command::tune);

struct FlagGroup {
  std::string_view heading;
  unsigned commands;  ///< that take its flags if their row names no others
};
enum FlagGroupIndex {
  simulation,
  execution,
  of_run,
  pictures,
  measurements,
  of_stability,
  of_tune,
  of_viewer
};
constexpr auto flag_groups = std::to_array<FlagGroup>({
    {"**Simulation** (`run`, `capture`, `bvh`, `bench`, `accuracy`, `tune` and the viewer). These change the "
     "result "
     "and override the scene.",
     stepping_commands},
    {"**Execution** (the same commands, and `replay`). These never change the result.",
     stepping_commands | bit(Command::replay)},
    {"**`run`**", bit(Command::run)},
    {"**Pictures** (`capture`, `bench frames` and the viewer)", drawing_commands},
    {"**Measurements** (`bench`, `bvh`, `accuracy`)", measuring_commands},
    {"**`stability`**", bit(Command::stability)},
    {"**`tune`**", bit(Command::tune)},
    {"**Viewer** (`collidoscope`)", bit(Command::view)},
});

bool takes_any(const Flag& flag, unsigned commands) { return (flag.commands & commands) != 0; }

FlagGroupIndex group_of_plain(const Flag& flag) {
  if ((flag.commands & stepping_commands) == stepping_commands) return execution;
  if (takes_any(flag, bit(Command::run))) return of_run;
  if (takes_any(flag, bit(Command::capture))) return pictures;
  if (takes_any(flag, measuring_commands)) return measurements;
  if (takes_any(flag, bit(Command::tune))) return of_tune;
  return takes_any(flag, bit(Command::stability)) ? of_stability : of_viewer;
}

/// "; also of `stability`", "; of `bench`", or nothing.
std::string other_commands(const Flag& flag, unsigned of_group) {
  if (flag.commands == of_group) return "";
  const bool contains_group = (flag.commands & of_group) == of_group;
  const unsigned named = contains_group ? flag.commands & ~of_group : flag.commands;
  std::vector<std::string_view> names;
  for (const FlagCommand& one : flag_commands)
    if (named & bit(one.command)) names.push_back(one.text);
  std::string text = contains_group ? "; also of " : "; of ";
  for (std::size_t k = 0; k < names.size(); ++k)
    text += std::string(k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + std::string(names[k]);
  return text;
}

/// The choices, range, help and default of a setting.
template <auto member>
std::string meaning_of_setting(const Field<member>& setting) {
  using Value = typename detail::Plain<typename Field<member>::Value>::Type;
  std::string text = prose(setting.help);
  if constexpr (std::is_same_v<Value, TimeStep>) {
    text += "; " + range_text(setting, setting.unit) + ", or `1/n`";
  } else if constexpr (std::is_same_v<Value, Effects>) {
    text += "; `none`; or a list such as `gravity,rotation`";
  } else if constexpr (is_field<member, &RunOptions::broad_phase>) {
    text = code_list(names_in(broad_phase_methods)) + ": " + text;
  } else if (!setting.choices.empty()) {
    text = code_list(choice_names(setting)) + ": " + text;
  } else {
    std::string range = range_text(setting, setting.unit);
    std::erase(range, '"');
    text += "; " + range;
  }
  if (is_physical(setting)) return text;
  std::string value = default_text(setting);
  std::erase(value, '"');
  text += "; default: " + value;
  const std::string choices = choices_help(setting);
  return choices.empty() ? text : text + ". " + choices;
}

}  // namespace

std::string flags_reference() {
  struct SettingRow {
    FlagGroupIndex group;
    std::string meaning;
  };
  std::map<std::string, SettingRow> settings;
  for_each_setting([&](const auto& setting) {
    settings[flag_name(setting.name)] = {is_physical(setting) ? simulation : execution,
                                         meaning_of_setting(setting)};
  });
  std::vector<MarkdownTable> tables(flag_groups.size(), MarkdownTable{"flag", "meaning"});
  for (const Flag& flag : flags()) {
    const auto setting = settings.find(flag.name);
    const bool is_setting = setting != settings.end();
    const FlagGroupIndex group = is_setting ? setting->second.group : group_of_plain(flag);
    tables[group].row({code(flag.value.empty() ? flag.name : flag.name + " " + flag.value),
                       (is_setting ? setting->second.meaning : prose(flag.help)) +
                           other_commands(flag, flag_groups[group].commands)});
  }
  std::string text;
  for (std::size_t k = 0; k < tables.size(); ++k)
    text += fmt::format("{}{}\n\n{}", k == 0 ? "" : "\n", flag_groups[k].heading, tables[k].text());
  return text;
}

}  // namespace collidoscope
