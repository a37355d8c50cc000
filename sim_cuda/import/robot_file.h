#pragma once
// Shapes of robots and models: URDF and MJCF, at the initial pose of all joints. Only spheres, boxes,
// cylinders, capsules and planes are read.

#include <string>
#include <vector>

#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/import/file_format.h"

namespace collidoscope {

struct RobotShape {
  enum class Kind { sphere, box, plane };
  Kind kind = Kind::sphere;
  bool fixed = false;          ///< part of the world
  Vector3d position{0, 0, 0};  ///< m, of the centre
  Quaterniond orientation{1, 0, 0, 0};
  double radius = 0;       ///< m, of a sphere, or of the sphere around another shape
  Vector3d size{0, 0, 0};  ///< m, full edge lengths of a box
};

struct RobotShapes {
  std::string name;
  std::vector<RobotShape> shapes;
  std::vector<std::string> notes;  ///< what was replaced or not taken, with counts
};

/// Reads a file of the format urdf or mjcf. Refers to no other file. Throws InputError: `file:line:column:
/// problem`.
RobotShapes read_robot(const std::string& file, FileFormat format);
/// The same from text.
RobotShapes parse_robot(const std::string& text, const std::string& file, FileFormat format);

}  // namespace collidoscope
