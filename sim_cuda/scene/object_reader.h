#pragma once
// Reads the members of a JSON object into plain values. Collects faults: unknown keys (with the nearest known
// key) and wrong types. validate() checks the ranges.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/json_document.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {

/// A document and the faults found so far. One per file.
struct Reading {
  const JsonDocument& document;
  std::vector<JsonFault> faults;

  /// True if further faults will not be listed.
  bool full() const { return faults.size() > JsonDocument::max_faults; }
  /// Adds a fault at a node. An invalid node already has a fault; no second one is added.
  void fault(const JsonNode& node, std::string message) {
    if (node.kind != JsonKind::invalid) add({node.begin, std::move(message)});
  }
  void fault_at_key(const JsonNode& node, std::string message) { add({node.key_begin, std::move(message)}); }
  /// Adds a fault once. An object with duplicate keys is read several times and would report its other faults
  /// again.
  void add(JsonFault fault) {
    if (!full() && std::ranges::find(faults, fault) == faults.end()) faults.push_back(std::move(fault));
  }
};

/// Reader of one object. Read every allowed member, then call finish(). A member that is missing or of the
/// wrong type leaves its value unchanged.
class ObjectReader {
 public:
  /// `what` names the object in messages: "a body". A node that is not an object is a fault and reads as
  /// empty.
  ObjectReader(Reading& reading, const JsonNode& node, std::string_view what);

  bool is_object() const { return is_object_; }

  /// The member, or null. Marks the key as known.
  const JsonNode* member(std::string_view key);
  /// The member of the given kind, or null. Another kind is a fault with `message`, or with a standard
  /// message if that is empty.
  const JsonNode* member(std::string_view key, JsonKind kind, std::string_view message = {});

  bool real(std::string_view key, double& value);
  bool whole(std::string_view key, std::int64_t& value);  ///< clamped to the range of int64
  bool whole(std::string_view key, int& value);           ///< clamped to the range of int
  bool whole(std::string_view key, std::uint64_t& value);
  bool text(std::string_view key, std::string& value);
  bool truth(std::string_view key, bool& value);
  bool vector(std::string_view key, Vector3d& value);
  /// Reads exactly `count` numbers. Returns the node, or null after a fault.
  const JsonNode* numbers(std::string_view key, double* values, std::size_t count, std::string_view wanted);

  template <class Choice, std::size_t count>
  bool choice(std::string_view key, const std::array<Named<Choice>, count>& table, Choice& value) {
    return choice(key, std::span<const Named<Choice>>(table), value);
  }
  template <class Choice>
  bool choice(std::string_view key, std::span<const Named<Choice>> table, Choice& value) {
    const JsonNode* node = member(key, JsonKind::text);
    if (node == nullptr) return false;
    const std::string_view name = reading_.document.text(*node);
    std::optional<Choice> found = value_of(table, name);
    if (!found) found = value_of(table, reading_.document.current_name(*node));
    if (found) {
      value = *found;
    } else {
      reading_.fault(*node, unknown_name(key, name, names_in(table)));
    }
    return found.has_value();
  }

  /// Checks "format" and "version": 1. `whose` is used in the message: "a scene".
  void header(std::string_view format, std::string_view whose);

  /// Adds a fault for every key that was not read.
  void finish();

 private:
  bool is_read(const JsonNode& node) const;

  Reading& reading_;
  const JsonNode& node_;
  std::string_view what_;
  bool is_object_;
  std::vector<std::string_view> known_;
};

}  // namespace collidoscope
