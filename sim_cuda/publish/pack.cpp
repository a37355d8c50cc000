#include "sim_cuda/publish/pack.h"

#include <cmath>

#include "sim_cuda/core/atomics.h"
#include "sim_cuda/narrow_phase/sphere_sphere.h"
#include "sim_cuda/solver/joint_ends.h"

namespace collidoscope {

namespace {

template <class Real>
struct PackBodies {
  BodyView<Real> bodies;
  const std::uint32_t* mesh;
  BodyColor color;
  BodyInstance* out;
  SIM_HD void operator()(int body) const {
    BodyInstance record{};
    const Vector3<Real> x = bodies.position[body], v = bodies.velocity[body];
    for (int k = 0; k < 3; ++k) record.center[k] = static_cast<float>(x[k]);
    record.radius = static_cast<float>(bodies.radius[body]);
    record.orientation[3] = 1;
    if (bodies.orientation != nullptr)
      for (int k = 0; k < 4; ++k)
        record.orientation[k] = static_cast<float>(bodies.orientation[body].coeffs()[k]);
    using std::sqrt;
    record.value = color == BodyColor::speed    ? static_cast<float>(sqrt(v.dot(v)))
                   : color == BodyColor::radius ? record.radius
                   : color == BodyColor::id     ? static_cast<float>(body)
                                                : 0.0f;
    record.id = static_cast<std::uint32_t>(body);
    record.mesh = mesh == nullptr ? 0 : mesh[body];
    out[body] = record;
  }
};

struct CountOfContacts {
  const Pair* contacts;
  std::uint32_t* count;
  SIM_HD void operator()(int contact) const {
    atomic_add(&count[contacts[contact].a], 1);
    atomic_add(&count[contacts[contact].b], 1);
  }
};

struct ColorByContacts {
  const std::uint32_t* count;
  BodyInstance* out;
  SIM_HD void operator()(int body) const { out[body].value = static_cast<float>(count[body]); }
};

struct ColorByOrder {
  const std::uint32_t* leaf_body;
  BodyInstance* out;
  SIM_HD void operator()(int leaf) const { out[leaf_body[leaf]].value = static_cast<float>(leaf); }
};

/// Processes the nodes of one level.
struct ColorByDepth {
  const std::uint32_t* body;
  float depth;  ///< level of the nodes, 0: root
  BodyInstance* out;
  SIM_HD void operator()(int node) const {
    if (body[node] != TreeView::inner) out[body[node]].value = depth;
  }
};

struct ColorByVisits {
  const std::uint32_t* visits;
  BodyInstance* out;
  SIM_HD void operator()(int body) const { out[body].value = static_cast<float>(visits[body]); }
};

struct ColorBySleep {
  SleepView sleep;
  BodyInstance* out;
  SIM_HD void operator()(int body) const { out[body].value = sleep.distance(body); }
};

struct ColorByError {
  const float* errors;
  BodyInstance* out;
  SIM_HD void operator()(int body) const { out[body].value = errors[body]; }
};

struct PackBoxes {
  const Aabb* boxes;
  const std::uint32_t* children;
  const float* values;  ///< by node; null: use the level
  bool leaves;          ///< leaves have values
  float depth;          ///< level of the nodes, 0: root
  BoxInstance* out;
  SIM_HD void operator()(int node) const {
    BoxInstance record{};
    for (int k = 0; k < 3; ++k) {
      record.min[k] = boxes[node].min[k];
      record.max[k] = boxes[node].max[k];
    }
    record.level = record.value = depth;
    if (values != nullptr) record.value = leaves || children[node] > 0 ? values[node] : -1.0f;
    out[node] = record;
  }
};

template <class Real>
struct PackContacts {
  ContactView<Real> contacts;
  SphereView<Real> spheres;
  ImpulseView<Real> impulses;
  ContactInstance* out;
  SIM_HD void operator()(int contact) const {
    const auto [a, b] = contacts.bodies[contact];
    const Vector3<Real> x_a = spheres.position[a], x_b = spheres.position[b];
    const Real r_a = spheres.radius[a], r_b = spheres.radius[b];
    const Separation<Real> now = separate<Real>(x_a, r_a, x_b, r_b);
    // Midway between the two surfaces along the line of centres.
    const Vector3<Real> point = x_a + (r_a + now.gap / 2) * now.normal;
    ContactInstance record{};
    for (int k = 0; k < 3; ++k) {
      record.point[k] = static_cast<float>(point[k]);
      record.normal[k] = static_cast<float>(now.normal[k]);
    }
    record.penetration = static_cast<float>(-now.gap);
    record.impulse = static_cast<float>(impulses.of(a, b));
    record.a = a;
    record.b = b;
    record.radius = static_cast<float>(min_of(r_a, r_b));
    out[contact] = record;
  }
};

template <class Real, bool with_rotation>
struct PackJoints {
  JointView<Real> joints;
  BodyView<Real> bodies;
  Vector3<Real> gravity;
  JointInstance* out;
  SIM_HD void operator()(int place) const {
    const JointRow<Real>& joint = joints.rows[place];
    const bool world = joint.b == JointRow<Real>::world;
    const JointEnds<Real, with_rotation> ends(bodies, joint);
    const Vector3<Real> anchor = ends.a.center + ends.a.arm;
    const Real r_a = bodies.radius[joint.a], size = world ? r_a : min_of(r_a, bodies.radius[joint.b]);
    JointInstance record{};
    const auto put = [](float* to, const Vector3<Real>& from) {
      for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(from[k]);
    };
    JointLook look = JointLook::line;
    if (joint.kind == JointKind::ball || joint.kind == JointKind::hinge) {
      look = JointLook::corner;
      put(record.from, ends.a.center);
      put(record.to, world ? anchor : ends.b.center);
      put(record.at, anchor);
      if (with_rotation && joint.kind == JointKind::hinge)
        put(record.aside, size * (ends.a.axes * joint.axis_a));
    } else {
      put(record.from, anchor);
      put(record.to, anchor + ends.separation);
      using std::sqrt;
      const Real length = sqrt(ends.separation.dot(ends.separation)), pull = sqrt(gravity.dot(gravity));
      if (joint.kind == JointKind::spring) {
        look = JointLook::spring;
      } else if (joint.low < joint.high && length < joint.high && finite(joint.high) && pull > 0) {
        // Sag of a parabola of the rope's length. Exact for nearly taut ropes and for folded ropes.
        look = JointLook::rope;
        put(record.aside, sqrt((joint.high - length) * (joint.high / 4 + length / 8)) / pull * gravity);
      }
    }
    record.look = static_cast<float>(look);
    record.size = static_cast<float>(size);
    out[place] = record;
  }
};

void pack_boxes(Executor& executor, const PublishTarget& target, const TreeView& tree, const float* values) {
  BoxInstance* out = target.boxes;
  const bool leaves = has_leaf_values(target.box_metric);
  for (int level = target.first_level; level <= target.last_level && level < tree.levels(); ++level) {
    const std::uint32_t begin = tree.level_begin(level);
    executor.run(
        "publish", tree.level_size(level),
        PackBoxes{tree.box + begin, tree.children + begin, values == nullptr ? nullptr : values + begin,
                  leaves, static_cast<float>(level), out});
    out += tree.level_size(level);
  }
}

}  // namespace

template <class Real>
void pack(Executor& executor, const PublishTarget& target, const PackSource<Real>& source,
          Buffer<std::uint32_t>& counts) {
  const auto& [bodies, body_count, mesh, contacts, contact_count, impulses, tree, values, joints, gravity,
               sleep, errors] = source;
  if (target.boxes != nullptr) pack_boxes(executor, target, tree, values.of_node);
  if (target.contacts != nullptr)
    executor.run("publish", contact_count,
                 PackContacts<Real>{contacts, {bodies.position, bodies.radius}, impulses, target.contacts});
  if (target.joints != nullptr && bodies.orientation != nullptr)
    executor.run("publish", joints.count, PackJoints<Real, true>{joints, bodies, gravity, target.joints});
  else if (target.joints != nullptr)
    executor.run("publish", joints.count, PackJoints<Real, false>{joints, bodies, gravity, target.joints});
  if (target.bodies == nullptr) return;
  executor.run("publish", body_count, PackBodies<Real>{bodies, mesh, target.body_color, target.bodies});
  if (target.body_color == BodyColor::contacts) {
    counts.resize_discarding(static_cast<std::size_t>(body_count));
    counts.fill_zero();
    executor.run("publish", contact_count, CountOfContacts{contacts.bodies, counts.data()});
    executor.run("publish", body_count, ColorByContacts{counts.data(), target.bodies});
  }
  if (target.body_color == BodyColor::order && tree.nodes > 0)
    executor.run("publish", body_count, ColorByOrder{tree.leaf_body, target.bodies});
  if (target.body_color == BodyColor::depth)
    for (int level = 0; level < tree.levels(); ++level)
      executor.run(
          "publish", tree.level_size(level),
          ColorByDepth{tree.body + tree.level_begin(level), static_cast<float>(level), target.bodies});
  if (target.body_color == BodyColor::sleep)
    executor.run("publish", body_count, ColorBySleep{sleep, target.bodies});
  if (target.body_color == BodyColor::error && errors != nullptr)
    executor.run("publish", body_count, ColorByError{errors, target.bodies});
  if (target.body_color == BodyColor::visits && values.of_body != nullptr)
    executor.run("publish", body_count, ColorByVisits{values.of_body, target.bodies});
}

template void pack(Executor&, const PublishTarget&, const PackSource<float>&, Buffer<std::uint32_t>&);
template void pack(Executor&, const PublishTarget&, const PackSource<double>&, Buffer<std::uint32_t>&);

}  // namespace collidoscope
