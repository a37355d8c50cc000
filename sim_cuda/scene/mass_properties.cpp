#include "sim_cuda/scene/mass_properties.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <numbers>
#include <utility>

namespace collidoscope {
namespace {

/// Sums of monomials of one coordinate over a triangle's corners. They give the face integrals of w, w^2, w^3
/// and of w^2 times another coordinate.
struct CornerSums {
  double first, second, third;  ///< complete homogeneous polynomials of degree 1, 2, 3 in the corners
  double weight[3];             ///< weights of the corners for products with another coordinate

  CornerSums(double w0, double w1, double w2) {
    first = w0 + w1 + w2;
    const double pair = w0 * w0 + w1 * (w0 + w1);
    second = pair + w2 * first;
    third = w0 * (w0 * w0) + w1 * pair + w2 * second;
    weight[0] = second + w0 * (first + w0);
    weight[1] = second + w1 * (first + w1);
    weight[2] = second + w2 * (first + w2);
  }
};

}  // namespace

MassProperties mass_properties(std::span<const Vector3d> vertices,
                               std::span<const std::array<std::uint32_t, 3>> faces) {
  MassProperties result;
  if (vertices.empty()) return result;
  // Integrate relative to the middle of the mesh, so that a mesh far from the origin keeps its precision.
  Vector3d low = vertices[0], high = vertices[0];
  for (const Vector3d& v : vertices) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Vector3d origin = (low + high) / 2;

  double volume = 0;                    // integral of 1
  Vector3d moment = Vector3d::Zero();   // integrals of x, y, z
  Vector3d square = Vector3d::Zero();   // integrals of x^2, y^2, z^2
  Vector3d product = Vector3d::Zero();  // integrals of xy, yz, zx
  for (const auto& face : faces) {
    const Vector3d p[3] = {vertices[face[0]] - origin, vertices[face[1]] - origin,
                           vertices[face[2]] - origin};
    const Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);  // length: twice the triangle's area
    for (int axis = 0; axis < 3; ++axis) {
      const CornerSums sums(p[0][axis], p[1][axis], p[2][axis]);
      const int next = (axis + 1) % 3;
      if (axis == 0) volume += normal[axis] * sums.first;
      moment[axis] += normal[axis] * sums.second;
      square[axis] += normal[axis] * sums.third;
      product[axis] += normal[axis] * (p[0][next] * sums.weight[0] + p[1][next] * sums.weight[1] +
                                       p[2][next] * sums.weight[2]);
    }
  }
  volume /= 6;
  moment /= 24;
  square /= 60;
  product /= 120;
  result.volume = volume;
  if (volume == 0) return result;

  const Vector3d c = moment / volume;
  result.center = origin + c;
  const Vector3d about = square - volume * c.cwiseProduct(c);
  const double xy = product[0] - volume * c[0] * c[1];
  const double yz = product[1] - volume * c[1] * c[2];
  const double zx = product[2] - volume * c[2] * c[0];
  result.inertia << about[1] + about[2], -xy, -zx,  //
      -xy, about[2] + about[0], -yz,                //
      -zx, -yz, about[0] + about[1];
  return result;
}

PrincipalAxes principal_axes(const Matrix3d& inertia) {
  Matrix3d tensor = inertia;
  Matrix3d axes = Matrix3d::Identity();
  const double tiny = 1e-12 * tensor.diagonal().maxCoeff();
  for (int sweep = 0; sweep < 32; ++sweep) {  // quadratic convergence: five or six sweeps suffice
    bool turned = false;
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      if (!(tensor(p, q) > tiny || tensor(p, q) < -tiny)) continue;
      Eigen::JacobiRotation<double> rotation;
      rotation.makeJacobi(tensor, p, q);
      tensor.applyOnTheLeft(p, q, rotation.adjoint());
      tensor.applyOnTheRight(p, q, rotation);
      axes.applyOnTheRight(p, q, rotation);
      turned = true;
    }
    if (!turned) break;
  }

  PrincipalAxes result;
  result.moments = tensor.diagonal();
  for (const auto& [p, q] : {std::pair{0, 1}, std::pair{1, 2}, std::pair{0, 1}}) {
    if (result.moments[p] > result.moments[q] * (1 + 1e-9)) {
      std::swap(result.moments[p], result.moments[q]);
      axes.col(p).swap(axes.col(q));
    }
  }
  if (axes.determinant() < 0) axes.col(2) = -axes.col(2);
  result.axes = Quaterniond(axes);
  result.axes.normalize();
  if (result.axes.w() < 0) result.axes.coeffs() = -result.axes.coeffs();
  return result;
}

double sphere_volume(double radius) { return 4.0 / 3 * std::numbers::pi * (radius * radius * radius); }

Vector3d sphere_inertia(double mass, double radius) {
  const double moment = 0.4 * mass * radius * radius;
  return {moment, moment, moment};
}

}  // namespace collidoscope
