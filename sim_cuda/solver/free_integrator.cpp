#include "sim_cuda/solver/free_integrator.h"

#include "sim_cuda/dynamics/awake.h"
#include "sim_cuda/dynamics/integrators.h"
#include "sim_cuda/dynamics/move.h"
#include "sim_cuda/dynamics/rotation_updates.h"
#include "sim_cuda/dynamics/wide_spin.h"
#include "sim_cuda/solver/clear_space.h"

namespace collidoscope {

namespace {

template <class Real>
struct SaveVelocities {
  const PackedVector3<Real>* velocity;
  PackedVector3<Real>* before;
  SIM_HD void operator()(int body) const { before[body] = velocity[body].load(); }
};

/// Smooth forces on free bodies.
template <class Real>
struct SmoothField {
  AttractorView<Real> attractors;
  const Vector3<Real>* start_field;  ///< acceleration by attractors at the start of the substep, m/s^2, by
                                     ///< body; null without attractors
  DragLaw<Real> drag;
  bool with_drag;
  Vector3<Real> gravity;  ///< m/s^2

  SIM_HD SmoothForces<Real> on(const BodyView<Real>& bodies, int body) const {
    return {attractors, drag, with_drag, gravity, bodies.radius[body], bodies.inverse_mass[body]};
  }
  SIM_HD Vector3<Real> acceleration(int body) const {
    return start_field != nullptr ? Vector3<Real>(gravity + start_field[body]) : gravity;
  }
  /// Velocity after drag, gravity and attractors. Repeats the arithmetic of the stages "drag" and "forces"
  /// (or "drag" and "move").
  SIM_HD Vector3<Real> predicted_velocity(const BodyView<Real>& bodies, int body, Vector3<Real> v,
                                          Real h) const {
    if (with_drag) v = DragBodies<Real>{bodies, drag, gravity, start_field, h, nullptr}.after_drag(body, v);
    return v + h * acceleration(body);
  }
};

/// Computes the drift velocity and the final velocity of each body.
template <class Real, Integrator integrator>
struct IntegrateFree {
  SmoothField<Real> field;
  BodyView<Real> bodies;
  const PackedVector3<Real>* before;
  PackedVector3<Real>* drift_velocity;
  PackedVector3<Real>* moved;         ///< the final velocity, too; or null
  std::uint8_t* is_free;              ///< 1 for each free body; or null
  const std::uint32_t* bounced_mask;  ///< see SoftWalls; or null
  const WallPlane<Real>* planes;
  int plane_count;
  BoxView<Real> boxes;
  StaticImpulse* static_impulses;  ///< or null
  Real h;                          ///< s
  bool forces_applied;
  const TreeMember* members;  ///< by body; null without joint trees
  ClearSpace<Real> clear;
  const StepControl* control;

  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    Vector3<Real> v = bodies.velocity[body];
    const Vector3<Real> start = before[body];
    if (!forces_applied) v += h * field.gravity;
    FreeStep<Real> step{v, v};
    bool free = false;
    const TreeMember member = members != nullptr ? members[body] : TreeMember::none;
    if (member != TreeMember::none) {
      if (member == TreeMember::free) step.drift_velocity -= h / 2 * field.gravity;
    } else if (v == field.predicted_velocity(bodies, body, start, h)) {
      const Vector3<Real> x = bodies.position[body];
      const FreeStep<Real> smooth = free_step(field.on(bodies, body), x, start, field.acceleration(body));
      if (!penetrates_plane(x, smooth.drift_velocity, v, bodies.radius[body])) {
        step = smooth;
        free = true;
      }
    }
    if (is_free != nullptr) is_free[body] = free ? 1 : 0;
    if (bounced_mask != nullptr && bounced_mask[body] != 0) {
      const Vector3<Real> whole = step.drift_velocity;
      end_at_surfaces(body, step.drift_velocity);
      const Vector3<Real> lost = whole - step.drift_velocity;
      if (static_impulses != nullptr && lost.dot(lost) > 0)
        static_impulses[body].push_work +=
            static_cast<double>(h * bodies.mass[body] * field.acceleration(body).dot(lost));
    }
    drift_velocity[body] = step.drift_velocity;
    bodies.velocity[body] = step.velocity;
    if (moved != nullptr) moved[body] = step.velocity;
  }

  template <class Forces>
  SIM_HD FreeStep<Real> free_step(const Forces& forces, const Vector3<Real>& x, const Vector3<Real>& v,
                                  const Vector3<Real>& a) const {
    if constexpr (integrator == Integrator::semi_implicit_euler)
      return {v + h * a, v + h * a};
    else if constexpr (integrator == Integrator::rk4)
      return rk4_step(forces, x, v, a, h);
    else
      return verlet_step(forces, x, v, a, h);
  }

  SIM_HD bool penetrates_plane(const Vector3<Real>& x, const Vector3<Real>& velocity,
                               const Vector3<Real>& euler, Real radius) const {
    if (clear.contains(x, radius, clear.time * velocity)) return false;
    for (int p = 0; p < plane_count; ++p) {
      const Vector3<Real> normal = planes[p].normal;
      const Real gap = normal.dot(x) - planes[p].offset - radius, speed = normal.dot(velocity);
      if (gap + h * speed < 0 && speed < normal.dot(euler)) return true;
    }
    return false;
  }
  /// Limits the drift velocity of a body that bounced and reaches the same surface again, because it is so
  /// fast that it crosses its container in a substep. See SoftWalls::ends_at_plane(). At a plane it moves on
  /// along the plane: a body between the plane and a heavy body that comes down would else stay in its way.
  /// In a scene with boxes it stops, because the new way may lead through a box.
  SIM_HD void end_at_surfaces(int body, Vector3<Real>& drift) const {
    const std::uint32_t bounced = bounced_mask[body];
    const Vector3<Real> x = bodies.position[body];
    const Real radius = bodies.radius[body];
    if (!(h * h * drift.dot(drift) > radius * radius)) return;
    for (int p = 0; p < min_of(plane_count, +plane_mask_bits); ++p)
      if ((bounced >> p & 1) != 0) {
        const Vector3<Real> normal = planes[p].normal;
        const Real excess = depth_at_end(normal, planes[p].offset, x, radius, drift);
        if (!(excess > 0)) continue;
        if (boxes.count == 0)
          drift += (excess / h) * normal;
        else
          drift *= 1 + excess / (h * normal.dot(drift));
      }
    for (int b = 0; b < min_of(boxes.count, plane_mask_bits - plane_count); ++b) {
      if ((bounced >> (plane_count + b) & 1) == 0) continue;
      const ContactPlane<Real> met = boxes.boxes[b].first_plane_on_path(x, h * drift, radius);
      if (met.is_none()) continue;
      const Real excess = depth_at_end(met.normal, met.offset, x, radius, drift);
      if (excess > 0) drift *= 1 + excess / (h * met.normal.dot(drift));
    }
  }
  /// How deep in the plane the body would be after the substep, m. A body in the plane counts as touching.
  SIM_HD Real depth_at_end(const Vector3<Real>& normal, Real offset, const Vector3<Real>& x, Real radius,
                           const Vector3<Real>& drift) const {
    return -(max_of(normal.dot(x) - offset - radius, Real(0)) + h * normal.dot(drift));
  }
};

/// Rotates bodies with unequal moments of inertia, except those of joint trees. All others rotate in the
/// stage "move".
template <class Real>
struct RotateBodies {
  BodyView<Real> bodies;
  Real h;  ///< s
  RotationUpdate update;
  RotationParts parts;
  const TreeMember* members;  ///< by body; null without joint trees
  Vector3<float>* low;        ///< of angular velocities (wide_spin.h); null in double
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    const Vector3<Real> inertia = bodies.inertia[body];
    if (is_isotropic(inertia) || (members != nullptr && members[body] != TreeMember::none)) return;
    const Vector3<Real> stored = bodies.angular_velocity[body];
    Vector3d w = stored.template cast<double>();
    if constexpr (sizeof(Real) == sizeof(float)) w = joined(stored, low[body]);
    if (!(update == RotationUpdate::first_order
              ? rotate_first_order(bodies.orientation[body], w, inertia, h)
              : rotate_lie_group(bodies.orientation[body], w, inertia, h, parts)))
      return;
    bodies.angular_velocity[body] = Vector3<Real>(w.cast<Real>());
    if constexpr (sizeof(Real) == sizeof(float)) low[body] = low_part(w);
  }
};

/// Clears parts that belong to another angular velocity. Otherwise such a part could fit again in a later
/// step, but it is not part of a snapshot.
struct ClearIgnoredParts {
  const PackedVector3<float>* angular_velocity;
  Vector3<float>* low;
  const StepControl* control;
  SIM_HD void operator()(int body) const {
    if (control->overflow) return;
    const Vector3<float> high = angular_velocity[body], part = low[body];
    for (int k = 0; k < 3; ++k)
      if (part[k] != 0 && is_ignored(high, part, k)) low[body][k] = 0;
  }
};

}  // namespace

template <class Real>
FreeIntegrator<Real>::FreeIntegrator(Executor& executor, const SolverScene<Real>& scene)
    : executor_(executor),
      scene_(scene),
      before_(executor, "velocities at substep start"),
      drift_velocity_(executor, "drift velocities") {
  if (!has_drift_velocity()) return;
  before_.resize_discarding(static_cast<std::size_t>(scene.body_count));
  drift_velocity_.resize_discarding(static_cast<std::size_t>(scene.body_count));
}

template <class Real>
void FreeIntegrator<Real>::begin() {
  if (has_drift_velocity())
    executor_.run("integrate", scene_.body_count,
                  SaveVelocities<Real>{scene_.bodies.velocity, before_.data()});
}

template <class Real>
BodyView<Real> FreeIntegrator<Real>::bodies_with_drift_velocity() const {
  BodyView<Real> bodies = scene_.bodies;
  if (has_drift_velocity()) bodies.velocity = drift_velocity_.data();
  return bodies;
}

template <class Real>
void FreeIntegrator<Real>::integrate(Real h, bool forces_applied, PackedVector3<Real>* moved,
                                     std::uint8_t* is_free, const std::uint32_t* bounced_mask) {
  if (!has_drift_velocity()) {
    if (moved != nullptr)
      executor_.run("integrate", scene_.body_count, SaveVelocities<Real>{scene_.bodies.velocity, moved});
    return;
  }
  const auto with = [&]<Integrator integrator>() {
    const Effects& effects = scene_.effects;
    const SmoothField<Real> field{effects.attractor ? scene_.attractors : AttractorView<Real>{},
                                  effects.attractor ? scene_.field : nullptr, scene_.drag, effects.drag,
                                  scene_.gravity};
    executor_.run(
        "integrate", scene_.body_count,
        IntegrateFree<Real, integrator>{
            field, scene_.bodies, before_.data(), drift_velocity_.data(), moved, is_free, bounced_mask,
            scene_.planes, scene_.plane_count, scene_.boxes, scene_.static_impulses, h, forces_applied,
            members(), ClearSpace<Real>::of(scene_.box, scene_.plane_count, h), scene_.control});
  };
  switch (scene_.integrator) {
    case Integrator::rk4:
      return with.template operator()<Integrator::rk4>();
    case Integrator::velocity_verlet:
      return with.template operator()<Integrator::velocity_verlet>();
    case Integrator::semi_implicit_euler:
      return with.template operator()<Integrator::semi_implicit_euler>();
  }
}

template <class Real>
void FreeIntegrator<Real>::move(Real h, bool forces_applied, const std::uint8_t* asleep,
                                ClampedMotion<Real> clamped) {
  clamped.static_impulses = scene_.static_impulses;
  clamped.field = scene_.effects.attractor ? scene_.field : nullptr;
  Effects move_effects = scene_.effects;
  if (forces_applied || has_drift_velocity()) move_effects.gravity = false;  // already in the velocities
  move_bodies<Real>(executor_, bodies_with_drift_velocity(), scene_.body_count, move_effects, scene_.gravity,
                    scene_.box, h, scene_.control, asleep, clamped, members());
  if (!scene_.unequal_moments) return;
  const RotationParts parts{scene_.integrator == Integrator::rk4 ? 5 : 1};
  run_awake_bodies(executor_, "turn", scene_.body_count, asleep,
                   RotateBodies<Real>{scene_.bodies, h, scene_.rotation_update, parts, members(),
                                      scene_.angular_velocity_low, scene_.control});
}

template <class Real>
void FreeIntegrator<Real>::end_step() {
  if constexpr (sizeof(Real) == sizeof(float))
    if (scene_.unequal_moments)
      executor_.run(
          "keep", scene_.body_count,
          ClearIgnoredParts{scene_.bodies.angular_velocity, scene_.angular_velocity_low, scene_.control});
}

template class FreeIntegrator<float>;
template class FreeIntegrator<double>;

}  // namespace collidoscope
