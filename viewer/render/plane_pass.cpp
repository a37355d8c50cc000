#include "viewer/render/plane_pass.h"

#include <algorithm>
#include <vector>

#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

enum class Kind { obstacle, floor, reference };  // matches plane.vert

/// Matches `Plane` in plane.vert.
struct PlaneRecord {
  float normal_offset[4], center_radius[4], side_kind[4];
};

/// Matches `Obstacle` in obstacle.vert.
struct ObstacleRecord {
  float center[4], half_size[4], side[3][4];
};

void store_vector(float (&to)[4], const Vector3d& from, double last) {
  for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(from[k]);
  to[3] = static_cast<float>(last);
}

PlaneRecord plane_record(const Plane& plane, const FrameScene& scene, double radius, Kind kind) {
  const Vector3d center = scene.bounds.center();
  // Grid lines run horizontally and along the slope; on a horizontal plane, along x and y.
  const Vector3d level = Vector3d::UnitZ().cross(plane.normal);
  const bool sloped = level.norm() > 1e-6;
  PlaneRecord record{};
  store_vector(record.normal_offset, plane.normal, plane.offset);
  store_vector(record.center_radius, center + (plane.offset - plane.normal.dot(center)) * plane.normal,
               radius);
  store_vector(record.side_kind, sloped ? level.normalized() : Vector3d(1, 0, 0), static_cast<double>(kind));
  return record;
}

}  // namespace

PlanePass::PlanePass()
    : surface_("plane.vert", "plane.frag"),
      veil_("plane.vert", "plane.frag", "#define VEIL\n"),
      obstacle_("obstacle.vert", "obstacle.frag"),
      nothing_{} {}

void PlanePass::set_scene(const FrameScene& scene) {
  const Vector3d size = scene.bounds.max - scene.bounds.min;
  const double floor_radius = 1.5 * std::max(size.x(), size.y());
  const Plane floor{.normal = {0, 0, 1}, .offset = scene.floor};
  std::vector<PlaneRecord> records;
  if (scene.box) records.push_back(plane_record(floor, scene, floor_radius, Kind::floor));
  for (const Plane& plane : scene.planes)
    records.push_back(plane_record(plane, scene, 1.5 * size.maxCoeff(), Kind::obstacle));
  if (records.empty()) records.push_back(plane_record(floor, scene, floor_radius, Kind::reference));
  planes_.upload(records.data(), records.size() * sizeof(PlaneRecord));
  count_ = static_cast<int>(records.size());

  std::vector<ObstacleRecord> boxes;
  for (const BoxObstacle& box : scene.boxes) {
    ObstacleRecord& record = boxes.emplace_back();
    store_vector(record.center, box.center, 0);
    store_vector(record.half_size, box.size / 2, 0);
    for (int k = 0; k < 3; ++k)
      store_vector(record.side[k], box.orientation * Vector3d(Vector3d::Unit(k)), 0);
  }
  boxes_.upload(boxes.data(), boxes.size() * sizeof(ObstacleRecord));
  box_count_ = static_cast<int>(boxes.size());

  const double far = 1e30;
  const Vector3d min = scene.box ? scene.box->min : Vector3d::Constant(-far);
  const Vector3d max = scene.box ? scene.box->max : Vector3d::Constant(far);
  const auto at = [](const Vector3d& v, int k) { return static_cast<float>(v[k]); };
  for (const gl::Program* program : {&surface_, &veil_}) {
    program->set("plane_count", count_);
    program->set("box_min", at(min, 0), at(min, 1), at(min, 2), 0);
    program->set("box_max", at(max, 0), at(max, 1), at(max, 2), 0);
  }
}

void PlanePass::draw(const gl::Program& program) const {
  if (count_ == 0) return;
  program.use();
  nothing_.bind(0, 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, planes_.get());
  glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, count_);
  gl::check("draw " + std::to_string(count_) + " planes");
}

void PlanePass::draw_surfaces() const {
  draw(surface_);
  if (box_count_ == 0) return;
  obstacle_.use();
  nothing_.bind(0, 0);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, boxes_.get());
  glDrawArraysInstanced(GL_TRIANGLES, 0, 36, box_count_);
  gl::check("draw " + std::to_string(box_count_) + " boxes");
}

void PlanePass::draw_veils() const {
  glEnable(GL_BLEND);
  glBlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glDepthMask(GL_FALSE);
  draw(veil_);
}

}  // namespace collidoscope
