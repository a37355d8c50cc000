#pragma once
// Volume, centre of mass and inertia of the solid that a closed triangle mesh encloses, and the principal
// axes of an inertia tensor. Only + - * / and sqrt: the results decide how a body turns.

#include <array>
#include <cstdint>
#include <span>

#include "sim_cuda/core/linear_algebra.h"

namespace collidoscope {

/// Of a solid of density 1.
struct MassProperties {
  double volume = 0;                    ///< m^3; negative where the faces are clockwise seen from outside
  Vector3d center{0, 0, 0};             ///< m, the centre of mass
  Matrix3d inertia = Matrix3d::Zero();  ///< m^5, about the centre of mass, along the mesh's own axes
};

/// Exact integrals of the polynomials 1, x, x^2, xy over the solid, by the divergence theorem: each becomes a
/// sum over faces. Brian Mirtich, "Fast and accurate computation of polyhedral mass properties" (1996), in
/// the closed form for triangles of David Eberly, "Polyhedral mass properties (revisited)" (2002).
MassProperties mass_properties(std::span<const Vector3d> vertices,
                               std::span<const std::array<std::uint32_t, 3>> faces);

/// m^3.
double sphere_volume(double radius);

/// Principal moments of inertia of a sphere of constant density, kg m^2.
Vector3d sphere_inertia(double mass, double radius);

struct PrincipalAxes {
  Vector3d moments;  ///< smallest first; moments equal to 1e-9 keep the order of the axes they belong to
  Quaterniond axes;  ///< turns the principal axes (right-handed) into the axes of the tensor; w >= 0
};

/// Diagonalises a symmetric tensor by Jacobi's method. Products of inertia below 1e-12 of the largest moment
/// are rounding and count as 0, so that a box or a cube along the axes keeps them.
PrincipalAxes principal_axes(const Matrix3d& inertia);

}  // namespace collidoscope
