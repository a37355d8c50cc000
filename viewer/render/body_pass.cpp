#include "viewer/render/body_pass.h"

#include <algorithm>
#include <cstddef>

#include "viewer/render/gl/errors.h"

namespace collidoscope {
namespace {

constexpr const char* definitions[] = {"#define SURFACE\n", "#define IDS\n", "#define SHADOW\n"};

struct MeshVertex {
  float position[3], normal[3];
};

using Input = gl::VertexLayout::Input;
constexpr Input center_radius_input{0, 4, offsetof(BodyInstance, center)};
constexpr Input orientation_input{1, 4, offsetof(BodyInstance, orientation)};
constexpr Input value_input{2, 1, offsetof(BodyInstance, value)};
constexpr Input id_input{3, 1, offsetof(BodyInstance, id), true};

}  // namespace

BodyPass::BodyPass()
    : sphere_layout_{center_radius_input, value_input, id_input},
      mesh_layout_{center_radius_input,
                   orientation_input,
                   value_input,
                   id_input,
                   {4, 3, offsetof(MeshVertex, position), false, true},
                   {5, 3, offsetof(MeshVertex, normal), false, true}},
      vertices_("mesh vertices") {
  for (const char* definition : definitions) {
    spheres_.emplace_back("sphere.vert", "sphere.frag", definition);
    meshes_.emplace_back("mesh.vert", "mesh.frag", definition);
  }
}

void BodyPass::set_scene(const FrameScene& scene) {
  runs_ = scene.runs;
  any_spheres_ = std::ranges::any_of(runs_, [](const FrameScene::Run& run) { return run.mesh == 0; });
  ranges_.clear();
  std::vector<MeshVertex> vertices;
  for (const Mesh& mesh : scene.meshes) {
    ranges_.push_back({static_cast<GLint>(vertices.size()), static_cast<GLsizei>(3 * mesh.faces.size())});
    for (const auto& face : mesh.faces) {
      const Vector3d a = mesh.vertices[face[0]], b = mesh.vertices[face[1]], c = mesh.vertices[face[2]];
      const Vector3f normal = (b - a).cross(c - a).normalized().cast<float>();
      for (const Vector3d& corner : {a, b, c}) {
        const Vector3f at = corner.cast<float>();
        vertices.push_back({{at.x(), at.y(), at.z()}, {normal.x(), normal.y(), normal.z()}});
      }
    }
  }
  vertices_.upload(vertices.data(), vertices.size() * sizeof(MeshVertex));
}

void BodyPass::draw(const InstanceBuffers& instances, Output output, GLuint colors, const gl::Target& target,
                    bool compute) {
  if (compute && !sphere_compute_) sphere_compute_.emplace();
  compute = compute && output != Output::ids && any_spheres_ && instances.counts.bodies > 0 &&
            sphere_compute_->fits(instances.counts.bodies);
  if (compute) sphere_compute_->draw(instances, output == Output::shadow, colors, target);
  glBindTextureUnit(0, colors);
  for (const FrameScene::Run& run : runs_)
    if (run.mesh != 0 || !compute) draw_run(instances, static_cast<std::size_t>(output), run);
  gl::check("draw " + std::to_string(instances.counts.bodies) + " bodies");
}

void BodyPass::draw_part(const InstanceBuffers& instances, Output output, GLuint colors, std::int64_t first,
                         std::int64_t count) {
  glBindTextureUnit(0, colors);
  for (FrameScene::Run run : runs_) {
    const std::int64_t end = std::min(run.first + run.count, first + count);
    run.first = std::max(run.first, first);
    run.count = end - run.first;
    draw_run(instances, static_cast<std::size_t>(output), run);
  }
  gl::check("draw " + std::to_string(count) + " bodies");
}

void BodyPass::draw_run(const InstanceBuffers& instances, std::size_t output,
                        const FrameScene::Run& run) const {
  const auto count = static_cast<GLsizei>(std::min(run.count, instances.counts.bodies - run.first));
  if (count <= 0) return;
  const auto first = static_cast<GLuint>(run.first);
  if (run.mesh == 0) {
    spheres_[output].use();
    sphere_layout_.bind(instances.bodies.get(), sizeof(BodyInstance));
    glDrawArraysInstancedBaseInstance(GL_TRIANGLE_STRIP, 0, 4, count, first);
    return;
  }
  const Range& range = ranges_.at(run.mesh - 1);
  meshes_[output].use();
  mesh_layout_.bind(instances.bodies.get(), sizeof(BodyInstance), vertices_.get(), sizeof(MeshVertex));
  glDrawArraysInstancedBaseInstance(GL_TRIANGLES, range.first, range.count, count, first);
}

}  // namespace collidoscope
