#pragma once
// Reads fields from a JSON object. Checks types, names and "auto", and the ranges of non-physical settings.
// validate() checks the other ranges. Faults are appended to the Reading.

#include <fmt/format.h>

#include <algorithm>

#include "sim_cuda/scene/body_reader.h"
#include "sim_cuda/scene/field.h"
#include "sim_cuda/scene/object_reader.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {
namespace detail {

inline bool is_auto(const Reading& reading, const JsonNode& node) {
  return node.kind == JsonKind::text && reading.document.text(node) == "auto";
}

/// Reads "time_step" in seconds, or "steps_per_second".
bool read_time_step(Reading& reading, ObjectReader& reader, TimeStep& value);

}  // namespace detail

/// Reads the member `key` of the object. If it is missing or invalid, returns false and leaves `value`
/// unchanged.
template <auto member>
bool read_value(Reading& reading, ObjectReader& reader, std::string_view key, const Field<member>& field,
                typename Field<member>::Value& value) {
  using Value = typename Field<member>::Value;
  if constexpr (std::is_same_v<Value, TimeStep>) {
    return detail::read_time_step(reading, reader, value);
  } else if constexpr (std::is_same_v<Value, std::optional<Effects>>) {
    const JsonNode* node = reader.member(key);
    if (node != nullptr) read_effects(reading, *node, value);
    return node != nullptr;
  } else if constexpr (std::is_enum_v<Value>) {
    return reader.choice(key, field.choices, value);
  } else if constexpr (std::is_same_v<Value, Vector3d>) {
    return reader.vector(key, value);
  } else if constexpr (std::is_same_v<Value, std::optional<Vector3d>>) {
    Vector3d read(0, 0, 0);
    if (!reader.vector(key, read)) return false;
    value = read;
    return true;
  } else if constexpr (std::is_same_v<Value, Quaterniond>) {
    read_orientation(reading, reader, value);
    return reader.member(key) != nullptr;
  } else if constexpr (std::is_same_v<Value, bool>) {
    return reader.truth(key, value);
  } else if constexpr (std::is_same_v<Value, std::string>) {
    std::string read;
    if (!reader.text(key, read)) return false;
    if (field.words != nullptr) {
      const std::vector<std::string> known = field.words();
      if (std::ranges::find(known, read) == known.end()) {
        reading.fault(
            *reader.member(key),
            unknown_name(field.label, read, std::vector<std::string_view>(known.begin(), known.end())));
        return false;
      }
    }
    value = std::move(read);
    return true;
  } else if constexpr (std::is_same_v<Value, std::optional<double>> ||
                       std::is_same_v<Value, std::optional<int>>) {
    const JsonNode* node = reader.member(key);
    if (node == nullptr) return false;
    if (field.automatic == Auto::unset) {
      if (detail::is_auto(reading, *node)) {
        value.reset();
        return true;
      }
      if (node->kind != JsonKind::number) {
        reading.fault(*node, fmt::format("\"{}\" must be \"auto\" or a number{}{}", key,
                                         field.unit.empty() ? "" : " in ", field.unit));
        return false;
      }
    }
    typename Value::value_type read{};
    bool good;
    if constexpr (std::is_same_v<Value, std::optional<int>>)
      good = reader.whole(key, read);
    else
      good = reader.real(key, read);
    if (good) value = read;
    return good;
  } else if constexpr (std::is_same_v<Value, double>) {
    return reader.real(key, value);
  } else {
    const JsonNode* node = reader.member(key);
    if (node == nullptr) return false;
    if (field.automatic == Auto::zero && detail::is_auto(reading, *node)) {
      value = 0;
      return true;
    }
    Value read{};
    if (!reader.whole(key, read)) return false;
    if constexpr (std::is_same_v<Value, int>) {
      if (!field.choices.empty() && (read == 0 || name_of(field.choices, read) == "?")) {
        std::vector<std::string_view> numbers = choice_names(field);
        std::erase(numbers, "auto");
        reading.fault(*node, fmt::format("\"{}\" must be {}", key, either_of(numbers)));
        return false;
      }
    }
    if (field.automatic == Auto::zero && field.choices.empty() &&
        !(static_cast<double>(read) >= field.low && static_cast<double>(read) <= field.high)) {
      reading.fault(*node, fmt::format("\"{}\" must be \"auto\" or a whole number from {:.0f} to {:.0f}", key,
                                       field.low, field.high));
      return false;
    }
    value = read;
    return true;
  }
}

/// Reads all fields of a table into their owners.
template <class Table, class Owner>
void read_fields(Reading& reading, ObjectReader& reader, const Table& table, Owner& owner) {
  for_each_field(table, [&](const auto& field) {
    read_value(reading, reader, field.key, field, owner.*(field.member));
  });
}

}  // namespace collidoscope
