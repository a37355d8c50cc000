#pragma once
// What the readers of a criterion share: the criterion read so far, the faults, and members that several
// objects of the file have.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>

#include "sim_cuda/scene/body_count.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/object_reader.h"
#include "sim_cuda/stability/criterion.h"

namespace collidoscope {

struct CriterionContext {
  /// `case_scene`: the case's scene, or null if it is invalid.
  CriterionContext(const JsonDocument& criterion_document, const Scene* case_scene)
      : document(criterion_document),
        reading{criterion_document, criterion_document.faults()},
        scene(case_scene),
        body_count(case_scene != nullptr ? bodies_of(*case_scene) : 0) {}

  /// Adds a fault if a whole number is out of range.
  bool in_range(const JsonNode& node, std::string_view key, std::int64_t value, std::int64_t least,
                std::int64_t most) {
    if (value >= least && value <= most) return true;
    reading.fault(node, fmt::format("\"{}\" must be a whole number from {} to {}, not {}", key, least, most,
                                    printable(document.token(node))));
    return false;
  }

  /// Checks the name of a file in the criterion's folder.
  void check_file(const JsonNode& node) {
    const std::string_view name = document.text(node);
    if (name.empty() || name.find('/') != std::string_view::npos || !name.ends_with(".json"))
      reading.fault(node, "must be the name of a file (.json) in the criterion's own folder");
  }

  /// Reads a body id. Returns false and adds a fault if neither the scene nor a change can provide that body.
  bool read_id(ObjectReader& reader, std::uint32_t& id) {
    std::int64_t number = 0;
    if (!reader.whole("body", number)) return false;
    const std::int64_t count =
        scene != nullptr && criterion.changes.empty() ? body_count : limits::max_bodies;
    if (!in_range(*reader.member("body"), "body", number, 0, std::max<std::int64_t>(count, 1) - 1))
      return false;
    id = static_cast<std::uint32_t>(number);
    return true;
  }

  /// Index of the term that has the quantity of the member `key`; with the member "term", the term of that
  /// number among those of the quantity, from 1. Unset: it has a fault. `what`: the object, for messages.
  std::optional<std::size_t> read_term(ObjectReader& reader, const JsonNode& node, std::string_view key,
                                       std::string_view what) {
    Quantity quantity{};
    int number = 1, found = 0;
    const bool numbered = reader.whole("term", number);
    if (!reader.choice(key, quantity_names, quantity)) {
      if (reader.member(key) == nullptr)
        reading.fault(
            node, fmt::format("{} must have \"{}\", the name of a quantity of the assertions", what, key));
      return std::nullopt;
    }
    for (std::size_t k = 0; k < criterion.assertions.size(); ++k)
      if (criterion.assertions[k].quantity == quantity && ++found == number) return k;
    reading.fault(
        numbered ? *reader.member("term") : *reader.member(key),
        fmt::format("\"assertions\" has {} of the quantity \"{}\"",
                    found == 0 ? "none" : fmt::to_string(found), name_of(quantity_names, quantity)));
    return std::nullopt;
  }

  /// Reads the number of a state of the run.
  void read_state(ObjectReader& reader, std::string_view key, std::optional<std::int64_t>& state) {
    std::int64_t number = 0;
    const std::int64_t most = criterion.long_steps.value_or(criterion.steps);
    if (reader.whole(key, number) && in_range(*reader.member(key), key, number, 0, most)) state = number;
  }

  const JsonDocument& document;
  Reading reading;
  const Scene* scene;
  std::int64_t body_count;
  Criterion criterion;
};

}  // namespace collidoscope
