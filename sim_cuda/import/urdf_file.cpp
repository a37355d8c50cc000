#include <algorithm>
#include <cmath>
#include <vector>

#include "sim_cuda/import/robot_reader.h"

namespace collidoscope {
namespace {

/// Rotation about the fixed axes x, then y, then z.
Quaterniond from_roll_pitch_yaw(const Vector3d& angles) {
  using Eigen::AngleAxisd;
  return Quaterniond(AngleAxisd(angles.z(), unit_vector(2)) * AngleAxisd(angles.y(), unit_vector(1)) *
                     AngleAxisd(angles.x(), unit_vector(0)));
}

class UrdfReader : RobotReader {
 public:
  UrdfReader(const std::string& text, const std::string& file) : RobotReader(text, file) {}

  RobotShapes read() {
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

 private:
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

  std::map<std::string, RobotPose> poses_;  ///< of links, in the world
};

}  // namespace

RobotShapes parse_urdf(const std::string& text, const std::string& file) {
  return UrdfReader(text, file).read();
}

}  // namespace collidoscope
