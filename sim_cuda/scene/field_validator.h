#pragma once
// Checks single fields against their tables: ranges and choices. Collects the faults of a scene. Used by
// validate().

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim_cuda/scene/json_syntax.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"
#include "sim_cuda/scene/settings.h"

namespace collidoscope {

/// A path whose text is built only if a fault is reported. Validating 10^5 bodies allocates no memory.
struct FaultPath {
  const char* list = "";
  std::int64_t index = -1;
  const char* field = "";
  int component = -1;
  const std::string* name = nullptr;  ///< name of a material

  std::string text() const {
    std::string path = list;
    if (index >= 0) path += fmt::format("[{}]", index);
    if (name != nullptr) {
      const bool plain = !name->empty() && name->find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789") ==
                                               std::string::npos;
      path += plain ? "." + *name : "[\"" + *name + "\"]";
    }
    if (*field != 0) path += (path.empty() ? "" : ".") + std::string(field);
    if (component >= 0) path += fmt::format("[{}]", component);
    return path;
  }
  FaultPath at(const char* member) const { return {list, index, member, -1, name}; }
  FaultPath at(int part) const { return {list, index, field, part, name}; }
};

/// True if the text fits in one line of a message.
inline bool is_printable(const std::string& text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) return false;
  }
  return is_utf8(text);
}

/// The checks return true if the value is valid.
class FieldValidator {
 public:
  /// `material_count`: number of materials of the scene.
  explicit FieldValidator(std::size_t material_count) : material_count_(material_count) {}

  void fault(const FaultPath& path, std::string message) {
    faults_.push_back({path.text(), std::move(message)});
  }

  bool number(const FaultPath& path, double value, double least, double most, std::string_view unit) {
    if (!(value >= least && value <= most)) {
      fault(path, fmt::format("must lie in [{:g}, {:g}]{}{}", least, most, unit.empty() ? "" : " ", unit));
      return false;
    }
    if (value != 0 && std::abs(value) < limits::smallest_normal) {
      fault(path, "must be 0 or at least 1.2e-38 in magnitude, the smallest normal float");
      return false;
    }
    return true;
  }
  bool whole(const FaultPath& path, std::int64_t value, std::int64_t least, std::int64_t most) {
    if (value >= least && value <= most) return true;
    fault(path, fmt::format("must be a whole number from {} to {}", least, most));
    return false;
  }

  /// Checks the range and the choices of a field. Fields without either always pass.
  template <auto member>
  bool check(const FaultPath& of, const Field<member>& field, const typename Field<member>::Value& value) {
    using Value = typename Field<member>::Value;
    const FaultPath path = of.at(field.key.data());
    if constexpr (std::is_same_v<Value, double>) {
      return number(path, value, field.low, field.high, field.unit);
    } else if constexpr (std::is_same_v<Value, std::optional<double>>) {
      return !value || number(path, *value, field.low, field.high, field.unit);
    } else if constexpr (std::is_same_v<Value, int> || std::is_same_v<Value, std::int64_t>) {
      return field.low == field.high || whole_in(path, value, field.low, field.high);
    } else if constexpr (std::is_same_v<Value, std::optional<int>>) {
      return !value || whole_in(path, *value, field.low, field.high);
    } else if constexpr (std::is_same_v<Value, Vector3d>) {
      bool good = true;
      for (int axis = 0; axis < 3 && field.low != field.high; ++axis)
        good &= number(path.at(axis), value[axis], field.low, field.high, field.unit);
      return good;
    } else if constexpr (std::is_same_v<Value, std::optional<Vector3d>>) {
      bool good = true;
      for (int axis = 0; axis < 3 && value; ++axis)
        good &= number(path.at(axis), (*value)[axis], field.low, field.high, field.unit);
      return good;
    } else if constexpr (std::is_enum_v<Value>) {
      if (name_of(field.choices, value) != "?") return true;
      fault(path, "must be " + either_of(choice_names(field)));
      return false;
    } else if constexpr (std::is_same_v<Value, TimeStep>) {
      if (const auto n = value.steps_per_second())
        return whole(of.at("steps_per_second"), *n, 1, limits::max_steps_per_second);
      return number(path, value, field.low, field.high, field.unit);
    } else {
      return true;
    }
  }
  template <class Table, class Owner>
  bool check_all(const FaultPath& path, const Table& table, const Owner& owner) {
    bool good = true;
    for_each_field(table, [&](const auto& field) { good &= check(path, field, owner.*(field.member)); });
    return good;
  }
  void check_material(const FaultPath& path, int index) {
    if (index >= 0 && static_cast<std::size_t>(index) < material_count_) return;
    fault(path.at("material"), "must be the index of a material");
  }

  /// The faults so far, in the order of the checks. Call once.
  std::vector<Fault> take_faults() { return std::move(faults_); }

 private:
  bool whole_in(const FaultPath& path, std::int64_t value, double least, double most) {
    return whole(path, value, static_cast<std::int64_t>(least), static_cast<std::int64_t>(most));
  }

  const std::size_t material_count_;
  std::vector<Fault> faults_;
};

}  // namespace collidoscope
