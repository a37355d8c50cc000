#include "sim_cuda/scene/body_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/box_file.h"
#include "sim_cuda/import/table_file.h"
#include "sim_cuda/import/tree_file.h"
#include "sim_cuda/scene/mass_properties.h"

namespace collidoscope {
namespace {

namespace fs = std::filesystem;

/// The file of a path that a scene gives. A scene of a stranger must not name files outside of its folder.
std::string contained_file(const std::string& directory, const std::string& path) {
  const fs::path given(path);
  const bool is_inside =
      !path.empty() && given.is_relative() && std::ranges::find(given, fs::path("..")) == given.end();
  if (!is_inside)
    throw InputError(
        fmt::format("{}: not a file in the folder of the scene, expected a relative path without ..",
                    path.empty() ? "''" : path));
  const fs::path file = fs::path(directory) / given;
  std::error_code failed;
  const fs::path folder = fs::weakly_canonical(directory, failed), real = fs::weakly_canonical(file, failed);
  const fs::path inside = real.lexically_relative(folder);
  if (failed || inside.empty() || *inside.begin() == "..")
    throw InputError(
        fmt::format("{}: a link that leaves the folder of the scene, expected a file in it", path));
  return file.lexically_normal().string();
}

/// Calls `use` for each row that is not excluded, in order.
template <class Use>
void for_each_kept(const BodyFile& file, const Use& use) {
  auto next = file.excluded.begin();
  for (std::size_t row = 0; row < file.table->size(); ++row) {
    if (next != file.excluded.end() && static_cast<std::size_t>(*next) == row)
      ++next;
    else
      use(row);
  }
}

/// Appends the kept rows of an optional array, after default values for all earlier bodies.
template <class Value>
void append_optional(const BodyFile& file, const std::vector<Value>& values, std::size_t first,
                     const Value& usual, std::vector<Value>& all) {
  if (values.empty()) return;
  all.resize(first, usual);
  for_each_kept(file, [&](std::size_t row) { all.push_back(values[row]); });
}

}  // namespace

void read_body_file(const std::string& directory, BodyFile& file) {
  const std::string name = contained_file(directory, file.path);
  if (file.boxes && file.columns.empty() && is_box_source(name)) {
    if (file.scale != 1 || file.frame != 0)
      throw InputError(name + ": boxes without columns, expected no scale and no frame");
    file.table = std::make_shared<const BodyTable>(read_box_table(name));
  } else {
    TableOptions options;
    options.columns = parse_column_map(file.columns, name + ": columns");
    options.scale = file.scale;
    options.frame = file.frame;
    file.table = std::make_shared<const BodyTable>(read_body_table(name, format_of(name), options));
    if (file.boxes && file.table->boxes.empty())
      throw InputError(name + ": no columns of boxes, expected min_x, min_y, min_z, max_x, max_y, max_z");
    file.boxes = !file.table->boxes.empty();
  }
  if (!file.tree.empty() && file.boxes)
    file.given_tree =
        std::make_shared<const GivenTree>(read_tree(contained_file(directory, file.tree), file.table->boxes));
}

void append_body_file(const BodyFile& file, double density, InitialBodies& all) {
  const BodyTable& table = *file.table;
  const std::size_t first = all.size();
  for_each_kept(file, [&](std::size_t row) {
    const double radius = table.radius.empty() ? *file.radius : table.radius[row];
    all.position.push_back(table.position[row]);
    all.radius.push_back(radius);
    all.mass.push_back(file.boxes           ? 1
                       : table.mass.empty() ? density * sphere_volume(radius)
                                            : table.mass[row]);
  });
  append_optional(file, table.velocity, first, Vector3d(0, 0, 0), all.velocity);
  append_optional(file, table.angular_velocity, first, Vector3d(0, 0, 0), all.angular_velocity);
  append_optional(file, table.orientation, first, Quaterniond(1, 0, 0, 0), all.orientation);
  if (file.boxes) {
    append_optional(file, table.boxes, first, Aabb::empty(), all.boxes);
    if (file.excluded.empty()) all.tree = file.given_tree;  // a tree has all boxes
    all.motion.resize(first, Motion::dynamic);
    all.motion.resize(all.size(), Motion::fixed);
  }
  if (file.material == 0) return;
  all.material.resize(first, 0);
  all.material.resize(all.size(), static_cast<std::uint16_t>(file.material));
}

}  // namespace collidoscope
