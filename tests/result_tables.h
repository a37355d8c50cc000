#pragma once
// Markdown tables of the pages in assets/results, made from the JSON files there.

#include <string>
#include <string_view>
#include <vector>

namespace collidoscope {

/// Names of the tables. A page marks a table with "<!-- begin generated: results NAME -->".
std::vector<std::string_view> result_table_names();

/// Throws InputError for an unknown name.
std::string result_table(std::string_view name);

}  // namespace collidoscope
