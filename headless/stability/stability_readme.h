#pragma once
// The table of stability in a page of Markdown, as assets/results/stability.md: made from what `stability
// --json` wrote on one machine or several, and put between its two marks. Free functions.

#include <string>
#include <utility>
#include <vector>

namespace collidoscope {

inline constexpr const char* stability_begin = "<!-- stability -->";
inline constexpr const char* stability_end = "<!-- /stability -->";

/// The table, the declared limits, and how many they are, as Markdown. `runs`: the texts of the files, with
/// their names. Throws InputError where one is none of `stability --json`.
std::string stability_markdown(const std::vector<std::pair<std::string, std::string>>& runs);

/// `readme` with the table in place of what stands between the marks. `name` stands for it in faults. Throws
/// InputError where it has no marks.
std::string with_stability(const std::string& readme, const std::string& name, const std::string& table);

/// Reads the files of --json, and writes the table into the file `readme`, which stays whole. Throws
/// InputError or MachineError.
void rewrite_readme(const std::string& readme, const std::vector<std::string>& from);

}  // namespace collidoscope
