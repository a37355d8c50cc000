#include "sim_cuda/scene/imported_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "sim_cuda/core/error.h"
#include "sim_cuda/import/body_table.h"
#include "sim_cuda/import/box_file.h"
#include "sim_cuda/import/ply_file.h"
#include "sim_cuda/import/robot_file.h"
#include "sim_cuda/scene/body_file.h"
#include "sim_cuda/scene/limits.h"
#include "sim_cuda/scene/names.h"
#include "sim_cuda/scene/scene_file.h"

namespace collidoscope {
namespace {

/// A quarter of the mean distance of neighbours in a cubic lattice of as many bodies in the same bounds, with
/// two digits. Axes without extent do not count.
double usual_radius(const std::vector<Vector3d>& position) {
  Vector3d low = position[0], high = position[0];
  for (const Vector3d& x : position) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const Vector3d size = high - low;
  double product = 1;
  int axes = 0;
  for (int k = 0; k < 3; ++k)
    if (size[k] > 1e-6 * size.maxCoeff()) {
      product *= size[k];
      ++axes;
    }
  if (axes == 0) return 1;
  const double distance = std::pow(product / static_cast<double>(position.size()), 1.0 / axes);
  const double radius = std::clamp(distance / 4, limits::min_radius, limits::max_radius);
  const double digit = std::pow(10.0, std::floor(std::log10(radius)) - 1);
  return std::clamp(std::stod(fmt::format("{:.1e}", std::round(radius / digit) * digit)), limits::min_radius,
                    limits::max_radius);
}

/// Fills `scene` with the bodies of a table.
void import_table(FileFormat format, const ImportOptions& options, Scene& scene) {
  BodyFile& bodies = scene.body_files.emplace_back();
  bodies.path = std::filesystem::path(scene.file).filename().string();
  bodies.columns = options.columns;
  bodies.scale = options.scale;
  bodies.frame = options.frame;
  read_body_file(scene.directory, bodies);
  const BodyTable& table = *bodies.table;
  const auto note = [&](const std::string& text) {
    scene.warnings.push_back(fmt::format("{}: {}", scene.file, text));
  };
  note(fmt::format("{}, {} {}{}", description_of(format), table.size(),
                   bodies.boxes ? "boxes, which are inspected, not simulated" : "bodies",
                   table.frames > 1 ? fmt::format(", frame {} of {}", options.frame, table.frames) : ""));
  if (table.radius.empty()) {
    bodies.radius = options.radius ? *options.radius : usual_radius(table.position);
    if (!options.radius)
      note(fmt::format("no radii; {} m is assumed, a quarter of the mean distance (--radius sets it)",
                       *bodies.radius));
  } else if (options.radius) {
    throw InputError(fmt::format("--radius: {} has radii; remove --radius", scene.file));
  }
  for (const std::string& text : table.notes) note(text);
}

/// Fills `scene` with the shapes of a robot.
void import_robot(FileFormat format, Scene& scene) {
  const RobotShapes robot = read_robot(scene.file, format);
  const auto unit = [](Quaterniond q) {
    q.coeffs() /= std::sqrt(q.squaredNorm());
    return q;
  };
  for (const RobotShape& shape : robot.shapes) {
    if (shape.kind == RobotShape::Kind::plane) {
      Vector3d normal = shape.orientation * unit_vector(2);
      normal /= std::sqrt(normal.squaredNorm());
      scene.obstacles.push_back({.normal = normal, .offset = normal.dot(shape.position)});
    } else if (shape.kind == RobotShape::Kind::box) {
      scene.boxes.push_back(
          {.center = shape.position, .size = shape.size, .orientation = unit(shape.orientation)});
    } else {
      Body& body = scene.bodies.emplace_back();
      body.motion = shape.fixed ? Motion::fixed : Motion::dynamic;
      body.radius = shape.radius;
      body.position = shape.position;
      body.orientation = unit(shape.orientation);
    }
  }
  scene.warnings.push_back(fmt::format("{}: {}, {} bodies, {} boxes, {} planes", scene.file,
                                       description_of(format), scene.bodies.size(), scene.boxes.size(),
                                       scene.obstacles.size()));
  for (const std::string& note : robot.notes)
    scene.warnings.push_back(fmt::format("{}: {}", scene.file, note));
}

/// A scene without bodies.
Scene scene_of_file(const std::string& file) {
  const std::filesystem::path path(file);
  Scene scene;
  scene.directory = path.has_parent_path() ? path.parent_path().string() : ".";
  scene.name = printable(path.filename().string(), limits::max_name_length);
  scene.file = file;
  scene.physics.gravity = Vector3d(0, 0, 0);
  return scene;
}

}  // namespace

Scene import_boxes(const std::string& file, const std::string& tree) {
  namespace fs = std::filesystem;
  Scene scene = scene_of_file(file);
  BodyFile& boxes = scene.body_files.emplace_back();
  boxes.path = fs::path(file).filename().string();
  boxes.boxes = true;
  if (!tree.empty()) {
    std::error_code failed;
    const fs::path folder = fs::weakly_canonical(scene.directory, failed);
    boxes.tree = fs::weakly_canonical(tree, failed).lexically_relative(folder).string();
    if (boxes.tree.empty() || boxes.tree.starts_with(".."))
      throw InputError(
          fmt::format("{}: not in the folder of {}, expected both files in one folder", tree, file));
  }
  read_body_file(scene.directory, boxes);
  scene.warnings.push_back(fmt::format("{}: {} boxes{}; they are inspected, not simulated", file,
                                       boxes.table->size(), tree.empty() ? "" : " and a tree over them"));
  valid(scene);
  return scene;
}

Scene import_scene(const std::string& file, FileFormat format, const ImportOptions& options) {
  if (format == FileFormat::npy && !options.any() && is_box_file(file)) return import_boxes(file, "");
  const std::filesystem::path path(file);
  Scene scene = scene_of_file(file);
  const bool is_mesh = format == FileFormat::obj || format == FileFormat::stl ||
                       (format == FileFormat::ply && ply_has_faces(file));
  const bool is_robot = format == FileFormat::urdf || format == FileFormat::mjcf;
  if ((is_mesh || is_robot) && options.any())
    throw InputError(fmt::format("--columns, --radius, --scale, --frame: {} is no table of bodies ({})", file,
                                 description_of(format)));
  if (is_mesh) {
    Body& body = scene.bodies.emplace_back();
    body.shape = Shape::mesh;
    body.mesh = path.filename().string();
  } else if (is_robot) {
    import_robot(format, scene);
  } else {
    import_table(format, options, scene);
  }
  valid(scene);
  return scene;
}

}  // namespace collidoscope
