#include "sim_cuda/import/robot_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <pugixml.hpp>
#include <set>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/text_rows.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_xml_bytes = std::size_t{64} << 20;
constexpr int deepest_nesting = 1000;

struct RobotPose {
  Vector3d position{0, 0, 0};
  Quaterniond orientation{1, 0, 0, 0};
};

RobotPose operator*(const RobotPose& outer, const RobotPose& inner) {
  return {outer.position + outer.orientation * inner.position, outer.orientation * inner.orientation};
}

/// Rotation about the fixed axes x, then y, then z.
Quaterniond from_roll_pitch_yaw(const Vector3d& angles) {
  using Eigen::AngleAxisd;
  return Quaterniond(AngleAxisd(angles.z(), unit_vector(2)) * AngleAxisd(angles.y(), unit_vector(1)) *
                     AngleAxisd(angles.x(), unit_vector(0)));
}

class RobotReader {
 public:
  RobotReader(const std::string& text, const std::string& file) : text_(text), file_(file) {
    const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
    if (!result)
      fail(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), result.description(),
           "well-formed XML");
    check_depth(document_.root());
  }

  RobotShapes read_urdf() {
    const pugi::xml_node robot = document_.child("robot");
    if (!robot) fail(0, "no element robot", "<robot>");
    shapes_.name = robot.attribute("name").as_string("robot");
    place_links(robot);
    for (const pugi::xml_node link : robot.children("link"))
      for (const pugi::xml_node collision : link.children("collision"))
        add_urdf(collision, poses_.at(link.attribute("name").as_string()));
    std::size_t moving = 0;
    for (const pugi::xml_node joint : robot.children("joint"))
      moving += std::string_view(joint.attribute("type").as_string()) == "fixed" ? 0 : 1;
    count("joints, shown at their initial pose", moving);
    return finish();
  }

  RobotShapes read_mjcf() {
    const pugi::xml_node model = document_.child("mujoco");
    if (!model) fail(0, "no element mujoco", "<mujoco>");
    shapes_.name = model.attribute("model").as_string("model");
    const pugi::xml_node compiler = model.child("compiler");
    degrees_ = std::string_view(compiler.attribute("angle").as_string("degree")) != "radian";
    sequence_ = compiler.attribute("eulerseq").as_string("xyz");
    for (const pugi::xml_node part : model.children("default")) read_defaults(part, {});
    for (const pugi::xml_node part : model.children())
      if (std::string_view(part.name()) == "include") ++counts_["included files"];
    for (const pugi::xml_node world : model.children("worldbody")) add_body(world, {}, true, "");
    return finish();
  }

 private:
  using Attributes = std::map<std::string, std::string>;

  [[noreturn]] void fail(std::size_t at, const std::string& problem, const std::string& expected) const {
    at = std::min(at, text_.size());
    const std::size_t line = static_cast<std::size_t>(std::count(
                                 text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n')) +
                             1;
    const std::size_t newline = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
    const std::size_t column = newline == std::string::npos ? at + 1 : at - newline;
    throw InputError(fmt::format("{}:{}:{}: {}, expected {}", file_, line, column, problem, expected));
  }
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& problem,
                         const std::string& expected) const {
    fail(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), problem, expected);
  }

  /// Nesting is bounded, since elements are visited recursively.
  void check_depth(const pugi::xml_node& root) const {
    int depth = 0;
    for (pugi::xml_node node = root; node;) {
      if (node.first_child()) {
        node = node.first_child();
        if (++depth > deepest_nesting)
          fail(node, "elements are nested too deeply", fmt::format("at most {} levels", deepest_nesting));
        continue;
      }
      while (node && node != root && !node.next_sibling()) {
        node = node.parent();
        --depth;
      }
      if (!node || node == root) return;
      node = node.next_sibling();
    }
  }

  void count(const std::string& what, std::size_t number = 1) {
    if (number > 0) counts_[what] += number;
  }

  RobotShapes finish() {
    for (const auto& [what, number] : counts_) shapes_.notes.push_back(fmt::format("{} {}", number, what));
    if (shapes_.shapes.empty())
      throw InputError(file_ + ": no spheres, boxes, cylinders or capsules, expected one");
    return std::move(shapes_);
  }

  /// Reads numbers between spaces, at least `least` and at most `most`; missing ones are `otherwise`.
  std::array<double, 6> numbers(const pugi::xml_node& node, std::string_view key, std::string_view text,
                                std::size_t least, std::size_t most, double otherwise = 0) const {
    std::array<double, 6> values;
    values.fill(otherwise);
    const std::vector<std::string_view> fields = fields_of(text, ' ');
    bool good = fields.size() >= least && fields.size() <= most;
    for (std::size_t k = 0; good && k < fields.size(); ++k)
      good = is_number(fields[k], values[k]) && std::abs(values[k]) <= limits::max_coordinate;
    if (!good)
      fail(node, fmt::format("damaged {}", key),
           least == most ? fmt::format("{} numbers", least) : fmt::format("{} to {} numbers", least, most));
    return values;
  }
  Vector3d vector(const pugi::xml_node& node, const char* key, const std::string& text) const {
    if (text.empty()) return {0, 0, 0};
    const std::array<double, 6> v = numbers(node, key, text, 3, 3);
    return {v[0], v[1], v[2]};
  }
  double length(const pugi::xml_node& node, const char* key, double value) const {
    if (!(value >= limits::min_radius && value <= limits::max_radius))
      fail(node, fmt::format("{} = {:g}", key, value),
           fmt::format("{:g} to {:g} m", limits::min_radius, limits::max_radius));
    return value;
  }

  void add(const pugi::xml_node& node, RobotShape shape) {
    if (shape.position.cwiseAbs().maxCoeff() > limits::max_coordinate)
      fail(node, "a shape too far away", fmt::format("coordinates up to {:g} m", limits::max_coordinate));
    constexpr std::size_t most = std::size_t{1} << 20;
    if (shapes_.shapes.size() == most) fail(node, "too many shapes", fmt::format("at most {}", most));
    shapes_.shapes.push_back(shape);
  }
  /// A box stays a box in the world; else it becomes the sphere around it.
  void add_box(const pugi::xml_node& node, const RobotPose& pose, const Vector3d& size, bool fixed) {
    for (int k = 0; k < 3; ++k) length(node, "size", size[k]);
    RobotShape shape{.fixed = fixed, .position = pose.position, .orientation = pose.orientation};
    shape.size = size;
    shape.radius = length(node, "radius of the sphere around it", size.norm() / 2);
    shape.kind = fixed ? RobotShape::Kind::box : RobotShape::Kind::sphere;
    if (!fixed) count("boxes as the spheres around them");
    add(node, shape);
  }
  void add_round(const pugi::xml_node& node, const RobotPose& pose, double radius, const char* replaced,
                 bool fixed) {
    if (replaced != nullptr) count(replaced);
    add(node, {.fixed = fixed,
               .position = pose.position,
               .orientation = pose.orientation,
               .radius = length(node, "radius", radius)});
  }

  // ---- URDF ----

  RobotPose urdf_origin(const pugi::xml_node& owner) const {
    const pugi::xml_node origin = owner.child("origin");
    if (!origin) return {};
    return {vector(origin, "xyz", origin.attribute("xyz").as_string()),
            from_roll_pitch_yaw(vector(origin, "rpy", origin.attribute("rpy").as_string()))};
  }

  /// Sets the pose of each link in the world. Links without a parent are at the origin.
  void place_links(const pugi::xml_node& robot) {
    std::map<std::string, pugi::xml_node> joint_of;  // by child
    for (const pugi::xml_node link : robot.children("link")) {
      const std::string name = link.attribute("name").as_string();
      if (!joint_of.emplace(name, pugi::xml_node()).second)
        fail(link, "a second link of the same name", "different names");
    }
    for (const pugi::xml_node joint : robot.children("joint")) {
      const std::string child = joint.child("child").attribute("link").as_string();
      const std::string parent = joint.child("parent").attribute("link").as_string();
      if (!joint_of.contains(child) || !joint_of.contains(parent))
        fail(joint, "a joint of an unknown link", "the names of two links");
      if (joint_of[child]) fail(joint, "a second parent of a link", "one joint for each child");
      joint_of[child] = joint;
    }
    for (const auto& [name, unused] : joint_of) {
      std::vector<std::string> way;  // to the first link whose pose is known
      std::string link = name;
      for (; !poses_.contains(link) && joint_of[link];
           link = joint_of[link].child("parent").attribute("link").as_string()) {
        way.push_back(link);
        if (way.size() > joint_of.size()) fail(joint_of[link], "a loop of joints", "a tree of links");
      }
      if (!poses_.contains(link)) poses_[link] = {};
      for (; !way.empty(); way.pop_back()) {
        const pugi::xml_node joint = joint_of[way.back()];
        poses_[way.back()] = poses_[joint.child("parent").attribute("link").as_string()] * urdf_origin(joint);
      }
    }
  }

  void add_urdf(const pugi::xml_node& collision, const RobotPose& link) {
    const RobotPose pose = link * urdf_origin(collision);
    const pugi::xml_node geometry = collision.child("geometry");
    if (const pugi::xml_node sphere = geometry.child("sphere")) {
      add_round(sphere, pose, sphere.attribute("radius").as_double(), nullptr, false);
    } else if (const pugi::xml_node box = geometry.child("box")) {
      add_box(box, pose, vector(box, "size", box.attribute("size").as_string()), false);
    } else if (const pugi::xml_node cylinder = geometry.child("cylinder")) {
      const double half = length(cylinder, "length", cylinder.attribute("length").as_double()) / 2;
      const double radius = length(cylinder, "radius", cylinder.attribute("radius").as_double());
      add_round(cylinder, pose, std::sqrt(half * half + radius * radius),
                "cylinders as the spheres around them", false);
    } else if (geometry.child("mesh")) {
      count("meshes not taken");
    } else {
      count("shapes of unknown kind not taken");
    }
  }

  // ---- MJCF ----

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

  const std::string& text_;
  const std::string& file_;
  pugi::xml_document document_;
  RobotShapes shapes_;
  std::map<std::string, std::size_t> counts_;
  std::map<std::string, RobotPose> poses_;
  std::map<std::string, Attributes> defaults_;
  bool degrees_ = true;
  std::string sequence_ = "xyz";
};

}  // namespace

RobotShapes parse_robot(const std::string& text, const std::string& file, FileFormat format) {
  return with_allocation_context("reading a robot", [&] {
    RobotReader reader(text, file);
    return format == FileFormat::urdf ? reader.read_urdf() : reader.read_mjcf();
  });
}

RobotShapes read_robot(const std::string& name, FileFormat format) {
  const InputFile file(name, "a robot (URDF or MJCF)");
  if (file.bytes() > most_xml_bytes)
    throw InputError(fmt::format("{}: larger than {} MiB, the maximum size", name, most_xml_bytes >> 20));
  return parse_robot(std::string(FileText(file).text()), name, format);
}

}  // namespace collidoscope
