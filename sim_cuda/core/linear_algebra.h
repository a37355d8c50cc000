#pragma once
// Vector and quaternion types of the simulator: Eigen's fixed-size types, stored unaligned and without SIMD.
// g++ and nvcc therefore agree on sizes and on all result bits. The required definitions are PUBLIC on the
// target `linear_algebra`.
//
// Code that computes the state uses + - * / and sqrt only. Do not call libm functions there (sin, pow, exp,
// cbrt...): they are not correctly rounded, and differ by version.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "sim_cuda/core/host_device.h"

namespace collidoscope {

template <class Real>
using Vector3 = Eigen::Matrix<Real, 3, 1>;
template <class Real>
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
template <class Real>
using Quaternion = Eigen::Quaternion<Real>;

using Vector3d = Vector3<double>;
inline Vector3d vector_of(const double (&v)[3]) { return {v[0], v[1], v[2]}; }
using Vector3f = Vector3<float>;
using Matrix3d = Matrix3<double>;
using Quaterniond = Quaternion<double>;
using Quaternionf = Quaternion<float>;

SIM_HD inline Vector3d unit_vector(int component) {
  return {component == 0 ? 1.0 : 0.0, component == 1 ? 1.0 : 0.0, component == 2 ? 1.0 : 0.0};
}
template <class Real>
SIM_HD Vector3d widened(const Vector3<Real>& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}
template <class Real>
SIM_HD Quaterniond widened(const Quaternion<Real>& q) {
  return {static_cast<double>(q.w()), static_cast<double>(q.x()), static_cast<double>(q.y()),
          static_cast<double>(q.z())};
}

static_assert(sizeof(Vector3f) == 12 && sizeof(Vector3d) == 24);
static_assert(sizeof(Quaternionf) == 16 && sizeof(Quaterniond) == 32);

}  // namespace collidoscope
