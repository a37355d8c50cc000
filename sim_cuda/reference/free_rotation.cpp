#include "sim_cuda/reference/free_rotation.h"

#include <cmath>

#include "sim_cuda/reference/jacobi_elliptic.h"

namespace collidoscope {

Quaterniond symmetric_top(const Vector3d& inertia, const Vector3d& spin, double t) {
  const Vector3d momentum = inertia.cwiseProduct(spin);
  const double size = momentum.norm();
  if (size == 0) return Quaterniond(1, 0, 0, 0);
  const Quaterniond about_l(Eigen::AngleAxisd(size / inertia.x() * t, Vector3d(momentum / size)));
  const Quaterniond about_axis(
      Eigen::AngleAxisd((1 - inertia.z() / inertia.x()) * spin.z() * t, Vector3d(0, 0, 1)));
  return about_l * about_axis;
}

Vector3d middle_axis_spin(const Vector3d& inertia, const Vector3d& spin, double t) {
  const double i1 = inertia.x(), i2 = inertia.y(), i3 = inertia.z();
  const double twice_energy = inertia.dot(spin.cwiseProduct(spin));
  const double squared = inertia.cwiseProduct(spin).squaredNorm();
  // L^2 - 2 E I1 and 2 E I3 - L^2: both > 0.
  const double over_1 = squared - twice_energy * i1, below_3 = twice_energy * i3 - squared;
  const double u = std::sqrt((i3 - i2) * over_1 / (i1 * i2 * i3));
  const double m = (i2 - i1) * below_3 / ((i3 - i2) * over_1);
  const JacobiElliptic e = jacobi_elliptic(u * t, m);
  return {spin.x() * e.cn, std::sqrt(below_3 / (i2 * (i3 - i2))) * e.sn, spin.z() * e.dn};
}

}  // namespace collidoscope
