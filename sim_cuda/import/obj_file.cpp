#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/surface.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_obj_faults = 100;

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  /// Throws all faults.
  Surface read() {
    while (!text_.empty() && faults_.size() < most_obj_faults) {
      const std::size_t end = std::min(text_.find('\n'), text_.size());
      line_ = text_.substr(0, end);
      text_.remove_prefix(std::min(end + 1, text_.size()));
      ++line_number_;
      if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
      read_line();
    }
    if (!faults_.empty()) throw InputError(std::move(faults_));
    return std::move(surface_);
  }

 private:
  void fault_here(std::string_view word, const std::string& what) {
    if (faults_.size() == most_obj_faults) return;
    const std::size_t column = static_cast<std::size_t>(word.data() - line_.data()) + 1;
    faults_.push_back(fmt::format("{}:{}:{}: {}", file_, line_number_, column, what));
  }

  /// The next word of the line. Empty at its end or at the start of a comment.
  static std::string_view next_word(std::string_view& rest) {
    const std::size_t start = std::min(rest.find_first_not_of(" \t"), rest.size());
    rest.remove_prefix(start);
    const std::size_t size = rest.starts_with('#') ? 0 : std::min(rest.find_first_of(" \t"), rest.size());
    const std::string_view word = rest.substr(0, size);
    rest.remove_prefix(size);
    return word;
  }

  void read_line() {
    std::string_view rest = line_;
    const std::string_view keyword = next_word(rest);
    if (keyword == "v") {
      read_vertex(keyword, rest);
    } else if (keyword == "f") {
      read_face(keyword, rest);
    } else {
      for (const std::string_view passed : {"", "vt", "vn", "o", "g", "s", "usemtl", "mtllib"}) {
        if (keyword == passed) return;
      }
      fault_here(keyword, fmt::format("unsupported keyword \"{}\"; a mesh consists of `v x y z` and `f i j k "
                                      "...` (vt, vn, o, g, s, usemtl and mtllib are ignored)",
                                      printable(keyword)));
    }
  }

  static std::string printable(std::string_view word) {
    std::string text(word.substr(0, 40));
    for (char& c : text) {
      if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) c = '?';
    }
    return text;
  }

  void read_vertex(std::string_view keyword, std::string_view rest) {
    double value[7];
    int count = 0;
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      if (count == 7) return fault_here(word, "a vertex has at most 7 numbers: x y z, w = 1 and a colour");
      const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
      double& x = value[count++];
      const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
      if (error != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(x)) {
        return fault_here(
            word, fmt::format("\"{}\" is not a number; expected `v x y z`, in metres", printable(word)));
      }
      if (std::abs(x) > limits::max_coordinate) {
        return fault_here(word, fmt::format("{} is out of range; a coordinate must be in [-1e9, 1e9] m", x));
      }
    }
    if (count < 3) return fault_here(keyword, fmt::format("{} numbers; expected `v x y z`", count));
    if (count != 6 && count > 3 && value[3] != 1) {
      return fault_here(keyword, "a vertex with a weight other than 1; give only x y z");
    }
    surface_.vertices.emplace_back(value[0], value[1], value[2]);
    if (surface_.vertices.size() > (std::size_t{1} << 30)) fault_here(keyword, "more than 2^30 vertices");
  }

  /// The vertex index, from 0, of a face corner `v`, `v/vt`, `v//vn` or `v/vt/vn`. A corner may refer to a
  /// later vertex.
  std::optional<std::uint32_t> corner(std::string_view word) {
    long long index[3] = {0, 0, 0};
    int part = 0;
    const char* at = word.data();
    const char* const end = word.data() + word.size();
    while (true) {
      const bool may_be_empty = part == 1 && at < end && *at == '/';
      if (!may_be_empty) {
        const auto [stop, error] = std::from_chars(at, end, index[part]);
        if (error != std::errc{}) return std::nullopt;
        at = stop;
      }
      if (at == end) break;
      if (*at != '/' || ++part == 3) return std::nullopt;
      ++at;
    }
    const long long absolute =
        index[0] > 0 ? index[0] - 1 : static_cast<long long>(surface_.vertices.size()) + index[0];
    if (index[0] == 0 || absolute < 0 || absolute >= (1LL << 30)) return std::nullopt;
    return static_cast<std::uint32_t>(absolute);
  }

  void read_face(std::string_view keyword, std::string_view rest) {
    Surface::Polygon polygon{static_cast<std::uint32_t>(surface_.corners.size()), 0, line_number_};
    constexpr std::uint32_t few = 64;        // corners; up to this number a linear search is used
    std::unordered_set<std::uint32_t> seen;  // used for more corners
    for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
      const std::optional<std::uint32_t> index = corner(word);
      if (!index) {
        return fault_here(word,
                          fmt::format("\"{}\" is not a vertex index; a corner is v, v/vt, v//vn or v/vt/vn, "
                                      "counted from 1, or from -1 backwards ({} vertices so far)",
                                      printable(word), surface_.vertices.size()));
      }
      const auto first = surface_.corners.begin() + polygon.first;
      if (polygon.count == few) seen.insert(first, surface_.corners.end());
      if (polygon.count < few ? std::find(first, surface_.corners.end(), *index) != surface_.corners.end()
                              : !seen.insert(*index).second) {
        return fault_here(
            word, fmt::format("vertex {} appears twice in one face; list each vertex once", *index + 1));
      }
      surface_.corners.push_back(*index);
      ++polygon.count;
    }
    if (polygon.count < 3) {
      return fault_here(keyword,
                        fmt::format("a face with {} corners; expected at least three", polygon.count));
    }
    surface_.polygons.push_back(polygon);
  }

  std::string_view text_, line_;
  const std::string& file_;
  std::uint32_t line_number_ = 0;
  Surface surface_;
  std::vector<std::string> faults_;
};

}  // namespace

Surface read_obj_surface(std::string_view text, const std::string& file) {
  return ObjReader(text, file).read();
}

}  // namespace collidoscope
