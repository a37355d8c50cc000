#pragma once
// The planes of `soft_step`: contacts like all others, but that each body resolves its own, obstacles first,
// then the faces of the box, then box obstacles, each as the plane that it is to this body in this substep
// (box_surface.h). Nothing behind a plane pushes back, so the planes are rigid: a body is at once
// out of them, and ends no substep inside.
//
// A bounce takes the speed at which the body reaches the plane, sqrt(v^2 + 2 g s) after a fall through the
// gap s that is left, not that of the substep's end: so the height of a rebound does not depend on how the
// time steps fall, and no bounce gains energy. Only what a body brings along bounces: the speeds that sweeps
// give it on their way to a solution are no impacts, and taken for such kept whole piles from their rest.
//
// Most bodies are at no plane. What a step remembers of body and plane is therefore looked up only where a
// bit of `active_mask` says that there may be something, and the rest of the body only where a plane may act
// on it.

#include <cstdint>
#include <type_traits>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/dynamics/body_state.h"
#include "sim_cuda/solver/box_surface.h"
#include "sim_cuda/solver/friction.h"
#include "sim_cuda/solver/restitution.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

/// Friction impulses at planes, plane by plane, all bodies of each; null without friction.
template <class Real>
struct WallFriction {
  Friction<Real> coefficients;
  Vector3<Real>* impulse;    ///< N s, of the substep
  Vector3<Real>* total;      ///< N s, of the step so far
  Real* normal_impulse_sum;  ///< N s, along the normal, of the step so far
};

template <class Real, bool with_friction, bool with_box_obstacles>
struct SoftWalls {
  BodyView<Real> bodies;
  std::int64_t body_count;
  const WallPlane<Real>* planes;
  int plane_count;
  Restitution<Real> restitution;
  Vector3<Real> gravity;  ///< m/s^2
  Real inverse_h;         ///< 1/s
  Real* impulse;          ///< N s, of the substep; plane by plane, all bodies of each
  Real* bounce;           ///< m/s, at which the body will leave the plane; < 0: not touched in this step
  std::uint32_t*
      active_mask;  ///< by body: bit p where plane p gives something, or did since the step began; or null
  WallFriction<Real> friction;  ///< read only with friction
  BoxContacts<Real> boxes;      ///< none unless `with_box_obstacles`
  StaticImpulse* static_impulses;

  /// A body while its planes are resolved.
  struct Body {
    Vector3<Real> x, v;
    Real radius, mass, inverse_mass;
    AngularState<Real> angular;  ///< read only with friction
    std::uint32_t active_mask;
    bool moved = false, velocity_changed = false;
  };

  /// Whether body and plane p may have something to remember. Planes beyond the bits are always asked.
  static constexpr int mask_bits = 32;
  SIM_HD static bool is_active(const Body& body, int p) {
    return p >= mask_bits || (body.active_mask >> p & 1) != 0;
  }
  SIM_HD void activate(int id, Body& body, int p) const {
    if (is_active(body, p)) return;
    body.active_mask |= std::uint32_t{1} << p;
    active_mask[id] = body.active_mask;
  }
  /// At the end of a step: leaves the planes that give nothing any more, nor what is no number: that would be
  /// in a snapshot, and who goes on from one asks all planes.
  SIM_HD void deactivate_unused(int id, Body& body) const {
    if (body.active_mask == 0) return;
    std::uint32_t still_active = 0;
    for (int p = 0; p < min_of(count(), +mask_bits); ++p) {
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
  /// Whether a sweep would do anything: exact, but for planes where it is asked.
  SIM_HD bool may_touch(const Body& body, bool relaxing) const {
    if constexpr (with_box_obstacles) return true;
    if (plane_count > mask_bits || body.active_mask != 0) return true;
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

  /// Plane p of a body; those from plane_count on are boxes.
  SIM_HD WallPlane<Real> plane(int p, int body) const {
    if constexpr (with_box_obstacles) {
      if (p >= plane_count) {
        const ContactPlane<Real> box_plane = boxes.plane[index(p - plane_count, body)];
        const BoxSurface<Real>& box = boxes.view.boxes[p - plane_count];
        return {box_plane.normal, box_plane.offset, box.restitution, box.friction};
      }
    }
    return planes[p];
  }
  /// Its normal when it touched last in this step.
  SIM_HD Vector3<Real> contact_normal(int p, int body) const {
    if constexpr (with_box_obstacles)
      if (p >= plane_count) return boxes.normal[index(p - plane_count, body)];
    return planes[p].normal;
  }
  /// At the start of a substep: the planes of boxes that it touches.
  SIM_HD void update_box_planes(int id, const Body& body) const {
    for (int b = 0; b < boxes.view.count; ++b) {
      const BoxSurface<Real>& box = boxes.view.boxes[b];
      const bool touches = impulse[index(plane_count + b, id)] > 0 || !(box.gap(body.x, body.radius) > 0);
      boxes.plane[index(b, id)] = touches ? box.contact_plane_at(body.x) : ContactPlane<Real>::none();
    }
  }
  /// Of a box that it does not touch, the plane that it would meet in this substep as it moves now; whether
  /// there is one.
  SIM_HD bool predict_contact(int b, int id, const Body& body) const {
    ContactPlane<Real>& box_plane = boxes.plane[index(b, id)];
    if (box_plane.is_none())
      box_plane = boxes.view.boxes[b].first_plane_on_path(body.x, (1 / inverse_h) * body.v, body.radius);
    return !box_plane.is_none();
  }
  /// After a sweep: what the last plane gave may lead through a box that came before it. A body that finds no
  /// way out between boxes stops.
  SIM_HD void resolve_boxes(int id, Body& body) const {
    if (!(body.inverse_mass > 0)) return;
    constexpr int rounds = 8;
    for (int round = 0; round < rounds; ++round) {
      bool clear = true;
      for (int b = 0; b < boxes.view.count; ++b) {
        if (!predict_contact(b, id, body)) continue;
        const ContactPlane<Real> box_plane = boxes.plane[index(b, id)];
        const Real gap = max_of(box_plane.normal.dot(body.x) - box_plane.offset - body.radius, Real(0));
        const Real speed = box_plane.normal.dot(body.v), over = speed + gap * inverse_h;
        const Real rounding = Real(1e-6) * body.v.template lpNorm<1>() + Real(1e-4) * body.radius * inverse_h;
        if (!(over < -rounding)) continue;
        clear = false;
        impulse[index(plane_count + b, id)] -= body.mass * over;
        activate(id, body, plane_count + b);
        boxes.normal[index(b, id)] = box_plane.normal;
        apply_normal_impulse(id, body, box_plane.normal, -body.mass * over);
      }
      if (clear) return;
    }
    for (int k = 0; k < 3; ++k) static_impulses[id].vector[k] -= static_cast<double>(body.mass * body.v[k]);
    body.v = Vector3<Real>::Zero();
    body.velocity_changed = true;
  }

  SIM_HD void apply_normal_impulse(int id, Body& body, const Vector3<Real>& normal, Real change) const {
    const Vector3<Real> momentum = change * normal;
    body.v += body.inverse_mass * momentum;
    body.velocity_changed = true;
    StaticImpulse& sum = static_impulses[id];
    sum.impulse += static_cast<double>(change);
    for (int k = 0; k < 3; ++k) sum.vector[k] += static_cast<double>(momentum[k]);
  }

  /// An impulse across the normal, where the body touches the plane.
  SIM_HD void apply_friction_impulse(int id, Body& body, const Vector3<Real>& normal,
                                     const Vector3<Real>& change) const {
    if constexpr (with_friction) {
      body.v += body.inverse_mass * change;
      body.angular.apply_angular_impulse(-body.radius * normal.cross(change));
      body.velocity_changed = true;
      for (int k = 0; k < 3; ++k) static_impulses[id].vector[k] += static_cast<double>(change[k]);
    }
  }

  /// The impulses of the substep before, as a start.
  SIM_HD void warm_start(int id, Body& body) const {
    for (int p = 0; p < count(); ++p) {
      if (!is_active(body, p)) continue;
      const Real start = impulse[index(p, id)];
      if (!(start > 0)) continue;
      const Vector3<Real> normal = plane(p, id).normal;
      if constexpr (with_box_obstacles)  // what the step before remembers is in no snapshot
        if (p >= plane_count && bounce[index(p, id)] < 0) boxes.normal[index(p - plane_count, id)] = normal;
      apply_normal_impulse(id, body, normal, start);
      if constexpr (with_friction) apply_friction_impulse(id, body, normal, friction.impulse[index(p, id)]);
    }
  }

  /// Friction at one plane within `normal_impulse` N s times its coefficient, of which `accumulated` is
  /// already there.
  SIM_HD void apply_plane_friction(int id, Body& body, int p, const Vector3<Real>& normal,
                                   Real normal_impulse, Vector3<Real>& accumulated) const {
    if constexpr (with_friction) {
      if (!(normal_impulse > 0) && accumulated.dot(accumulated) == 0) return;
      const Vector3<Real> slip =
          tangential_part<Real>(body.v - body.radius * body.angular.velocity.cross(normal), normal);
      const Real mass =
          1 / (body.inverse_mass + body.radius * body.radius * body.angular.inverse_inertia_max());
      const Real mu = Friction<Real>::between(friction.coefficients.of_body(static_cast<std::uint32_t>(id)),
                                              plane(p, id).friction);
      apply_friction_impulse(id, body, normal,
                             solve_friction<Real>(slip, mass, mu * normal_impulse, accumulated));
    }
  }
  /// After the normal impulses are relaxed; `last`: for the last time in this substep, which is counted.
  SIM_HD void apply_friction(int id, Body& body, bool last) const {
    if constexpr (with_friction) {
      for (int p = 0; p < count(); ++p) {
        if (!is_active(body, p)) continue;
        const std::int64_t here = index(p, id);
        apply_plane_friction(id, body, p, plane(p, id).normal, impulse[here], friction.impulse[here]);
        if (!last || !(impulse[here] > 0)) continue;
        friction.normal_impulse_sum[here] += impulse[here];
        friction.total[here] += friction.impulse[here];
      }
    }
  }

  /// One sweep. `relaxing`: after the move, when no contact may begin that the next move closes. `before`:
  /// the velocity before forces acted in this substep, where this is the first.
  SIM_HD void solve(int id, Body& body, bool relaxing, const Vector3<Real>* before) const {
    for (int p = 0; p < count(); ++p) {
      if constexpr (with_box_obstacles)
        if (p >= plane_count && (relaxing ? plane(p, id).normal.dot(plane(p, id).normal) == 0
                                          : !predict_contact(p - plane_count, id, body)))
          continue;
      const WallPlane<Real> surface = plane(p, id);
      const Vector3<Real> normal = surface.normal;
      Real gap = normal.dot(body.x) - surface.offset - body.radius;
      if (gap < 0) {
        const Vector3<Real> shift = -gap * normal;
        body.x += shift;
        body.moved = true;
        static_impulses[id].push_work -= static_cast<double>(body.mass * gravity.dot(shift));
        gap = 0;
      }
      const Real speed = normal.dot(body.v);
      const Real accumulated = is_active(body, p) ? impulse[index(p, id)] : Real(0);
      if (relaxing && gap > 0 && !(accumulated > 0)) continue;
      const Real next = max_of(accumulated - body.mass * (speed + gap * inverse_h), Real(0));
      if (next == accumulated) continue;
      impulse[index(p, id)] = next;
      activate(id, body, p);
      if constexpr (with_box_obstacles)
        if (p >= plane_count && next > 0) boxes.normal[index(p - plane_count, id)] = normal;
      if (before != nullptr && next > 0 && bounce[index(p, id)] < 0) {
        const Real start = -normal.dot(*before);
        using std::sqrt;
        const Real approach =
            start > 0 ? sqrt(max_of(start * start - 2 * gap * normal.dot(gravity), Real(0))) : Real(0);
        const Real e = restitution.between(restitution.of_body(static_cast<std::uint32_t>(id)),
                                           surface.restitution, approach);
        bounce[index(p, id)] = e * max_of(approach, Real(0));
      }
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
  /// What may_touch() asks for.
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
