// Tests mass, centre and inertia of triangle meshes against closed forms, and the principal axes.
#include "sim_cuda/scene/mass_properties.h"

#include <gtest/gtest.h>

#include <vector>

namespace collidoscope {
namespace {

using Faces = std::vector<std::array<std::uint32_t, 3>>;

struct Solid {
  std::vector<Vector3d> vertices;
  Faces faces;
};

/// A box with edge lengths `size` about the origin: 12 triangles, counter-clockwise from outside.
Solid box(const Vector3d& size) {
  Solid solid;
  for (int i = 0; i < 8; ++i) {
    solid.vertices.emplace_back((i & 1 ? 0.5 : -0.5) * size[0], (i & 2 ? 0.5 : -0.5) * size[1],
                                (i & 4 ? 0.5 : -0.5) * size[2]);
  }
  solid.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                 {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return solid;
}

Vector3d box_moments(const Vector3d& s) {
  const double volume = s[0] * s[1] * s[2];
  return volume / 12 *
         Vector3d(s[1] * s[1] + s[2] * s[2], s[2] * s[2] + s[0] * s[0], s[0] * s[0] + s[1] * s[1]);
}

Solid moved(Solid solid, const Quaterniond& turn, const Vector3d& shift) {
  for (Vector3d& v : solid.vertices) v = turn * v + shift;
  return solid;
}

TEST(MassProperties, UnitCube) {
  const Solid cube = box({1, 1, 1});
  const MassProperties mass = mass_properties(cube.vertices, cube.faces);
  EXPECT_DOUBLE_EQ(mass.volume, 1);
  EXPECT_TRUE(mass.center.isZero(1e-15));
  EXPECT_TRUE(mass.inertia.isApprox(Matrix3d::Identity() / 6, 1e-14)) << mass.inertia;
}

TEST(MassProperties, BoxAgainstItsFormula) {
  const Vector3d size(1, 2, 5);
  const Solid solid = box(size);
  const MassProperties mass = mass_properties(solid.vertices, solid.faces);
  EXPECT_DOUBLE_EQ(mass.volume, 10);
  EXPECT_TRUE(mass.inertia.isApprox(Matrix3d(box_moments(size).asDiagonal()), 1e-14)) << mass.inertia;
}

TEST(MassProperties, CornerTetrahedronAgainstItsFormula) {
  // Vertices (0,0,0), (a,0,0), (0,b,0), (0,0,c): volume abc/6, centre (a,b,c)/4. About the centre, Ixx = V 3
  // (b^2 + c^2) / 80 and Ixy = +V a b / 80. These follow from the integrals of y^2, V b^2/10, and of xy, V
  // ab/20.
  const double a = 2, b = 3, c = 7, volume = a * b * c / 6;
  const std::vector<Vector3d> vertices{{0, 0, 0}, {a, 0, 0}, {0, b, 0}, {0, 0, c}};
  const Faces faces{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const MassProperties mass = mass_properties(vertices, faces);
  EXPECT_NEAR(mass.volume, volume, 1e-13);
  EXPECT_TRUE(mass.center.isApprox(Vector3d(a, b, c) / 4, 1e-14));
  Matrix3d expected;
  expected << 3 * (b * b + c * c), a * b, a * c, a * b, 3 * (a * a + c * c), b * c, a * c, b * c,
      3 * (a * a + b * b);
  EXPECT_TRUE(mass.inertia.isApprox(expected * volume / 80, 1e-13)) << mass.inertia;
}

TEST(MassProperties, FarFromTheOriginLosesOnlyWhatTheVerticesLose) {
  const Vector3d size(1, 2, 5), shift(1e5, -2e5, 3e5);
  const Solid solid = moved(box(size), Quaterniond::Identity(), shift);
  const MassProperties mass = mass_properties(solid.vertices, solid.faces);
  EXPECT_NEAR(mass.volume, 10, 1e-9);
  EXPECT_TRUE(mass.center.isApprox(shift, 1e-15));
  EXPECT_TRUE(mass.inertia.isApprox(Matrix3d(box_moments(size).asDiagonal()), 1e-9));
}

TEST(MassProperties, TurnedInsideOutIsNegative) {
  Solid solid = box({1, 1, 1});
  for (auto& face : solid.faces) std::swap(face[1], face[2]);
  EXPECT_DOUBLE_EQ(mass_properties(solid.vertices, solid.faces).volume, -1);
}

TEST(PrincipalAxes, OfATurnedBox) {
  const Vector3d size(1, 2, 5);
  for (const Quaterniond& turn :
       {Quaterniond(1, 0, 0, 0), Quaterniond(0.5, 0.5, 0.5, 0.5), Quaterniond(0.1, -0.7, 0.3, 0.6),
        Quaterniond(-0.2, 0.1, 0.9, 0.05), Quaterniond(1, 1e-3, 0, 0), Quaterniond(1, 1e-9, 0, 1e-9)}) {
    const Solid solid = moved(box(size), turn.normalized(), {3, -4, 5});
    const MassProperties mass = mass_properties(solid.vertices, solid.faces);
    const PrincipalAxes principal = principal_axes(mass.inertia);
    // The smallest moment comes first: the one about the long axis.
    const Vector3d moments = box_moments(size);
    EXPECT_TRUE(principal.moments.isApprox(Vector3d(moments[2], moments[1], moments[0]), 1e-12));
    const Matrix3d r = principal.axes.toRotationMatrix();
    EXPECT_NEAR(r.determinant(), 1, 1e-14);
    EXPECT_GE(principal.axes.w(), 0);
    const Matrix3d rebuilt = r * principal.moments.asDiagonal() * r.transpose();
    EXPECT_TRUE(rebuilt.isApprox(mass.inertia, 1e-12)) << rebuilt << "\n\n" << mass.inertia;
  }
}

TEST(PrincipalAxes, EqualMomentsKeepTheAxes) {
  for (const Vector3d& size : {Vector3d(1, 1, 1), Vector3d(2, 2, 1), Vector3d(3, 3, 3)}) {
    const Solid solid = moved(box(size), Quaterniond::Identity(), {0.1, 0.2, 0.3});
    const PrincipalAxes principal = principal_axes(mass_properties(solid.vertices, solid.faces).inertia);
    EXPECT_TRUE(principal.axes.isApprox(Quaterniond::Identity(), 1e-15)) << principal.axes.coeffs();
  }
  // All moments of a cube are equal, so the axes stay as they are after a rotation.
  const Solid turned = moved(box({1, 1, 1}), Quaterniond(0.1, -0.7, 0.3, 0.6).normalized(), {0, 0, 0});
  const PrincipalAxes principal = principal_axes(mass_properties(turned.vertices, turned.faces).inertia);
  EXPECT_TRUE(principal.axes.isApprox(Quaterniond::Identity(), 1e-15)) << principal.axes.coeffs();
}

}  // namespace
}  // namespace collidoscope
