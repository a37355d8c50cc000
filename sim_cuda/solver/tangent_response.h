#pragma once
// Change of the slip velocity at a contact by a friction impulse, as a symmetric 2 x 2 matrix in the plane of
// contact, 1/kg. Only for bodies of anisotropic inertia: for others, the matrix is a number.
//
// A number that bounds the matrix would do in a converged solution. But with few iterations, a slender body
// would keep friction impulses of earlier substeps that it needs no more.

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/solver/friction.h"

namespace collidoscope {

template <class Real>
class TangentResponse {
 public:
  /// `inverse_mass`: of both bodies, 1/kg; `normal`: of the contact, a unit vector.
  SIM_HD TangentResponse(const Vector3<Real>& normal, Real inverse_mass)
      : x_(perpendicular(normal)),
        y_(normal.cross(x_)),
        least_(inverse_mass),
        xx_(inverse_mass),
        xy_(0),
        yy_(inverse_mass) {}

  /// Adds the rotation of a body. `squared_arm`: m^2; times the number of parts of the body, if it is split.
  SIM_HD void add(const AngularState<Real>& angular, Real squared_arm) {
    if (angular.is_isotropic()) {
      xx_ += squared_arm / angular.inertia.x();
      yy_ += squared_arm / angular.inertia.x();
      return;
    }
    // The moment of an impulse along x has the direction of y, that of an impulse along y the opposite of x.
    const Vector3<Real> by_x = angular.axes.conjugate() * y_, by_y = angular.axes.conjugate() * x_;
    for (int k = 0; k < 3; ++k) {
      const Real factor = squared_arm / angular.inertia[k];
      xx_ += factor * by_x[k] * by_x[k];
      xy_ -= factor * by_x[k] * by_y[k];
      yy_ += factor * by_y[k] * by_y[k];
    }
  }

  /// The impulse of length `limit` at most, N s, that leaves the least kinetic energy. `slip`: the present
  /// velocity, m/s, with the impulse `accumulated`, N s.
  SIM_HD Vector3<Real> solve(const Vector3<Real>& slip, const Vector3<Real>& accumulated, Real limit) const {
    using std::sqrt;
    if (!(limit > least_limit)) return Vector3<Real>::Zero();
    const double xx = xx_, xy = xy_, yy = yy_, length = limit;
    // Principal axes: the larger value first.
    const double mean = (xx + yy) / 2, half = (xx - yy) / 2, radius = sqrt(half * half + xy * xy),
                 first = mean + radius,
                 second = max_of((xx * yy - xy * xy) / first, static_cast<double>(least_)),
                 cosine = radius > 0 ? sqrt(max_of((1 + half / radius) / 2, 0.0)) : 1.0,
                 magnitude = sqrt(max_of(1 - cosine * cosine, 0.0)), sine = xy < 0 ? -magnitude : magnitude;
    const double slip_x = slip.dot(x_), slip_y = slip.dot(y_), x = accumulated.dot(x_),
                 y = accumulated.dot(y_);
    // Slip without friction, along the principal axes.
    const double u = cosine * slip_x + sine * slip_y - first * (cosine * x + sine * y),
                 v = cosine * slip_y - sine * slip_x - second * (cosine * y - sine * x);
    // The impulse is -(u / (first + shift), v / (second + shift)); shift > 0 if the contact slides.
    double shift = 0, p = u / first, q = v / second;
    if (p * p + q * q > length * length) {
      // Newton's method for 1 / |impulse| = 1 / limit.
      shift = max_of(sqrt(u * u + v * v) / length - first, 0.0);
      for (int step = 0; step < newton_steps; ++step) {
        p = u / (first + shift);
        q = v / (second + shift);
        const double squared = p * p + q * q;
        shift +=
            (sqrt(squared) / length - 1) * squared / (p * p / (first + shift) + q * q / (second + shift));
      }
      p = u / (first + shift);
      q = v / (second + shift);
    }
    return clamp_length<Real>(
        static_cast<Real>(sine * q - cosine * p) * x_ - static_cast<Real>(sine * p + cosine * q) * y_, limit);
  }

 private:
  static constexpr int newton_steps = 4;
  static constexpr double least_limit = 1e-100;  ///< N s; prevents underflow
  SIM_HD static Vector3<Real> perpendicular(const Vector3<Real>& normal) {
    const Vector3<Real> other =
        normal.x() * normal.x() < Real(0.5) ? Vector3<Real>(1, 0, 0) : Vector3<Real>(0, 1, 0);
    const Vector3<Real> across = normal.cross(other);
    using std::sqrt;
    return across / sqrt(across.dot(across));
  }

  Vector3<Real> x_, y_;  ///< in the plane of contact
  Real least_;           ///< both eigenvalues are at least this, 1/kg
  Real xx_, xy_, yy_;
};

/// As solve_friction() with an effective mass.
template <class Real>
SIM_HD Vector3<Real> solve_friction(const Vector3<Real>& slip, const TangentResponse<Real>& response,
                                    Real limit, Vector3<Real>& accumulated) {
  const Vector3<Real> next = response.solve(slip, accumulated, limit);
  const Vector3<Real> change = next - accumulated;
  accumulated = next;
  return change;
}

}  // namespace collidoscope
