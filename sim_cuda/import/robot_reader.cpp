#include "sim_cuda/import/robot_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sim_cuda/core/error.h"
#include "sim_cuda/core/out_of_memory.h"
#include "sim_cuda/import/input_file.h"
#include "sim_cuda/import/text_rows.h"
#include "sim_cuda/scene/limits.h"

namespace collidoscope {
namespace {

constexpr std::size_t most_xml_bytes = std::size_t{64} << 20;
constexpr int deepest_nesting = 1000;

}  // namespace

RobotReader::RobotReader(const std::string& text, const std::string& file) : text_(text), file_(file) {
  const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
  if (!result)
    fail(static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0)), result.description(),
         "well-formed XML");
  check_depth(document_.root());
}

void RobotReader::fail(std::size_t at, const std::string& problem, const std::string& expected) const {
  at = std::min(at, text_.size());
  const std::size_t line = static_cast<std::size_t>(std::count(
                               text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n')) +
                           1;
  const std::size_t newline = at == 0 ? std::string::npos : text_.rfind('\n', at - 1);
  const std::size_t column = newline == std::string::npos ? at + 1 : at - newline;
  throw InputError(fmt::format("{}:{}:{}: {}, expected {}", file_, line, column, problem, expected));
}

void RobotReader::fail(const pugi::xml_node& node, const std::string& problem,
                       const std::string& expected) const {
  fail(static_cast<std::size_t>(std::max<std::ptrdiff_t>(node.offset_debug(), 0)), problem, expected);
}

/// Nesting is bounded, since elements are visited recursively.
void RobotReader::check_depth(const pugi::xml_node& root) const {
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

RobotShapes RobotReader::finish() {
  for (const auto& [what, number] : counts_) shapes_.notes.push_back(fmt::format("{} {}", number, what));
  if (shapes_.shapes.empty())
    throw InputError(file_ + ": no spheres, boxes, cylinders or capsules, expected one");
  return std::move(shapes_);
}

std::array<double, 6> RobotReader::numbers(const pugi::xml_node& node, std::string_view key,
                                           std::string_view text, std::size_t least, std::size_t most) const {
  std::array<double, 6> values{};
  const std::vector<std::string_view> fields = fields_of(text, ' ');
  bool good = fields.size() >= least && fields.size() <= most;
  for (std::size_t k = 0; good && k < fields.size(); ++k)
    good = is_number(fields[k], values[k]) && std::abs(values[k]) <= limits::max_coordinate;
  if (!good)
    fail(node, fmt::format("damaged {}", key),
         least == most ? fmt::format("{} numbers", least) : fmt::format("{} to {} numbers", least, most));
  return values;
}

Vector3d RobotReader::vector(const pugi::xml_node& node, const char* key, const std::string& text) const {
  if (text.empty()) return {0, 0, 0};
  const std::array<double, 6> v = numbers(node, key, text, 3, 3);
  return {v[0], v[1], v[2]};
}

double RobotReader::length(const pugi::xml_node& node, const char* key, double value) const {
  if (!(value >= limits::min_radius && value <= limits::max_radius))
    fail(node, fmt::format("{} = {:g}", key, value),
         fmt::format("{:g} to {:g} m", limits::min_radius, limits::max_radius));
  return value;
}

void RobotReader::add(const pugi::xml_node& node, RobotShape shape) {
  if (shape.position.cwiseAbs().maxCoeff() > limits::max_coordinate)
    fail(node, "a shape too far away", fmt::format("coordinates up to {:g} m", limits::max_coordinate));
  constexpr std::size_t most = std::size_t{1} << 20;
  if (shapes_.shapes.size() == most) fail(node, "too many shapes", fmt::format("at most {}", most));
  shapes_.shapes.push_back(shape);
}

void RobotReader::add_box(const pugi::xml_node& node, const RobotPose& pose, const Vector3d& size,
                          bool fixed) {
  for (int k = 0; k < 3; ++k) length(node, "size", size[k]);
  RobotShape shape{.fixed = fixed, .position = pose.position, .orientation = pose.orientation};
  shape.size = size;
  shape.radius = length(node, "radius of the sphere around it", size.norm() / 2);
  shape.kind = fixed ? RobotShape::Kind::box : RobotShape::Kind::sphere;
  if (!fixed) count("boxes as the spheres around them");
  add(node, shape);
}

void RobotReader::add_round(const pugi::xml_node& node, const RobotPose& pose, double radius,
                            const char* replaced, bool fixed) {
  if (replaced != nullptr) count(replaced);
  add(node, {.fixed = fixed,
             .position = pose.position,
             .orientation = pose.orientation,
             .radius = length(node, "radius", radius)});
}

RobotShapes parse_robot(const std::string& text, const std::string& file, FileFormat format) {
  return with_allocation_context("reading a robot", [&] {
    return format == FileFormat::urdf ? parse_urdf(text, file) : parse_mjcf(text, file);
  });
}

RobotShapes read_robot(const std::string& name, FileFormat format) {
  const InputFile file(name, "a robot (URDF or MJCF)");
  if (file.bytes() > most_xml_bytes)
    throw InputError(fmt::format("{}: larger than {} MiB, the maximum size", name, most_xml_bytes >> 20));
  return parse_robot(std::string(FileText(file).text()), name, format);
}

}  // namespace collidoscope
