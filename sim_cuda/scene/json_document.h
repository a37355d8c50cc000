#pragma once
// A JSON text with // and /* */ comments, parsed into a tree whose nodes keep their text positions. Error
// messages use the positions as line and column.
// Uses nlohmann's SAX parser, because its DOM has no positions. The document owns the text. Memory is bounded
// by the limits below.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace collidoscope {

/// `invalid` is a word that is not a JSON value, such as NaN. It is a fault of the document and causes no
/// further fault.
enum class JsonKind : std::uint8_t { null, boolean, number, text, array, object, invalid };

/// Description for messages: "a number", "an object" and so on.
std::string_view described(JsonKind kind);

struct JsonNode {
  std::uint32_t begin = 0, size = 0;          ///< token in the text, in bytes; first character of a container
  std::uint32_t key_begin = 0, key_size = 0;  ///< key including its quotes; size 0: not a member of an object
  std::uint32_t first_child = 0, child_count = 0;
  JsonKind kind = JsonKind::null;
};

/// An error at a byte of the text.
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
  static constexpr std::size_t max_bytes = std::size_t{64} << 20;  ///< size of the text
  static constexpr std::size_t max_nodes = std::size_t{1} << 23;   ///< values in total; 28 bytes each
  static constexpr std::size_t max_depth = 64;                     ///< nesting depth of arrays and objects
  static constexpr std::size_t max_faults = 10'000;  ///< listed faults; the rest is counted in one line
  static constexpr std::size_t max_repeated = 20;    ///< values of duplicate keys; if there are more, none is
                                                     ///< read

  /// Parses the text. `name` precedes the positions in all messages. Throws InputError if the text is not
  /// JSON or exceeds a limit. faults() returns recoverable faults.
  /// find() also finds the old keys of `aliases`.
  JsonDocument(std::string text, std::string name, std::span<const JsonAlias> aliases = {});

  const JsonNode& root() const { return nodes_.back(); }
  std::span<const JsonNode> children(const JsonNode& node) const {
    return {nodes_.data() + node.first_child, node.child_count};
  }
  /// The member of an object, or null. If a key is duplicate, its first member, except during read_all().
  const JsonNode* find(const JsonNode& object, std::string_view key) const;

  std::string_view key(const JsonNode& node) const { return unquoted(node.key_begin, node.key_size); }
  std::string_view text(const JsonNode& node) const { return unquoted(node.begin, node.size); }
  /// The token as written: `-1e5`, `true`, `"text"`; `[` or `{` of a container.
  std::string_view token(const JsonNode& node) const {
    return std::string_view(text_).substr(node.begin, node.size);
  }
  /// The nearest double. Unset if the value underflows (1e-999).
  std::optional<double> number(const JsonNode& node) const;

  /// Whether the key is the old one of an alias.
  bool is_old_key(std::string_view key) const;
  /// The text of a node. If it is an old name, the new name, and a warning is noted.
  std::string_view current_name(const JsonNode& node) const;
  /// `name:line:column: warning: ...` for each old name that was read.
  std::vector<std::string> warnings() const;

  /// Recoverable faults: duplicate keys and words that are not JSON values.
  const std::vector<JsonFault>& faults() const { return faults_; }

  /// Checks the values of duplicate keys too. Throws InputError with all faults.
  /// First calls `read(true)`, which returns its faults. Then calls `read(false)` once per further value of a
  /// duplicate key; find() returns the members that lead to that value.
  void read_all(const std::function<std::vector<JsonFault>(bool first)>& read);

  /// `name:line:column: message` for each fault, in text order. Columns count characters.
  std::vector<std::string> lines(std::vector<JsonFault> faults) const;

 private:
  friend class JsonTreeBuilder;
  std::string_view unquoted(std::uint32_t begin, std::uint32_t size) const;

  void warn(std::uint32_t offset, const JsonAlias& alias) const;
  const JsonNode* find_key(const JsonNode& object, std::string_view key) const;

  std::string text_, name_;
  std::span<const JsonAlias> aliases_;
  mutable std::vector<JsonFault> warnings_;
  std::vector<JsonNode> nodes_;                               ///< children are contiguous; the root is last
  std::unordered_map<std::uint32_t, std::string> unescaped_;  ///< unescaped strings that contain a backslash,
                                                              ///< by offset
  std::vector<JsonFault> faults_;
  std::vector<std::uint32_t> repeated_;  ///< offsets of the second and later values of duplicate keys
  std::uint32_t chosen_ = 0;             ///< offset of the duplicate value that find() currently selects
};

}  // namespace collidoscope
