#pragma once
// Box obstacles against spheres. To one sphere and for one substep, a box is the half-space beyond its
// supporting plane where they touch, or would: whatever else happens to the sphere, it cannot pass a box
// whose plane it does not pass. Which plane that is, `contact_plane_at` says of a sphere that touches (the
// nearest point; inside, the nearest face), and `first_plane_on_path` of one under way: it goes from
// supporting plane to supporting plane, each of which the way is free to, until it is at the box grown by the
// radius, or past it.
//
// Called for by a list of boxes among the obstacles. Every body looks at every box: meant for dozens.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Bodies stay where normal . x >= offset; none: they are nowhere near.
template <class Real>
struct ContactPlane {
  Vector3<Real> normal;  ///< unit; 0: none
  Real offset;           ///< m

  SIM_HD static ContactPlane none() { return {Vector3<Real>::Zero(), Real(-1e30)}; }
  SIM_HD bool is_none() const { return normal.dot(normal) == 0; }
};

template <class Real>
struct BoxSurface {
  Vector3<Real> center, half;  ///< m
  Vector3<Real> side[3];       ///< unit, its axes in the world's
  Real restitution, friction;  ///< 0 to 1; 0 to 100

  /// The nearest point, seen from `p` in the box's own axes: which way out, and how far.
  struct Nearest {
    Vector3<Real> normal;  ///< unit, in the box's axes
    Real distance;         ///< m, < 0 inside
    Real support;          ///< m, normal . x of the supporting plane
  };
  SIM_HD Nearest nearest(const Vector3<Real>& p) const {
    Vector3<Real> at;
    for (int k = 0; k < 3; ++k) at[k] = clamp_to(p[k], -half[k], half[k]);
    const Vector3<Real> out = p - at;
    using std::sqrt;
    const Real distance = sqrt(out.dot(out));
    if (distance > 0) {
      const Vector3<Real> normal = out / distance;
      return {normal, distance, normal.dot(at)};
    }
    int axis = 0;
    Real depth = half[0] - (p[0] < 0 ? -p[0] : p[0]);
    for (int k = 1; k < 3; ++k) {
      const Real other = half[k] - (p[k] < 0 ? -p[k] : p[k]);
      if (other < depth) {
        depth = other;
        axis = k;
      }
    }
    Vector3<Real> normal = Vector3<Real>::Zero();
    normal[axis] = p[axis] < 0 ? Real(-1) : Real(1);
    return {normal, -depth, half[axis]};
  }

  SIM_HD Vector3<Real> own(const Vector3<Real>& v) const {
    return {side[0].dot(v), side[1].dot(v), side[2].dot(v)};
  }
  SIM_HD ContactPlane<Real> plane_of(const Nearest& near) const {
    const Vector3<Real> normal =
        near.normal.x() * side[0] + near.normal.y() * side[1] + near.normal.z() * side[2];
    return {normal, normal.dot(center) + near.support};
  }

  /// m between the box and a sphere, < 0 where they overlap.
  SIM_HD Real gap(const Vector3<Real>& x, Real radius) const {
    return nearest(own(x - center)).distance - radius;
  }
  SIM_HD ContactPlane<Real> contact_plane_at(const Vector3<Real>& x) const {
    return plane_of(nearest(own(x - center)));
  }

  /// Of a sphere at x that will go by `displacement`, m.
  SIM_HD ContactPlane<Real> first_plane_on_path(const Vector3<Real>& x, const Vector3<Real>& displacement,
                                                Real radius) const {
    constexpr int max_iterations =
        16;  // two or three are usual; where that is not enough, the plane is near enough
    const Vector3<Real> from = own(x - center), along = own(displacement);
    const Real touching = Real(1e-5) * radius;
    Real t = 0;
    for (int k = 0;; ++k) {
      const Nearest near = nearest(from + t * along);
      const Real gap = near.distance - radius, approach = -near.normal.dot(along);
      if (!(approach > 0)) return ContactPlane<Real>::none();
      if (gap <= touching || k == max_iterations) return plane_of(near);
      t += gap / approach;
      if (!(t <= 1)) return ContactPlane<Real>::none();
    }
  }
};

/// In the executor's memory.
template <class Real>
struct BoxView {
  const BoxSurface<Real>* boxes = nullptr;
  int count = 0;
};

/// What a step keeps of bodies and boxes; box by box, all bodies of each. Null without boxes.
template <class Real>
struct BoxContacts {
  BoxView<Real> view;
  ContactPlane<Real>* plane;  ///< of this substep
  Vector3<Real>* normal;      ///< unit, along which it touched last in this step
};

}  // namespace collidoscope
