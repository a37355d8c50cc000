#include "sim_cuda/solver/joint_rows.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "sim_cuda/core/series.h"
#include "sim_cuda/scene/mass_properties.h"

namespace collidoscope {
namespace {

// See joint_constraint.h. A warm-start factor of springs below 1 bounds the accumulated impulse if another
// constraint resists it.
constexpr double error_fraction = 0.8;  ///< of the error of a rigid joint that is corrected per substep
constexpr double alone_spring_factor = 0.95, coupled_spring_factor = 0.9;

constexpr double full_turn = 6.283185307179586;

/// What the rotation of both bodies adds to the inverse effective mass of a spring, 1/kg.
struct RotationalInverseMass {
  double start = 0;  ///< at time zero
  double most = 0;   ///< largest in any orientation
};

RotationalInverseMass rotational_inverse_mass(const PlacedJoint& joint, const InitialBodies& bodies,
                                              const std::vector<bool>& moves) {
  const auto axes_of = [&](std::uint32_t body) {
    return bodies.orientation.empty() ? Quaterniond(1, 0, 0, 0) : bodies.orientation[body];
  };
  const auto place_of = [&](std::uint32_t body, const Vector3d& anchor) {
    return body == PlacedJoint::world ? anchor : Vector3d(bodies.position[body] + axes_of(body) * anchor);
  };
  const Vector3d apart = place_of(joint.b, joint.anchor_b) - place_of(joint.a, joint.anchor_a);
  const double length = std::sqrt(apart.dot(apart));
  const Vector3d along = length > 0 ? Vector3d(apart / length) : Vector3d(0, 0, 1);
  RotationalInverseMass sum;
  const auto add = [&](std::uint32_t body, const Vector3d& anchor) {
    if (body == PlacedJoint::world || !moves[body]) return;
    const Vector3d inertia = bodies.inertia.empty() ? sphere_inertia(bodies.mass[body], bodies.radius[body])
                                                    : bodies.inertia[body];
    const Vector3d moment = anchor.cross(axes_of(body).conjugate() * along);
    for (int k = 0; k < 3; ++k) sum.start += moment[k] * moment[k] / inertia[k];
    sum.most += anchor.dot(anchor) / inertia.minCoeff();
  };
  add(joint.a, joint.anchor_a);
  add(joint.b, joint.anchor_b);
  return sum;
}

/// Phase angle of a spring per substep at time zero, rad. `joint_count`: largest number of joints at one of
/// its bodies. `ratio`: largest inverse effective mass over that at time zero. See joint_constraint.h.
double spring_angle(const PlacedJoint& joint, std::uint32_t joint_count, double ratio, double h) {
  return std::min(full_turn * joint.frequency * h, 1 / std::sqrt(joint_count * ratio));
}

JointStiffness<double> spring(const PlacedJoint& joint, std::uint32_t joint_count, double angle, double h) {
  const double z = joint.damping_ratio;
  const double scale = -expm1_series(-2 * z * angle);
  double bias = 0;  // (1 - p1) (1 - p2)
  if (z < 1) {
    const double decayed = -expm1_series(-z * angle);  // 1 - e
    const double half = cosine_sine(std::sqrt(1 - z * z) * angle / 2).sine;
    bias = decayed * decayed + 4 * (1 - decayed) * half * half;  // 1 - 2 e c + e^2
  } else {
    const double fast = z + std::sqrt(z * z - 1);
    bias = expm1_series(-angle * fast) * expm1_series(-angle / fast);
  }
  const double factor = joint_count > 1 ? coupled_spring_factor : alone_spring_factor;  // of the damping part
  return {scale, bias / h, 1 - scale, 1 - (1 - factor) * scale};
}

/// A unit vector perpendicular to `axis`.
Vector3d perpendicular_to(const Vector3d& axis) {
  const Vector3d other = std::abs(axis.x()) < 0.6 ? Vector3d(1, 0, 0) : Vector3d(0, 1, 0);
  const Vector3d side = other - other.dot(axis) * axis;
  return side / std::sqrt(side.dot(side));
}

}  // namespace

template <class Real>
JointRow<Real> row_of(const PlacedJoint& joint, const InitialBodies& bodies, const std::vector<bool>& moves,
                      std::uint32_t joint_count, double max_correction_speed, double h) {
  const auto narrow = [](const Vector3d& v) { return Vector3<Real>(v.cast<Real>()); };
  JointRow<Real> row{};
  JointStiffness<double> s{1, error_fraction / h, 0, 1};
  if (joint.kind == JointKind::spring) {
    const auto inverse_mass = [&](std::uint32_t body) {
      return body != PlacedJoint::world && moves[body] ? 1 / static_cast<Real>(bodies.mass[body]) : Real(0);
    };
    const Real linear = inverse_mass(joint.a) + inverse_mass(joint.b);
    const RotationalInverseMass rotational = rotational_inverse_mass(joint, bodies, moves);
    row.start_inverse_mass = linear + static_cast<Real>(rotational.start);
    const double wide = static_cast<double>(linear);
    const double ratio = wide > 0 ? (wide + rotational.most) / (wide + rotational.start) : 1;
    const double angle = spring_angle(joint, joint_count, ratio, h), frequency = angle / h;  // rad/s
    s = spring(joint, joint_count, angle, h);
    if (row.start_inverse_mass > 0)
      row.spring = static_cast<Real>(frequency * frequency) / row.start_inverse_mass;
  }
  row.a = joint.a;
  row.b = joint.b;
  row.kind = joint.kind;
  row.limited = joint.limited;
  row.anchor_a = narrow(joint.anchor_a);
  row.anchor_b = narrow(joint.anchor_b);
  row.max_correction_speed = static_cast<Real>(max_correction_speed);
  row.stiffness = {static_cast<Real>(s.mass_scale), static_cast<Real>(s.bias_rate),
                   static_cast<Real>(s.impulse_scale), static_cast<Real>(s.warm_start_factor)};
  row.low = static_cast<Real>(joint.low);
  row.high = static_cast<Real>(joint.high);
  row.axis_a = narrow(joint.axis);
  row.axis_b = narrow(joint.start.conjugate() * joint.axis);
  row.side = narrow(perpendicular_to(joint.axis));
  row.start = joint.start.cast<Real>();
  const CosineSine low = cosine_sine(joint.low_angle / 2), high = cosine_sine(joint.high_angle / 2);
  row.low_cosine = static_cast<Real>(low.cosine);
  row.low_sine = static_cast<Real>(low.sine);
  row.high_cosine = static_cast<Real>(high.cosine);
  row.high_sine = static_cast<Real>(high.sine);
  return row;
}

std::vector<std::size_t> colours_of(const std::vector<PlacedJoint>& joints, const std::vector<bool>& in_tree,
                                    const std::vector<bool>& moves) {
  std::vector<std::vector<std::uint64_t>> taken(moves.size());
  std::vector<std::size_t> colours;
  for (const PlacedJoint& joint : joints) {
    if (in_tree[colours.size()]) {
      colours.push_back(0);
      continue;
    }
    const auto words = [&](std::uint32_t body) {
      return body != PlacedJoint::world && moves[body] ? &taken[body] : nullptr;
    };
    std::vector<std::uint64_t>*const a = words(joint.a), *const b = words(joint.b);
    std::size_t word = 0;
    std::uint64_t used = 0;
    for (;; ++word) {
      used = (a && word < a->size() ? (*a)[word] : 0) | (b && word < b->size() ? (*b)[word] : 0);
      if (~used != 0) break;
    }
    const auto bit = static_cast<std::size_t>(std::countr_one(used));
    for (std::vector<std::uint64_t>* body : {a, b}) {
      if (body == nullptr) continue;
      if (body->size() <= word) body->resize(word + 1, 0);
      (*body)[word] |= std::uint64_t{1} << bit;
    }
    colours.push_back(64 * word + bit);
  }
  return colours;
}

template JointRow<float> row_of(const PlacedJoint&, const InitialBodies&, const std::vector<bool>&,
                                std::uint32_t, double, double);
template JointRow<double> row_of(const PlacedJoint&, const InitialBodies&, const std::vector<bool>&,
                                 std::uint32_t, double, double);

}  // namespace collidoscope
