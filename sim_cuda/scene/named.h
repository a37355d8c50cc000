#pragma once
// Tables of named values for scene files, command lines and reports: one table per enumeration.

#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace collidoscope {

template <class Choice>
struct Named {
  std::string_view name;
  Choice value;
  std::string_view help = {};  ///< a short phrase for lists and generated documents
};

/// The name of a value, or "?" if the table does not contain it.
template <class Choice>
constexpr std::string_view name_of(std::span<const Named<Choice>> table, Choice value) {
  for (const Named<Choice>& entry : table) {
    if (entry.value == value) return entry.name;
  }
  return "?";
}

template <class Choice, std::size_t count>
constexpr std::string_view name_of(const std::array<Named<Choice>, count>& table, Choice value) {
  return name_of(std::span<const Named<Choice>>(table), value);
}

/// The value of a name. Unset if the table does not contain it.
template <class Choice>
constexpr std::optional<Choice> value_of(std::span<const Named<Choice>> table, std::string_view name) {
  for (const Named<Choice>& entry : table) {
    if (entry.name == name) return entry.value;
  }
  return std::nullopt;
}

template <class Choice, std::size_t count>
constexpr std::optional<Choice> value_of(const std::array<Named<Choice>, count>& table,
                                         std::string_view name) {
  return value_of(std::span<const Named<Choice>>(table), name);
}

/// All names of a table, in order. The entries must have a member `name`.
template <class Table>
std::vector<std::string_view> names_in(const Table& table) {
  std::vector<std::string_view> names;
  for (const auto& entry : table) names.push_back(entry.name);
  return names;
}

}  // namespace collidoscope
