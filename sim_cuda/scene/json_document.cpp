#include "sim_cuda/scene/json_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "sim_cuda/core/error.h"
#include "sim_cuda/scene/json_syntax.h"
#include "sim_cuda/scene/names.h"

namespace collidoscope {
namespace {

/// An iterator that exposes the position of the parser. When the parser reports a string, the position is the
/// end of its token.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, const char** read) : at_(at), read_(read) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    *read_ = ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    const CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char** read_;
};

}  // namespace

/// SAX handler for nlohmann's parser. Values stay in `pending_` until their container closes; then its
/// children move into the document as one contiguous block.
class JsonTreeBuilder {
 public:
  JsonTreeBuilder(JsonDocument& document, std::string_view text, const std::vector<JsonWord>& invalid)
      : document_(document), text_(text), invalid_(invalid) {}

  static void build(JsonDocument& document) {
    const std::vector<JsonWord> none;
    JsonTreeBuilder builder(document, document.text_, none);
    if (builder.parse()) return;
    if (!builder.is_word_ || builder.open_.empty()) throw InputError(document.lines({*builder.fault_}));
    // Invalid words are recoverable: replace each one with a number and parse again.
    const std::vector<JsonWord> words = bad_words(document.text_, JsonDocument::max_faults);
    std::string repaired = document.text_;
    document.nodes_.clear();
    document.unescaped_.clear();
    document.faults_.clear();
    document.repeated_.clear();
    for (const JsonWord& word : words) {
      repaired.replace(word.begin, word.size, word.size, ' ');
      repaired[word.begin] = '0';
      document.faults_.push_back(
          {word.begin, explain_word(std::string_view(document.text_).substr(word.begin, word.size))});
    }
    JsonTreeBuilder again(document, repaired, words);
    if (again.parse()) return;
    std::vector<JsonFault> faults = document.faults_;
    std::erase_if(faults, [&](const JsonFault& fault) { return fault.offset >= again.fault_->offset; });
    faults.push_back(*again.fault_);
    throw InputError(document.lines(std::move(faults)));
  }

  bool null() { return scalar(JsonKind::null, 4); }
  bool boolean(bool value) { return scalar(JsonKind::boolean, value ? 4 : 5); }
  bool number_integer(std::int64_t) { return number(); }
  bool number_unsigned(std::uint64_t) { return number(); }
  bool number_float(double, const std::string&) { return number(); }
  bool string(std::string& value) {
    const std::uint32_t begin = token_begin();
    keep_unescaped(begin, offset_read(), value);
    return add(JsonKind::text, begin, offset_read() - begin);
  }
  bool binary(std::vector<std::uint8_t>&) { return false; }

  bool key(std::string& value) {
    key_begin_ = token_begin();
    end_ = offset_read();
    key_size_ = end_ - key_begin_;
    keep_unescaped(key_begin_, end_, value);
    last_ = JsonProgress::key;
    return true;
  }

  bool start_object(std::size_t) { return start(JsonKind::object); }
  bool start_array(std::size_t) { return start(JsonKind::array); }
  bool end_object() {
    note_duplicates();
    return finish();
  }
  bool end_array() { return finish(); }

  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) { return false; }

 private:
  /// Returns false if the text is not JSON; fault_ then has the reason.
  bool parse() {
    const char* const begin = text_.data();
    const char* const end = begin + text_.size();
    read_ = begin;
    const bool complete =
        nlohmann::json::sax_parse(CountingIterator(begin, &read_), CountingIterator(end, &read_), this,
                                  nlohmann::json::input_format_t::json, true, true);
    // The parser treats a zero byte as the end of the text.
    if (!fault_ && (!complete || skip_blanks(text_, end_) != text_.size()))
      fault_ = explain_syntax(document_.text_, end_, last_, open_, &is_word_);
    if (fault_) return false;
    document_.nodes_.push_back(pending_.back());
    return true;
  }

  std::uint32_t offset_read() const { return static_cast<std::uint32_t>(read_ - text_.data()); }

  /// Start of the token after the last one. Skips blanks, comments, "," and ":".
  std::uint32_t token_begin() const {
    std::uint32_t at = skip_blanks(text_, end_);
    while (at < text_.size() && (text_[at] == ',' || text_[at] == ':')) at = skip_blanks(text_, at + 1);
    return at;
  }

  void keep_unescaped(std::uint32_t begin, std::uint32_t end, std::string& value) {
    if (text_.substr(begin, end - begin).find('\\') == std::string_view::npos) return;
    document_.unescaped_.emplace(begin, std::move(value));
  }

  bool scalar(JsonKind kind, std::uint32_t size) { return add(kind, token_begin(), size); }
  bool number() {
    const std::uint32_t begin = token_begin();
    while (next_invalid_ < invalid_.size() && invalid_[next_invalid_].begin < begin) ++next_invalid_;
    if (next_invalid_ < invalid_.size() && invalid_[next_invalid_].begin == begin)
      return add(JsonKind::invalid, begin, invalid_[next_invalid_].size);
    return add(JsonKind::number, begin, number_length(text_, begin));
  }

  bool add(JsonKind kind, std::uint32_t begin, std::uint32_t size) {
    if (document_.nodes_.size() + pending_.size() == JsonDocument::max_nodes) {
      fault_ = JsonFault{begin, fmt::format("more than {} values; use a generator for so many bodies",
                                            JsonDocument::max_nodes)};
      return false;
    }
    JsonNode node;
    node.begin = begin;
    node.size = size;
    if (last_ == JsonProgress::key) {
      node.key_begin = key_begin_;
      node.key_size = key_size_;
    }
    node.kind = kind;
    pending_.push_back(node);
    end_ = begin + size;
    last_ = JsonProgress::value;
    return true;
  }

  bool start(JsonKind kind) {
    const std::uint32_t begin = token_begin();
    if (open_.size() == JsonDocument::max_depth) {
      fault_ = JsonFault{begin, fmt::format("more than {} nested arrays and objects; a scene needs at most 4",
                                            JsonDocument::max_depth)};
      return false;
    }
    if (!add(kind, begin, 1)) return false;
    open_.push_back({begin, kind == JsonKind::array});
    containers_.push_back(pending_.size() - 1);
    last_ = JsonProgress::opened;
    return true;
  }

  bool finish() {
    end_ = token_begin() + 1;
    const std::size_t container = containers_.back();
    pending_[container].first_child = static_cast<std::uint32_t>(document_.nodes_.size());
    pending_[container].child_count = static_cast<std::uint32_t>(pending_.size() - container - 1);
    document_.nodes_.insert(document_.nodes_.end(),
                            pending_.begin() + static_cast<std::ptrdiff_t>(container) + 1, pending_.end());
    pending_.resize(container + 1);
    containers_.pop_back();
    open_.pop_back();
    last_ = JsonProgress::value;
    return true;
  }

  void note_duplicates() {
    std::vector<const JsonNode*> members;
    for (std::size_t i = containers_.back() + 1; i < pending_.size(); ++i) members.push_back(&pending_[i]);
    std::stable_sort(members.begin(), members.end(), [&](const JsonNode* a, const JsonNode* b) {
      return document_.key(*a) < document_.key(*b);
    });
    for (std::size_t i = 1; i < members.size(); ++i) {
      if (document_.key(*members[i]) != document_.key(*members[i - 1])) continue;
      if (document_.faults_.size() > JsonDocument::max_faults) return;
      document_.faults_.push_back(
          {members[i]->key_begin, fmt::format("duplicate key \"{}\" in this object; keep one of them",
                                              printable(document_.key(*members[i])))});
      document_.repeated_.push_back(members[i]->begin);
    }
  }

  JsonDocument& document_;
  std::string_view text_;  ///< parsed text: the document's text, or a repaired copy of equal length
  const std::vector<JsonWord>& invalid_;  ///< invalid words of the document's text; numbers replace them in
                                          ///< text_
  std::size_t next_invalid_ = 0;
  const char* read_ = nullptr;
  std::uint32_t end_ = 0;  ///< end of the last reported token
  std::uint32_t key_begin_ = 0, key_size_ = 0;
  JsonProgress last_ = JsonProgress::nothing;
  std::vector<JsonNode> pending_;
  std::vector<std::size_t> containers_;  ///< indices in pending_ of the open containers
  std::vector<JsonOpen> open_;
  std::optional<JsonFault> fault_;
  bool is_word_ = false;  ///< fault_ is one of bad_words()
};

std::string_view described(JsonKind kind) {
  switch (kind) {
    case JsonKind::null:
      return "null";
    case JsonKind::boolean:
      return "true or false";
    case JsonKind::number:
      return "a number";
    case JsonKind::text:
      return "a string";
    case JsonKind::array:
      return "a list";
    case JsonKind::object:
      return "an object";
    case JsonKind::invalid:
      return "no value";
  }
  return "?";
}

JsonDocument::JsonDocument(std::string text, std::string name, std::span<const JsonAlias> aliases)
    : text_(std::move(text)), name_(std::move(name)), aliases_(aliases) {
  if (text_.size() > max_bytes) {
    throw InputError(
        fmt::format("{}: larger than {} MiB, the maximum size; use a generator for so many "
                    "bodies",
                    name_, max_bytes >> 20));
  }
  JsonTreeBuilder::build(*this);
}

void JsonDocument::read_all(const std::function<std::vector<JsonFault>(bool first)>& read) {
  std::vector<JsonFault> all = read(true);
  if (!repeated_.empty() && repeated_.size() <= max_repeated) {
    std::set<std::pair<std::uint32_t, std::string>> known;
    for (const JsonFault& fault : all) known.emplace(fault.offset, fault.message);
    for (const std::uint32_t value : repeated_) {
      chosen_ = value;
      for (JsonFault& fault : read(false))
        if (known.emplace(fault.offset, fault.message).second) all.push_back(std::move(fault));
    }
    chosen_ = 0;
  }
  if (!all.empty()) throw InputError(lines(std::move(all)));
}

const JsonNode* JsonDocument::find(const JsonNode& object, std::string_view wanted) const {
  if (const JsonNode* node = find_key(object, wanted)) return node;
  for (const JsonAlias& alias : aliases_) {
    if (alias.key != wanted) continue;
    const JsonNode* node = find_key(object, alias.old_key);
    if (node == nullptr) continue;
    warn(node->key_begin, alias);
    return node;
  }
  return nullptr;
}

void JsonDocument::warn(std::uint32_t offset, const JsonAlias& alias) const {
  JsonFault warning{offset, fmt::format("warning: \"{}\" is now \"{}\"; the old name still works",
                                        alias.old_key, alias.key)};
  if (std::ranges::find(warnings_, warning) == warnings_.end()) warnings_.push_back(std::move(warning));
}

std::string_view JsonDocument::current_name(const JsonNode& node) const {
  const std::string_view word = text(node);
  const auto alias = std::ranges::find(aliases_, word, &JsonAlias::old_key);
  if (alias == aliases_.end()) return word;
  warn(node.begin, *alias);
  return alias->key;
}

bool JsonDocument::is_old_key(std::string_view key) const {
  return std::ranges::find(aliases_, key, &JsonAlias::old_key) != aliases_.end();
}

std::vector<std::string> JsonDocument::warnings() const {
  return warnings_.empty() ? std::vector<std::string>{} : lines(warnings_);
}

const JsonNode* JsonDocument::find_key(const JsonNode& object, std::string_view wanted) const {
  const JsonNode* found = nullptr;
  for (const JsonNode& child : children(object)) {
    if (key(child) != wanted) continue;
    if (found == nullptr || child.begin <= chosen_) found = &child;
    if (chosen_ == 0) break;
  }
  return found;
}

std::string_view JsonDocument::unquoted(std::uint32_t begin, std::uint32_t size) const {
  const std::string_view token = std::string_view(text_).substr(begin, size);
  if (token.find('\\') != std::string_view::npos) {
    if (const auto entry = unescaped_.find(begin); entry != unescaped_.end()) return entry->second;
  }
  return size < 2 ? std::string_view{} : token.substr(1, size - 2);
}

std::optional<double> JsonDocument::number(const JsonNode& node) const {
  const std::string_view digits = token(node);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::vector<std::string> JsonDocument::lines(std::vector<JsonFault> faults) const {
  std::stable_sort(faults.begin(), faults.end(),
                   [](const JsonFault& a, const JsonFault& b) { return a.offset < b.offset; });
  std::vector<std::string> result;
  std::size_t line = 1, column = 1, at = text_.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  for (const JsonFault& fault : faults) {
    if (result.size() == max_faults) {
      result.push_back(fmt::format("{}: more than {} faults; the others are not listed", name_, max_faults));
      break;
    }
    for (; at < fault.offset && at < text_.size(); ++at) {
      if (text_[at] == '\n') {
        ++line;
        column = 1;
      } else if ((static_cast<unsigned char>(text_[at]) & 0xC0) != 0x80) {
        ++column;
      }
    }
    result.push_back(fmt::format("{}:{}:{}: {}", name_, line, column, fault.message));
  }
  return result;
}

}  // namespace collidoscope
