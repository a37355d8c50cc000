#pragma once
// Vector and quaternion types of the simulator: Eigen's fixed-size types, stored unaligned and without SIMD.
// g++ and nvcc therefore agree on sizes and on all result bits. The required definitions are PUBLIC on the
// target `linear_algebra`.
//
// Code that computes the state uses + - * / and sqrt only. Do not call libm functions there (sin, pow, exp,
// cbrt...): they are not correctly rounded, and differ by version.

#include <Eigen/Core>
#include <Eigen/Geometry>

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

static_assert(sizeof(Vector3f) == 12 && sizeof(Vector3d) == 24);
static_assert(sizeof(Quaternionf) == 16 && sizeof(Quaterniond) == 32);

}  // namespace collidoscope
