// Man pages and shell completion, from the tables of commands and flags.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "headless/cli/command_line.h"
#include "headless/cli/flag_value.h"
#include "headless/markdown/reference_pages.h"
#include "sim_cuda/core/error.h"

namespace collidoscope {
namespace {

/// Text for roff: no line begins with a control character.
std::string roff(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
  }
  return escaped.starts_with('.') || escaped.starts_with('\'') ? "\\&" + escaped : escaped;
}

std::vector<std::string> groups_of(unsigned commands) {
  std::vector<std::string> groups;
  for (const Flag& flag : flags())
    if ((flag.commands & commands) != 0 && std::ranges::find(groups, flag.group) == groups.end())
      groups.push_back(flag.group);
  return groups;
}

std::string flag_sections(unsigned commands) {
  std::string text;
  for (const std::string& group : groups_of(commands)) {
    text += fmt::format(".SS {}\n", roff(group));
    for (const Flag& flag : flags()) {
      if ((flag.commands & commands) == 0 || flag.group != group) continue;
      text += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", roff(flag.name),
                          flag.value.empty() ? "" : " \\fI" + roff(flag.value) + "\\fR", roff(flag.help));
      std::vector<std::string> names;
      for (const CommandText& command : command_texts())
        if ((flag.commands & commands & bit(command.command)) != 0) names.push_back(command.name);
      if (!names.empty()) text += fmt::format("(with {})\n", fmt::join(names, ", "));
    }
  }
  return text;
}

std::string flag_words(Command command) {
  std::vector<std::string> names{"--help"};
  for (const Flag& flag : flags())
    if ((flag.commands & bit(command)) != 0) names.push_back(flag.name);
  return fmt::format("{}", fmt::join(names, " "));
}

}  // namespace

std::string man_page(std::string_view program) {
  const bool is_viewer = program == "collidoscope";
  if (!is_viewer && program != "collidoscope-headless")
    throw InputError(fmt::format(
        "help --man: {} is no program, expected collidoscope or collidoscope-headless", shown(program)));
  std::string text = fmt::format(
      ".TH {} 1 \"\" \"Collidoscope\"\n.SH NAME\n{} \\- visual debugger and profiler for GPU broad phases "
      "and "
      "rigid\\-body simulation{}\n",
      is_viewer ? "COLLIDOSCOPE" : "COLLIDOSCOPE\\-HEADLESS", roff(program),
      is_viewer ? "" : ", without a window");
  if (is_viewer)
    return text +
           ".SH SYNOPSIS\n\\fBcollidoscope\\fR [\\fISCENE\\fR | \\fIFILE\\fR...] [\\fIFLAGS\\fR]\n.SH "
           "FLAGS\n" +
           flag_sections(bit(Command::view)) + ".SH SEE ALSO\n.BR collidoscope\\-headless (1)\n";
  text +=
      ".SH SYNOPSIS\n\\fBcollidoscope\\-headless\\fR \\fICOMMAND\\fR [\\fIOPERANDS\\fR] [\\fIFLAGS\\fR]\n.SH "
      "COMMANDS\n";
  unsigned all = 0;
  for (const CommandText& command : command_texts()) {
    text += fmt::format(".TP\n\\fB{}\\fR \\fI{}\\fR\n{}\n", roff(command.name), roff(command.usage),
                        roff(command.help));
    all |= bit(command.command);
  }
  return text + ".SH FLAGS\n" + flag_sections(all) +
         ".SH EXIT STATUS\n0 success, 1 failed check, 2 bad input, 3 missing hardware, memory or display.\n"
         ".SH SEE ALSO\n.BR collidoscope (1)\n";
}

std::string bash_completion() {
  std::vector<std::string> names;
  std::string cases;
  for (const CommandText& command : command_texts()) {
    names.push_back(command.name);
    cases += fmt::format("    {}) flags='{}' ;;\n", command.name, flag_words(command.command));
  }
  return fmt::format(R"(# bash completion of collidoscope and collidoscope-headless
_collidoscope_headless() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} flags=
  if ((COMP_CWORD == 1)); then
    COMPREPLY=($(compgen -W '{} help' -- "$word"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  if [[ $word == -* ]]; then COMPREPLY=($(compgen -W "$flags" -- "$word")); else COMPREPLY=($(compgen -f -- "$word")); fi
}}
_collidoscope() {{
  local word=${{COMP_WORDS[COMP_CWORD]}}
  if [[ $word == -* ]]; then COMPREPLY=($(compgen -W '{}' -- "$word")); else COMPREPLY=($(compgen -f -- "$word")); fi
}}
complete -o filenames -F _collidoscope_headless collidoscope-headless
complete -o filenames -F _collidoscope collidoscope
)",
                     fmt::join(names, " "), cases, flag_words(Command::view));
}

}  // namespace collidoscope
