#pragma once
// Writes fields as the text of JSON values. field_reader.h reads them back to the same bits. nlohmann's
// library formats single values only: its arrays and objects allocate memory in their destructors, and a
// failing allocation there ends the program. Include this header in source files only: it includes nlohmann's
// library.

#include <fmt/ranges.h>
#include <bit>
#include <nlohmann/json.hpp>

#include "sim_cuda/scene/field.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

/// The text of a number, boolean or string. Invalid UTF-8 bytes of a string are replaced.
inline std::string scalar_text(const nlohmann::ordered_json& scalar) {
  return scalar.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

inline std::string array_text(std::initializer_list<double> numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "[" : ", ") + scalar_text(number);
  return text + "]";
}

/// A JSON array in one line. Strings among the values must be JSON.
template <class Values>
std::string list_text(const Values& values) {
  return fmt::format("[{}]", fmt::join(values, ", "));
}

/// "auto" if unset, otherwise the names of the enabled effects.
std::string effects_text(const std::optional<Effects>& effects);

/// The JSON text of a field's value. Empty if an optional value is unset and the field has no "auto".
template <auto member>
std::string value_text(const Field<member>& field, const typename Field<member>::Value& value) {
  using Value = typename Field<member>::Value;
  const char* const automatic = "\"auto\"";
  if constexpr (std::is_same_v<Value, std::optional<Effects>>) {
    return effects_text(value);
  } else if constexpr (std::is_enum_v<Value>) {
    return scalar_text(std::string(name_of(field.choices, value)));
  } else if constexpr (std::is_same_v<Value, Vector3d>) {
    return array_text({value[0], value[1], value[2]});
  } else if constexpr (std::is_same_v<Value, std::optional<Vector3d>>) {
    return value ? array_text({(*value)[0], (*value)[1], (*value)[2]}) : "";
  } else if constexpr (std::is_same_v<Value, std::optional<std::array<double, 2>>>) {
    return value ? array_text({(*value)[0], (*value)[1]}) : "";
  } else if constexpr (std::is_same_v<Value, Quaterniond>) {
    return array_text({value.w(), value.x(), value.y(), value.z()});
  } else if constexpr (std::is_same_v<Value, TimeStep>) {
    return scalar_text(value.seconds());
  } else if constexpr (requires { value.has_value(); }) {
    if (value) return scalar_text(*value);
    return field.automatic == Auto::unset ? automatic : "";
  } else if constexpr (std::is_integral_v<Value>) {
    return field.automatic == Auto::zero && value == 0 ? automatic : scalar_text(value);
  } else {
    return scalar_text(value);
  }
}

/// The value for other documents of nlohmann's library. Null if it has no text.
template <auto member>
nlohmann::ordered_json value_json(const Field<member>& field, const typename Field<member>::Value& value) {
  const std::string text = value_text(field, value);
  return text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json::parse(text);
}

/// Passes the key and the text of a value to `add`. An unset value is skipped.
template <class Add, auto member>
void put(Add&& add, std::string_view key, const Field<member>& field,
         const typename Field<member>::Value& value) {
  if constexpr (std::is_same_v<typename Field<member>::Value, TimeStep>) {
    if (const auto n = value.steps_per_second()) {
      add("steps_per_second", scalar_text(*n));
      return;
    }
  }
  if (const std::string text = value_text(field, value); !text.empty()) add(key, text);
}

/// Passes all fields of a table under their keys to `add`.
template <class Add, class Table, class Owner>
void put_fields(Add&& add, const Table& table, const Owner& owner) {
  for_each_field(table, [&](const auto& field) { put(add, field.key, field, owner.*(field.member)); });
}

/// A JSON object in one line.
class ObjectText {
 public:
  /// `value` is JSON.
  void operator()(std::string_view key, std::string_view value) {
    text_ += fmt::format("{}\"{}\": {}", text_.empty() ? "" : ", ", key, value);
  }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

/// An object with all fields of a table.
template <class Table, class Owner>
std::string fields_text(const Table& table, const Owner& owner) {
  ObjectText object;
  put_fields(object, table, owner);
  return object.text();
}

/// Bitwise equality. -0 differs from 0, so that a value of -0 is written.
template <class Value>
bool same_bits(const Value& a, const Value& b) {
  if constexpr (std::is_same_v<Value, double>) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
  } else if constexpr (std::is_same_v<Value, Vector3d>) {
    return same_bits(a[0], b[0]) && same_bits(a[1], b[1]) && same_bits(a[2], b[2]);
  } else if constexpr (std::is_same_v<Value, Quaterniond>) {
    return same_bits(a.w(), b.w()) && same_bits(Vector3d(a.vec()), Vector3d(b.vec()));
  } else if constexpr (requires { a.has_value(); }) {
    return a.has_value() == b.has_value() && (!a || same_bits(*a, *b));
  } else {
    return a == b;
  }
}

}  // namespace collidoscope
