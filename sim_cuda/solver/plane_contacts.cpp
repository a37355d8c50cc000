#include "sim_cuda/solver/plane_contacts.h"

#include <algorithm>
#include <vector>

#include "sim_cuda/solver/wide_vectors.h"

namespace collidoscope {

template <class Real>
PlaneContacts<Real>::PlaneContacts(Executor& executor, const SolverScene<Real>& scene)
    : scene_(scene),
      impulse_(executor, "wall impulses"),
      bounced_mask_(executor, "wall impact masks"),
      active_mask_(executor, "wall contact masks"),
      stopped_(executor, "bodies stopped by walls"),
      friction_(executor, "wall friction"),
      box_planes_(executor, "box faces") {
  const auto bodies = static_cast<std::size_t>(scene.body_count),
             entries = static_cast<std::size_t>(scene.surfaces()) * bodies,
             boxes = static_cast<std::size_t>(scene.boxes.count) * bodies;
  impulse_.upload(std::vector<Real>(entries, 0));
  bounced_mask_.upload(std::vector<std::uint32_t>(scene.surfaces() > 0 ? bodies : 0, 0));
  stopped_.upload(std::vector<std::uint8_t>(bounced_mask_.size(), 0));
  activate_all();
  box_planes_.resize_discarding(boxes);
  if (!scene.effects.friction) return;
  friction_.upload(std::vector<Vector3<Real>>(entries, Vector3<Real>::Zero()));
}

/// Marks all surfaces of all bodies as active. Used before the first step and after load().
template <class Real>
void PlaneContacts<Real>::activate_all() {
  const auto bodies = static_cast<std::size_t>(scene_.surfaces() > 0 ? scene_.body_count : 0);
  active_mask_.upload(std::vector<std::uint32_t>(bodies, ~std::uint32_t{0}));
}

template <class Real>
void PlaneContacts<Real>::save(WarmStartParts& parts) const {
  parts.add([bodies = scene_.body_count, walls = impulse_.download()](WarmStart& warm_start) {
    for (auto plane = walls.begin(); plane != walls.end(); plane += bodies)
      warm_start.walls.emplace_back(plane, plane + bodies);
  });
  if (scene_.effects.friction)
    parts.add([friction = friction_.download()](WarmStart& warm_start) {
      warm_start.wall_friction = widened_vectors<Real>(friction, friction.size());
    });
}

template <class Real>
void PlaneContacts<Real>::load(const WarmStart& warm_start) {
  if (warm_start.walls.size() != static_cast<std::size_t>(scene_.surfaces())) return;
  std::vector<Real> walls(impulse_.size(), 0);
  std::vector<Vector3<Real>> wall_friction(friction_.size(), Vector3<Real>::Zero());
  const auto n = static_cast<std::size_t>(scene_.body_count);
  for (std::size_t p = 0; p < warm_start.walls.size(); ++p) {
    const std::size_t saved_bodies = warm_start.walls[p].size();
    for (std::size_t body = 0; body < std::min(n, saved_bodies); ++body) {
      walls[p * n + body] = static_cast<Real>(warm_start.walls[p][body]);
      if (!wall_friction.empty() && !warm_start.wall_friction.empty())
        wall_friction[p * n + body] =
            narrowed_vector<Real>(warm_start.wall_friction[p * saved_bodies + body]);
    }
  }
  impulse_.upload(walls);
  friction_.upload(wall_friction);
  activate_all();
}

template <class Real>
void PlaneContacts<Real>::visit(const ArrayVisitor& visit) const {
  visit(impulse_.data(), impulse_.bytes());
  visit(friction_.data(), friction_.bytes());
  visit(active_mask_.data(), active_mask_.bytes());
}

template <class Real>
void PlaneContacts<Real>::list(HashedArrays& arrays) const {
  if (impulse_.size() > 0) arrays.add<Real>(impulse_.data(), static_cast<std::int64_t>(impulse_.size()));
  if (friction_.size() > 0) arrays.add<Real>(friction_.data(), static_cast<std::int64_t>(friction_.size()));
}

template class PlaneContacts<float>;
template class PlaneContacts<double>;

}  // namespace collidoscope
