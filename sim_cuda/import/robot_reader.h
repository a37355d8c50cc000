#pragma once
// What the readers of URDF and MJCF share: XML, places of faults, numbers, shapes. Lives for one reading.

#include <array>
#include <map>
#include <pugixml.hpp>
#include <string>
#include <string_view>

#include "sim_cuda/import/robot_file.h"

namespace collidoscope {

struct RobotPose {
  Vector3d position{0, 0, 0};
  Quaterniond orientation{1, 0, 0, 0};
};

inline RobotPose operator*(const RobotPose& outer, const RobotPose& inner) {
  return {outer.position + outer.orientation * inner.position, outer.orientation * inner.orientation};
}

class RobotReader {
 protected:
  /// Keeps references. Throws InputError for text that is not XML.
  RobotReader(const std::string& text, const std::string& file);

  [[noreturn]] void fail(std::size_t at, const std::string& problem, const std::string& expected) const;
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& problem,
                         const std::string& expected) const;
  /// Counts what is replaced or left out, for the notes.
  void count(const std::string& what, std::size_t number = 1) {
    if (number > 0) counts_[what] += number;
  }
  RobotShapes finish();

  /// Reads numbers between spaces, at least `least` and at most `most`; missing ones are 0.
  std::array<double, 6> numbers(const pugi::xml_node& node, std::string_view key, std::string_view text,
                                std::size_t least, std::size_t most) const;
  /// Three numbers; 0 if there is no text.
  Vector3d vector(const pugi::xml_node& node, const char* key, const std::string& text) const;
  /// Returns `value` if it is a valid length.
  double length(const pugi::xml_node& node, const char* key, double value) const;

  void add(const pugi::xml_node& node, RobotShape shape);
  /// A box stays a box in the world; else it becomes the sphere around it.
  void add_box(const pugi::xml_node& node, const RobotPose& pose, const Vector3d& size, bool fixed);
  /// A sphere. `replaced`: null, or a count of shapes that become spheres.
  void add_round(const pugi::xml_node& node, const RobotPose& pose, double radius, const char* replaced,
                 bool fixed);

  pugi::xml_document document_;
  RobotShapes shapes_;

 private:
  void check_depth(const pugi::xml_node& root) const;

  const std::string& text_;
  const std::string& file_;
  std::map<std::string, std::size_t> counts_;
};

RobotShapes parse_urdf(const std::string& text, const std::string& file);
RobotShapes parse_mjcf(const std::string& text, const std::string& file);

}  // namespace collidoscope
