#pragma once
// The reference tables of the documents, made from the tables of the code. `help --markdown TOPIC` prints
// one. A page has it between the marks `<!-- begin generated: help --markdown TOPIC -->` and
// `<!-- end generated -->`.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace collidoscope {

struct ReferenceTopic {
  std::string_view name;
  std::string (*table)();  ///< Markdown, ends in a newline
};
std::span<const ReferenceTopic> reference_topics();

/// Throws InputError for an unknown topic.
std::string reference_table(std::string_view topic);

/// What the arguments `help --markdown [TOPIC]` print; unset for other arguments. Throws InputError.
std::optional<std::string> markdown_help(const std::vector<std::string>& arguments);

/// What `help --man PROGRAM` and `help --completion` print: a man page in roff, and completion for bash.
std::string man_page(std::string_view program);
std::string bash_completion();

std::string flags_reference();
std::string scene_reference();
std::string effects_reference();
std::string changes_reference();
std::string report_reference();
std::string broad_phases_reference();
std::string breaks_reference();
std::string quantities_reference();

}  // namespace collidoscope
