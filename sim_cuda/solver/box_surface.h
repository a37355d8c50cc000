#pragma once
// Contact planes between box obstacles and spheres. For one sphere and one substep, a box is replaced by a
// supporting plane of the box. The half-space behind that plane contains the box, so a sphere that stays in
// front of the plane cannot pass the box.
//
// `contact_plane_at` returns the plane for a sphere that touches: at the nearest point, or at the nearest
// face if the centre is inside. `first_plane_on_path` returns the plane that a moving sphere meets first.
// It advances the sphere from supporting plane to supporting plane until it reaches or passes the box
// enlarged by the radius.
//
// Required if the scene has box obstacles. Each body tests each box, so the cost is bodies x boxes;
// intended for dozens of boxes. Pure functions.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// The half-space normal . x >= offset, in which a body must stay. none(): no contact.
template <class Real>
struct ContactPlane {
  Vector3<Real> normal;  ///< unit; 0 for none()
  Real offset;           ///< m

  SIM_HD static ContactPlane none() { return {Vector3<Real>::Zero(), Real(-1e30)}; }
  SIM_HD bool is_none() const { return normal.dot(normal) == 0; }
};

template <class Real>
struct BoxSurface {
  Vector3<Real> center, half;  ///< m
  Vector3<Real> side[3];       ///< box axes in world axes, unit
  Real restitution, friction;  ///< restitution 0 to 1; friction 0 to 100

  /// The nearest point of the surface to `p`, in the box's own axes.
  struct Nearest {
    Vector3<Real> normal;  ///< outward, unit, in the box's axes
    Real distance;         ///< m, < 0 if `p` is inside
    Real support;          ///< offset of the supporting plane (normal . x), m
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

  /// Distance between the box and a sphere, m; < 0 if they overlap.
  SIM_HD Real gap(const Vector3<Real>& x, Real radius) const {
    return nearest(own(x - center)).distance - radius;
  }
  SIM_HD ContactPlane<Real> contact_plane_at(const Vector3<Real>& x) const {
    return plane_of(nearest(own(x - center)));
  }

  /// The plane that a sphere at x meets along `displacement` (m). none() if it misses the box.
  SIM_HD ContactPlane<Real> first_plane_on_path(const Vector3<Real>& x, const Vector3<Real>& displacement,
                                                Real radius) const {
    constexpr int max_iterations = 16;  // two or three are usual; after 16 the plane is accurate enough
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

/// Box obstacles of the scene; `boxes` is in the executor's memory.
template <class Real>
struct BoxView {
  const BoxSurface<Real>* boxes = nullptr;
  int count = 0;
};

/// Contact state of bodies with boxes: index box * body count + body. Null without boxes.
template <class Real>
struct BoxContacts {
  BoxView<Real> view;
  ContactPlane<Real>* plane;  ///< contact plane in this substep
};

}  // namespace collidoscope
