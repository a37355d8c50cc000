#include "sim_cuda/scene/object_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

namespace collidoscope {
namespace {

/// Reads a whole number, written as an integer (12) or as a double (1e3, 12.0). Clamps it to the range of the
/// type.
template <class Whole>
bool read_whole(const JsonDocument& document, const JsonNode& node, Whole& value) {
  const std::string_view digits = document.token(node);
  const char* const stop = digits.data() + digits.size();
  Whole whole = 0;
  const auto [end, error] = std::from_chars(digits.data(), stop, whole);
  if (end == stop && error == std::errc{}) {
    value = whole;
    return true;
  }
  const std::optional<double> real = document.number(node);
  if (!real || (std::is_unsigned_v<Whole> && *real < 0)) return false;
  constexpr Whole least = std::numeric_limits<Whole>::min(), most = std::numeric_limits<Whole>::max();
  if (*real >= static_cast<double>(most)) {
    value = most;
  } else if (*real <= static_cast<double>(least)) {
    value = least;
  } else {
    whole = static_cast<Whole>(*real);
    if (static_cast<double>(whole) != *real) return false;
    value = whole;
  }
  return true;
}

}  // namespace

ObjectReader::ObjectReader(Reading& reading, const JsonNode& node, std::string_view what)
    : reading_(reading), node_(node), what_(what), is_object_(node.kind == JsonKind::object) {
  if (!is_object_)
    reading_.fault(node, fmt::format("{} must be an object, {{ ... }}, not {}", what, described(node.kind)));
}

const JsonNode* ObjectReader::member(std::string_view key) {
  if (std::ranges::find(known_, key) == known_.end()) known_.push_back(key);
  return is_object_ ? reading_.document.find(node_, key) : nullptr;
}

const JsonNode* ObjectReader::member(std::string_view key, JsonKind kind, std::string_view message) {
  const JsonNode* node = member(key);
  if (node == nullptr || node->kind == kind) return node;
  reading_.fault(*node, message.empty() ? fmt::format("\"{}\" must be {}, not {}", key, described(kind),
                                                      described(node->kind))
                                        : std::string(message));
  return nullptr;
}

bool ObjectReader::real(std::string_view key, double& value) {
  const JsonNode* node = member(key, JsonKind::number);
  if (node == nullptr) return false;
  const std::optional<double> number = reading_.document.number(*node);
  if (!number) {
    reading_.fault(*node, fmt::format("{} is too small for a double; write 0",
                                      printable(reading_.document.token(*node))));
    return false;
  }
  value = *number;
  return true;
}

bool ObjectReader::whole(std::string_view key, std::int64_t& value) {
  const JsonNode* node = member(key, JsonKind::number);
  if (node == nullptr) return false;
  if (read_whole(reading_.document, *node, value)) return true;
  reading_.fault(*node, fmt::format("\"{}\" must be a whole number, not {}", key,
                                    printable(reading_.document.token(*node))));
  return false;
}

bool ObjectReader::whole(std::string_view key, int& value) {
  std::int64_t wide = value;
  if (!whole(key, wide)) return false;
  value = static_cast<int>(
      std::clamp<std::int64_t>(wide, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()));
  return true;
}

bool ObjectReader::whole(std::string_view key, std::uint64_t& value) {
  const JsonNode* node = member(key, JsonKind::number);
  if (node == nullptr) return false;
  const std::optional<double> real = reading_.document.number(*node);
  // 2^64 is the first double out of range. An integer literal just below it is read exactly.
  const std::string_view digits = reading_.document.token(*node);
  const bool is_digits = digits.find_first_not_of("0123456789") == std::string_view::npos;
  std::uint64_t exact = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), exact);
  if (is_digits && error == std::errc{} && end == digits.data() + digits.size()) {
    value = exact;
    return true;
  }
  if (!is_digits && real && *real < 0x1p64 && read_whole(reading_.document, *node, value)) return true;
  reading_.fault(*node, fmt::format("\"{}\" must be a whole number from 0 to 18446744073709551615, not {}",
                                    key, printable(digits)));
  return false;
}

bool ObjectReader::truth(std::string_view key, bool& value) {
  const JsonNode* node = member(key, JsonKind::boolean);
  if (node != nullptr) value = reading_.document.token(*node) == "true";
  return node != nullptr;
}

bool ObjectReader::text(std::string_view key, std::string& value) {
  const JsonNode* node = member(key, JsonKind::text);
  if (node != nullptr) value = reading_.document.text(*node);
  return node != nullptr;
}

const JsonNode* ObjectReader::numbers(std::string_view key, double* values, std::size_t count,
                                      std::string_view wanted) {
  const JsonNode* node =
      member(key, JsonKind::array, fmt::format("\"{}\" must be a list of {}", key, wanted));
  if (node == nullptr) return nullptr;
  if (node->child_count != count) {
    reading_.fault(
        *node, fmt::format("\"{}\" must be a list of {}, not of {} values", key, wanted, node->child_count));
    return nullptr;
  }
  bool good = true;
  for (std::size_t i = 0; i < count; ++i) {
    const JsonNode& child = reading_.document.children(*node)[i];
    const std::optional<double> number =
        child.kind == JsonKind::number ? reading_.document.number(child) : std::nullopt;
    if (number) {
      values[i] = *number;
      continue;
    }
    good = false;
    reading_.fault(
        child,
        child.kind == JsonKind::number
            ? fmt::format("{} is too small for a double; write 0", printable(reading_.document.token(child)))
            : fmt::format("\"{}\" must be a list of {}; this is {}", key, wanted, described(child.kind)));
  }
  return good ? node : nullptr;
}

bool ObjectReader::vector(std::string_view key, Vector3d& value) {
  double values[3];
  if (numbers(key, values, 3, "three numbers, [x, y, z]") == nullptr) return false;
  value = {values[0], values[1], values[2]};
  return true;
}

void ObjectReader::header(std::string_view format, std::string_view whose) {
  const JsonDocument& document = reading_.document;
  const JsonNode* name = member("format");
  if (name == nullptr || name->kind != JsonKind::text || document.text(*name) != format)
    reading_.fault(name == nullptr ? node_ : *name,
                   fmt::format("{} must start with \"format\": \"{}\"", whose, format));
  const JsonNode* version = member("version");
  if (version == nullptr || version->kind != JsonKind::number || document.number(*version) != 1.0)
    reading_.fault(version == nullptr ? node_ : *version, version == nullptr
                                                              ? "\"version\" is missing; expected 1"
                                                              : "unknown version of the format; expected 1");
}

/// Whether the node is the value of a known key, under its old key.
bool ObjectReader::is_read(const JsonNode& node) const {
  return std::ranges::any_of(
      known_, [&](std::string_view key) { return reading_.document.find(node_, key) == &node; });
}

void ObjectReader::finish() {
  if (!is_object_) return;
  for (const JsonNode& child : reading_.document.children(node_)) {
    const std::string_view key = reading_.document.key(child);
    if (std::ranges::find(known_, key) != known_.end()) continue;
    if (reading_.document.is_old_key(key) && is_read(child)) continue;
    if (reading_.full()) return;
    const std::string_view nearest = nearest_name(key, known_);
    reading_.fault_at_key(child, fmt::format("unknown key \"{}\" in {}; {}", printable(key), what_,
                                             nearest.empty() ? "expected " + either_of(known_)
                                                             : fmt::format("did you mean \"{}\"?", nearest)));
  }
}

}  // namespace collidoscope
