#include "sim_cuda/measure/inspect.h"

#include <algorithm>
#include <type_traits>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"

namespace collidoscope {

namespace {

struct FindBody {
  const std::uint32_t* ids;
  std::uint32_t body;
  std::uint32_t* place;
  SIM_HD void operator()(int k) const {
    if (ids[k] == body) *place = static_cast<std::uint32_t>(k);
  }
};

/// Contacts of one body in any order. `count` may exceed the capacity; excess contacts are only counted.
struct Found {
  std::uint32_t other;
  double impulse;  ///< N s
};
template <class Real>
struct FindContacts {
  const Pair* contacts;
  ImpulseView<Real> impulses;
  std::uint32_t body;
  std::uint32_t* count;
  Found* found;
  std::uint32_t capacity;
  SIM_HD void operator()(int contact) const {
    const auto [a, b] = contacts[contact];
    if (a != body && b != body) return;
    const std::uint32_t place = atomic_add(count, 1);
    if (place < capacity) found[place] = {a == body ? b : a, static_cast<double>(impulses.of(a, b))};
  }
};

}  // namespace

template <class Real>
BodyReport inspect(Executor& executor, const InspectSource<Real>& source, std::uint32_t id) {
  const auto read = [&](const auto* array, std::size_t index) {
    std::remove_cv_t<std::remove_reference_t<decltype(*array)>> value;
    executor.copy_to_host(&value, array + index, sizeof value);
    return value;
  };
  const BodyView<Real>& bodies = source.bodies;
  BodyReport report;
  report.id = id;
  report.mass = static_cast<double>(read(bodies.mass, id));
  report.radius = static_cast<double>(read(bodies.radius, id));
  report.X = read(bodies.position, id).template cast<double>();
  report.v = Vector3<Real>(read(bodies.velocity, id)).template cast<double>();
  report.P = report.mass * report.v;
  report.F = report.mass * source.gravity;
  Vector3d inertia = Vector3d::Constant(0.4 * report.mass * report.radius * report.radius);
  if (bodies.orientation != nullptr) {
    report.q = read(bodies.orientation, id).template cast<double>();
    report.w = Vector3<Real>(read(bodies.angular_velocity, id)).template cast<double>();
    inertia = read(bodies.inertia, id).template cast<double>();
  }
  const Matrix3d r = report.q.toRotationMatrix();
  if (report.mass > 0) {  // static and kinematic bodies have no momentum
    report.inverse_inertia = r * inertia.cwiseInverse().asDiagonal() * r.transpose();
    report.L = r * inertia.asDiagonal() * r.transpose() * report.w;
  }

  constexpr std::uint32_t capacity = 1024;
  Buffer<Found> found(executor, "contacts of a body");
  Buffer<std::uint32_t> counts(executor,
                               "contact counts of a body");  // {contacts, index in leaf order, node}
  found.resize_discarding(capacity);
  counts.resize_discarding(3);
  counts.fill_zero();
  executor.run(
      "inspect", source.contact_count,
      FindContacts<Real>{source.contacts.bodies, source.impulses, id, counts.data(), found.data(), capacity});
  const TreeView& tree = source.tree;
  if (tree.nodes > 0) {
    executor.run("inspect", source.body_count, FindBody{tree.leaf_body, id, counts.data() + 1});
    executor.run("inspect", tree.nodes, FindBody{tree.body, id, counts.data() + 2});
  }
  const std::vector<std::uint32_t> count = counts.download();
  report.contact_count = count[0];
  std::vector<Found> touching = found.download(min_of(count[0], capacity));
  std::ranges::sort(touching, {}, &Found::other);
  for (const auto& [other, impulse] : touching) {
    const Separation<double> s =
        separate<double>(report.X, report.radius, read(bodies.position, other).template cast<double>(),
                         static_cast<double>(read(bodies.radius, other)));
    report.contacts.push_back({other, s.normal, -s.gap, impulse});
  }
  if (tree.nodes > 0) {
    report.leaf = count[1];
    for (std::uint32_t node = count[2], child = ~node; node != child;) {
      const Aabb box = read(tree.box, node);
      report.path.push_back(
          {{box.min.x(), box.min.y(), box.min.z()}, {box.max.x(), box.max.y(), box.max.z()}});
      child = node;
      node = read(tree.parent, node);
    }
  }
  return report;
}

template BodyReport inspect(Executor&, const InspectSource<float>&, std::uint32_t);
template BodyReport inspect(Executor&, const InspectSource<double>&, std::uint32_t);

}  // namespace collidoscope
