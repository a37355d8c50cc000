#pragma once
// Writes fields as JSON values. field_reader.h reads them back to the same bits.
// Include it in source files only: it includes nlohmann's library.

#include <bit>
#include <nlohmann/json.hpp>

#include "sim_cuda/scene/field.h"
#include "sim_cuda/scene/scene.h"

namespace collidoscope {

using OrderedJson = nlohmann::ordered_json;

/// "auto" if unset, otherwise the names of the enabled effects.
OrderedJson effects_json(const std::optional<Effects>& effects);

inline OrderedJson vector_json(const Vector3d& v) { return OrderedJson::array({v[0], v[1], v[2]}); }

/// The JSON value of a field. Null if an optional value is unset and the field has no "auto".
template <auto member>
OrderedJson value_json(const Field<member>& field, const typename Field<member>::Value& value) {
  using Value = typename Field<member>::Value;
  if constexpr (std::is_same_v<Value, std::optional<Effects>>) {
    return effects_json(value);
  } else if constexpr (std::is_enum_v<Value>) {
    return std::string(name_of(field.choices, value));
  } else if constexpr (std::is_same_v<Value, Vector3d>) {
    return vector_json(value);
  } else if constexpr (std::is_same_v<Value, std::optional<Vector3d>>) {
    return value ? vector_json(*value) : OrderedJson(nullptr);
  } else if constexpr (std::is_same_v<Value, Quaterniond>) {
    return OrderedJson::array({value.w(), value.x(), value.y(), value.z()});
  } else if constexpr (std::is_same_v<Value, TimeStep>) {
    return value.seconds();
  } else if constexpr (requires { value.has_value(); }) {
    if (value) return *value;
    return field.automatic == Auto::unset ? OrderedJson("auto") : OrderedJson(nullptr);
  } else if constexpr (std::is_integral_v<Value>) {
    return field.automatic == Auto::zero && value == 0 ? OrderedJson("auto") : OrderedJson(value);
  } else {
    return value;
  }
}

/// Adds the member `key` to an object. An unset value is skipped. The object must not be null: if an
/// allocation fails while nlohmann 3.11 turns null into an object, the program ends.
template <auto member>
void put(OrderedJson& object, std::string_view key, const Field<member>& field,
         const typename Field<member>::Value& value) {
  if constexpr (std::is_same_v<typename Field<member>::Value, TimeStep>) {
    if (const auto n = value.steps_per_second()) {
      object["steps_per_second"] = *n;
      return;
    }
  }
  OrderedJson json = value_json(field, value);
  if (!json.is_null()) object[std::string(key)] = std::move(json);
}

/// Adds all fields of a table under their keys. The object must not be null.
template <class Table, class Owner>
void put_fields(OrderedJson& object, const Table& table, const Owner& owner) {
  for_each_field(table, [&](const auto& field) { put(object, field.key, field, owner.*(field.member)); });
}

/// An object with all fields of a table.
template <class Table, class Owner>
OrderedJson fields_json(const Table& table, const Owner& owner) {
  OrderedJson object = OrderedJson::object();
  put_fields(object, table, owner);
  return object;
}

/// One line of text with a space after each colon and comma. Invalid UTF-8 bytes are replaced.
std::string json_line(const OrderedJson& json);

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
