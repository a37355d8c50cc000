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
// bit of `at` says that there may be something, and the rest of the body only where a plane may act on it.

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

/// What friction at planes remembers, plane by plane, all bodies of each; null without friction.
template <class Real>
struct WallGrips {
  Friction<Real> friction;
  Vector3<Real>* impulse;  ///< N s, of the substep
  Vector3<Real>* total;    ///< N s, of the step so far
  Real* pressed;           ///< N s, along the normal, of the step so far
};

template <class Real, bool rubbed, bool boxed>
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
  std::uint32_t* at;  ///< by body: bit p where plane p gives something, or did since the step began; or null
  WallGrips<Real> grips;    ///< read only with friction
  BoxContacts<Real> boxes;  ///< none unless `boxed`
  WallLedger* ledger;

  /// A body while its planes are resolved.
  struct Body {
    Vector3<Real> x, v;
    Real radius, mass, inverse_mass;
    Spin<Real> spin;  ///< read only with friction
    std::uint32_t at;
    bool moved = false, given = false;
  };

  /// Whether body and plane p may have something to remember. Planes beyond the bits are always asked.
  static constexpr int bits = 32;
  SIM_HD static bool is_at(const Body& body, int p) { return p >= bits || (body.at >> p & 1) != 0; }
  SIM_HD void come_to(int id, Body& body, int p) const {
    if (is_at(body, p)) return;
    body.at |= std::uint32_t{1} << p;
    at[id] = body.at;
  }
  /// At the end of a step: leaves the planes that give nothing any more, nor what is no number: that would be
  /// in a snapshot, and who goes on from one asks all planes.
  SIM_HD void leave(int id, Body& body) const {
    if (body.at == 0) return;
    std::uint32_t stays = 0;
    for (int p = 0; p < min_of(count(), +bits); ++p) {
      if (!is_at(body, p)) continue;
      Real& normal = impulse[place(p, id)];
      bool gives = normal > 0;
      if constexpr (rubbed) {
        const Vector3<Real> grip = grips.impulse[place(p, id)];
        gives = gives || grip.dot(grip) > 0;
      }
      if (gives) {
        stays |= std::uint32_t{1} << p;
        continue;
      }
      normal = 0;
      if constexpr (rubbed) grips.impulse[place(p, id)] = Vector3<Real>::Zero();
    }
    if (stays != body.at) at[id] = stays;
  }
  /// Whether a sweep would do anything: exact, but for planes where it is asked.
  SIM_HD bool meets(const Body& body, bool relaxing) const {
    if constexpr (boxed) return true;
    if (plane_count > bits || body.at != 0) return true;
    for (int p = 0; p < plane_count; ++p) {
      const Vector3<Real> normal = planes[p].normal;
      const Real gap = normal.dot(body.x) - planes[p].offset - body.radius;
      if (gap < 0 || (normal.dot(body.v) + gap * inverse_h < 0 && !(relaxing && gap > 0))) return true;
    }
    return false;
  }

  SIM_HD std::int64_t place(int plane, int body) const { return plane * body_count + body; }
  SIM_HD int count() const {
    if constexpr (boxed)
      return plane_count + boxes.view.count;
    else
      return plane_count;
  }

  /// Plane p of a body; those from plane_count on are boxes.
  SIM_HD WallPlane<Real> plane(int p, int body) const {
    if constexpr (boxed) {
      if (p >= plane_count) {
        const Face<Real> face = boxes.face[place(p - plane_count, body)];
        const BoxSurface<Real>& box = boxes.view.boxes[p - plane_count];
        return {face.normal, face.offset, box.restitution, box.friction};
      }
    }
    return planes[p];
  }
  /// Its normal when it pressed last in this step.
  SIM_HD Vector3<Real> touched(int p, int body) const {
    if constexpr (boxed)
      if (p >= plane_count) return boxes.touched[place(p - plane_count, body)];
    return planes[p].normal;
  }
  /// At the start of a substep: the planes of boxes that it touches.
  SIM_HD void face_boxes(int id, const Body& body) const {
    for (int b = 0; b < boxes.view.count; ++b) {
      const BoxSurface<Real>& box = boxes.view.boxes[b];
      const bool touches = impulse[place(plane_count + b, id)] > 0 || !(box.gap(body.x, body.radius) > 0);
      boxes.face[place(b, id)] = touches ? box.facing(body.x) : Face<Real>::none();
    }
  }
  /// Of a box that it does not touch, the plane that it would meet in this substep as it moves now; whether
  /// there is one.
  SIM_HD bool foresee(int b, int id, const Body& body) const {
    Face<Real>& face = boxes.face[place(b, id)];
    if (face.is_none()) face = boxes.view.boxes[b].swept(body.x, (1 / inverse_h) * body.v, body.radius);
    return !face.is_none();
  }
  /// After a sweep: what the last plane gave may lead through a box that came before it. A body that finds no
  /// way out between boxes stops.
  SIM_HD void hold_boxes(int id, Body& body) const {
    if (!(body.inverse_mass > 0)) return;
    constexpr int rounds = 8;
    for (int round = 0; round < rounds; ++round) {
      bool clear = true;
      for (int b = 0; b < boxes.view.count; ++b) {
        if (!foresee(b, id, body)) continue;
        const Face<Real> face = boxes.face[place(b, id)];
        const Real gap = max_of(face.normal.dot(body.x) - face.offset - body.radius, Real(0));
        const Real speed = face.normal.dot(body.v), over = speed + gap * inverse_h;
        const Real rounding = Real(1e-6) * body.v.template lpNorm<1>() + Real(1e-4) * body.radius * inverse_h;
        if (!(over < -rounding)) continue;
        clear = false;
        impulse[place(plane_count + b, id)] -= body.mass * over;
        come_to(id, body, plane_count + b);
        boxes.touched[place(b, id)] = face.normal;
        give(id, body, face.normal, -body.mass * over);
      }
      if (clear) return;
    }
    for (int k = 0; k < 3; ++k) ledger[id].vector[k] -= static_cast<double>(body.mass * body.v[k]);
    body.v = Vector3<Real>::Zero();
    body.given = true;
  }

  SIM_HD void give(int id, Body& body, const Vector3<Real>& normal, Real change) const {
    const Vector3<Real> momentum = change * normal;
    body.v += body.inverse_mass * momentum;
    body.given = true;
    WallLedger& book = ledger[id];
    book.impulse += static_cast<double>(change);
    for (int k = 0; k < 3; ++k) book.vector[k] += static_cast<double>(momentum[k]);
  }

  /// An impulse across the normal, where the body touches the plane.
  SIM_HD void turn(int id, Body& body, const Vector3<Real>& normal, const Vector3<Real>& change) const {
    if constexpr (rubbed) {
      body.v += body.inverse_mass * change;
      body.spin.turn(-body.radius * normal.cross(change));
      body.given = true;
      for (int k = 0; k < 3; ++k) ledger[id].vector[k] += static_cast<double>(change[k]);
    }
  }

  /// The impulses of the substep before, as a start.
  SIM_HD void warm_start(int id, Body& body) const {
    for (int p = 0; p < count(); ++p) {
      if (!is_at(body, p)) continue;
      const Real start = impulse[place(p, id)];
      if (!(start > 0)) continue;
      const Vector3<Real> normal = plane(p, id).normal;
      if constexpr (boxed)  // what the step before remembers is in no snapshot
        if (p >= plane_count && bounce[place(p, id)] < 0) boxes.touched[place(p - plane_count, id)] = normal;
      give(id, body, normal, start);
      if constexpr (rubbed) turn(id, body, normal, grips.impulse[place(p, id)]);
    }
  }

  /// Friction at one plane within `pressing` N s times its coefficient, of which `given` is already there.
  SIM_HD void rub_plane(int id, Body& body, int p, const Vector3<Real>& normal, Real pressing,
                        Vector3<Real>& given) const {
    if constexpr (rubbed) {
      if (!(pressing > 0) && given.dot(given) == 0) return;
      const Vector3<Real> slip = across<Real>(body.v - body.radius * body.spin.rate.cross(normal), normal);
      const Real mass = 1 / (body.inverse_mass + body.radius * body.radius * body.spin.ease());
      const Real mu = Friction<Real>::between(grips.friction.of_body(static_cast<std::uint32_t>(id)),
                                              plane(p, id).friction);
      turn(id, body, normal, rub<Real>(slip, mass, mu * pressing, given));
    }
  }
  /// After the normal impulses are relaxed; `last`: for the last time in this substep, which is counted.
  SIM_HD void rub_all(int id, Body& body, bool last) const {
    if constexpr (rubbed) {
      for (int p = 0; p < count(); ++p) {
        if (!is_at(body, p)) continue;
        const std::int64_t here = place(p, id);
        rub_plane(id, body, p, plane(p, id).normal, impulse[here], grips.impulse[here]);
        if (!last || !(impulse[here] > 0)) continue;
        grips.pressed[here] += impulse[here];
        grips.total[here] += grips.impulse[here];
      }
    }
  }

  /// One sweep. `relaxing`: after the move, when no contact may begin that the next move closes. `before`:
  /// the velocity before forces acted in this substep, where this is the first.
  SIM_HD void solve(int id, Body& body, bool relaxing, const Vector3<Real>* before) const {
    for (int p = 0; p < count(); ++p) {
      if constexpr (boxed)
        if (p >= plane_count && (relaxing ? plane(p, id).normal.dot(plane(p, id).normal) == 0
                                          : !foresee(p - plane_count, id, body)))
          continue;
      const WallPlane<Real> surface = plane(p, id);
      const Vector3<Real> normal = surface.normal;
      Real gap = normal.dot(body.x) - surface.offset - body.radius;
      if (gap < 0) {
        const Vector3<Real> shift = -gap * normal;
        body.x += shift;
        body.moved = true;
        ledger[id].push_work -= static_cast<double>(body.mass * gravity.dot(shift));
        gap = 0;
      }
      const Real speed = normal.dot(body.v);
      const Real known = is_at(body, p) ? impulse[place(p, id)] : Real(0);
      if (relaxing && gap > 0 && !(known > 0)) continue;
      const Real next = max_of(known - body.mass * (speed + gap * inverse_h), Real(0));
      if (next == known) continue;
      impulse[place(p, id)] = next;
      come_to(id, body, p);
      if constexpr (boxed)
        if (p >= plane_count && next > 0) boxes.touched[place(p - plane_count, id)] = normal;
      if (before != nullptr && next > 0 && bounce[place(p, id)] < 0) {
        const Real start = -normal.dot(*before);
        using std::sqrt;
        const Real approach =
            start > 0 ? sqrt(max_of(start * start - 2 * gap * normal.dot(gravity), Real(0))) : Real(0);
        const Real e = restitution.between(restitution.of_body(static_cast<std::uint32_t>(id)),
                                           surface.restitution, approach);
        bounce[place(p, id)] = e * max_of(approach, Real(0));
      }
      give(id, body, normal, next - known);
    }
    if constexpr (boxed)
      if (!relaxing) hold_boxes(id, body);
  }

  SIM_HD Body load(int id) const {
    Body body = approach(id);
    load_rest(id, body);
    return body;
  }
  /// What meets() asks for.
  SIM_HD Body approach(int id) const {
    Body body;
    body.x = bodies.position[id];
    body.v = bodies.velocity[id];
    body.radius = bodies.radius[id];
    body.at = at != nullptr ? at[id] : 0;
    return body;
  }
  SIM_HD void load_rest(int id, Body& body) const {
    body.mass = bodies.mass[id];
    body.inverse_mass = bodies.inverse_mass[id];
    if constexpr (rubbed) body.spin = Spin<Real>::of(bodies, static_cast<std::uint32_t>(id));
  }
  SIM_HD void store(int id, const Body& body) const {
    if (body.moved) bodies.position[id] = body.x;
    if (!body.given) return;
    bodies.velocity[id] = body.v;
    if constexpr (rubbed) bodies.angular_velocity[id] = body.spin.rate;
  }
};

}  // namespace collidoscope
