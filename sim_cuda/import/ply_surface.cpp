#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/ply_file.h"
#include "sim_cuda/import/surface.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

/// The numbers of a PLY file one after the other, in any encoding.
class PlyNumbers {
 public:
  PlyNumbers(std::string_view text, const PlyHeader& header, const std::string& file)
      : file_(file), data_(text.substr(header.bytes)), begin_(header.bytes), encoding_(header.encoding) {}

  double next(PlyHeader::Type type) {
    if (encoding_ == PlyHeader::Encoding::text) return next_word();
    const std::size_t bytes = bytes_of(type);
    if (bytes > data_.size() - at_) fail("the file ends", "more numbers");
    const double number = ply_number(data_.data() + at_, type, encoding_ == PlyHeader::Encoding::big);
    at_ += bytes;
    return number;
  }
  std::size_t left() const { return data_.size() - at_; }
  [[noreturn]] void fail(const std::string& problem, const std::string& expected) const {
    throw InputError(fmt::format("{}: byte {}: {}, expected {}", file_, begin_ + at_, problem, expected));
  }

 private:
  double next_word() {
    at_ = std::min(data_.find_first_not_of(" \t\r\n", at_), data_.size());
    double number = 0;
    const char *const first = data_.data() + at_, *const end = data_.data() + data_.size();
    const auto [stop, error] = std::from_chars(first, end, number);
    if (error != std::errc{}) fail("no number", "a number");
    at_ += static_cast<std::size_t>(stop - first);
    return number;
  }

  const std::string& file_;
  std::string_view data_;
  std::size_t begin_, at_ = 0;
  PlyHeader::Encoding encoding_;
};

class PlySurfaceReader {
 public:
  PlySurfaceReader(std::string_view text, const std::string& file)
      : header_(read_ply_header(text, file)), numbers_(text, header_, file) {
    surface_.places_are_lines = false;
  }

  Surface read() {
    for (const PlyHeader::Element& element : header_.elements) {
      // Each row has at least a byte, unless it has no properties.
      if (!element.properties.empty() && element.count > numbers_.left())
        numbers_.fail(fmt::format("{} elements {}", element.count, element.name), "a longer file");
      for (std::size_t row = 0; row < element.count && !element.properties.empty(); ++row)
        read_row(element, row);
    }
    return std::move(surface_);
  }

 private:
  void read_row(const PlyHeader::Element& element, std::size_t row) {
    Vector3d x(0, 0, 0);
    for (const PlyHeader::Property& property : element.properties) {
      if (property.is_list) {
        const bool corners =
            element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index");
        read_list(property, corners, row);
        continue;
      }
      const double number = numbers_.next(property.type);
      if (element.name != "vertex" || property.name.size() != 1) continue;
      const int axis = property.name[0] - 'x';
      if (axis < 0 || axis > 2) continue;
      if (!(number >= -limits::max_coordinate && number <= limits::max_coordinate))
        numbers_.fail("a coordinate out of range", fmt::format("up to {:g} m", limits::max_coordinate));
      x[axis] = number;
    }
    if (element.name == "vertex") surface_.vertices.push_back(x);
  }

  void read_list(const PlyHeader::Property& property, bool corners, std::size_t row) {
    const double count = numbers_.next(property.count_type);
    if (!(count >= 0 && count <= static_cast<double>(numbers_.left())))
      numbers_.fail("a damaged list", "its length");
    const auto first = static_cast<std::uint32_t>(surface_.corners.size());
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const double index = numbers_.next(property.type);
      if (!corners) continue;
      if (!(index >= 0 && index < 0x1p30)) numbers_.fail("no index of a vertex", "a whole number from 0");
      surface_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    if (!corners) return;
    if (count < 3) numbers_.fail(fmt::format("a face with {} corners", count), "at least 3");
    const auto begin = surface_.corners.begin() + first;
    std::vector<std::uint32_t> sorted(begin, surface_.corners.end());
    std::ranges::sort(sorted);
    if (std::ranges::adjacent_find(sorted) != sorted.end())
      numbers_.fail("a face with the same vertex twice", "each vertex once");
    surface_.polygons.push_back(
        {first, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(row + 1)});
  }

  PlyHeader header_;
  PlyNumbers numbers_;
  Surface surface_;
};

}  // namespace

Surface read_ply_surface(std::string_view bytes, const std::string& file) {
  return PlySurfaceReader(bytes, file).read();
}

}  // namespace collidoscope
