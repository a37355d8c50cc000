#pragma once
// A JSON text (with // and /* */ comments) as a small tree whose nodes know where they are in it, so that
// every complaint about a value can name its line and column. Parsed by nlohmann's SAX parser, whose own
// DOM has no positions. Lives while a file is read. Memory is bounded: see the limits below.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace collidoscope {

/// `invalid`: a word such as NaN, which is a fault of the document; it has no value, and no other fault.
enum class JsonKind : std::uint8_t { null, boolean, number, text, array, object, invalid };

/// "a number", "an object"...: for messages.
std::string_view described(JsonKind kind);

struct JsonNode {
  std::uint32_t begin = 0, size = 0;          ///< the token in the text, bytes; a container's first character
  std::uint32_t key_begin = 0, key_size = 0;  ///< with its quotes; size 0: no member of an object
  std::uint32_t first_child = 0, child_count = 0;
  JsonKind kind = JsonKind::null;
};

/// Something wrong at a byte of the text.
struct JsonFault {
  std::uint32_t offset;
  std::string message;
  friend bool operator==(const JsonFault&, const JsonFault&) = default;
};

/// A key that was renamed. The old one is still read, with a warning.
struct JsonAlias {
  std::string_view key, old_key;
};

class JsonDocument {
 public:
  static constexpr std::size_t max_bytes = std::size_t{64} << 20;  ///< of text
  static constexpr std::size_t max_nodes = std::size_t{1} << 23;   ///< values in all; 28 bytes each
  static constexpr std::size_t max_depth = 64;                     ///< arrays and objects within each other
  static constexpr std::size_t max_faults = 10'000;                ///< listed; more are counted as one
  static constexpr std::size_t max_repeated = 20;  ///< values of duplicate keys; of more none is read

  /// Throws InputError where the text is no JSON or beyond a limit. `name` stands before the positions in all
  /// messages. Faults beside which the rest can be read wait in faults().
  /// find() also finds the old keys of `aliases`.
  JsonDocument(std::string text, std::string name, std::span<const JsonAlias> aliases = {});

  const JsonNode& root() const { return nodes_.back(); }
  std::span<const JsonNode> children(const JsonNode& node) const {
    return {nodes_.data() + node.first_child, node.child_count};
  }
  /// The member of an object, or null. Of members with one key it is the first, but see read_all().
  const JsonNode* find(const JsonNode& object, std::string_view key) const;

  std::string_view key(const JsonNode& node) const { return unquoted(node.key_begin, node.key_size); }
  std::string_view text(const JsonNode& node) const { return unquoted(node.begin, node.size); }
  /// As it is written: `-1e5`, `true`, `"text"`; `[` or `{` of a container.
  std::string_view token(const JsonNode& node) const {
    return std::string_view(text_).substr(node.begin, node.size);
  }
  /// The nearest double; none where it is too near to zero to be one (1e-999).
  std::optional<double> number(const JsonNode& node) const;

  /// Whether the key is the old one of an alias.
  bool is_old_key(std::string_view key) const;
  /// The new name, if the text of the node is an old one, which gives a warning; else the text.
  std::string_view current_name(const JsonNode& node) const;
  /// `name:line:column: warning: ...` for each old key in the document that find() has met, in its order.
  std::vector<std::string> warnings() const;

  /// Duplicate keys, and words that are no values.
  const std::vector<JsonFault>& faults() const { return faults_; }

  /// Calls `read(true)`, which returns all faults that it finds; then `read(false)` for each further value of
  /// a duplicate key, while find() returns the members that lead to it. Throws InputError with all faults.
  void read_all(const std::function<std::vector<JsonFault>(bool first)>& read);

  /// `name:line:column: message` for each fault, in the order of the text; columns count characters.
  std::vector<std::string> lines(std::vector<JsonFault> faults) const;

 private:
  friend class JsonTreeBuilder;
  std::string_view unquoted(std::uint32_t begin, std::uint32_t size) const;

  void warn(std::uint32_t offset, const JsonAlias& alias) const;
  const JsonNode* find_key(const JsonNode& object, std::string_view key) const;

  std::string text_, name_;
  std::span<const JsonAlias> aliases_;
  mutable std::vector<JsonFault> warnings_;
  std::vector<JsonNode> nodes_;                               ///< children side by side; the root is last
  std::unordered_map<std::uint32_t, std::string> unescaped_;  ///< by offset: texts that hold a backslash
  std::vector<JsonFault> faults_;
  std::vector<std::uint32_t> repeated_;  ///< offsets of the values of duplicate keys, but the first of each
  std::uint32_t chosen_ = 0;             ///< find() returns what leads to the value at this offset
};

}  // namespace collidoscope
