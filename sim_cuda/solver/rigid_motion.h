#pragma once
// The rigid motion that has the mass, momentum and angular momentum of several bodies. The motion relative to
// it can be scaled without a change of momentum or angular momentum. Pure functions.

#include <cstdint>

#include "sim_cuda/core/arithmetic.h"
#include "sim_cuda/core/host_device.h"
#include "sim_cuda/core/linear_algebra.h"
#include "sim_cuda/solver/small_matrix.h"

namespace collidoscope {

struct RigidMotion {
  Vector3d centre{0, 0, 0}, velocity{0, 0, 0}, spin{0, 0, 0};  ///< m, m/s, rad/s

  SIM_HD Vector3d velocity_at(const Vector3d& position) const {
    return velocity + spin.cross(Vector3d(position - centre));
  }
};

/// Sums over bodies. Arms are positions relative to an origin, velocities are relative to that of the origin.
struct RigidSums {
  /// 0: mass, 1 to 3: mass times arm, 4 to 6: momentum, 7 to 9: angular momentum, 10 to 15: inertia tensor
  /// about the origin: xx, yy, zz, xy, xz, yz.
  static constexpr std::uint32_t count = 16;
  /// Values of one kind have similar sizes.
  static constexpr std::uint32_t kinds = 5;
  double values[count] = {};

  SIM_HD static std::uint32_t kind_of(std::uint32_t value) {
    return value == 0 ? 0 : value < 10 ? (value + 2) / 3 : 4;
  }
  SIM_HD double largest(std::uint32_t kind) const {
    double largest = 0;
    for (std::uint32_t k = 0; k < count; ++k)
      if (kind_of(k) == kind) largest = max_of(largest, values[k] < 0 ? -values[k] : values[k]);
    return largest;
  }
  SIM_HD void add(double mass, const Vector3d& arm, const Vector3d& velocity) {
    values[0] += mass;
    const Vector3d momentum = mass * velocity, angular = arm.cross(momentum);
    for (int k = 0; k < 3; ++k) {
      values[1 + k] += mass * arm[k];
      values[4 + k] += momentum[k];
      values[7 + k] += angular[k];
    }
    add_point_inertia(mass, arm);
  }
  /// Adds the rotation of a body: its principal moments, its orientation and its angular velocity.
  SIM_HD void add_rotation(const Vector3d& inertia, const Quaterniond& axes, const Vector3d& w) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d axis = axes * unit_vector(k);
      const Vector3d by_axis = inertia[k] * axis;
      for (int row = 0; row < 3; ++row) {
        values[7 + row] += axis.dot(w) * by_axis[row];
        values[10 + row] += axis[row] * by_axis[row];
      }
      values[13] += axis[0] * by_axis[1];
      values[14] += axis[0] * by_axis[2];
      values[15] += axis[1] * by_axis[2];
    }
  }
  /// Relative to the origin and its velocity.
  SIM_HD RigidMotion motion() const {
    const double mass = values[0];
    RigidMotion rigid{Vector3d(values[1], values[2], values[3]) / mass,
                      Vector3d(values[4], values[5], values[6]) / mass, Vector3d(0, 0, 0)};
    const Vector3d angular =
        Vector3d(values[7], values[8], values[9]) - mass * rigid.centre.cross(rigid.velocity);
    RigidSums about_centre = *this;
    about_centre.add_point_inertia(-mass, rigid.centre);
    const double* tensor = about_centre.values + 10;
    const double regular = 1e-10 * (tensor[0] + tensor[1] + tensor[2]);  // bodies may lie on a line
    const Symmetric3<double> matrix{tensor[0] + regular, tensor[1] + regular, tensor[2] + regular,
                                    tensor[3],           tensor[4],           tensor[5]};
    rigid.spin = matrix.solve(angular);
    // One step of iterative refinement removes the effect of `regular`.
    const Vector3d spin = rigid.spin;
    const Vector3d by_spin(tensor[0] * spin[0] + tensor[3] * spin[1] + tensor[4] * spin[2],
                           tensor[3] * spin[0] + tensor[1] * spin[1] + tensor[5] * spin[2],
                           tensor[4] * spin[0] + tensor[5] * spin[1] + tensor[2] * spin[2]);
    rigid.spin += matrix.solve(Vector3d(angular - by_spin));
    return rigid;
  }

 private:
  SIM_HD void add_point_inertia(double mass, const Vector3d& arm) {
    const double square = arm.dot(arm);
    for (int k = 0; k < 3; ++k) values[10 + k] += mass * (square - arm[k] * arm[k]);
    values[13] -= mass * arm[0] * arm[1];
    values[14] -= mass * arm[0] * arm[2];
    values[15] -= mass * arm[1] * arm[2];
  }
};

}  // namespace collidoscope
