#include "sim_cuda/import/box_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/import/file_format.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/npy.h"
#include "sim_cuda/import/outwards.h"
#include "sim_cuda/import/ply_file.h"
#include "sim_cuda/import/surface.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_faults = 20;

std::vector<Aabb> boxes_of_triangles(const std::string& name) {
  const InputFile file(name, "a mesh");
  const FileText contents(file);
  const Surface surface = read_surface(contents.text(), name);
  std::vector<Aabb> boxes;
  for (const std::array<std::uint32_t, 3>& triangle : triangles_of(surface)) {
    Aabb& box = boxes.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const double a = surface.vertices[triangle[0]][k], b = surface.vertices[triangle[1]][k],
                   c = surface.vertices[triangle[2]][k];
      box.min[k] = rounded_outwards(std::min({a, b, c}), -1);
      box.max[k] = rounded_outwards(std::max({a, b, c}), 1);
    }
  }
  if (boxes.empty() || boxes.size() > static_cast<std::size_t>(limits::max_bodies))
    throw InputError(
        fmt::format("{}: {} triangles, expected 1 to {}", name, boxes.size(), limits::max_bodies));
  return boxes;
}

bool is_mesh_file(const std::string& file) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) return false;
  const FileFormat format = format_of(file);
  return format == FileFormat::obj || format == FileFormat::stl || format == FileFormat::ply;
}

}  // namespace

std::vector<Aabb> read_boxes(const std::string& file) {
  if (is_mesh_file(file))
    return with_allocation_context("reading a mesh", [&] { return boxes_of_triangles(file); });
  const NpyArray array = read_npy(file);
  const std::vector<std::size_t>& shape = array.shape;
  const bool is_flat = shape.size() == 2 && shape[1] == 6;
  if (!is_flat && !(shape.size() == 3 && shape[1] == 2 && shape[2] == 3))
    throw InputError(
        fmt::format("{}: an array of shape {}, expected (n, 6) or (n, 2, 3): min and max of each box", file,
                    shape_text(shape)));
  const std::size_t count = shape[0];
  if (count < 1 || count > static_cast<std::size_t>(limits::max_bodies))
    throw InputError(fmt::format("{}: {} boxes, expected 1 to {}", file, count, limits::max_bodies));

  std::vector<Aabb> boxes(count);
  std::vector<std::string> faults;
  array.visit([&](const auto* numbers) {
    // Steps between two rows, between min and max, and between two coordinates.
    const std::size_t row = array.fortran_order ? 1 : 6;
    const std::size_t end = !array.fortran_order ? 3 : is_flat ? 3 * count : count;
    const std::size_t axis = !array.fortran_order ? 1 : is_flat ? count : 2 * count;
    for (std::size_t i = 0; i < count && faults.size() < most_faults; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto low = numbers[i * row + k * axis], high = numbers[i * row + end + k * axis];
        const float min = rounded_outwards(low, -1), max = rounded_outwards(high, 1);
        boxes[i].min[static_cast<int>(k)] = min;
        boxes[i].max[static_cast<int>(k)] = max;
        const auto fault = [&](const char* problem) {
          faults.push_back(
              fmt::format("{}: row {}: {} from {} to {} {}", file, i, "xyz"[k], low, high, problem));
        };
        if (!std::isfinite(min) || !std::isfinite(max)) {
          fault("is not finite in single precision");
          break;
        }
        if (low > high) {
          fault("has min above max");
          break;
        }
      }
  });
  if (!faults.empty()) throw InputError(faults);
  return boxes;
}

BodyTable read_box_table(const std::string& file) {
  BodyTable table;
  take_boxes(read_boxes(file), file, table);
  return table;
}

bool is_box_source(const std::string& file) {
  if (is_mesh_file(file)) return format_of(file) != FileFormat::ply || ply_has_faces(file);
  return format_of(file) == FileFormat::npy && is_box_file(file);
}

bool is_box_file(const std::string& name) {
  const std::vector<std::size_t> shape = read_npy_layout(InputFile(name, "a NumPy file (.npy)")).shape;
  if (shape.size() == 3) return shape[1] == 2 && shape[2] == 3;
  if (shape.size() != 2 || shape[1] != 6 || shape[0] == 0) return false;
  const NpyArray array = read_npy(name);
  return array.visit([&](const auto* numbers) {
    const std::size_t row = array.fortran_order ? 1 : 6, column = array.fortran_order ? shape[0] : 1;
    for (std::size_t i = 0; i < shape[0]; ++i)
      for (std::size_t k = 0; k < 3; ++k)
        if (!(numbers[i * row + k * column] <= numbers[i * row + (k + 3) * column])) return false;
    return true;
  });
}

}  // namespace collidoscope
