#pragma once
// Impacts of a body at planes and box obstacles in one sweep (impact.h, impact_sweeps.h). A view; does not
// own memory.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/solver/box_surface.h"
#include "sim_cuda/solver/impact.h"
#include "sim_cuda/solver/soft_walls.h"
#include "sim_cuda/solver/walls.h"

namespace collidoscope {

template <class Real, bool with_friction, bool with_box_obstacles>
struct PlaneImpacts {
  using Walls = SoftWalls<Real, with_friction, with_box_obstacles>;
  using Body = typename Walls::Body;

  const Walls& walls;
  const ImpactLaw<Real>& law;
  Vector3<Real> pull;  ///< acceleration of the body, m/s^2
  Real rest;           ///< speed of slow impacts, m/s (ImpactLaw::rest_speed())

  /// False if resolve() would do nothing. Needs only SoftWalls::load_motion().
  SIM_HD bool may_bounce(const Body& body) const {
    bool any = with_box_obstacles;
    const Real time = Real(1.0001) * law.reach_time();  // more than in meets(), for rounding
    const Vector3<Real> way = time * (body.v.cwiseAbs() + law.h * pull.cwiseAbs());
    if (!any && walls.clear.contains(body.x, body.radius, way)) return false;
    for (int p = 0; p < walls.plane_count && !any; ++p) any = meets(walls.planes[p], body);
    return any;
  }

  /// One sweep over the planes of a body. Returns true if the body got an impulse. `growth`: factor of `rest`
  /// if the body rebounds. `may_shift`: the body has no contacts, so an impact may move it to the surface
  /// (impact.h). `driven`: see ShockMarks.
  template <bool unequal_moments>
  SIM_HD bool resolve(int id, Body& body, Real growth, bool may_shift, bool driven) const {
    bool any = false;
    for (int p = 0; p < walls.count(); ++p) {
      const WallPlane<Real>& surface = plane(p, body);
      if (!meets(surface, body)) continue;
      const Vector3<Real> normal = surface.normal;
      const Real approach = -normal.dot(body.v), acceleration = -normal.dot(pull);
      const Real gap = max_of(normal.dot(body.x) - surface.offset - body.radius, Real(0));
      using std::sqrt;
      const Real speed = sqrt(body.v.dot(body.v));
      const std::int64_t here = walls.index(p, id);
      const Real load = Walls::is_active(body, p) ? walls.impulse[here] : Real(0);
      const Real load_speed = driven && !with_friction ? Real(0) : load * body.inverse_mass;
      if (!(approach > law.threshold(rest, speed, load_speed))) continue;
      if (walls.ends_at_plane(id, body, p)) continue;
      const Real arrival = sqrt(max_of(approach * approach + 2 * acceleration * gap, Real(0)));
      const Real e = law.restitution.between(law.restitution.of_body(static_cast<std::uint32_t>(id)),
                                             surface.restitution, arrival);
      if (e > 0 && !(approach > law.threshold(growth * rest, speed, load_speed))) continue;
      Real separation = may_shift && e < 1 ? Real(0) : law.separation(approach, gap, acceleration, e);
      if (!(e > 0)) {
        separation = -gap / law.h;
        // At this speed, a fast body would pass the edge of a box before it touches.
        const bool is_fast = speed > body.radius * walls.inverse_h;
        if (may_shift || (is_fast && p >= walls.plane_count)) continue;
        if (!(approach + separation > rest + law.rounding * speed)) continue;
      } else if (!(separation > 0)) {
        separation = e * arrival;
        body.x -= gap * normal;
        body.moved = true;
      }
      if (e > 0 && p < plane_mask_bits) walls.bounced_mask[id] |= std::uint32_t{1} << p;
      const bool leaves = e > 0 && Walls::is_active(body, p);
      const Real change = body.mass * (approach + separation);
      walls.apply_normal_impulse(id, body, normal, change);
      if (leaves) walls.impulse[here] = 0;
      if constexpr (with_friction) {
        if (leaves) walls.friction.impulse[here] = Vector3<Real>::Zero();
        Vector3<Real> sum = Vector3<Real>::Zero();
        walls.template apply_plane_friction<unequal_moments>(id, body, normal, change, sum, surface.friction);
      }
      any = true;
    }
    return any;
  }

 private:
  /// Surface p. Boxes: the plane that the body touches, or meets in the substep.
  SIM_HD decltype(auto) plane(int p, [[maybe_unused]] const Body& body) const {
    if constexpr (with_box_obstacles) {
      if (p >= walls.plane_count) {
        const BoxSurface<Real>& box = walls.boxes.view.boxes[p - walls.plane_count];
        const ContactPlane<Real> met =
            box.gap(body.x, body.radius) > 0
                ? box.first_plane_on_path(body.x, law.reach_time() * (body.v + law.h * pull), body.radius)
                : box.contact_plane_at(body.x);
        return WallPlane<Real>{met.normal, met.offset, box.restitution, box.friction};
      }
      return WallPlane<Real>(walls.planes[p]);
    } else {
      return (walls.planes[p]);
    }
  }
  /// True if the body meets the surface within the law's time, at more than `rest`. In free flight, or in a
  /// step of Euler's method if other impulses act.
  SIM_HD bool meets(const WallPlane<Real>& surface, const Body& body) const {
    const Real approach = -surface.normal.dot(body.v);
    if (!(approach > rest)) return false;
    const Real gap = max_of(surface.normal.dot(body.x) - surface.offset - body.radius, Real(0));
    const Real acceleration = -surface.normal.dot(pull);
    return gap < law.reach_time() * (approach + law.h * max_of(acceleration / 2, acceleration));
  }
};

}  // namespace collidoscope
