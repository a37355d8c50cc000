#pragma once
// One member of a struct that files, flags and panels show: its key, unit, range, choices and help. A table
// of fields is a std::tuple. Readers, writers, checks and generated documents are loops over such tables.

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

/// How a member stores "auto".
enum class Auto { none, unset, zero };

/// What a change of the member does to a run.
enum class Live {
  never,      ///< it is given at the start
  in_place,   ///< the next step uses it
  new_world,  ///< the run continues in another World
  restart     ///< it makes other bodies, so that the run starts at state 0
};

namespace detail {
template <class Member>
struct MemberTypes;
template <class OwnerType, class ValueType>
struct MemberTypes<ValueType OwnerType::*> {
  using Owner = OwnerType;
  using Value = ValueType;
};
/// What a field can be chosen from: enumerations, and whole numbers of which few are allowed.
template <class Value>
using Choice = std::conditional_t<std::is_enum_v<Value> || std::is_same_v<Value, int>, Value, char>;
}  // namespace detail

template <auto pointer_to_member>
struct Field {
  static constexpr auto member = pointer_to_member;
  using Owner = typename detail::MemberTypes<decltype(pointer_to_member)>::Owner;
  using Value = typename detail::MemberTypes<decltype(pointer_to_member)>::Value;

  std::string_view key;   ///< in scene files
  std::string_view help;  ///< a phrase; of fields that are no settings in Markdown
  std::string_view unit = {};
  double low = 0, high = 0;  ///< closed range; of each component of a vector
  Auto automatic = Auto::none;
  std::span<const Named<detail::Choice<Value>>> choices = {};
  std::vector<std::string> (*words)() = nullptr;  ///< of a text: the allowed ones
  /// What the generated documents give as the default, if it is not the value in a new owner.
  std::string_view fallback = {};

  // Of settings only: see settings.h.
  std::string_view name = key;  ///< in files of changes, reports and flags: "--" and '-' for '_'
  std::string_view label = name;
  std::string_view placeholder = "N";  ///< of the flag's value, in --help
  Live live = Live::never;
  bool for_stability = false;  ///< the command `stability` has the flag, too
  double slider_high = 0;      ///< the end of a logarithmic slider; more can be typed
};

/// Whether a pointer to member is one of some others, which may be of other types.
template <auto member, auto... others>
inline constexpr bool is_field = (std::is_same_v<Field<member>, Field<others>> || ...);

/// Calls use(field) for each field of a table.
template <class Table, class Use>
constexpr void for_each_field(const Table& table, Use&& use) {
  std::apply([&](const auto&... fields) { (use(fields), ...); }, table);
}

/// The allowed names of a field, empty if it has none.
template <auto member>
std::vector<std::string_view> choice_names(const Field<member>& field) {
  return names_in(field.choices);
}

}  // namespace collidoscope
