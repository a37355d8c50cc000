#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim_cuda/import/robot_reader.h"

namespace collidoscope {
namespace {

class MjcfReader : RobotReader {
 public:
  MjcfReader(const std::string& text, const std::string& file) : RobotReader(text, file) {}

  RobotShapes read() {
    const pugi::xml_node model = document_.child("mujoco");
    if (!model) fail(0, "no element mujoco", "<mujoco>");
    shapes_.name = model.attribute("model").as_string("model");
    const pugi::xml_node compiler = model.child("compiler");
    degrees_ = std::string_view(compiler.attribute("angle").as_string("degree")) != "radian";
    sequence_ = compiler.attribute("eulerseq").as_string("xyz");
    for (const pugi::xml_node part : model.children("default")) read_defaults(part, {});
    for (const pugi::xml_node part : model.children())
      if (std::string_view(part.name()) == "include") count("included files");
    for (const pugi::xml_node world : model.children("worldbody")) add_body(world, {}, true, "");
    return finish();
  }

 private:
  using Attributes = std::map<std::string, std::string>;

  /// Attributes of geoms by class. Nested classes inherit.
  void read_defaults(const pugi::xml_node& node, Attributes inherited) {
    if (const pugi::xml_node geom = node.child("geom")) merge(geom, inherited);
    defaults_[node.attribute("class").as_string(node.parent() == document_.child("mujoco") ? "main" : "")] =
        inherited;
    for (const pugi::xml_node part : node.children("default")) read_defaults(part, inherited);
  }
  static void merge(const pugi::xml_node& node, Attributes& attributes) {
    for (const pugi::xml_attribute attribute : node.attributes())
      attributes[attribute.name()] = attribute.as_string();
  }

  Quaterniond mjcf_orientation(const pugi::xml_node& node, const Attributes& a) const {
    const double to_radians = degrees_ ? std::numbers::pi / 180 : 1;
    const auto text = [&](const char* key) {
      const auto found = a.find(key);
      return found == a.end() ? std::string() : found->second;
    };
    if (const std::string quat = text("quat"); !quat.empty()) {
      const std::array<double, 6> q = numbers(node, "quat", quat, 4, 4);
      const Quaterniond read(q[0], q[1], q[2], q[3]);
      if (!(read.squaredNorm() > 1e-30)) fail(node, "a quaternion of 0", "w x y z");
      return read.normalized();
    }
    if (const std::string axis = text("axisangle"); !axis.empty()) {
      const std::array<double, 6> v = numbers(node, "axisangle", axis, 4, 4);
      const Vector3d direction(v[0], v[1], v[2]);
      if (!(direction.squaredNorm() > 1e-30)) fail(node, "an axis of 0", "x y z angle");
      return Quaterniond(Eigen::AngleAxisd(v[3] * to_radians, direction.normalized()));
    }
    if (const std::string euler = text("euler"); !euler.empty()) {
      const Vector3d angles = vector(node, "euler", euler);
      Quaterniond q(1, 0, 0, 0);
      for (std::size_t k = 0; k < 3 && k < sequence_.size(); ++k) {
        const char axis = sequence_[k];
        const int component = axis == 'x' || axis == 'X' ? 0 : axis == 'y' || axis == 'Y' ? 1 : 2;
        const Quaterniond turn(
            Eigen::AngleAxisd(angles[static_cast<int>(k)] * to_radians, unit_vector(component)));
        q = axis >= 'a' ? q * turn : turn * q;  // lower case: axes that turn with the body
      }
      return q;
    }
    if (const std::string zaxis = text("zaxis"); !zaxis.empty()) {
      const Vector3d direction = vector(node, "zaxis", zaxis);
      if (!(direction.squaredNorm() > 1e-30)) fail(node, "an axis of 0", "x y z");
      return Quaterniond::FromTwoVectors(unit_vector(2), direction);
    }
    if (const std::string axes = text("xyaxes"); !axes.empty()) {
      const std::array<double, 6> v = numbers(node, "xyaxes", axes, 6, 6);
      const Vector3d x = Vector3d(v[0], v[1], v[2]), other(v[3], v[4], v[5]), z = x.cross(other);
      if (!(z.squaredNorm() > 1e-30)) fail(node, "axes in one line", "two directions");
      Matrix3d matrix;
      matrix.col(0) = x.normalized();
      matrix.col(2) = z.normalized();
      matrix.col(1) = matrix.col(2).cross(matrix.col(0));
      return Quaterniond(matrix);
    }
    return {1, 0, 0, 0};
  }

  RobotPose mjcf_pose(const pugi::xml_node& node, const Attributes& a) const {
    const auto position = a.find("pos");
    return {position == a.end() ? Vector3d(0, 0, 0) : vector(node, "pos", position->second),
            mjcf_orientation(node, a)};
  }

  void add_body(const pugi::xml_node& body, const RobotPose& pose, bool fixed, const std::string& inherited) {
    const std::string child_class = body.attribute("childclass").as_string(inherited.c_str());
    for (const pugi::xml_node part : body.children()) {
      const std::string_view kind = part.name();
      if (kind == "geom") {
        add_geom(part, pose, fixed, child_class);
      } else if (kind == "body" || kind == "frame") {
        Attributes attributes;
        merge(part, attributes);
        add_body(part, pose * mjcf_pose(part, attributes), fixed && kind == "frame", child_class);
      } else if (kind == "joint" || kind == "freejoint") {
        if (kind == "joint") count("joints, shown at their initial pose");
      } else if (kind == "include") {
        count("included files");
      }
    }
  }

  void add_geom(const pugi::xml_node& geom, const RobotPose& body, bool fixed, const std::string& inherited) {
    Attributes a;
    std::string name = geom.attribute("class").as_string(inherited.c_str());
    if (name.empty()) name = "main";
    if (const auto found = defaults_.find(name); found != defaults_.end()) a = found->second;
    merge(geom, a);
    if (a.contains("mesh") && !a.contains("type")) a["type"] = "mesh";
    const std::string type = a.contains("type") ? a["type"] : "sphere";
    if (type == "mesh" || type == "hfield" || type == "sdf") {
      count(type == "mesh" ? "meshes not taken" : "height fields not taken");
      return;
    }
    RobotPose pose = body * mjcf_pose(geom, a);
    std::array<double, 6> size = numbers(geom, "size", a.contains("size") ? a["size"] : "0", 1, 3);
    if (a.contains("fromto")) {  // the ends of an axis; size has the radius only
      const std::array<double, 6> v = numbers(geom, "fromto", a["fromto"], 6, 6);
      const Vector3d from(v[0], v[1], v[2]), to(v[3], v[4], v[5]);
      if (!((to - from).squaredNorm() > 0)) fail(geom, "fromto of two equal points", "two different points");
      pose = body * RobotPose{(from + to) / 2, Quaterniond::FromTwoVectors(unit_vector(2), to - from)};
      const double half = (to - from).norm() / 2;
      if (type == "box" || type == "ellipsoid")
        size = {size[0], size[0], half};
      else
        size[1] = half;
    }
    if (type == "plane") {
      if (!fixed) return count("planes of moving bodies not taken");
      add(geom, {.kind = RobotShape::Kind::plane,
                 .fixed = true,
                 .position = pose.position,
                 .orientation = pose.orientation});
    } else if (type == "sphere") {
      add_round(geom, pose, size[0], nullptr, fixed);
    } else if (type == "box") {
      add_box(geom, pose, 2 * Vector3d(size[0], size[1], size[2]), fixed);
    } else if (type == "capsule") {
      add_round(geom, pose, length(geom, "size", size[0]) + length(geom, "size", size[1]),
                "capsules as the spheres around them", fixed);
    } else if (type == "cylinder") {
      add_round(geom, pose, std::hypot(length(geom, "size", size[0]), length(geom, "size", size[1])),
                "cylinders as the spheres around them", fixed);
    } else if (type == "ellipsoid") {
      add_round(geom, pose, std::max({size[0], size[1], size[2]}), "ellipsoids as the spheres around them",
                fixed);
    } else {
      count("shapes of unknown kind not taken");
    }
  }

  std::map<std::string, Attributes> defaults_;  ///< of geoms, by class
  bool degrees_ = true;
  std::string sequence_ = "xyz";  ///< of Euler angles
};

}  // namespace

RobotShapes parse_mjcf(const std::string& text, const std::string& file) {
  return MjcfReader(text, file).read();
}

}  // namespace collidoscope
