#pragma once
// Volume, centre of mass and inertia of the solid enclosed by a closed triangle mesh, and principal axes of
// an inertia tensor.
// Uses only + - * / and sqrt, because the results affect the state and must be the same on every platform.

#include <array>
#include <cstdint>
#include <span>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Mass properties of a solid of density 1.
struct MassProperties {
  double volume = 0;                    ///< m^3; negative if the faces are clockwise seen from outside
  Vector3d center{0, 0, 0};             ///< m, centre of mass
  Matrix3d inertia = Matrix3d::Zero();  ///< m^5, about the centre of mass, in the mesh's axes
};

/// Integrates the polynomials 1, x, x^2, xy over the solid. The divergence theorem turns each integral into
/// an exact sum over faces.
/// Brian Mirtich, "Fast and accurate computation of polyhedral mass properties" (1996), in the closed form
/// for triangles of David Eberly, "Polyhedral mass properties (revisited)" (2002).
MassProperties mass_properties(std::span<const Vector3d> vertices,
                               std::span<const std::array<std::uint32_t, 3>> faces);

/// m^3.
double sphere_volume(double radius);

/// Principal moments of inertia of a homogeneous sphere, kg m^2.
Vector3d sphere_inertia(double mass, double radius);

struct PrincipalAxes {
  Vector3d moments;  ///< ascending; moments equal within 1e-9 keep the order of their axes
  Quaterniond axes;  ///< rotation from the principal axes (right-handed) to the tensor's axes; w >= 0
};

/// Diagonalises a symmetric tensor by Jacobi's method. Off-diagonal entries below 1e-12 of the largest moment
/// count as 0, so an axis-aligned box keeps its axes.
PrincipalAxes principal_axes(const Matrix3d& inertia);

}  // namespace collidoscope
