#pragma once
// Reading one JSON object's members into plain values, and noting everything that is wrong with them: unknown
// keys (with the nearest known one), wrong types. Whether a value is in its range is validate()'s business.

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/scene/json_document.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {

/// A document being read and the faults found so far; one per file.
struct Reading {
  const JsonDocument& document;
  std::vector<JsonFault> faults;

  /// More are not listed, and need not be put into words.
  bool full() const { return faults.size() > JsonDocument::max_faults; }
  /// A node that is no value has its fault already.
  void fault(const JsonNode& node, std::string message) {
    if (node.kind != JsonKind::invalid) add({node.begin, std::move(message)});
  }
  void fault_at_key(const JsonNode& node, std::string message) { add({node.key_begin, std::move(message)}); }
  /// An object with duplicate keys is read once for each of their values: its other faults are listed once.
  void add(JsonFault fault) {
    if (!full() && std::ranges::find(faults, fault) == faults.end()) faults.push_back(std::move(fault));
  }
};

/// For as long as one object is read: name every member that it may have, then call finish(). A member that
/// is missing or of the wrong type leaves its value as it was.
class ObjectReader {
 public:
  /// `what` names the object in faults: "a body". A node that is no object is a fault, and reads as empty.
  ObjectReader(Reading& reading, const JsonNode& node, std::string_view what);

  bool is_object() const { return is_object_; }

  /// The member, or null; from now on the key is known.
  const JsonNode* member(std::string_view key);
  /// The same, of the given kind: another kind is a fault, `message` or else a standard one.
  const JsonNode* member(std::string_view key, JsonKind kind, std::string_view message = {});

  bool real(std::string_view key, double& value);
  bool whole(std::string_view key, std::int64_t& value);  ///< beyond int64: its nearest end
  bool whole(std::string_view key, int& value);           ///< beyond int: its nearest end
  bool whole(std::string_view key, std::uint64_t& value);
  bool text(std::string_view key, std::string& value);
  bool truth(std::string_view key, bool& value);
  bool vector(std::string_view key, Vector3d& value);
  /// `count` numbers; the node, or null where there was a fault.
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

  /// Checks "format" and "version": 1 of a file. `whose`: "a scene", for the message.
  void header(std::string_view format, std::string_view whose);

  /// Notes every key that was not named.
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
