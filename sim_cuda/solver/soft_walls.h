#pragma once
// Plane contacts of `soft_step`. Each body solves its own planes in order: half-space obstacles, box faces
// of the scene, box obstacles. A box obstacle acts as one plane per body and substep (box_surface.h).
// Planes are rigid: overlap is removed at once, and no substep ends with a body inside a plane. A view;
// does not own memory.
//
// Impacts are resolved at the start of a substep, before all forces (plane_impacts.h). The iterations are
// inelastic.
//
// Most bodies touch no plane. Plane data are read only if a bit of `active_mask` is set, and the remaining
// body data only if a plane may act.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/box_surface.h"
#include "sim_cuda/solver/clear_space.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/tangent_response.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

/// Iterations over planes and boxes before and after the move. After it, speculative planes without impulse
/// stay inactive. `relax` stops bodies that have closed a gap in the substep, which ends the load of the
/// plane. `relax_without_stops` does not, because other passes may push loaded bodies for a moment.
enum class WallPass : std::uint8_t { solve, relax, relax_without_stops };

template <class Real, bool with_friction, bool with_box_obstacles>
struct SoftWalls {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const WallPlane<Real>* planes;
  int plane_count;
  Vector3<Real> gravity;        ///< m/s^2
  Real inverse_h;               ///< 1/s
  Real closing_speed;           ///< m/s: closing_gap() in a substep
  Real* impulse;                ///< accumulated in the substep, N s; index plane * body count + body
  std::uint32_t* bounced_mask;  ///< by body: bit p is set if the body bounced off plane p in this substep
  std::uint8_t* stopped;  ///< by body: 1: stopped in this substep by an impulse that is not in `impulse`
  std::uint32_t*
      active_mask;  ///< by body: bit p is set if plane p has impulses or had some in this step; may be null
  WallFriction<Real> friction;  ///< used only with friction
  BoxContacts<Real> boxes;      ///< empty unless `with_box_obstacles`
  StaticImpulse* static_impulses;
  ClearSpace<Real> clear;

  /// State of a body while its planes are solved.
  struct Body {
    Vector3<Real> x, v;
    Real radius, mass, inverse_mass;
    AngularState<Real> angular;  ///< used only with friction
    std::uint32_t active_mask;
    bool moved = false, velocity_changed = false;
  };

  /// True if the body may have impulses at plane p. Planes from plane_mask_bits on have no bit and are always
  /// active.
  SIM_HD static bool is_active(const Body& body, int p) {
    return p >= plane_mask_bits || (body.active_mask >> p & 1) != 0;
  }
  SIM_HD void activate(int id, Body& body, int p) const {
    if (is_active(body, p)) return;
    body.active_mask |= std::uint32_t{1} << p;
    active_mask[id] = body.active_mask;
  }
  /// Call at the end of a step. Clears planes with zero or NaN impulse from the active mask. Reason: a
  /// loaded snapshot activates all planes and must give the same result.
  SIM_HD void deactivate_unused(int id, Body& body) const {
    if (body.active_mask == 0) return;
    std::uint32_t still_active = 0;
    for (int p = 0; p < min_of(count(), +plane_mask_bits); ++p) {
      if (!is_active(body, p)) continue;
      Real& normal = impulse[index(p, id)];
      bool gives = normal > 0;
      if constexpr (with_friction) {
        const Vector3<Real> tangential = friction.impulse[index(p, id)];
        gives = gives || tangential.dot(tangential) > 0;
      }
      if (gives) {
        still_active |= std::uint32_t{1} << p;
        continue;
      }
      normal = 0;
      if constexpr (with_friction) friction.impulse[index(p, id)] = Vector3<Real>::Zero();
    }
    if (still_active != body.active_mask) active_mask[id] = still_active;
  }
  /// True only if no surface acts on the body in the substep.
  SIM_HD bool is_clear(const Body& body) const {
    return !with_box_obstacles && body.active_mask == 0 &&
           clear.contains(body.x, body.radius, clear.time * body.v);
  }
  /// True if an iteration may change the body. Exact if no plane is active and there are no box obstacles.
  SIM_HD bool may_touch(const Body& body, bool relaxing) const {
    if constexpr (with_box_obstacles) return true;
    if (plane_count > plane_mask_bits || body.active_mask != 0) return true;
    return meets_plane(body, relaxing);
  }
  /// True if the body overlaps a plane, or reaches it in the substep at its velocity. With `relaxing`, only
  /// if it has reached it.
  SIM_HD bool meets_plane(const Body& body, bool relaxing) const {
    if (clear.contains(body.x, body.radius, (relaxing ? Real(0) : clear.time) * body.v)) return false;
    for (int p = 0; p < plane_count; ++p) {
      const Vector3<Real> normal = planes[p].normal;
      const Real gap = normal.dot(body.x) - planes[p].offset - body.radius;
      if (gap < 0 || (normal.dot(body.v) + gap * inverse_h < 0 && !(relaxing && gap > 0))) return true;
    }
    return false;
  }

  SIM_HD std::int64_t index(int plane, int body) const { return plane * body_count + body; }
  SIM_HD int count() const {
    if constexpr (with_box_obstacles)
      return plane_count + boxes.view.count;
    else
      return plane_count;
  }

  /// Plane p of a body. Indices from plane_count on are box obstacles. A reference if there are none, because
  /// most planes are only tested.
  SIM_HD decltype(auto) plane(int p, [[maybe_unused]] int body) const {
    if constexpr (with_box_obstacles) {
      if (p >= plane_count) {
        const ContactPlane<Real> box_plane = boxes.plane[index(p - plane_count, body)];
        const BoxSurface<Real>& box = boxes.view.boxes[p - plane_count];
        return WallPlane<Real>{box_plane.normal, box_plane.offset, box.restitution, box.friction};
      }
      return WallPlane<Real>(planes[p]);
    } else {
      return (planes[p]);
    }
  }
  /// Call at the start of a substep.
  SIM_HD void clear_stopped(int id) const {
    if (count() > 0 && stopped[id] != 0) stopped[id] = 0;
  }
  /// Call at the start of a substep. Sets the contact planes of the boxes that the body touches.
  SIM_HD void update_box_planes(int id, const Body& body) const {
    for (int b = 0; b < boxes.view.count; ++b) {
      const BoxSurface<Real>& box = boxes.view.boxes[b];
      const bool touches = impulse[index(plane_count + b, id)] > 0 || !(box.gap(body.x, body.radius) > 0);
      boxes.plane[index(b, id)] = touches ? box.contact_plane_at(body.x) : ContactPlane<Real>::none();
    }
  }
  /// For a box without contact, predicts the plane that the body meets in this substep. Returns true if the
  /// box has a plane.
  SIM_HD bool predict_contact(int b, int id, const Body& body) const {
    ContactPlane<Real>& box_plane = boxes.plane[index(b, id)];
    if (box_plane.is_none())
      box_plane = boxes.view.boxes[b].first_plane_on_path(body.x, (1 / inverse_h) * body.v, body.radius);
    return !box_plane.is_none();
  }
  /// Call after an iteration. The impulse of a later plane may push the body through an earlier box. A body
  /// that still penetrates after all rounds is stopped.
  SIM_HD void resolve_boxes(int id, Body& body) const {
    if (!(body.inverse_mass > 0)) return;
    constexpr int rounds = 8;
    for (int round = 0; round < rounds; ++round) {
      bool outside = true;
      for (int b = 0; b < boxes.view.count; ++b) {
        if (!predict_contact(b, id, body)) continue;
        const ContactPlane<Real> box_plane = boxes.plane[index(b, id)];
        const Real gap = max_of(box_plane.normal.dot(body.x) - box_plane.offset - body.radius, Real(0));
        const Real speed = box_plane.normal.dot(body.v), over = speed + gap * inverse_h;
        const Real rounding = Real(1e-6) * body.v.template lpNorm<1>() + Real(1e-4) * body.radius * inverse_h;
        if (!(over < -rounding) || ends_at_plane(id, body, plane_count + b)) continue;
        outside = false;
        impulse[index(plane_count + b, id)] -= body.mass * over;
        activate(id, body, plane_count + b);
        apply_normal_impulse(id, body, box_plane.normal, -body.mass * over);
      }
      if (outside) return;
    }
    for (int k = 0; k < 3; ++k) static_impulses[id].vector[k] -= static_cast<double>(body.mass * body.v[k]);
    body.v = Vector3<Real>::Zero();
    body.velocity_changed = true;
    stopped[id] = 1;
  }

  SIM_HD void apply_normal_impulse(int id, Body& body, const Vector3<Real>& normal, Real change) const {
    const Vector3<Real> momentum = change * normal;
    body.v += body.inverse_mass * momentum;
    body.velocity_changed = true;
    StaticImpulse& sum = static_impulses[id];
    sum.impulse += static_cast<double>(change);
    for (int k = 0; k < 3; ++k) sum.vector[k] += static_cast<double>(momentum[k]);
  }

  /// Applies a tangential impulse at the contact point of the plane.
  SIM_HD void apply_friction_impulse(int id, Body& body, const Vector3<Real>& normal,
                                     const Vector3<Real>& change) const {
    if constexpr (with_friction) {
      body.v += body.inverse_mass * change;
      body.angular.apply_angular_impulse(-body.radius * normal.cross(change));
      body.velocity_changed = true;
      for (int k = 0; k < 3; ++k) static_impulses[id].vector[k] += static_cast<double>(change[k]);
    }
  }

  /// Applies the accumulated impulses of the last substep. A body that a guard has frozen keeps its impulses.
  SIM_HD void warm_start(int id, Body& body) const {
    if (!(body.inverse_mass > 0)) return;
    if (body.active_mask == 0 && count() <= plane_mask_bits) return;
    for (int p = 0; p < count(); ++p) {
      if (!is_active(body, p)) continue;
      const Real start = impulse[index(p, id)];
      if (!(start > 0)) continue;
      const Vector3<Real> normal = plane(p, id).normal;
      apply_normal_impulse(id, body, normal, start);
      if constexpr (with_friction) apply_friction_impulse(id, body, normal, friction.impulse[index(p, id)]);
    }
  }

  /// Solves friction at one plane, limited by mu times `normal_impulse` (N s). Updates `accumulated`.
  template <bool unequal_moments>
  SIM_HD void apply_plane_friction(int id, Body& body, int p, const Vector3<Real>& normal,
                                   Real normal_impulse, Vector3<Real>& accumulated) const {
    if constexpr (with_friction)
      apply_plane_friction<unequal_moments>(id, body, normal, normal_impulse, accumulated,
                                            plane(p, id).friction);
  }
  template <bool unequal_moments>
  SIM_HD void apply_plane_friction(int id, Body& body, const Vector3<Real>& normal, Real normal_impulse,
                                   Vector3<Real>& accumulated, Real surface_friction) const {
    if constexpr (with_friction) {
      if (!(normal_impulse > 0) && accumulated.dot(accumulated) == 0) return;
      const Vector3<Real> slip =
          tangential_part<Real>(body.v - body.radius * body.angular.velocity.cross(normal), normal);
      const Real mu = Friction<Real>::between(friction.coefficients.of_body(static_cast<std::uint32_t>(id)),
                                              surface_friction);
      const auto solve = [&](const auto& mass) {
        return solve_friction<Real>(slip, mass, mu * normal_impulse, accumulated);
      };
      const Real squared_arm = body.radius * body.radius;
      if constexpr (unequal_moments)
        if (!body.angular.is_isotropic()) {
          TangentResponse<Real> response(normal, body.inverse_mass);
          response.add(body.angular, squared_arm);
          return apply_friction_impulse(id, body, normal, solve(response));
        }
      apply_friction_impulse(
          id, body, normal,
          solve(1 / (body.inverse_mass + squared_arm * body.angular.inverse_inertia_max())));
    }
  }
  /// Call after the normal impulses of relax.
  template <bool unequal_moments>
  SIM_HD void apply_friction(int id, Body& body) const {
    if constexpr (with_friction) {
      for (int p = 0; p < count(); ++p) {
        if (!is_active(body, p)) continue;
        const std::int64_t here = index(p, id);
        apply_plane_friction<unequal_moments>(id, body, p, plane(p, id).normal, impulse[here],
                                              friction.impulse[here]);
      }
    }
  }

  /// Call for each body at the start of a substep, before its impacts.
  SIM_HD void clear_bounced(int id) const {
    if (bounced_mask[id] != 0) bounced_mask[id] = 0;
  }
  /// True if the body bounced off plane p and is so fast that it may cross its container in a substep. It
  /// keeps its speed; its way ends at the plane (IntegrateFree).
  SIM_HD bool ends_at_plane(int id, const Body& body, int p) const {
    if (p >= plane_mask_bits || (bounced_mask[id] >> p & 1) == 0) return false;
    return body.v.dot(body.v) > body.radius * inverse_h * body.radius * inverse_h;
  }
  /// Stops a body at plane p that has closed a gap in the substep, with friction. Its impulses are no loads.
  template <bool unequal_moments>
  SIM_HD void stop_at_plane(int id, Body& body, int p, const WallPlane<Real>& surface, Real change) const {
    stopped[id] = 1;
    apply_normal_impulse(id, body, surface.normal, change);
    Real& sum = impulse[index(p, id)];
    if constexpr (with_friction) {
      Vector3<Real>& tangential = friction.impulse[index(p, id)];
      apply_plane_friction<unequal_moments>(id, body, surface.normal, sum + change, tangential,
                                            surface.friction);
      tangential = Vector3<Real>::Zero();
    }
    sum = 0;
  }

  /// One iteration. `pull`: acceleration for the work of overlap recovery, m/s^2.
  template <bool unequal_moments = false>
  SIM_HD void solve(int id, Body& body, WallPass pass, const Vector3<Real>& pull) const {
    const bool relaxing = pass != WallPass::solve;
    for (int p = 0; p < count(); ++p) {
      if constexpr (with_box_obstacles)
        if (p >= plane_count && (relaxing ? plane(p, id).normal.dot(plane(p, id).normal) == 0
                                          : !predict_contact(p - plane_count, id, body)))
          continue;
      const WallPlane<Real>& surface = plane(p, id);
      const Vector3<Real>& normal = surface.normal;
      Real gap = normal.dot(body.x) - surface.offset - body.radius;
      if (gap < 0) {
        const Vector3<Real> shift = -gap * normal;
        body.x += shift;
        body.moved = true;
        static_impulses[id].push_work -= static_cast<double>(body.mass * pull.dot(shift));
        gap = 0;
      }
      const Real speed = normal.dot(body.v);
      if (speed < 0 && ends_at_plane(id, body, p)) continue;
      const Real accumulated = is_active(body, p) ? impulse[index(p, id)] : Real(0);
      if (relaxing && !(accumulated > 0)) continue;
      const Real over = -(speed + gap * inverse_h);
      if (pass == WallPass::relax && over > closing_speed) {
        stop_at_plane<unequal_moments>(id, body, p, surface, body.mass * over);
        continue;
      }
      const Real next = max_of(accumulated + body.mass * over, Real(0));
      if (next == accumulated) continue;
      impulse[index(p, id)] = next;
      activate(id, body, p);
      apply_normal_impulse(id, body, normal, next - accumulated);
    }
    if constexpr (with_box_obstacles)
      if (!relaxing) resolve_boxes(id, body);
  }

  SIM_HD Body load(int id) const {
    Body body = load_motion(id);
    load_rest(id, body);
    return body;
  }
  /// Loads the data that may_touch() needs.
  SIM_HD Body load_motion(int id) const {
    Body body;
    body.x = bodies.position[id];
    body.v = bodies.velocity[id];
    body.radius = bodies.radius[id];
    body.active_mask = active_mask != nullptr ? active_mask[id] : 0;
    return body;
  }
  SIM_HD void load_rest(int id, Body& body) const {
    body.mass = bodies.mass[id];
    body.inverse_mass = bodies.inverse_mass[id];
    if constexpr (with_friction)
      body.angular = AngularState<Real>::of(bodies, static_cast<std::uint32_t>(id));
  }
  SIM_HD void store(int id, const Body& body) const {
    if (body.moved) bodies.position[id] = body.x;
    if (!body.velocity_changed) return;
    bodies.velocity[id] = body.v;
    if constexpr (with_friction) bodies.angular_velocity[id] = body.angular.velocity;
  }
};

}  // namespace collidoscope
