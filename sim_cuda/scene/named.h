#pragma once
// Values with names, as scene files, command lines and reports write them: one table per enumeration.

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
  std::string_view help = {};  ///< a phrase for lists and generated documents
};

/// The name of a value that is in the table; "?" for another one.
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

/// The value of a name; unset if the table lacks the name.
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

/// All names of a table, in order. Its entries have a member `name`.
template <class Table>
std::vector<std::string_view> names_in(const Table& table) {
  std::vector<std::string_view> names;
  for (const auto& entry : table) names.push_back(entry.name);
  return names;
}

}  // namespace collidoscope
