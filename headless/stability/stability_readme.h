#pragma once
// The stability table in a Markdown page such as assets/results/stability.md. Created from the files of
// `stability --json` of one or more machines, and inserted between two marks. Stateless functions.

#include <string>
#include <utility>
#include <vector>

namespace collidoscope {

inline constexpr const char* stability_begin = "<!-- stability -->";
inline constexpr const char* stability_end = "<!-- /stability -->";

/// The table, the expected failures and their number, as Markdown. `runs`: contents and names of the files.
/// Throws InputError if a file was not written by `stability --json`.
std::string stability_markdown(const std::vector<std::pair<std::string, std::string>>& runs);

/// Replaces the text between the marks of `readme` by the table. `name` is used in messages. Throws
/// InputError if the marks are missing.
std::string with_stability(const std::string& readme, const std::string& name, const std::string& table);

/// Reads the --json files and updates the file `readme` atomically. Throws InputError or MachineError.
void rewrite_readme(const std::string& readme, const std::vector<std::string>& from);

}  // namespace collidoscope
