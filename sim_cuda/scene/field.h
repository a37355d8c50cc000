#pragma once
// Description of a struct member that appears in files, flags and panels: key, unit, range, choices, help.
// A table of fields is a std::tuple. Readers, writers, checks and generated documents iterate over such
// tables.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <vector>

#include "sim_cuda/scene/named.h"

namespace collidoscope {

/// Representation of "auto": not allowed, an unset optional, or 0.
enum class Auto { none, unset, zero };

/// Effect of changing the member during a run.
enum class Live {
  never,      ///< can only be set at the start
  in_place,   ///< takes effect in the next step
  new_world,  ///< the run continues in a new World
  restart     ///< changes the bodies; the run restarts at state 0
};

namespace detail {
template <class Member>
struct MemberTypes;
template <class OwnerType, class ValueType>
struct MemberTypes<ValueType OwnerType::*> {
  using Owner = OwnerType;
  using Value = ValueType;
};
/// Type of the entries in a field's list of choices: the value for enumerations and int. Other types have no
/// choices.
template <class Value>
using Choice = std::conditional_t<std::is_enum_v<Value> || std::is_same_v<Value, int>, Value, char>;
}  // namespace detail

template <auto pointer_to_member>
struct Field {
  static constexpr auto member = pointer_to_member;
  using Owner = typename detail::MemberTypes<decltype(pointer_to_member)>::Owner;
  using Value = typename detail::MemberTypes<decltype(pointer_to_member)>::Value;

  std::string_view key;   ///< key in scene files
  std::string_view help;  ///< a short phrase; Markdown, unless the field is a setting
  std::string_view unit = {};
  double low = 0, high = 0;  ///< closed range, for each component of a vector
  Auto automatic = Auto::none;
  std::span<const Named<detail::Choice<Value>>> choices = {};
  std::vector<std::string> (*words)() = nullptr;  ///< allowed values of a string member
  /// Default in generated documents, if it is not the value in a default-constructed owner.
  std::string_view fallback = {};

  // Members used by settings only: see settings.h.
  std::string_view name = key;  ///< name in change files, reports and flags (flags: "--" prefix, '-' for '_')
  std::string_view label = name;
  std::string_view placeholder = "N";  ///< placeholder of the flag's value in --help
  Live live = Live::never;
  bool for_stability = false;  ///< the command `stability` also accepts the flag
  double slider_high = 0;      ///< upper end of a logarithmic slider; larger values can be typed
};

/// True if a pointer to member is in a list of pointers to members, whose types may differ.
template <auto member, auto... others>
inline constexpr bool is_field = (std::is_same_v<Field<member>, Field<others>> || ...);

/// Calls use(field) for each field of a table.
template <class Table, class Use>
constexpr void for_each_field(const Table& table, Use&& use) {
  std::apply([&](const auto&... fields) { (use(fields), ...); }, table);
}

/// Names of the allowed values of a field. Empty if any value is allowed.
template <auto member>
std::vector<std::string_view> choice_names(const Field<member>& field) {
  return names_in(field.choices);
}

}  // namespace collidoscope
